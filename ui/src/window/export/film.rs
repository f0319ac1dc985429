//! Saving films in the background.

use super::{Destination, Exported};
use crate::picture::film::{Film, FilmEvent};
use crate::window::rendering::{TaskError, TaskHandle};
use afterimage::Tracer;
use afterimage::raster::save::Target;
use std::sync::Arc;

/// Saves a film in the first folder that accepts it.
///
/// # Errors
/// [`TaskError::Cancelled`] before the first frame, or a message with a remedy. After the first
/// frame, a film that was cancelled is a result: what was complete is kept.
pub(crate) fn save_film(
    film: &Film,
    tracer: &Arc<Tracer>,
    destination: &Destination,
    task: &TaskHandle,
) -> Result<Exported, TaskError> {
    let mut refusal = "there is no folder to save films in".to_owned();
    for folder in &destination.folders {
        let (folder, stem) = (folder.clone(), destination.stem.clone());
        let target = Target::Next { folder, stem, extension: "mp4" };
        match target.probe() {
            Ok(()) => return save(film, tracer, target, task),
            Err(error) => refusal = format!("{error}; choose another folder in Scene, Picture settings"),
        }
    }
    Err(TaskError::Failed(refusal))
}

fn save(film: &Film, tracer: &Arc<Tracer>, target: Target, task: &TaskHandle) -> Result<Exported, TaskError> {
    let count = film.walk.frames;
    let what = format!("Film of {count} frames");
    task.begin(&what)?;
    let made = film.make(tracer, target, &|| task.is_cancelled(), &mut |event| match event {
        FilmEvent::Frames(done) => task.report(&what, done as f32 / count.max(1) as f32),
        FilmEvent::Ending(frames) => task.report(&format!("Film, its first {frames} frames"), 1.0),
        FilmEvent::StoreProblem(_) => {}
    });
    let made = made
        .map_err(|error| TaskError::Failed(format!("{error}; free some space or choose another folder")))?;
    let made = made.ok_or(TaskError::Cancelled)?;
    if let Some(problem) = &made.problem {
        return Err(TaskError::Failed(format!("{problem}; {}", made.text())));
    }
    Ok(Exported { text: made.text(), path: Some(made.path), film_command: None })
}
