//! Folders of numbered pictures, `frame_0000.png` and so on, with a description by which an
//! interrupted sequence or film recognises its own.

use super::PictureJob;
use afterimage::raster::load::{Picture, read_bounded};
use afterimage::raster::save::write_atomically;
use afterimage::{Tracer, camera::CameraPath, render::bands::Background};
use anyhow::{Context, bail, ensure};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Name of the file that describes the pictures of a folder.
pub(super) const DESCRIPTION: &str = "sequence.json";

/// Path of a picture.
pub(super) fn picture_path(folder: &Path, frame: u32) -> PathBuf {
    folder.join(format!("frame_{frame:04}.png"))
}

/// Everything that decides the pictures of a camera path.
pub(super) fn description(job: &PictureJob, walk: &CameraPath, tracer: &Tracer) -> Value {
    let [width, height] = job.size;
    json!({
        "scene": job.scene_name,
        "scene_hash": tracer.scene().hash,
        "size": [width, height],
        "samples": job.settings.trace.samples,
        "bounces": job.settings.trace.bounce_limit(),
        "seed": job.settings.trace.seed,
        "antialias": job.antialias,
        "has_background": job.background == Background::Shown,
        "exposure_ev": job.exposure_ev,
        "tone_map": job.tone_map.name(),
        "walk": walk,
    })
}

/// A description as the text of its file.
pub(super) fn text_of(description: &Value) -> String {
    format!("{description:#}\n")
}

/// True where a folder holds pictures with this description.
pub(super) fn is_described(folder: &Path, text: &str) -> bool {
    read_bounded(&folder.join(DESCRIPTION), text.len() as u64).is_ok_and(|bytes| bytes == text.as_bytes())
}

/// Opens a folder for pictures with a description: a new or an empty one, or one whose pictures have
/// the same description.
///
/// # Errors
/// If the folder cannot be written to, or holds other pictures; then nothing in it is changed.
pub(super) fn open(folder: &Path, text: &str) -> anyhow::Result<()> {
    let place = || format!("the folder {}", folder.display());
    std::fs::create_dir_all(folder).with_context(|| format!("cannot create {}", place()))?;
    if is_described(folder, text) {
        return Ok(());
    }
    ensure!(
        !folder.join(DESCRIPTION).exists(),
        "{} holds pictures of another film, or of this one with other settings; choose another folder",
        place()
    );
    if picture_path(folder, 0).exists() {
        bail!("{} holds pictures that do not say which film they are of; choose another folder", place());
    }
    Ok(write_atomically(&folder.join(DESCRIPTION), text.as_bytes())?)
}

/// Reads a picture of a size as 8-bit sRGB.
///
/// # Errors
/// If it cannot be read, or has another size.
pub(super) fn read(path: &Path, size: [u32; 2]) -> anyhow::Result<Vec<[u8; 3]>> {
    let remedy = "delete it, and it will be rendered again";
    let picture = Picture::load(path).with_context(|| remedy.to_owned());
    let picture = picture.map_err(|error| anyhow::anyhow!("{}; {remedy}", error.root_cause()))?;
    ensure!(picture.size == size, "{} has another size; {remedy}", path.display());
    Ok(picture.values.iter().map(|value| (*value * 255.0).round().to_array().map(|c| c as u8)).collect())
}
