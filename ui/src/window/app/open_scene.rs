//! Opening models, sessions and pictures. Unsaved changes are asked about before they would be
//! lost.

use super::{
    AppEvent, Arrival, Parts, SavedSession, SessionFile, begin_document, beside_model, end_recording,
    is_own_recovery, is_session, is_sky, look_again, open_sky, rebuild, remember_model, restore_session,
    save_session, show_note, watch,
};
use crate::picture::restore::{beside, is_picture, read_view};
use crate::settings;
use crate::window::input::{Obstacles, Playback};
use crate::window::panels::widgets::counted;
use crate::window::rendering::{
    LoadedScene, Loading, ReadEdit, RenderCommand, SceneSource, TaskError, take_result,
};
use crate::window::state::{Answer, AppState, Leaving, OutsidePicture, PlanState, SceneInfo};
use afterimage::scene::SourceFile;
use afterimage::{Camera, Tracer, raster::exposure::Exposure};
use egui::ViewportCommand;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A session file is refused beyond this size; a walk recorded for hours at ten poses a second is
/// smaller.
const MAX_SESSION_BYTES: u64 = 64 << 20;

/// Opens a file of any kind.
pub(super) fn open_path(app: &mut Parts, path: PathBuf) {
    app.state.forget_errors();
    app.current.arrival = Arrival::default();
    if is_picture(&path) {
        app.services.spawn(&format!("{}: reading the view", path.display()), move || {
            let view = read_view(&path).map_err(TaskError::failed)?;
            Ok(AppEvent::PictureView(beside(view, &path)))
        });
    } else if is_sky(&path) {
        open_sky(app, path);
    } else if is_session(&path) {
        open_session(app, path);
    } else {
        open_model(app, SceneSource::file(path));
    }
}

/// Opens a model, together with the session next to it where there is one.
pub(super) fn open_model(app: &mut Parts, source: SceneSource) {
    if let SceneSource::File { path, .. } = &source {
        let beside = beside_model(path);
        // A name may be shared by several models.
        let is_of_model = |file: &SessionFile| file.source(&beside).is_same(&SceneSource::file(path));
        match beside.exists().then(|| read_session(&beside)) {
            Some(Ok(file)) if is_of_model(&file) => {
                app.state.info(format!("with the session {}", beside.display()));
                app.current.arrival.session = Some((file, beside));
            }
            Some(Err(error)) => app.state.error(format!("{error:#}; the model is opened without it")),
            Some(Ok(_)) | None => {}
        }
    }
    open(app, source);
}

fn read_session(path: &Path) -> anyhow::Result<SessionFile> {
    SessionFile::parse(&settings::read_text(path, MAX_SESSION_BYTES)?, path)
}

/// Opens a session. A kept session that is broken is renamed, so that it is not offered again.
pub(super) fn open_session(app: &mut Parts, path: PathBuf) {
    match read_session(&path) {
        Ok(file) => {
            let source = file.source(&path);
            app.current.arrival.session = Some((file, path));
            open(app, source);
        }
        Err(error) => {
            let is_renamed = is_own_recovery(&app.services, &path)
                && std::fs::rename(&path, path.with_extension("toml.bad")).is_ok();
            let end = if is_renamed { "; it was renamed to end in .bad" } else { "" };
            app.state.error(format!("{error}{end}"));
        }
    }
}

pub(super) fn is_shown(state: &AppState, source: &SceneSource) -> bool {
    state.scene.as_ref().is_some_and(|s| s.source.is_same(source))
}

/// Loads a scene, or asks first what is to be done with unsaved changes. A reload keeps them.
pub(super) fn open(app: &mut Parts, source: SceneSource) {
    let is_reload = is_shown(&app.state, &source) && app.current.arrival.session.is_none();
    if is_reload || !app.state.is_unsaved() {
        load(app, source);
    } else {
        app.state.dialogs.leaving = Some(Leaving::Open(source));
    }
}

/// Opens a scene by itself: an earlier destination no longer applies.
pub(super) fn open_new(app: &mut Parts, source: SceneSource) {
    app.state.forget_errors();
    app.current.arrival = Arrival::default();
    open(app, source);
}

/// Loads the scene that is shown once more, unless another one is on its way.
pub(super) fn reload(app: &mut Parts) {
    if is_leaving(app) {
        return app.state.info("another scene is being opened; this one is not loaded again");
    }
    if let Some(source) = app.state.scene.as_ref().map(|s| s.source.clone()) {
        open(app, source);
    }
}

/// True where another scene is being loaded or waits for an answer, or the window does.
fn is_leaving(app: &Parts) -> bool {
    let loads_other =
        app.services.loading.as_ref().is_some_and(|loading| !is_shown(&app.state, &loading.source));
    let dialogs = &app.state.dialogs;
    let is_asked = dialogs.leaving.is_some() || dialogs.outside_picture.is_some();
    loads_other || is_asked || app.current.arrival.session.is_some()
}

/// Starts to load a scene. The old one is shown until the new one is complete.
fn load(app: &mut Parts, source: SceneSource) {
    app.state.dialogs.outside_picture = None;
    let (daylight, wake) = (app.services.launch.daylight.clone(), app.services.wake.clone());
    let edit = reading_of_session(app, &source, false);
    app.services.loading = Some(Loading::start(source, daylight, edit, wake));
}

/// Returns how the edit of the session that waits for its scene is read. Only what this program has
/// kept itself, and what the user agrees to, is read from outside the folder of the model.
fn reading_of_session(app: &Parts, source: &SceneSource, is_agreed: bool) -> Option<ReadEdit> {
    let (session, file) = app.current.arrival.session.clone()?;
    let allow_outside = is_agreed || is_own_recovery(&app.services, &file);
    let source = source.clone();
    Some(Box::new(move |scene| session.edit(scene, &scene.to_edit(), &source, allow_outside)))
}

/// Shows a scene that waits for the answer whether a picture outside its folder is read.
pub(super) fn answer_outside(app: &mut Parts, is_agreed: bool) {
    let Some(OutsidePicture { name, source, tracer }) = app.state.dialogs.outside_picture.take() else {
        return;
    };
    match reading_of_session(app, &source, true).filter(|_| is_agreed) {
        Some(edit) => {
            app.services.loading = Some(Loading::again(source, tracer, edit, app.services.wake.clone()));
        }
        None => {
            let text =
                format!("the picture of the sky {name} was left out; the session keeps it until it is saved");
            app.state.info(text);
            arrive(app, source, tracer);
        }
    }
}

/// Stops loading a scene; the scene that is shown stays.
pub(super) fn cancel_loading(app: &mut Parts) {
    app.services.loading = None;
    (app.current.arrival, app.current.discards_edits) = (Arrival::default(), false);
}

/// Shows the progress of loading, and then the scene.
pub(super) fn poll_loading(app: &mut Parts) {
    app.state.loading = app.services.loading.as_ref().map(|l| (l.source.clone(), l.progress()));
    let Some(result) = app.services.loading.as_ref().and_then(Loading::result) else { return };
    let (Some(loading), _) = (app.services.loading.take(), app.state.loading.take()) else { return };
    let source = loading.source.clone();
    match result {
        Ok(LoadedScene { tracer, edit }) => {
            let outside = edit.as_ref().and_then(|edit| edit.outside.clone());
            app.current.arrival.edit = edit;
            match outside {
                Some(name) => {
                    app.state.dialogs.outside_picture = Some(OutsidePicture { name, source, tracer });
                }
                None => arrive(app, source, tracer),
            }
        }
        Err(error) => {
            cancel_loading(app);
            if let TaskError::Failed(message) = error {
                app.state.error(message);
            }
        }
    }
}

/// Shows a scene that was loaded, or asks first what is to be done with changes that were made
/// meanwhile.
fn arrive(app: &mut Parts, source: SceneSource, tracer: Arc<Tracer>) {
    let discards = std::mem::take(&mut app.current.discards_edits);
    let is_reload = is_shown(&app.state, &source) && app.current.arrival.session.is_none();
    if is_reload || discards || !app.state.is_unsaved() {
        show_scene(app, source, tracer);
    } else {
        app.state.dialogs.leaving = Some(Leaving::Show(source, tracer));
    }
}

/// Reloads the scene when its files have changed. The camera stays, and the old scene stays where
/// the new one cannot be loaded.
pub(super) fn poll_watch(app: &mut Parts) {
    // A change waits until it is known whether the scene stays.
    if is_leaving(app) {
        return;
    }
    if let Some(Ok(path)) = take_result(&mut app.services.watch) {
        let files = app.current.tracer().map(|tracer| look_again(&tracer.scene().files)).unwrap_or_default();
        start_watch(app, path.clone(), files);
        app.state.info(format!("{} has changed and is loaded again", path.display()));
        reload(app);
    }
}

/// Watches a model's files. A change since the state in `files` loads the model again.
fn start_watch(app: &mut Parts, model: PathBuf, files: Vec<SourceFile>) {
    let services = &app.services;
    let watching = watch(model, files, services.own_writes.clone(), services.wake.clone());
    app.services.watch = Some(watching);
}

fn show_scene(app: &mut Parts, source: SceneSource, tracer: Arc<Tracer>) {
    let is_reload = is_shown(&app.state, &source);
    let arrival = std::mem::take(&mut app.current.arrival);
    let (scene, exposure) = (SceneInfo::new(source.clone(), &tracer), tracer.scene().exposure);
    if arrival.scene_hash.as_ref().is_some_and(|expected| *expected != tracer.scene().hash) {
        app.state.info("the scene has changed since the picture was taken; this is the same pose in it");
    }
    if !scene.warnings.is_empty() {
        let count = counted(scene.warnings.len(), "import warning");
        app.state.warning(format!("{}: {count}, listed in the tab Scene", scene.name));
    }
    app.current.number += 1;
    if !is_reload {
        end_recording(app);
        let (view_index, start) = start_pose(&mut app.state, &scene, &arrival);
        app.state.navigation.view_index = view_index;
        app.state.navigation.fly.jump_to(start);
        app.state.navigation.fly.set_speed(scene.speed_m_per_s);
        app.state.navigation.playback = Playback::default();
        app.state.navigation.renaming = None;
        app.state.navigation.before.clear();
    }
    app.state.scene = Some(scene);
    app.state.history.clear();
    app.state.thumbnails.set_tracer(tracer.clone());
    app.services.plan = None;
    app.state.plan = PlanState {
        view: if is_reload { app.state.plan.view } else { Default::default() },
        ..Default::default()
    };
    app.current.obstacles = Some(Obstacles::new(tracer.clone()));
    if !is_reload {
        reset_exposure(app, &arrival, exposure);
    }
    begin_document(app, tracer.scene(), is_reload);
    app.current.files_hash.clone_from(&tracer.scene().hash);
    app.current.first_generation = app.services.render.send(RenderCommand::SetTracer(tracer.clone()));
    app.current.factors_of = None;
    app.current.sent = None;
    let (fly, is_placed) = (app.state.navigation.fly.clone(), arrival.is_placed());
    restore_session(app, arrival.session, arrival.edit, is_reload);
    if is_placed {
        // Flags of the program take precedence over the session.
        app.state.navigation.fly = fly;
    }
    if let Some(note) = arrival.note {
        show_note(app, note);
    }
    rebuild(app);
    app.services.watch = None;
    if let SceneSource::File { path, .. } = source {
        remember_model(app, &path);
        let files = tracer.scene().files.to_vec();
        start_watch(app, path, files);
    }
}

/// Sets the exposure as it suits the scene; a reset of the quality restores it. `exposure` is that
/// of the scene.
fn reset_exposure(app: &mut Parts, arrival: &Arrival, exposure: Exposure) {
    let launch = &app.services.launch;
    app.state.default_quality.exposure = launch.exposure.unwrap_or(exposure);
    app.state.quality.exposure =
        arrival.exposure_ev.map_or(app.state.default_quality.exposure, Exposure::Stops);
}

/// Returns the index of the saved view to start at, and the pose.
fn start_pose(state: &mut AppState, scene: &SceneInfo, arrival: &Arrival) -> (usize, Camera) {
    let index = arrival.view.as_ref().and_then(|name| scene.views.iter().position(|v| v.name == *name));
    if let (Some(name), None) = (&arrival.view, index) {
        let known: Vec<&str> = scene.views.iter().map(|v| v.name.as_str()).collect();
        state.error(format!("{} has no view '{name}'; it has: {}", scene.name, known.join(", ")));
    }
    let index = index.unwrap_or(0);
    let mut camera = arrival.camera.unwrap_or(scene.views[index].camera);
    if let Some(degrees) = arrival.fov_y_deg {
        camera.fov_y = degrees.to_radians();
    }
    (index, camera)
}

/// Keeps the window open where closing it would lose changes or end an export, and asks.
pub(super) fn hold_close(app: &mut Parts) {
    if app.services.is_ended_from_outside() && !std::mem::replace(&mut app.current.may_close, true) {
        app.services.ctx.send_viewport_cmd(ViewportCommand::Close);
    }
    let is_closing = app.services.ctx.input(|i| i.viewport().close_requested());
    if is_closing {
        // The walk is saved before the program ends.
        end_recording(app);
    }
    let is_asked = app.state.is_unsaved() || app.services.export.is_some();
    if is_closing && !app.current.may_close && is_asked {
        app.services.ctx.send_viewport_cmd(ViewportCommand::CancelClose);
        app.current.arrival = Arrival::default();
        app.state.dialogs.leaving = Some(Leaving::Close);
    }
}

/// Applies the answer to the question about unsaved changes.
pub(super) fn handle_answer(app: &mut Parts, answer: Answer) {
    match answer {
        // The action follows once they are saved.
        Answer::Save => save_session(app),
        Answer::Discard => {
            let is_opening = matches!(app.state.dialogs.leaving, Some(Leaving::Open(_)));
            leave(app);
            app.current.discards_edits = is_opening;
        }
        Answer::Stay => {
            app.state.dialogs.leaving = None;
            app.current.arrival = Arrival::default();
        }
    }
}

/// Takes over a session that was saved, or could not be.
pub(super) fn poll_saving(app: &mut Parts) {
    if let Some(result) = take_result(&mut app.services.saving) {
        session_saved(app, result);
    }
}

/// Notes that a session was saved, or could not be, and does what has waited for that.
fn session_saved(app: &mut Parts, result: Result<SavedSession, TaskError>) {
    let saves_again = std::mem::take(&mut app.current.saves_again);
    match result {
        Ok(saved) => {
            app.state.info(format!("saved {}", saved.path.display()));
            note_saved(app, saved);
            if saves_again {
                return save_session(app);
            }
            // What has changed meanwhile is asked about as well.
            if !app.state.is_unsaved() {
                leave(app);
            }
        }
        Err(error) => {
            if app.state.dialogs.leaving.is_some() {
                handle_answer(app, Answer::Stay);
            }
            app.state.error(match error {
                TaskError::Failed(text) => text,
                TaskError::Cancelled => "saving was cancelled".to_owned(),
            });
        }
    }
}

/// Notes that the scene that is shown was saved, if it is the one that was.
fn note_saved(app: &mut Parts, SavedSession { path, source, scene, document, quality }: SavedSession) {
    if is_shown(&app.state, &source) {
        app.current.file = Some(path.clone());
    }
    if let Some(open) = app.state.document.as_mut().filter(|_| scene == app.current.number) {
        open.set_saved(document, quality);
    }
    // A session that waits to be opened was read before it was written again.
    if app.current.arrival.session.as_ref().is_some_and(|(_, file)| *file == path) {
        app.current.arrival.session = read_session(&path).ok().map(|session| (session, path));
        if let Some(Leaving::Show(source, _)) = &app.state.dialogs.leaving {
            app.state.dialogs.leaving = Some(Leaving::Open(source.clone()));
        }
    }
}

/// Does what has waited for the answer, if anything has.
fn leave(app: &mut Parts) {
    match app.state.dialogs.leaving.take() {
        Some(Leaving::Close) => {
            app.current.may_close = true;
            app.services.ctx.send_viewport_cmd(ViewportCommand::Close);
        }
        Some(Leaving::Open(source)) => load(app, source),
        Some(Leaving::Show(source, tracer)) => show_scene(app, source, tracer),
        None => {}
    }
}
