//! Baking in the window: the command, its progress, and the floor that fills.

use super::Parts;
use crate::window::rendering::baking::{ShownFloor, start_baking, start_floor};
use crate::window::rendering::{RenderCommand, TaskError, take_result};
use crate::window::state::Work;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// Time between two looks at the store while a bake is running.
const LOOK_AGAIN: Duration = Duration::from_secs(10);

/// Starts to bake the scene, or cancels the bake that is running.
pub(super) fn toggle_bake(app: &mut Parts) {
    if let Some(baking) = app.services.baking.take() {
        drop(baking);
        app.state.info("baking was cancelled; what is done is kept, and Bake continues it");
        return end(app);
    }
    let Some(store) = app.services.launch.store.clone() else {
        return app.state.error("baking needs a store; start the window without --store off");
    };
    let render = app.state.quality.walk.render;
    if !render.mode.looks_up() {
        return app.state.error("baking is for the modes exact and fast");
    }
    if let Some(tracer) = app.current.tracer() {
        let (threads, wake) = (app.services.threads, app.services.wake.clone());
        app.services.baking = Some(start_baking(tracer, &store, &render.trace, threads, wake));
    }
}

/// Lets the frames read what was baked, and shows it on the floor.
fn end(app: &mut Parts) {
    app.services.render.send(RenderCommand::ReadStore);
    app.services.floor.looked = None;
    app.state.plan.baking = None;
}

/// Takes over progress and result of a bake, which waits unless the viewer is at rest.
pub(super) fn poll_bake(app: &mut Parts) {
    let Some(baking) = &app.services.baking else { return };
    let is_shown = app.current.tracer().is_some_and(|tracer| tracer.epoch() == baking.tracer.epoch());
    let is_at_rest =
        matches!(app.state.work, Work::Complete | Work::Refining | Work::Converged | Work::Paused);
    baking.waits.store(!is_at_rest, Ordering::Relaxed);
    app.state.plan.baking = Some(baking.task.progress());
    let result = baking.task.result();
    if result.is_none() && is_shown {
        return;
    }
    app.services.baking = None;
    match result {
        Some(Ok(report)) => {
            let (lit, all) = (100.0 * report.covered, report.progress.planned);
            app.state
                .info(format!("the scene is baked: {all} references light {lit:.0} % of what can be seen"));
        }
        Some(Err(TaskError::Failed(text))) => app.state.error(text),
        Some(Err(TaskError::Cancelled)) => {}
        None => app.state.info("the scene has changed; baking was stopped, and what is done is kept"),
    }
    end(app);
}

/// Looks at what the store lights of the floor: once for each state of the scene, and again while a
/// bake is running and when it has ended.
pub(super) fn update_floor(app: &mut Parts) {
    match take_result(&mut app.services.floor.task) {
        Some(Ok(ShownFloor { cover, places })) => {
            app.services.floor.cover = Some(cover);
            app.state.plan.floor = places;
        }
        Some(Err(TaskError::Failed(text))) => app.state.error(text),
        Some(Err(TaskError::Cancelled)) | None => {}
    }
    let is_idle = matches!(app.state.work, Work::Refining | Work::Converged | Work::Complete);
    let (Some(store), Some(tracer), None, true) =
        (&app.services.launch.store, app.current.tracer(), &app.services.floor.task, is_idle)
    else {
        return;
    };
    let trace = app.state.quality.walk.render.trace;
    let seen = (tracer.epoch(), trace.bounces);
    let is_same = app.services.floor.looked.is_some_and(|(looked, at)| {
        looked == seen && (app.services.baking.is_none() || at.elapsed() < LOOK_AGAIN)
    });
    if is_same || !store.folder.is_dir() {
        return;
    }
    let cover = app
        .services
        .floor
        .cover
        .clone()
        .filter(|_| app.services.floor.looked.is_none_or(|(looked, _)| looked.0 == seen.0));
    app.services.floor.looked = Some((seen, Instant::now()));
    let wake = app.services.wake.clone();
    app.services.floor.task = Some(start_floor(tracer, cover, store, trace.bounces, wake));
}
