//! Where new files are saved, and how they are named.

use afterimage::raster::save::{SaveError, Target};
use std::path::PathBuf;

/// Folders that are tried in order, and the stem of the names in them.
#[derive(Clone, Debug)]
pub(crate) struct Destination {
    pub(crate) folders: Vec<PathBuf>,
    pub(crate) stem: String,
}

impl Destination {
    /// Saves in `chosen`; where nothing is chosen, in the folder of the model, or in the default
    /// folders. Files are named after the scene.
    pub(crate) fn new(chosen: Option<PathBuf>, model_folder: Option<PathBuf>, scene_name: &str) -> Self {
        let beside = || model_folder.into_iter().chain(default_folders()).collect();
        let folders = chosen.map_or_else(beside, |folder| vec![folder]);
        Self { folders, stem: stem(scene_name) }
    }

    /// Writes a new file into the first folder that accepts it, and returns its path.
    ///
    /// # Errors
    /// The error of the last folder; `None` where there is no folder.
    pub(crate) fn write_new(
        &self,
        extension: &'static str,
        bytes: &[u8],
    ) -> Result<PathBuf, Option<SaveError>> {
        let mut last = None;
        for folder in &self.folders {
            match (Target::Next { folder: folder.clone(), stem: self.stem.clone(), extension }).write(bytes) {
                Ok(path) => return Ok(path),
                Err(error) => last = Some(error),
            }
        }
        Err(last)
    }
}

/// The user's folder for pictures, then the current folder, then the home folder.
fn default_folders() -> Vec<PathBuf> {
    let home = std::env::var_os("HOME").map(PathBuf::from);
    pictures_folder().into_iter().chain(std::env::current_dir().ok()).chain(home).collect()
}

/// The user's folder for pictures.
pub(crate) fn pictures_folder() -> Option<PathBuf> {
    let pictures = std::env::var_os("XDG_PICTURES_DIR").map(PathBuf::from);
    pictures.or_else(|| std::env::var_os("HOME").map(|home| PathBuf::from(home).join("Pictures")))
}

/// Turns the name of a scene into the stem of a file name that any file system accepts.
fn stem(scene_name: &str) -> String {
    let plain = |c: char| if c.is_alphanumeric() || c == '-' || c == '_' { c } else { '-' };
    let name = scene_name.trim_start_matches("builtin:");
    let mut extensions = afterimage::import::extensions();
    let name = extensions.find_map(|e| name.strip_suffix(e)?.strip_suffix('.')).unwrap_or(name);
    let name: String = name.chars().take(60).map(plain).collect();
    format!("afterimage-{name}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_name_becomes_a_plain_file_name() {
        assert_eq!(stem("builtin:gallery"), "afterimage-gallery");
        assert_eq!(stem("house.obj"), "afterimage-house");
        assert_eq!(stem("../a b/c"), "afterimage----a-b-c");
    }
}
