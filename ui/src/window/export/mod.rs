//! Saving pictures and picture sequences.

pub(crate) mod destination;
pub(crate) mod pictures;
