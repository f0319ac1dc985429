//! The embedded scenes.

use super::{Scene, SceneBuilder, SceneError};

/// Names of the embedded scenes; the first is the default.
pub const NAMES: &[&str] = &["gallery"];

/// Builds an embedded scene.
///
/// # Errors
/// [`SceneError::UnknownBuiltin`] where there is none of that name.
pub fn build(name: &str) -> Result<Scene, SceneError> {
    let _ = SceneBuilder::new(name);
    Err(SceneError::UnknownBuiltin { name: name.to_owned(), known: NAMES.join(", ") })
}
