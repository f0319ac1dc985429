//! Where pictures of the window are kept, and what they are called.

use afterimage::raster::color::ToneMap;
use std::path::PathBuf;

/// How a picture is developed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Development {
    /// In stops.
    pub exposure_ev: f32,
    /// From radiance to display.
    pub tone_map: ToneMap,
}

/// The current folder, and after it the user's pictures.
pub fn default_folders() -> Vec<PathBuf> {
    let home = std::env::var_os("HOME").map(PathBuf::from);
    let pictures = std::env::var_os("XDG_PICTURES_DIR").map(PathBuf::from);
    let pictures = pictures.or_else(|| home.as_ref().map(|home| home.join("Pictures")));
    std::env::current_dir().ok().into_iter().chain(pictures).chain(home).collect()
}

/// A file stem out of a scene's name: nothing that a file system could take amiss.
pub fn stem(scene_name: &str) -> String {
    let plain = |c: char| if c.is_alphanumeric() || c == '-' || c == '_' { c } else { '-' };
    let name = scene_name.trim_start_matches("builtin:");
    let name = [".obj", ".gltf", ".glb"].iter().find_map(|end| name.strip_suffix(end)).unwrap_or(name);
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
