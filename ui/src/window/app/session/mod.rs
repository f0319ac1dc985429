//! Session files: their format, and where they are.

mod file;
#[cfg(test)]
mod hostile;
mod place;
#[cfg(test)]
mod soak;
mod sun;

pub(super) use file::{EXTENSION, SessionFile, is_session};
pub(super) use place::{beside_model, write_session};
