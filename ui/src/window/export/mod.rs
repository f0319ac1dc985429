//! Saving pictures and picture sequences.

pub(crate) mod destination;
pub(crate) mod pictures;

pub(crate) use destination::Destination;
pub(crate) use pictures::{Exported, save_picture, save_sequence, spawn_export};
