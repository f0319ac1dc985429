//! Commands about saved pictures and picture sequences.

use super::{Parts, Services, SessionFile, panorama_job, save_shown};
use crate::picture::film::{Film, FilmFormat, FilmHeatmap, rays_of};
use crate::picture::sequence::Sequence;
use crate::picture::{LONGEST_SIDE, PictureJob, Shows};
use crate::window::export::{Exported, save_film, save_panorama, save_picture, save_sequence, spawn_export};
use crate::window::input::playback::film_frames;
use crate::window::rendering::{
    Picture, Quantity, RenderCommand, SeenSection, TaskError, TaskHandle, take_result,
};
use crate::window::state::{AppState, PictureCommand, PictureFormat, PictureSize};
use afterimage::camera::CameraPath;
use afterimage::raster::film::even;
use afterimage::reference::ReferenceFrame;
use afterimage::render::aov::Aov;
use afterimage::render::bands::Background;
use afterimage::render::outlines::MAX_OUTLINE_WIDTH;
use afterimage::{Camera, Mode, RenderSettings, Tracer};
use anyhow::{Context, ensure};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

/// Applies a command about saved pictures.
pub(super) fn handle_picture(app: &mut Parts, command: PictureCommand) {
    let picture = &mut app.state.picture;
    let saved = match command {
        PictureCommand::Save if app.state.options.quantity != Quantity::Picture => {
            return save_shown(app);
        }
        PictureCommand::Save => save(app, None),
        PictureCommand::SaveWithoutBackground => save(app, Some(Background::LeftOut)),
        PictureCommand::SaveSequence => sequence(app),
        PictureCommand::SaveFilm => film(app),
        PictureCommand::SavePanorama => panorama(app),
        PictureCommand::ShowDialog(is_open) => return picture.is_open = is_open,
        PictureCommand::Set(settings) => return picture.settings = settings,
        PictureCommand::SetFolderText(text) => {
            let trimmed = text.trim();
            picture.settings.folder = (!trimmed.is_empty()).then(|| PathBuf::from(trimmed));
            return picture.folder_text = text;
        }
        PictureCommand::Cancel => return cancel(&mut app.state, &mut app.services),
    };
    if let Err(error) = saved {
        app.state.error(error.to_string());
    }
}

fn cancel(state: &mut AppState, services: &mut Services) {
    if let Some(export) = services.export.as_ref().filter(|_| state.picture.running_film.is_some()) {
        // What is complete is kept, and the window does not wait for the encoder.
        return export.cancel();
    }
    if let Some(export) = services.export.take() {
        export.cancel_and_wait();
        state.picture.end_export(false);
        state.info("saving was cancelled");
    }
}

/// Returns the picture of a view with the settings of the dialog.
fn job(state: &AppState, camera: Camera, background: Background) -> anyhow::Result<PictureJob> {
    let settings = &state.picture.settings;
    let size = match settings.size {
        PictureSize::Viewport => state.viewport_size.map(|side| side.clamp(1, LONGEST_SIDE)),
        PictureSize::Pixels(size) => size,
    };
    let is_valid = size.iter().all(|side| (1..=LONGEST_SIDE).contains(side));
    ensure!(is_valid, "a picture is from 1 to {LONGEST_SIDE} pixels wide and high");
    let mut render = state.quality.walk.render;
    render.trace.samples = settings.samples.unwrap_or(render.trace.samples);
    render.mode = if background == Background::LeftOut { Mode::Full } else { settings.mode };
    Ok(PictureJob {
        scene_name: state.scene.as_ref().map(|s| s.source.label()).context("there is no scene yet")?,
        camera,
        size,
        settings: render,
        antialias: (render.mode == Mode::Full && settings.antialias > 1).then_some(settings.antialias),
        background,
        exposure_ev: state.exposure_ev(),
        tone_map: state.quality.tone_map,
        outlines: state.options.has_edges.then_some((size[1] / 1080).clamp(1, MAX_OUTLINE_WIDTH)),
        document: SessionFile::note_of(state).map(Into::into),
    })
}

/// Saves the current view. Modes that reuse references first ask the render thread for them.
fn save(app: &mut Parts, background: Option<Background>) -> anyhow::Result<()> {
    let background = background.unwrap_or(app.state.picture.settings.background);
    let job = job(&app.state, *app.state.navigation.fly.camera(), background)?;
    if job.settings.mode == Mode::Full {
        return export_picture(app, job, Vec::new());
    }
    app.services.render.send(RenderCommand::Picture);
    Ok(())
}

/// Saves a picture whose references have arrived from the render thread.
pub(super) fn save_from_references(app: &mut Parts, picture: Picture) {
    let job = job(&app.state, picture.camera, Background::Shown);
    let saved = job.and_then(|job| export_picture(app, job, picture.references));
    if let Err(error) = saved {
        app.state.error(error.to_string());
    }
}

fn export_picture(
    app: &mut Parts,
    job: PictureJob,
    references: Vec<Arc<ReferenceFrame>>,
) -> anyhow::Result<()> {
    job.check(&references)?;
    let settings = &app.state.picture.settings;
    let shows = match settings.format {
        // A JPEG file has no transparency.
        PictureFormat::Jpeg if job.background == Background::LeftOut => Shows::Display,
        PictureFormat::Jpeg => Shows::Jpeg(settings.jpeg_quality),
        PictureFormat::Png => Shows::Display,
        PictureFormat::Exr => Shows::Linear(Aov::ALL.to_vec()),
    };
    let destination = app.services.destination(&app.state);
    let samples = samples_of(&job);
    start(app, samples, move |tracer, task| {
        save_picture(&job, tracer, &references, &destination, &shows, task)
    })
}

/// Saves the camera path. Every picture of the sequence is traced in full.
fn sequence(app: &mut Parts) -> anyhow::Result<()> {
    let walk = app.state.path().clone();
    let is_path = walk.keyframes.len() > 1;
    ensure!(is_path, "a sequence needs a camera path of two keys or more; K adds one at your pose");
    let settings = &app.state.picture.settings;
    let job = job(&app.state, *app.state.navigation.fly.camera(), settings.film_background)?;
    let full = RenderSettings { mode: Mode::Full, ..job.settings };
    let antialias = Some(settings.antialias).filter(|n| *n > 1);
    let rate = settings.film_rate;
    let walk = CameraPath { frames: film_frames(&walk, rate), ..walk };
    let sequence = Sequence { job: PictureJob { settings: full, antialias, ..job }, walk, rate };
    let destination = app.services.destination(&app.state);
    let samples = samples_of(&sequence.job) * f64::from(sequence.walk.frames);
    start(app, samples, move |tracer, task| save_sequence(&sequence, tracer, &destination, task))
}

/// Saves the camera path as a film, with references as a walk has them.
fn film(app: &mut Parts) -> anyhow::Result<()> {
    let walk = app.state.path().clone();
    ensure!(
        walk.keyframes.len() > 1,
        "a film needs a camera path of two keys or more; K adds one at your pose"
    );
    let settings = app.state.picture.settings.clone();
    let job = job(&app.state, *app.state.navigation.fly.camera(), Background::Shown)?;
    let size = if settings.size == PictureSize::Viewport { job.size.map(even) } else { job.size };
    let (walkthrough, rate, quality) = (app.state.quality.walk, settings.film_rate, settings.film_quality);
    let render = RenderSettings { mode: walkthrough.render.mode, ..job.settings };
    let antialias = Some(rays_of(quality)).filter(|n| *n > 1);
    let walk = CameraPath { frames: film_frames(&walk, rate), ..walk };
    let (job, heatmap) = (PictureJob { size, settings: render, antialias, ..job }, FilmHeatmap::Off);
    let format = FilmFormat::Mp4;
    let film = Film { job, walk, walkthrough, rate, format, quality, heatmap, pictures: None, store: None };
    film.check()?;
    let destination = app.services.destination(&app.state);
    let rays = film.rays_in_all();
    start(app, 0.0, move |tracer, task| save_film(&film, tracer, &destination, task))?;
    app.state.picture.running_film = Some(rays);
    Ok(())
}

/// Saves the panorama around the current pose.
fn panorama(app: &mut Parts) -> anyhow::Result<()> {
    let job = panorama_job(&app.state)?;
    let destination = app.services.destination(&app.state);
    let pixels = job.size.map(f64::from).iter().product();
    // Its samples are reused: they say nothing about the time of traced ones.
    start(app, 0.0, move |tracer, task| save_panorama(&job, tracer, &destination, task))?;
    app.state.picture.panorama_pixels = Some(pixels);
    Ok(())
}

/// Number of samples of a picture.
fn samples_of(job: &PictureJob) -> f64 {
    let pixels: f64 = job.size.map(f64::from).iter().product();
    pixels * f64::from(job.antialias.unwrap_or(1)) * f64::from(job.settings.trace.samples)
}

/// Starts an export of a number of samples, unless one is running.
fn start(
    app: &mut Parts,
    samples: f64,
    work: impl FnOnce(&Arc<Tracer>, &TaskHandle) -> Result<Exported, TaskError> + Send + 'static,
) -> anyhow::Result<()> {
    ensure!(app.services.export.is_none(), "a picture is being saved; wait for it, or cancel it");
    if let Some(tracer) = app.current.tracer() {
        let tracer = SeenSection::of(app.state.section(), tracer);
        let export =
            spawn_export(app.services.threads, app.services.wake.clone(), move |task| work(&tracer, task));
        app.services.export = Some(export);
        app.state.picture.running = Some((Instant::now(), samples));
    }
    Ok(())
}

/// Shows the progress of an export, and its result.
pub(super) fn poll_export(state: &mut AppState, services: &mut Services) {
    let result = take_result(&mut services.export);
    state.picture.exporting = services.export.as_ref().map(|export| export.progress());
    if let Some(result) = &result {
        state.picture.end_export(result.is_ok());
    }
    match result {
        Some(Ok(exported)) => {
            state.picture.film_command = exported.film_command;
            state.saved(exported.text, exported.path);
        }
        Some(Err(TaskError::Failed(text))) => state.error(text),
        Some(Err(TaskError::Cancelled)) => state.info("saving was cancelled"),
        None => {}
    }
}
