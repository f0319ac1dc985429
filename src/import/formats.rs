//! The table of formats. A new format is a file or a folder with a `read` function, and an entry
//! here.

use super::{context::Import, gltf, obj};
use crate::scene::SceneError;
use std::path::Path;

/// A format of model files.
#[derive(Clone, Copy, Debug)]
pub struct Format {
    /// Name of the format, for users.
    pub name: &'static str,
    /// File name extensions, lower case, without the dot.
    pub extensions: &'static [&'static str],
    /// Reads `import.file` into `import.builder`.
    pub(super) read: fn(&mut Import) -> Result<(), SceneError>,
}

/// All formats that [`load`](super::load()) reads.
pub const FORMATS: &[Format] = &[
    Format { name: "OBJ", extensions: &["obj"], read: obj::read },
    Format { name: "glTF", extensions: &["gltf", "glb"], read: gltf::read },
];

/// Returns the file name extensions of all formats, lower case, without the dot.
pub fn extensions() -> impl Iterator<Item = &'static str> {
    FORMATS.iter().flat_map(|format| format.extensions).copied()
}

impl Format {
    /// Returns the format of a file by its extension, in upper or lower case.
    pub fn of(path: &Path) -> Option<&'static Self> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        FORMATS.iter().find(|format| format.extensions.contains(&extension.as_str()))
    }
}
