//! Saving pictures and picture sequences.

pub(crate) mod destination;
pub(crate) mod panorama;
mod pictures;

pub(crate) use destination::Destination;
pub(crate) use panorama::save_panorama;
pub(crate) use pictures::{Exported, save_picture, save_sequence, spawn_export};
