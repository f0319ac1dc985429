//! Back from a picture to its view: what its notes say, read again.

use crate::window::input::pose_text::pose_of_flags;
use afterimage::Camera;
use afterimage::raster::load::read_notes;
use std::path::Path;

/// What a picture says of its view.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureView {
    /// The scene as it was asked for: `builtin:NAME` or a path.
    pub scene: String,
    /// Its hash, as text.
    pub scene_hash: String,
    /// Where it was seen from.
    pub camera: Camera,
    /// Exposure in stops, where it is said.
    pub exposure_ev: Option<f32>,
}

/// True for the names of pictures that may know their view.
pub fn is_picture(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("png") || e.eq_ignore_ascii_case("exr"))
}

/// Reads a picture's view.
///
/// # Errors
/// A message for people: the file cannot be read, or knows nothing of a view.
pub fn read_view(path: &Path) -> Result<PictureView, String> {
    let notes = read_notes(path).map_err(|error| error.to_string())?;
    let note = |name: &str| notes.iter().find(|(n, _)| n == name).map(|(_, text)| text.as_str());
    let (Some(scene), Some(pose)) = (note("Scene"), note("Pose")) else {
        return Err(format!(
            "{} does not say what it shows: only pictures saved by this program lead back to their view, and only \
             while no other program has saved them again",
            path.display()
        ));
    };
    let damaged = |what: &str| format!("{}: its note '{what}' cannot be read", path.display());
    let (scene, scene_hash) = scene.rsplit_once(' ').ok_or_else(|| damaged("Scene"))?;
    let anywhere = Camera::look_at(glam::DVec3::ZERO, glam::DVec3::NEG_Z, 60.0);
    let camera = pose_of_flags(pose, &anywhere).map_err(|cause| format!("{}: {cause}", damaged("Pose")))?;
    let exposure_ev = note("Tone map").and_then(|text| text.split_whitespace().nth(2)?.parse().ok());
    Ok(PictureView { scene: scene.to_owned(), scene_hash: scene_hash.to_owned(), camera, exposure_ev })
}

/// The model may lie beside its picture: a path in it is meant from where the program was started then.
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
