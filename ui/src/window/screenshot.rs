//! The finished picture as a PNG file: from radiance, not from the screen, and never half a file.

use super::render_thread::Picture;
use crate::notes::{Made, notes};
use afterimage::raster::color::{ToneMap, srgb8};
use afterimage::raster::save::{encode_png, write_new_atomically};
use std::path::PathBuf;

/// How a picture is developed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Development {
    /// In stops.
    pub exposure_ev: f32,
    /// From radiance to display.
    pub tone_map: ToneMap,
}

/// Saves a picture under a name that is not taken, in the first folder that takes it; returns the path.
///
/// # Errors
/// Where no folder takes it, with the reason of the last one.
pub fn save(
    picture: &Picture,
    development: Development,
    stem: &str,
    folders: &[PathBuf],
) -> anyhow::Result<PathBuf> {
    let bytes = png_bytes(picture, development)?;
    let mut result = Err(anyhow::anyhow!("there is no folder to save pictures in"));
    for folder in folders {
        result = write_new_atomically(folder, stem, "png", &bytes).map_err(Into::into);
        if result.is_ok() {
            break;
        }
    }
    result
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
    let name: String = scene_name.trim_start_matches("builtin:").chars().take(60).map(plain).collect();
    format!("afterimage-{name}")
}

fn png_bytes(picture: &Picture, development: Development) -> anyhow::Result<Vec<u8>> {
    let Development { exposure_ev, tone_map } = development;
    let pixels: Vec<[u8; 3]> = picture.radiance.iter().map(|&c| srgb8(c, exposure_ev, tone_map)).collect();
    let notes = notes(&Made {
        scene_name: &picture.scene.name,
        scene: &picture.scene,
        camera: &picture.camera,
        settings: &picture.settings,
        is_complete: picture.is_complete,
        refined: picture.refined,
        exposure_ev,
        tone_map,
    });
    Ok(encode_png(picture.size, &pixels, &notes)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use afterimage::scene::SceneBuilder;
    use afterimage::{Camera, RefineState, RenderSettings};
    use glam::{DVec3, Vec2, Vec3};
    use std::sync::Arc;

    fn picture(radiance: Vec<Vec3>) -> Picture {
        let mut builder = SceneBuilder::new("builtin:square");
        let material = builder.add_material(afterimage::scene::Material::diffuse("m", Vec3::ONE));
        let corners = [DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y];
        builder.add_quad(corners, Vec2::ONE, material);
        Picture {
            size: [radiance.len() as u32, 1],
            radiance,
            scene: Arc::new(builder.finish().unwrap()),
            camera: Camera::look_at(DVec3::Z, DVec3::ZERO, 60.0),
            settings: RenderSettings::default(),
            is_complete: true,
            refined: RefineState::default(),
        }
    }

    const PLAIN: Development = Development { exposure_ev: 0.0, tone_map: ToneMap::Linear };

    #[test]
    fn pictures_never_overwrite_each_other_and_hold_the_pixels() {
        let folder = tempfile::tempdir().unwrap();
        let picture = picture(vec![Vec3::ZERO, Vec3::new(1.0, 0.0, 0.0)]);
        let folders = [PathBuf::from("/no/such/folder"), folder.path().to_owned()];
        let first = save(&picture, PLAIN, "a", &folders).unwrap();
        let second = save(&picture, PLAIN, "a", &folders).unwrap();
        assert_ne!(first, second);
        let image = image::open(&second).unwrap().to_rgb8();
        assert_eq!((image.get_pixel(0, 0).0, image.get_pixel(1, 0).0), ([0, 0, 0], [255, 0, 0]));
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2, "something half-written was left");
    }

    #[test]
    fn a_picture_says_how_it_was_made() {
        let bytes = png_bytes(&picture(vec![Vec3::ONE]), PLAIN).unwrap();
        let text = String::from_utf8_lossy(&bytes);
        for words in ["builtin:square", "--eye 0,0,1 --look-at 0,0,0", "--samples", "linear at 0 EV"] {
            assert!(text.contains(words), "'{words}' is not in the file");
        }
    }

    #[test]
    #[cfg(unix)]
    fn a_picture_gets_the_permissions_of_any_new_file() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let usual = folder.path().join("usual");
        std::fs::write(&usual, "").unwrap();
        let saved = save(&picture(vec![Vec3::ONE]), PLAIN, "a", &[folder.path().to_owned()]).unwrap();
        let mode = |path: &std::path::Path| std::fs::metadata(path).unwrap().permissions().mode();
        assert_eq!(mode(&saved), mode(&usual));
    }

    #[test]
    fn a_scene_name_becomes_a_plain_file_name() {
        assert_eq!(stem("builtin:gallery"), "afterimage-gallery");
        assert_eq!(stem("../a b/c"), "afterimage----a-b-c");
    }
}
