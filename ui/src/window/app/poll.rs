//! Takes over everything that has happened in the background since the last update of the window.

use super::{
    AppEvent, Parts, go_to_picture, handle_answer, leave, open_path, poll_edit, poll_export, poll_loading,
    poll_watch, save_from_references, show_reference, show_sky_picture, update_plan, update_thumbnails,
};
use crate::window::gpu::viewport;
use crate::window::rendering::{Message, TaskError, locked, take_result};
use crate::window::state::{Answer, AppState};
use std::ops::RangeInclusive;
use std::path::Path;

/// Range of a metered exposure in stops. A picture beyond it is meant to be dark or bright.
const METERED_EV: RangeInclusive<f32> = -4.0..=6.0;

/// Takes over results, messages and the newest frame.
pub(super) fn poll(app: &mut Parts) {
    poll_loading(app);
    poll_export(&mut app.state, &mut app.services);
    poll_edit(app);
    poll_watch(app);
    poll_messages(app);
    poll_tasks(app);
    poll_frame(app);
    app.state.notices.retain(|n| !n.is_expired());
    update_plan(app);
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
    match take_result(&mut app.services.file_dialog) {
        Some(Ok(Some(path))) => open_path(app, path),
        Some(Err(TaskError::Failed(text))) => {
            app.state.error(format!("the file dialog cannot be started: {text}"));
        }
        Some(Ok(None) | Err(TaskError::Cancelled)) | None => {}
    }
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
        AppEvent::SavedSession(path) => {
            saved(&mut app.state, &path);
            app.current.file = Some(path);
        }
        AppEvent::Kept => {}
        AppEvent::SkyPicture(image) => show_sky_picture(app, image),
        AppEvent::PictureView(view) => go_to_picture(app, view),
        AppEvent::SavedEdit(edit, Ok(path)) => {
            saved(&mut app.state, &path);
            if let Some(edits) = &mut app.state.edits {
                edits.set_saved(*edit);
            }
            leave(app);
        }
        AppEvent::SavedEdit(_, Err(error)) => {
            if app.state.dialogs.leaving.is_some() {
                handle_answer(app, Answer::Stay);
            }
            app.state.error(error.to_string());
        }
    }
}

fn saved(state: &mut AppState, path: &Path) {
    state.info(format!("saved {}", path.display()));
}

/// Shows the newest frame. The first complete one of a model that was just opened sets the
/// exposure.
fn poll_frame(app: &mut Parts) {
    if !app.services.render.take_frame(&mut app.state.frame) {
        return;
    }
    let Some(frame) = &app.state.frame else { return };
    let is_metered = app.current.is_metering && frame.generation >= app.current.first_generation;
    if let Some(ev) = frame.metered_ev.filter(|_| is_metered) {
        app.state.quality.exposure_ev = ev.clamp(*METERED_EV.start(), *METERED_EV.end());
        app.current.is_metering = false;
    }
    if let Some(graphics) = &app.services.graphics {
        viewport::upload(graphics, frame);
    }
    if !frame.is_refinement {
        app.state.record();
    }
}
