//! The finished picture as a PNG file: from radiance, not from the screen, and never half a file.

use super::render_thread::Picture;
use afterimage::raster::color::{ToneMap, srgb8};
use anyhow::Context;
use std::io::Write;
use std::path::{Path, PathBuf};

/// How a picture is developed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Development {
    /// In stops.
    pub exposure_ev: f32,
    /// From radiance to display.
    pub tone_map: ToneMap,
}

/// A name is tried with so many numbers before giving up.
const MOST_NAMES: u32 = 100_000;

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
        result =
            write_new(&bytes, folder, stem).with_context(|| format!("cannot save in {}", folder.display()));
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

/// The current folder may change and disks fill up: the file appears under its name only when it is whole.
fn write_new(bytes: &[u8], folder: &Path, stem: &str) -> anyhow::Result<PathBuf> {
    let mut file = tempfile::NamedTempFile::new_in(folder)?;
    file.write_all(bytes)?;
    file.as_file().sync_all()?;
    for number in 1..MOST_NAMES {
        let path = folder.join(format!("{stem}-{number:04}.png"));
        match file.persist_noclobber(&path) {
            Ok(_) => return Ok(path),
            Err(error) if error.error.kind() == std::io::ErrorKind::AlreadyExists => file = error.file,
            Err(error) => return Err(error.error.into()),
        }
    }
    anyhow::bail!("all names {stem}-NNNN.png are taken")
}

fn png_bytes(picture: &Picture, development: Development) -> anyhow::Result<Vec<u8>> {
    let Development { exposure_ev, tone_map } = development;
    let pixels: Vec<u8> = picture.radiance.iter().flat_map(|&c| srgb8(c, exposure_ev, tone_map)).collect();
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, picture.size[0], picture.size[1]);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::RelativeColorimetric);
    encoder.add_text_chunk("Software".to_owned(), "Afterimage".to_owned())?;
    encoder.add_text_chunk("Tone map".to_owned(), tone_map.name().to_owned())?;
    encoder.add_text_chunk("Exposure".to_owned(), format!("{exposure_ev} EV"))?;
    let mut writer = encoder.write_header()?;
    writer.write_image_data(&pixels)?;
    writer.finish()?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    const PLAIN: Development = Development { exposure_ev: 0.0, tone_map: ToneMap::Linear };

    #[test]
    fn pictures_never_overwrite_each_other_and_hold_the_pixels() {
        let folder = tempfile::tempdir().unwrap();
        let picture = Picture { size: [2, 1], radiance: vec![Vec3::ZERO, Vec3::new(1.0, 0.0, 0.0)] };
        let folders = [PathBuf::from("/no/such/folder"), folder.path().to_owned()];
        let first = save(&picture, PLAIN, "a", &folders).unwrap();
        let second = save(&picture, PLAIN, "a", &folders).unwrap();
        assert_ne!(first, second);
        let image = image::open(&second).unwrap().to_rgb8();
        assert_eq!((image.get_pixel(0, 0).0, image.get_pixel(1, 0).0), ([0, 0, 0], [255, 0, 0]));
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2, "something half-written was left");
    }

    #[test]
    fn a_scene_name_becomes_a_plain_file_name() {
        assert_eq!(stem("builtin:gallery"), "afterimage-gallery");
        assert_eq!(stem("../a b/c"), "afterimage----a-b-c");
    }
}
