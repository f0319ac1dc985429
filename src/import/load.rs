//! The entry point of the importer.

use super::formats::{Format, extensions};
use super::progress::{Progress, Steps};
use super::{context::Import, files::unreadable, options::ImportOptions};
use crate::scene::{Scene, SceneError};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::time::Instant;

/// Reads a model with all files that belong to it: libraries, textures, and the `.afterimage.toml`
/// next to it.
///
/// ```no_run
/// use afterimage::import::{ImportOptions, load};
///
/// let scene = load("house.glb".as_ref(), &ImportOptions::default(), &|_phase, _part| true)?;
/// for warning in &scene.warnings {
///     eprintln!("{}: {}", warning.file, warning.message);
/// }
/// # Ok::<(), afterimage::scene::SceneError>(())
/// ```
///
/// # Errors
/// [`SceneError::Read`], [`SceneError::Line`] or [`SceneError::TooLarge`] where nothing can be
/// shown, [`SceneError::Cancelled`] where `progress` returned `false`.
pub fn load(path: &Path, options: &ImportOptions, progress: Progress) -> Result<Scene, SceneError> {
    catch_unwind(AssertUnwindSafe(|| read(path, options, Steps { progress })))
        .unwrap_or_else(|_| Err(unreadable(path, "the importer failed on it", "please report this file")))
}

fn read(path: &Path, options: &ImportOptions, steps: Steps) -> Result<Scene, SceneError> {
    let mut import = Import::new(path, options, steps)?;
    let Some(format) = Format::of(path) else {
        let known: Vec<String> = extensions().map(|e| format!(".{e}")).collect();
        let cause = "models of this format are not read";
        return Err(import.failed(cause, format!("export the model as one of {}", known.join(", "))));
    };
    profiling::scope!("import");
    let start = Instant::now();
    (format.read)(&mut import)?;
    let scene = import.finish()?;
    let (triangles, secs) = (scene.triangles.len(), start.elapsed().as_secs_f64());
    let (materials, textures, warnings) = (scene.materials.len(), scene.textures.len(), scene.warnings.len());
    log::info!(
        "{}: {triangles} triangles, {materials} materials, {textures} textures, {warnings} warnings, in {secs:.3} s",
        path.display()
    );
    Ok(scene)
}
