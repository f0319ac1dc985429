//! Saving panoramas in the background.

use super::{Destination, Exported};
use crate::picture::panorama::{PanoramaJob, PanoramaOutput};
use crate::window::rendering::{TaskError, TaskHandle};
use afterimage::Tracer;
use afterimage::raster::save::Target;

/// Saves a panorama in the first folder that accepts it.
///
/// # Errors
/// [`TaskError::Cancelled`] without a file, or a message with a remedy.
pub(crate) fn save_panorama(
    job: &PanoramaJob,
    tracer: &Tracer,
    destination: &Destination,
    task: &TaskHandle,
) -> Result<Exported, TaskError> {
    let mut refusal = "there is no folder to save pictures in".to_owned();
    for folder in &destination.folders {
        let stem = format!("{}-panorama", destination.stem);
        let target = Target::Next { folder: folder.clone(), stem, extension: "png" };
        match target.probe() {
            Ok(()) => return save(job, tracer, target, task),
            Err(error) => refusal = format!("{error}; choose another folder in Scene, Picture settings"),
        }
    }
    Err(TaskError::Failed(refusal))
}

fn save(
    job: &PanoramaJob,
    tracer: &Tracer,
    target: Target,
    task: &TaskHandle,
) -> Result<Exported, TaskError> {
    let [width, height] = job.size;
    let what = format!("Panorama {width}x{height}");
    task.begin(&what)?;
    let (stop, progress) = (|| task.is_cancelled(), |part: f64| task.report(&what, part as f32));
    let output = PanoramaOutput { target, is_linear: false };
    let made = job.make_whole(tracer, std::slice::from_ref(&output), &stop, &progress);
    let made = made
        .map_err(|error| TaskError::Failed(format!("{error}; free some space or choose another folder")))?;
    let path = made.ok_or(TaskError::Cancelled)?.into_iter().next();
    let text = format!("saved {}", path.as_ref().map(|p| p.display().to_string()).unwrap_or_default());
    Ok(Exported { text, path, film_command: None })
}
