//! Restores the view of a saved picture from the metadata in its file.

use crate::picture::metadata::DOCUMENT;
use crate::picture::pose_text::pose_of_flags;
use afterimage::raster::exposure::Exposure;
use afterimage::{Camera, raster::load::read_notes};
use anyhow::{Context, bail};
use std::path::{Path, PathBuf};

/// Maximum size of the session in a picture, in bytes.
const MAX_DOCUMENT_BYTES: usize = 1 << 20;

/// The view that a picture shows.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureView {
    /// Name of the scene as given by the user: `builtin:NAME` or a path.
    pub scene: String,
    /// Hash of the scene, as text.
    pub scene_hash: String,
    /// Pose and field of view of the camera.
    pub camera: Camera,
    /// Exposure in stops; `None` if the file does not state it.
    pub exposure_ev: Option<f32>,
    /// Session with the changes of the scene, if the picture shows any.
    pub document: Option<String>,
    /// The picture itself.
    pub file: PathBuf,
}

/// True for file names of pictures, which may contain a view.
pub fn is_picture(path: &Path) -> bool {
    let is_it = |name: &str| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(name));
    is_it("png") || is_it("exr") || is_jpeg(path)
}

/// True for file names of JPEG pictures.
pub fn is_jpeg(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("jpg") || e.eq_ignore_ascii_case("jpeg"))
}

/// Reads the view of a picture.
///
/// # Errors
/// If the file cannot be read, or contains no valid view.
pub fn read_view(path: &Path) -> anyhow::Result<PictureView> {
    let notes = read_notes(path)?;
    let note = |name: &str| notes.iter().find(|(n, _)| n == name).map(|(_, text)| text.as_str());
    let (Some(scene), Some(pose)) = (note("Scene"), note("Pose")) else {
        bail!(
            "{} does not say what it shows: only pictures saved by this program contain their view, and only \
             until another program saves them again",
            path.display()
        );
    };
    let damaged = |what: &str| format!("{}: the metadata '{what}' cannot be read", path.display());
    let (scene, scene_hash) = scene.rsplit_once(' ').with_context(|| damaged("Scene"))?;
    let any_fov = Camera::look_at(glam::DVec3::ZERO, glam::DVec3::NEG_Z, 60.0);
    let camera = match pose_of_flags(pose, &any_fov) {
        Ok(camera) => camera,
        Err(cause) => bail!("{}: {cause}", damaged("Pose")),
    };
    let exposure_ev = note("Tone map").and_then(|text| text.split_whitespace().nth(2)?.parse().ok());
    let exposure_ev = exposure_ev.filter(|ev: &f32| Exposure::STOPS.contains(ev));
    let document = note(DOCUMENT).map(str::to_owned);
    if document.as_ref().is_some_and(|text| text.len() > MAX_DOCUMENT_BYTES) {
        bail!("{}: more than {MAX_DOCUMENT_BYTES} bytes are not read", damaged(DOCUMENT));
    }
    let (scene, scene_hash) = (scene.to_owned(), scene_hash.to_owned());
    Ok(PictureView { scene, scene_hash, camera, exposure_ev, document, file: path.to_owned() })
}

/// Looks for the model of a view also in the folder of its picture: a relative path in the file
/// refers to the folder that the program was started in.
pub fn beside(view: PictureView, picture: &Path) -> PictureView {
    let model = Path::new(&view.scene);
    if view.scene.starts_with("builtin:") || model.exists() {
        return view;
    }
    let folder = picture.parent().unwrap_or(Path::new("."));
    let name = model.file_name().map(|name| folder.join(name));
    let found = [Some(folder.join(model)), name].into_iter().flatten().find(|path| path.exists());
    found.map_or(view.clone(), |path| PictureView { scene: path.display().to_string(), ..view })
}
