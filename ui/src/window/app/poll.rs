//! Takes over everything that has happened in the background since the last update of the window.

use crate::window::app::inspect::{show_reference, update_plan, update_thumbnails};
use crate::window::app::open_scene::{
    go_to_picture, handle_answer, leave, open_path, poll_loading, poll_watch,
};
use crate::window::app::pictures::{poll_export, save_from_references};
use crate::window::app::scene_edits::poll_edit;
use crate::window::app::services::{AppEvent, Services};
use crate::window::app::session::Session;
use crate::window::gpu::viewport;
use crate::window::rendering::lock::locked;
use crate::window::rendering::request::Message;
use crate::window::rendering::task::{TaskError, take_result};
use crate::window::state::{Answer, AppState};
use std::ops::RangeInclusive;
use std::path::PathBuf;

/// Range of a metered exposure in stops. A picture beyond it is meant to be dark or bright.
const METERED_EV: RangeInclusive<f32> = -4.0..=6.0;

/// Takes over results, messages and the newest frame.
pub(super) fn poll(state: &mut AppState, session: &mut Session, services: &mut Services) {
    poll_loading(state, session, services);
    poll_export(state, services);
    poll_edit(state, session, services);
    poll_watch(state, services);
    poll_messages(state, session, services);
    poll_tasks(state, session, services);
    poll_frame(state, session, services);
    state.notices.retain(|n| !n.is_expired());
    update_plan(state, session, services);
    update_thumbnails(state, services);
}

fn poll_messages(state: &mut AppState, session: &Session, services: &mut Services) {
    let messages: Vec<Message> = services.render.messages().collect();
    for message in messages {
        match message {
            Message::Reference(reference) => show_reference(state, services, &reference),
            Message::Picture(picture) => save_from_references(state, session, services, picture),
            Message::Failed(text) => state.error(text),
        }
    }
    for text in std::mem::take(&mut *locked(&services.graphics_errors)) {
        state.error(text);
    }
}

fn poll_tasks(state: &mut AppState, session: &mut Session, services: &mut Services) {
    if let Some(Ok(Some(path))) = take_result(&mut services.file_dialog) {
        open_path(state, session, services, path);
    }
    let mut results = Vec::new();
    services.tasks.retain(|task| {
        let result = task.result();
        let is_running = result.is_none();
        results.extend(result);
        is_running
    });
    for result in results {
        match result {
            Ok(event) => apply(state, session, services, event),
            Err(TaskError::Failed(text)) => state.error(text),
            Err(TaskError::Cancelled) => {}
        }
    }
}

fn apply(state: &mut AppState, session: &mut Session, services: &mut Services, event: AppEvent) {
    match event {
        AppEvent::Saved(path) => saved(state, &path),
        AppEvent::SavedSession(path) => {
            saved(state, &path);
            session.file = Some(path);
        }
        AppEvent::Kept => {}
        AppEvent::PictureView(view) => go_to_picture(state, session, services, view),
        AppEvent::SavedEdit(edit, Ok(path)) => {
            saved(state, &path);
            if let Some(edits) = &mut state.edits {
                edits.set_saved(*edit);
            }
            leave(state, session, services);
        }
        AppEvent::SavedEdit(_, Err(text)) => {
            if state.dialogs.leaving.is_some() {
                handle_answer(state, session, services, Answer::Stay);
            }
            state.error(text);
        }
    }
}

fn saved(state: &mut AppState, path: &PathBuf) {
    state.info(format!("saved {}", path.display()));
}

/// Shows the newest frame. The first complete one of a model that was just opened sets the exposure.
fn poll_frame(state: &mut AppState, session: &mut Session, services: &Services) {
    if !services.render.take_frame(&mut state.frame) {
        return;
    }
    let Some(frame) = &state.frame else { return };
    let is_metered = session.is_metering && frame.generation >= session.first_generation;
    if let Some(ev) = frame.metered_ev.filter(|_| is_metered) {
        state.quality.exposure_ev = ev.clamp(*METERED_EV.start(), *METERED_EV.end());
        session.is_metering = false;
    }
    if let Some(graphics) = &services.graphics {
        viewport::upload(graphics, frame);
    }
    if !frame.is_refinement {
        state.record();
    }
}
