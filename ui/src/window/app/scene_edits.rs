//! Commands about materials, objects and daylight. An edit is shown by the panels at once; the
//! scene is rebuilt in the background, and the old picture stays until there is one of the new
//! scene.

use super::{AppEvent, Parts, PendingEdit};
use crate::window::input::Obstacles;
use crate::window::rendering::{RenderCommand, SceneSource, TaskError, spawn_task};
use crate::window::state::{AppState, Change, EditCommand, Edits, Selection, SunControls};
use afterimage::import::{Limits, load_sky};
use afterimage::scene::{Daylight, PictureSky, Scene, Sky, SkyImage};
use afterimage::{Tracer, import};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Applies a command about edits of the scene: a change, undo, redo or saving.
pub(super) fn handle_edit(app: &mut Parts, command: EditCommand) {
    match command {
        EditCommand::Change(change) => {
            if let (Some(edits), Some(scene)) = (&mut app.state.edits, &mut app.state.scene) {
                edits.change(change, &mut scene.views);
            }
        }
        EditCommand::SetSun(sun) => app.state.sun = sun,
        EditCommand::KnowLights => {
            app.state.knows_lights = true;
            app.services.render.send(RenderCommand::KnowLights(true));
        }
        EditCommand::BrowseSky => browse_sky(app),
        EditCommand::Undo => step(&mut app.state, true),
        EditCommand::Redo => step(&mut app.state, false),
        EditCommand::SaveSidecar => save_sidecar(app),
    }
    rebuild(app);
}

/// Asks for a picture of the sky and reads it, in the background. Where it cannot be used, a
/// message says so and the sky stays.
fn browse_sky(app: &mut Parts) {
    app.services.spawn("reading a sky", || {
        let dialog = rfd::FileDialog::new()
            .set_title("Choose a picture of the sky")
            .add_filter("Pictures of all directions", &["hdr", "exr"]);
        dialog.pick_file().map_or(Ok(AppEvent::Kept), |path| read_sky(&path))
    });
}

/// Reads a picture of the sky in the background.
pub(super) fn open_sky(app: &mut Parts, path: PathBuf) {
    app.services.spawn(&format!("{}: reading a sky", path.display()), move || read_sky(&path));
}

fn read_sky(path: &Path) -> Result<AppEvent, TaskError> {
    let image = load_sky(path, &Limits::default());
    image.map(|image| AppEvent::SkyPicture(Arc::new(image))).map_err(TaskError::failed)
}

/// True for file names of pictures that cannot be anything but a sky.
pub(super) fn is_sky(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("hdr"))
}

/// Shows a picture as the sky. It has a sun of its own, so that the other one is switched off.
pub(super) fn show_sky_picture(app: &mut Parts, image: Arc<SkyImage>) {
    let sky = Sky::Picture(PictureSky::new(image, app.state.sun.nits_per_unit));
    (app.state.sun.kind, app.state.sun.has_sun, app.state.sun.has_sky) = (sky.kind(), false, true);
    let daylight = Daylight { sun: None, sky: Some(sky) };
    handle_edit(app, EditCommand::Change(Change::Daylight(daylight)));
}

/// Undoes or redoes an edit.
fn step(state: &mut AppState, is_undo: bool) {
    let (Some(edits), Some(scene)) = (&mut state.edits, &mut state.scene) else { return };
    let before = edits.now().daylight.clone();
    let is_done = if is_undo { edits.undo(&mut scene.views) } else { edits.redo(&mut scene.views) };
    let now = edits.now().daylight.clone();
    let navigation = &mut state.navigation;
    if now != before {
        navigation.view_index = 0;
        state.sun.show(&now);
    }
    navigation.view_index = navigation.view_index.min(scene.views.len().saturating_sub(1));
    if !is_done {
        state.info(if is_undo { "there is nothing to undo" } else { "there is nothing to redo" });
    }
}

/// Starts to rebuild the scene with the current edit, unless it is shown or being rebuilt.
fn rebuild(app: &mut Parts) {
    let (Some(edits), Some(tracer), None) = (&app.state.edits, app.current.tracer(), &app.services.edit)
    else {
        return;
    };
    if app.current.rendered_edit.as_ref() == Some(edits.now()) {
        return;
    }
    let (edit, base, wanted) = (edits.now().clone(), tracer.clone(), edits.now().clone());
    let work = move || Arc::new(base.with_state(Arc::new(base.scene().with_edit(&wanted))));
    let task = spawn_task("edit", app.services.wake.clone(), move |_| Ok(work()));
    app.services.edit = Some(PendingEdit { edit, task });
}

/// Shows the scene that was rebuilt, if it is ready.
pub(super) fn poll_edit(app: &mut Parts) {
    let Some(result) = app.services.edit.as_ref().and_then(|pending| pending.task.result()) else { return };
    app.current.rendered_edit = app.services.edit.take().map(|pending| pending.edit);
    match result {
        Ok(tracer) => show_rebuilt(app, tracer),
        Err(TaskError::Failed(text)) => app.state.error(format!("the change failed: {text}")),
        Err(TaskError::Cancelled) => {}
    }
    rebuild(app);
}

fn show_rebuilt(app: &mut Parts, tracer: Arc<Tracer>) {
    if let Some(scene) = &mut app.state.scene {
        scene.relight(tracer.scene());
    }
    let is_same = |shown: &Arc<Tracer>| shown.scene().has_same_geometry(tracer.scene());
    if !app.current.tracer().is_some_and(is_same) {
        // Triangles have other numbers, and the plan shows objects where they were.
        app.state.selection.inspection = None;
        (app.services.plan, app.state.plan.asked_m) = (None, None);
    }
    app.current.obstacles = Some(Obstacles::new(tracer.clone()));
    app.state.thumbnails.set_tracer(tracer.clone());
    app.services.render.send(RenderCommand::SetTracer(tracer));
    // The references of the old scene are gone.
    app.state.selection.reference_view = None;
    // The next request has the render scale again, so that the edit is seen soon.
    app.current.sent = None;
}

/// Begins the edits of a scene that was loaded. Unsaved edits of the same scene are kept.
pub(super) fn begin_edits(app: &mut Parts, scene: &Scene, is_reload: bool) {
    let saved = scene.to_edit();
    app.current.rendered_edit = Some(saved.clone());
    app.services.edit = None;
    let edits = match app.state.edits.as_ref().filter(|e| is_reload && e.is_unsaved()) {
        Some(edits) => edits.carried_to(saved),
        None => Edits::new(saved),
    };
    if !is_reload {
        app.state.sun = SunControls::default();
    }
    app.state.sun.nits_per_unit = scene.nits_per_unit();
    app.state.sun.show(&edits.now().daylight);
    app.state.edits = Some(edits);
    if !is_reload {
        app.state.knows_lights = false;
        app.services.render.send(RenderCommand::KnowLights(false));
        app.state.selection = Selection::default();
    }
    rebuild(app);
}

/// Saves materials, objects and daylight in the sidecar of the model.
pub(super) fn save_sidecar(app: &mut Parts) {
    let (Some(edits), Some(scene)) = (&app.state.edits, &app.state.scene) else { return };
    let SceneSource::File { path, .. } = &scene.source else {
        let text = format!(
            "{} is part of the program and has no sidecar; open a model file to keep changes",
            scene.source.label()
        );
        return app.state.error(text);
    };
    let (path, before, edit) = (path.clone(), edits.saved().clone(), edits.now().clone());
    app.services.spawn("saving the sidecar", move || {
        let saved = import::save_edit(&path, &before, &edit).map_err(Into::into);
        Ok(AppEvent::SavedEdit(Box::new(edit), saved))
    });
}
