//! Opening models, sessions and pictures. Unsaved changes are asked about before they would be lost.

use crate::picture::restore::{PictureView, beside, is_picture, read_view};
use crate::settings;
use crate::window::app::autosave::is_recovery;
use crate::window::app::persistence::{remember_model, restore_session};
use crate::window::app::scene_edits::{begin_edits, save_beside};
use crate::window::app::services::{AppEvent, Services};
use crate::window::app::session::{Arrival, Session};
use crate::window::app::session_file::{SessionFile, is_session};
use crate::window::app::watch::watch;
use crate::window::input::playback::Playback;
use crate::window::input::walking::Obstacles;
use crate::window::rendering::request::RenderCommand;
use crate::window::rendering::scene_loading::{Loading, SceneSource};
use crate::window::rendering::task::{TaskError, take_result};
use crate::window::state::{Answer, AppState, Edits, Leaving, PlanState, SceneInfo};
use afterimage::{Camera, Tracer};
use egui::ViewportCommand;
use std::path::PathBuf;
use std::sync::Arc;

/// A session file is refused beyond this size; a walk recorded for hours at ten poses a second is
/// smaller.
const MAX_SESSION_BYTES: u64 = 64 << 20;

/// Opens a file of any kind.
pub(super) fn open_path(state: &mut AppState, session: &mut Session, services: &mut Services, path: PathBuf) {
    session.arrival = Arrival::default();
    if is_picture(&path) {
        services.spawn("picture", move || {
            let view = read_view(&path).map_err(TaskError::failed)?;
            Ok(AppEvent::PictureView(beside(view, &path)))
        });
    } else if is_session(&path) {
        open_session(state, session, services, path);
    } else {
        open(state, services, SceneSource::file(path));
    }
}

/// Opens a session. A kept session that is broken is renamed, so that it is not offered again.
pub(super) fn open_session(
    state: &mut AppState,
    session: &mut Session,
    services: &mut Services,
    path: PathBuf,
) {
    let text = settings::read_text(&path, MAX_SESSION_BYTES).map_err(|error| error.to_string());
    match text.and_then(|text| SessionFile::parse(&text, &path)) {
        Ok(file) => {
            let source = file.source(&path);
            session.arrival.session = Some((file, path));
            open(state, services, source);
        }
        Err(message) => {
            let is_renamed =
                is_recovery(&path) && std::fs::rename(&path, path.with_extension("toml.bad")).is_ok();
            state.error(message + if is_renamed { "; it was renamed to end in .bad" } else { "" });
        }
    }
}

/// Goes to the view of a picture. Its scene is loaded unless it is shown.
pub(super) fn go_to_picture(
    state: &mut AppState,
    session: &mut Session,
    services: &mut Services,
    view: PictureView,
) {
    if session.tracer().is_some_and(|tracer| tracer.scene().hash == view.scene_hash) {
        state.navigation.fly.ease_to(view.camera);
        state.quality.exposure_ev = view.exposure_ev.unwrap_or(state.quality.exposure_ev);
        return state.info("the picture was taken here");
    }
    let source = SceneSource::named(&view.scene, Default::default());
    if let SceneSource::File { path, .. } = &source
        && !path.exists()
    {
        return state.error(format!(
            "the picture shows {}, which does not exist; open the model, then drop the picture again",
            view.scene
        ));
    }
    if is_shown(state, &source) {
        // A reload keeps the pose.
        state.navigation.fly.jump_to(view.camera);
    }
    session.arrival = Arrival {
        camera: Some(view.camera),
        exposure_ev: view.exposure_ev,
        scene_hash: Some(view.scene_hash),
        ..Arrival::default()
    };
    open(state, services, source);
}

fn is_shown(state: &AppState, source: &SceneSource) -> bool {
    state.scene.as_ref().is_some_and(|s| s.source.is_same(source))
}

fn has_unsaved_changes(state: &AppState) -> bool {
    state.edits.as_ref().is_some_and(Edits::is_unsaved)
}

/// Loads a scene, or asks first what is to be done with unsaved changes. A reload keeps them.
pub(super) fn open(state: &mut AppState, services: &mut Services, source: SceneSource) {
    if is_shown(state, &source) || !has_unsaved_changes(state) {
        load(services, source);
    } else {
        state.dialogs.leaving = Some(Leaving::Open(source));
    }
}

/// Opens a scene by itself: an earlier destination no longer applies.
pub(super) fn open_new(
    state: &mut AppState,
    session: &mut Session,
    services: &mut Services,
    source: SceneSource,
) {
    session.arrival = Arrival::default();
    open(state, services, source);
}

/// Loads the scene that is shown once more.
pub(super) fn reload(state: &mut AppState, services: &mut Services) {
    if let Some(source) = state.scene.as_ref().map(|s| s.source.clone()) {
        open(state, services, source);
    }
}

/// Starts to load a scene. The old one is shown until the new one is complete.
fn load(services: &mut Services, source: SceneSource) {
    services.loading = Some(Loading::start(source, services.wake.clone()));
}

/// Stops loading.
pub(super) fn cancel_loading(session: &mut Session, services: &mut Services) {
    services.loading = None;
    (session.arrival, session.discards_edits) = (Arrival::default(), false);
}

/// Shows the progress of loading, and then the scene, or asks first what is to be done with changes that
/// were made meanwhile.
pub(super) fn poll_loading(state: &mut AppState, session: &mut Session, services: &mut Services) {
    state.loading = services.loading.as_ref().map(|l| (l.source.clone(), l.progress()));
    let Some(result) = services.loading.as_ref().and_then(Loading::result) else { return };
    let (Some(loading), _) = (services.loading.take(), state.loading.take()) else { return };
    let source = loading.source.clone();
    match result {
        Ok(tracer) => {
            let discards = std::mem::take(&mut session.discards_edits);
            if is_shown(state, &source) || discards || !has_unsaved_changes(state) {
                show_scene(state, session, services, source, tracer);
            } else {
                state.dialogs.leaving = Some(Leaving::Show(source, tracer));
            }
        }
        Err(error) => {
            cancel_loading(session, services);
            if let TaskError::Failed(message) = error {
                state.error(message);
            }
        }
    }
}

/// Reloads the scene when its files have changed. The camera stays, and the old scene stays where the new
/// one cannot be loaded.
pub(super) fn poll_watch(state: &mut AppState, services: &mut Services) {
    if let Some(Ok(path)) = take_result(&mut services.watch) {
        services.watch = Some(watch(path.clone(), services.wake.clone()));
        state.info(format!("{} has changed and is loaded again", path.display()));
        reload(state, services);
    }
}

fn show_scene(
    state: &mut AppState,
    session: &mut Session,
    services: &mut Services,
    source: SceneSource,
    tracer: Arc<Tracer>,
) {
    let is_reload = is_shown(state, &source);
    let arrival = std::mem::take(&mut session.arrival);
    let scene = SceneInfo::new(source.clone(), &tracer);
    if arrival.scene_hash.as_ref().is_some_and(|expected| *expected != tracer.scene().hash) {
        state.info("the scene has changed since the picture was taken; this is the same pose in it");
    }
    if !scene.warnings.is_empty() {
        let count = scene.warnings.len();
        state.info(format!("{}: {count} import warnings, listed in the Scene panel", scene.name));
    }
    if !is_reload {
        let (view_index, start) = start_pose(state, &scene, &arrival);
        state.navigation.view_index = view_index;
        state.navigation.fly.jump_to(start);
        state.navigation.playback = Playback::of_scene(tracer.scene().walk.clone());
        (state.navigation.recording, state.navigation.renaming) = (None, None);
    }
    state.scene = Some(scene);
    state.history.clear();
    state.thumbnails.set_tracer(tracer.clone());
    services.plan = None;
    state.plan = PlanState { cut: None, view: if is_reload { state.plan.view } else { Default::default() } };
    session.obstacles = Some(Obstacles::new(tracer.clone()));
    begin_edits(state, session, services, tracer.scene(), is_reload);
    session.first_generation = services.render.send(RenderCommand::SetTracer(tracer));
    if !is_reload {
        reset_quality(state, session, services, &source, &arrival);
    }
    session.sent = None;
    restore_session(state, session, arrival.session, is_reload);
    services.watch = None;
    if let SceneSource::File { path, .. } = source {
        remember_model(state, services, &path);
        services.watch = Some(watch(path, services.wake.clone()));
    }
}

/// Sets bounces and exposure as they suit the scene; a reset of the quality restores these bounces. Models
/// from files are made for renderers with indirect light, and their exposure is metered.
fn reset_quality(
    state: &mut AppState,
    session: &mut Session,
    services: &Services,
    source: &SceneSource,
    arrival: &Arrival,
) {
    let launch = &services.launch;
    let is_model = matches!(source, SceneSource::File { .. });
    let bounces = if is_model { launch.model_bounces } else { launch.settings.render.trace.bounces };
    for quality in [&mut state.quality, &mut state.default_quality] {
        quality.walk.render.trace.bounces = bounces;
    }
    state.quality.exposure_ev = arrival.exposure_ev.unwrap_or(state.default_quality.exposure_ev);
    session.is_metering = is_model && launch.exposure_ev.is_none() && arrival.exposure_ev.is_none();
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

/// Keeps the window open where closing it would lose changes, and asks.
pub(super) fn hold_close(state: &mut AppState, session: &mut Session, services: &Services) {
    let is_closing = services.ctx.input(|i| i.viewport().close_requested());
    if is_closing && !session.may_close && has_unsaved_changes(state) {
        services.ctx.send_viewport_cmd(ViewportCommand::CancelClose);
        session.arrival = Arrival::default();
        state.dialogs.leaving = Some(Leaving::Close);
    }
}

/// Applies the answer to the question about unsaved changes.
pub(super) fn handle_answer(
    state: &mut AppState,
    session: &mut Session,
    services: &mut Services,
    answer: Answer,
) {
    match answer {
        // The action follows once they are saved.
        Answer::Save => save_beside(state, services),
        Answer::Discard => {
            let is_opening = matches!(state.dialogs.leaving, Some(Leaving::Open(_)));
            leave(state, session, services);
            session.discards_edits = is_opening;
        }
        Answer::Stay => {
            state.dialogs.leaving = None;
            session.arrival = Arrival::default();
        }
    }
}

/// Does what has waited for the answer, if anything has.
pub(super) fn leave(state: &mut AppState, session: &mut Session, services: &mut Services) {
    match state.dialogs.leaving.take() {
        Some(Leaving::Close) => {
            session.may_close = true;
            services.ctx.send_viewport_cmd(ViewportCommand::Close);
        }
        Some(Leaving::Open(source)) => load(services, source),
        Some(Leaving::Show(source, tracer)) => show_scene(state, session, services, source, tracer),
        None => {}
    }
}
