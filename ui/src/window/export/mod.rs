//! Saving pictures and picture sequences.

pub(crate) mod destination;
mod film;
pub(crate) mod panorama;
pub(crate) mod pictures;

pub(crate) use destination::Destination;
pub(crate) use film::save_film;
pub(crate) use panorama::save_panorama;
pub(crate) use pictures::{Exported, save_picture, save_sequence, spawn_export};
