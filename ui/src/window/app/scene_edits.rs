//! Commands about materials and daylight. An edit is shown by the panels at once; the scene is rebuilt in
//! the background, and the old picture stays until there is one of the new scene.

use crate::window::app::services::{AppEvent, PendingEdit, Services};
use crate::window::app::session::Session;
use crate::window::input::walking::Obstacles;
use crate::window::rendering::request::RenderCommand;
use crate::window::rendering::scene_loading::SceneSource;
use crate::window::rendering::task::{TaskError, spawn_task};
use crate::window::state::{AppState, EditCommand, Edits, Selection};
use afterimage::scene::Scene;
use afterimage::{Tracer, import};
use std::sync::Arc;

/// Applies a command.
pub(super) fn handle_edit(
    state: &mut AppState,
    session: &Session,
    services: &mut Services,
    command: EditCommand,
) {
    match command {
        EditCommand::Change(change) => {
            if let (Some(edits), Some(scene)) = (&mut state.edits, &mut state.scene) {
                edits.change(change, &mut scene.views);
            }
        }
        EditCommand::SetSun(sun) => state.sun = sun,
        EditCommand::Undo => step(state, true),
        EditCommand::Redo => step(state, false),
        EditCommand::SaveBeside => save_beside(state, services),
    }
    rebuild(state, session, services);
}

/// Undoes or redoes an edit.
fn step(state: &mut AppState, is_undo: bool) {
    let (Some(edits), Some(scene)) = (&mut state.edits, &mut state.scene) else { return };
    let before = edits.now().daylight;
    let is_done = if is_undo { edits.undo(&mut scene.views) } else { edits.redo(&mut scene.views) };
    let now = edits.now().daylight;
    let navigation = &mut state.navigation;
    if now != before {
        (state.sun.is_by_place, navigation.view_index) = (false, 0);
        state.sun.show(&now);
    }
    navigation.view_index = navigation.view_index.min(scene.views.len().saturating_sub(1));
    if !is_done {
        state.info(if is_undo { "there is nothing to undo" } else { "there is nothing to redo" });
    }
}

/// Starts to rebuild the scene with the current edit, unless it is shown or being rebuilt.
fn rebuild(state: &AppState, session: &Session, services: &mut Services) {
    let (Some(edits), Some(tracer), None) = (&state.edits, session.tracer(), &services.edit) else { return };
    if session.rendered_edit.as_ref() == Some(edits.now()) {
        return;
    }
    let (edit, base, wanted) = (edits.now().clone(), tracer.clone(), edits.now().clone());
    let work = move || Arc::new(base.with_same_geometry(Arc::new(base.scene().with_edit(&wanted))));
    let task = spawn_task("edit", services.wake.clone(), move |_| Ok(work()));
    services.edit = Some(PendingEdit { edit, task });
}

/// Shows the scene that was rebuilt, if it is ready.
pub(super) fn poll_edit(state: &mut AppState, session: &mut Session, services: &mut Services) {
    let Some(result) = services.edit.as_ref().and_then(|pending| pending.task.result()) else { return };
    session.rendered_edit = services.edit.take().map(|pending| pending.edit);
    match result {
        Ok(tracer) => show_rebuilt(state, session, services, tracer),
        Err(TaskError::Failed(text)) => state.error(format!("the change failed: {text}")),
        Err(TaskError::Cancelled) => {}
    }
    rebuild(state, session, services);
}

fn show_rebuilt(state: &mut AppState, session: &mut Session, services: &Services, tracer: Arc<Tracer>) {
    if let Some(scene) = &mut state.scene {
        scene.relight(tracer.scene());
    }
    session.obstacles = Some(Obstacles::new(tracer.clone()));
    state.thumbnails.set_tracer(tracer.clone());
    services.render.send(RenderCommand::SetTracer(tracer));
    // The references of the old scene are gone.
    state.selection.reference_view = None;
    // The next request has the render scale again, so that the edit is seen soon.
    session.sent = None;
}

/// Begins the edits of a scene that was loaded. Unsaved edits of the same scene are kept.
pub(super) fn begin_edits(
    state: &mut AppState,
    session: &mut Session,
    services: &mut Services,
    scene: &Scene,
    is_reload: bool,
) {
    let saved = scene.to_edit();
    session.rendered_edit = Some(saved.clone());
    services.edit = None;
    let edits = match state.edits.as_ref().filter(|e| is_reload && e.is_unsaved()) {
        Some(edits) => edits.carried_to(saved),
        None => Edits::new(saved),
    };
    state.sun.show(&edits.now().daylight);
    state.edits = Some(edits);
    if !is_reload {
        state.selection = Selection::default();
    }
    rebuild(state, session, services);
}

/// Saves materials and daylight in the file beside the scene.
pub(super) fn save_beside(state: &mut AppState, services: &mut Services) {
    let (Some(edits), Some(scene)) = (&state.edits, &state.scene) else { return };
    let SceneSource::File { path, .. } = &scene.source else {
        let text = format!(
            "{} is part of the program and has no folder to save beside; open a model file to keep changes",
            scene.source.label()
        );
        return state.error(text);
    };
    let (path, before, edit) = (path.clone(), edits.saved().clone(), edits.now().clone());
    services.spawn("save", move || {
        let saved = import::save_edit(&path, &before, &edit).map_err(|error| error.to_string());
        Ok(AppEvent::SavedEdit(Box::new(edit), saved))
    });
}
