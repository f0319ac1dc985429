//! Saving pictures and picture sequences in the background.

use super::Destination;
use crate::picture::sequence::Sequence;
use crate::picture::{Output, PictureJob, Shows};
use crate::window::rendering::{Task, TaskError, TaskHandle, Wake, background_pool, spawn_activity};
use afterimage::Tracer;
use afterimage::raster::save::Target;
use afterimage::reference::ReferenceFrame;
use std::path::PathBuf;
use std::sync::Arc;

/// Result of an export.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Exported {
    /// Message for the user.
    pub(crate) text: String,
    /// The saved file, or the folder of a sequence.
    pub(crate) path: Option<PathBuf>,
    /// Shell command that makes a film of a sequence.
    pub(crate) film_command: Option<String>,
}

/// Runs an export on a pool of its own.
pub(crate) fn spawn_export(
    threads: usize,
    wake: Wake,
    work: impl FnOnce(&TaskHandle) -> Result<Exported, TaskError> + Send + 'static,
) -> Task<Exported> {
    spawn_activity("export", "saving", wake, move |task| {
        background_pool("export", threads).map_err(TaskError::failed)?.install(|| work(task))
    })
}

/// Saves a picture in the first folder that accepts it. `shows` decides the format.
///
/// # Errors
/// [`TaskError::Cancelled`] without a file, or a message with a remedy.
pub(crate) fn save_picture(
    job: &PictureJob,
    tracer: &Tracer,
    references: &[Arc<ReferenceFrame>],
    destination: &Destination,
    shows: &Shows,
    task: &TaskHandle,
) -> Result<Exported, TaskError> {
    let extension = match shows {
        Shows::Linear(_) => "exr",
        Shows::Jpeg(_) => "jpg",
        Shows::Display | Shows::Types => "png",
    };
    let mut refusal = "there is no folder to save pictures in".to_owned();
    for folder in &destination.folders {
        let (folder, stem) = (folder.clone(), destination.stem.clone());
        let output = Output { target: Target::Next { folder, stem, extension }, shows: shows.clone() };
        match output.target.probe() {
            Ok(()) => return save(job, tracer, references, &output, task),
            Err(error) => refusal = format!("{error}; choose another folder in File, Picture settings"),
        }
    }
    Err(TaskError::Failed(refusal))
}

fn save(
    job: &PictureJob,
    tracer: &Tracer,
    references: &[Arc<ReferenceFrame>],
    output: &Output,
    task: &TaskHandle,
) -> Result<Exported, TaskError> {
    let [width, height] = job.size;
    let what = format!("Picture {width}x{height}");
    task.begin(&what)?;
    let (stop, progress) = (|| task.is_cancelled(), |part: f64| task.report(&what, part as f32));
    let made = job.make_whole(tracer, references, std::slice::from_ref(output), &stop, &progress);
    let made = made
        .map_err(|error| TaskError::Failed(format!("{error}; free some space or choose another folder")))?;
    let paths = made.ok_or(TaskError::Cancelled)?.paths;
    let names: Vec<String> = paths.iter().map(|p| p.display().to_string()).collect();
    let text = format!("saved {}", names.join(", "));
    Ok(Exported { text, path: paths.into_iter().next(), film_command: None })
}

/// Saves a camera path as numbered pictures.
///
/// # Errors
/// [`TaskError::Cancelled`], or a message with a remedy; the pictures saved so far are kept.
pub(crate) fn save_sequence(
    sequence: &Sequence,
    tracer: &Tracer,
    destination: &Destination,
    task: &TaskHandle,
) -> Result<Exported, TaskError> {
    let what = format!("Sequence of {} pictures", sequence.walk.frames);
    task.begin(&what)?;
    let (stop, progress) = (|| task.is_cancelled(), |part: f64| task.report(&what, part as f32));
    let made = sequence.make(tracer, &destination.folders, &destination.stem, &stop, &progress);
    let made = made.map_err(TaskError::failed)?;
    if task.is_cancelled() {
        return Err(TaskError::Cancelled);
    }
    let (text, film_command) = (made.text(), Some(made.film_command()));
    Ok(Exported { text, path: Some(made.folder), film_command })
}

#[cfg(test)]
mod tests {
    use super::*;
    use afterimage::raster::color::ToneMap;
    use afterimage::render::bands::Background;
    use afterimage::scene::builtin;
    use afterimage::{Mode, RenderSettings};

    #[test]
    #[cfg(target_os = "linux")]
    fn a_full_disk_is_reported_with_a_remedy() {
        let tracer = Tracer::new(Arc::new(builtin::build("furnace").unwrap()));
        let job = PictureJob {
            scene_name: "builtin:furnace".to_owned(),
            camera: tracer.scene().views[0].camera,
            document: None,
            size: [64, 64],
            settings: RenderSettings { mode: Mode::Full, ..RenderSettings::default() },
            antialias: None,
            background: Background::Shown,
            exposure_ev: 0.0,
            tone_map: ToneMap::default(),
            outlines: None,
        };
        let output = Output { target: Target::File("/dev/full".into()), shows: Shows::Display };
        let work = move |task: &TaskHandle| save(&job, &tracer, &[], &output, task);
        let mut task = Some(spawn_export(1, Arc::new(|| {}), work));
        let result = loop {
            if let Some(result) = crate::window::rendering::task::take_result(&mut task) {
                break result;
            }
            std::thread::yield_now();
        };
        let Err(TaskError::Failed(text)) = result else { panic!("a full disk accepts no picture") };
        assert!(text.contains("No space") && text.contains("free some space"), "{text}");
    }
}
