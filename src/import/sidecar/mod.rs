//! The sidecar, a settings file next to a model, `<model>.afterimage.toml`: reading it, and saving
//! edits in it.

mod edit;
mod edit_text;
mod ground;
mod lamps;
mod light;
mod lights;
mod objects;
mod read;
mod table;

pub use edit::save_edit;
pub use edit_text::{AppliedEdit, EditFolder, apply_edit_text, edit_text};
pub(super) use read::Sidecar;
