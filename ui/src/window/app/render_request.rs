//! The request that is sent to the renderer, and what the renderer is doing.

use super::{MOTION_TIME, Parts, current_scene::CurrentScene, rendered_quantity};
use crate::window::input::keymap::{Action, keys_of};
use crate::window::rendering::{Quantity, RenderRequest};
use crate::window::state::{Navigation, Quality, Work};
use afterimage::Camera;
use afterimage::render::schedule;
use afterimage::{Mode, WalkthroughSettings};
use std::time::{Duration, Instant};

/// Largest edge of a frame in pixels: the largest texture that every adapter accepts.
const MAX_EDGE: u32 = 8192;

/// Sends the pose and the settings where they have changed.
pub(super) fn send_request(app: &mut Parts) {
    let is_sharp = is_sharp(app);
    let q = &app.state.quality;
    let scale = if is_sharp { 1.0 } else { app.current.pace.scale(q.render_scale) };
    let edge = |pixels: u32| edge_of(pixels, scale);
    let size = if app.state.viewport_size.contains(&0) { [0, 0] } else { app.state.viewport_size.map(edge) };
    let camera = *app.state.navigation.fly.camera();
    end_pause(app, &camera);
    let quantity = rendered_quantity(app);
    let (state, q) = (&app.state, &app.state.quality);
    let sent = app.current.sent.filter(|sent| sent.camera == camera);
    let request = RenderRequest {
        camera,
        size,
        settings: wanted_settings(q, quantity),
        budget: (!is_sharp).then(|| budget(q)),
        is_moving: sent.map_or_else(|| is_moving(&app.current, &state.navigation), |sent| sent.is_moving),
        quantity,
        is_paused: state.options.is_paused,
        is_compared: state.comparison.is_wanted(),
        is_endless: q.keeps_improving,
        section: state.section(),
        has_edges: state.options.has_edges,
    };
    if app.current.sent != Some(request) {
        if app.current.sent.is_some_and(|s| s.camera != request.camera) {
            app.current.moved = Instant::now();
            app.state.navigation.has_moved = true;
        }
        app.services.render.request(request);
        app.current.sent = Some(request);
    }
}

/// Ends a pause where the camera has moved, unless the frame is frozen.
fn end_pause(app: &mut Parts, camera: &Camera) {
    let options = app.state.options;
    let has_moved = app.current.sent.is_some_and(|sent| sent.is_paused && sent.camera != *camera);
    if options.is_paused && !options.is_frozen && has_moved {
        app.state.options = options.paused(false);
        app.state
            .info(format!("rendering goes on: the camera has moved ({} pauses)", keys_of(Action::Pause)));
    }
}

/// The settings of the walk. Mode `paper` warps pictures, and cannot show light without them.
fn wanted_settings(quality: &Quality, quantity: Quantity) -> WalkthroughSettings {
    let mut settings = quality.walk;
    if quantity.shows_light() && settings.render.mode == Mode::Paper {
        settings.render.mode = Mode::Exact;
    }
    settings
}

/// Notes the newest frame, of a new generation, if it was rendered while the camera moved.
pub(super) fn note_frame(app: &mut Parts) {
    let (state, current) = (&mut app.state, &mut app.current);
    let Some(frame) = state.frame.as_ref().filter(|_| is_moving(current, &state.navigation)) else { return };
    state.frame_rate.note(frame.begun);
    let most = state.quality.render_scale;
    let expected = state.viewport_size.map(|edge| edge_of(edge, current.pace.scale(most)));
    if frame.size == expected {
        current.pace.note(&frame.stats, budget(&state.quality), most);
    }
}

fn edge_of(pixels: u32, scale: f32) -> u32 {
    schedule::scaled_edge(pixels, scale).min(MAX_EDGE)
}

fn budget(quality: &Quality) -> Duration {
    Duration::from_secs_f32(quality.budget_ms / 1000.0)
}

fn is_moving(current: &CurrentScene, navigation: &Navigation) -> bool {
    navigation.has_moved && current.moved.elapsed() < MOTION_TIME
}

/// True where nothing has changed since a frame at the render scale was complete: then a frame with
/// every pixel of the viewport is requested. Only in modes that refine at rest.
fn is_sharp(app: &Parts) -> bool {
    let (q, camera) = (&app.state.quality, app.state.navigation.fly.camera());
    let settings = wanted_settings(q, rendered_quantity(app));
    let is_same = |s: &RenderRequest| s.camera == *camera && s.settings == settings && !s.is_paused;
    // Pictures that are compared keep their size.
    let has_newest = has_newest(app) && !app.state.comparison.is_wanted();
    app.current.sent.as_ref().filter(|s| is_same(s)).is_some_and(|s| {
        let (mode, was_sharp) = (settings.render.mode, s.budget.is_none());
        schedule::is_sharp(
            mode,
            app.current.pace.scale(q.render_scale),
            was_sharp,
            app.current.moved.elapsed(),
            has_newest,
        )
    })
}

/// True where the newest request is shown and complete.
fn has_newest(app: &Parts) -> bool {
    let is_newest = |generation| generation == app.services.render.generation();
    app.state.frame.as_ref().is_some_and(|f| is_newest(f.generation) && f.stats.is_complete)
}

/// Returns what the renderer is doing.
pub(super) fn current_work(app: &Parts) -> Work {
    match () {
        () if app.services.loading.is_some() => Work::Loading,
        () if app.state.scene.is_none() => Work::NoScene,
        () if app.state.options.is_paused => Work::Paused,
        () if is_moving(&app.current, &app.state.navigation) => Work::Moving,
        () if app.services.edit.is_some() => Work::Editing,
        () if !has_newest(app) => Work::Filling,
        () if app.services.render.is_adding_reference() => Work::AddingReference,
        () => match app.state.frame.as_ref().map(|f| f.stats.refined) {
            Some(refined) if refined.of > 0 && refined.is_complete => Work::Converged,
            Some(refined) if refined.of > 0 => Work::Refining,
            _ => Work::Complete,
        },
    }
}
