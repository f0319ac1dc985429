//! The settings file beside a model, `<model>.afterimage.toml`: reading it, and saving edits in it.

mod edit;
mod read;
mod table;

pub use edit::save_look_beside;
pub(super) use read::Sidecar;
