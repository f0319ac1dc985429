//! Takes over everything that has happened in the background since the last update of the window.

use super::{
    AppEvent, Parts, SavedEdit, apply_note, go_to_picture, note_frame, poll_bake, poll_edit, poll_export,
    poll_files, poll_lighting, poll_loading, poll_saving, poll_watch, save_from_references, save_session,
    show_reference, show_sky_picture, update_floor, update_outline, update_plan, update_thumbnails,
};
use crate::window::gpu::viewport;
use crate::window::input::ViewChange;
use crate::window::rendering::{
    Message, Quantity, TaskError, background_pool, locked, spawn_task, take_result,
};
use crate::window::state::AppState;
use afterimage::raster::exposure::{Exposure, Metered};
use std::path::Path;

/// Takes over results, messages and the newest frame.
pub(super) fn poll(app: &mut Parts) {
    poll_saving(app);
    poll_loading(app);
    poll_export(&mut app.state, &mut app.services);
    poll_edit(app);
    poll_watch(app);
    poll_messages(app);
    poll_files(app);
    poll_tasks(app);
    poll_frame(app);
    poll_light(app);
    follow_view(app);
    app.state.notices.retain(|n| !n.is_expired());
    poll_bake(app);
    poll_lighting(app);
    update_plan(app);
    update_outline(app);
    update_floor(app);
    update_thumbnails(&mut app.state, &app.services);
}

fn poll_messages(app: &mut Parts) {
    let messages: Vec<Message> = app.services.render.messages().collect();
    for message in messages {
        match message {
            Message::Reference(reference) => show_reference(&mut app.state, &app.services, &reference),
            Message::Picture(picture) => save_from_references(app, picture),
            Message::Failed(text) => app.state.error(text),
        }
    }
    for text in std::mem::take(&mut *locked(&app.services.graphics_errors)) {
        app.state.error(text);
    }
}

fn poll_tasks(app: &mut Parts) {
    let mut results = Vec::new();
    app.services.tasks.retain(|task| {
        let result = task.result();
        let is_running = result.is_none();
        results.extend(result);
        is_running
    });
    for result in results {
        match result {
            Ok(event) => apply(app, event),
            Err(TaskError::Failed(text)) => app.state.error(text),
            Err(TaskError::Cancelled) => {}
        }
    }
}

fn apply(app: &mut Parts, event: AppEvent) {
    match event {
        AppEvent::Saved(path) => saved(&mut app.state, &path),
        AppEvent::Kept => {}
        AppEvent::SkyPicture(image) => show_sky_picture(app, image),
        AppEvent::PictureView(view) => go_to_picture(app, view),
        AppEvent::Note(note) => apply_note(app, *note),
        AppEvent::SavedEdit(edit) => sidecar_saved(app, *edit),
    }
}

/// Notes what a sidecar holds now, unless another scene is shown meanwhile.
fn sidecar_saved(app: &mut Parts, SavedEdit { path, scene, document }: SavedEdit) {
    saved(&mut app.state, &path);
    if scene != app.current.number {
        return;
    }
    if let Some(open) = &mut app.state.document {
        open.set_saved_in_files(document);
    }
    // A picture of before shows what the files do not hold any more.
    app.current.files_hash.clear();
    // A session that the model is opened with would bring back the old values.
    if app.current.file.is_some() {
        save_session(app);
    }
}

fn saved(state: &mut AppState, path: &Path) {
    state.saved(format!("saved {}", path.display()), Some(path.to_owned()));
}

/// Shows the newest frame.
fn poll_frame(app: &mut Parts) {
    let before = app.state.frame.as_ref().map(|frame| frame.generation);
    if !app.services.render.take_frame(&mut app.state.frame) {
        return;
    }
    if app.state.frame.as_ref().map(|frame| frame.generation) != before {
        note_frame(app);
    }
    let Some(frame) = &app.state.frame else { return };
    if frame.values.quantity == Quantity::Picture {
        app.state.view_exposure.meter(frame);
    }
    app.state.lighting.note(&frame.values);
    if let Some(graphics) = &app.services.graphics {
        viewport::upload(graphics, frame);
    }
    if !frame.is_refinement {
        app.state.picture.note_frame(&frame.stats, app.state.quality.walk.render.trace.samples);
        app.state.record();
    }
}

/// Lets the automatic exposure follow the view, once that of the scene is known.
fn follow_view(app: &mut Parts) {
    let state = &mut app.state;
    let Some(of_scene) = state.metered.map(Metered::ev) else { return };
    let is_at_once = state.options.view_change == ViewChange::AtOnce;
    let secs = app.services.ctx.input(|i| i.stable_dt);
    let moves = state.view_exposure.advance(of_scene, secs, is_at_once);
    if moves && state.quality.exposure == Exposure::Auto && state.quality.follows_view {
        app.services.ctx.request_repaint();
    }
}

/// Takes over the automatic exposure of the scene. Where the light in it is not measured yet,
/// because it was edited, the exposure of before is kept meanwhile.
fn poll_light(app: &mut Parts) {
    if let Some(Err(TaskError::Failed(text))) = take_result(&mut app.services.light) {
        app.state.error(format!("the light in the scene cannot be measured: {text}"));
        app.state.quality.exposure = Exposure::Stops(app.state.exposure_ev());
    }
    let Some(tracer) = app.current.tracer().cloned() else { return };
    let is_auto = app.state.quality.exposure == Exposure::Auto;
    match tracer.metered() {
        Some(metered) if app.state.metered != Some(metered) => {
            app.state.metered = Some(metered);
            if metered == Metered::Dark {
                app.state.info("no light was found in the scene; the automatic exposure is 0 EV");
            }
        }
        None if is_auto && app.services.light.is_none() => {
            let (wake, threads) = (app.services.wake.clone(), app.services.threads);
            app.services.light = Some(spawn_task("light", wake, move |task| {
                let pool = background_pool("light", threads).map_err(TaskError::failed)?;
                let progress = |part| task.report("measuring the light", part);
                pool.install(|| tracer.measure_light(&progress, &|| task.is_cancelled()));
                Ok(())
            }));
        }
        _ => {}
    }
}
