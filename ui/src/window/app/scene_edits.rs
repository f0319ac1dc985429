//! Commands about materials, objects and daylight. An edit is shown by the panels at once; the
//! scene is rebuilt in the background, and the old picture stays until there is one of the new
//! scene.

use super::{AppEvent, Parts, PendingEdit, SavedEdit};
use crate::window::input::Obstacles;
use crate::window::rendering::{RenderCommand, SceneSource, TaskError, spawn_task};
use crate::window::state::{
    AppState, Change, Document, EditCommand, OpenDocument, SceneInfo, Selection, SunControls,
};
use afterimage::import::{Limits, load_sky};
use afterimage::scene::{Daylight, PictureSky, Scene, Sky, SkyImage};
use afterimage::{Tracer, import};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Applies a command about edits of the scene: a change, undo, redo or saving.
pub(super) fn handle_edit(app: &mut Parts, command: EditCommand) {
    match command {
        EditCommand::Change(change) => return self::change(app, change),
        EditCommand::KnowLights => {
            app.state.knows_lights = true;
            app.services.render.send(RenderCommand::KnowLights(true));
        }
        EditCommand::Undo => step(&mut app.state, true),
        EditCommand::Redo => step(&mut app.state, false),
        EditCommand::SaveSidecar => save_sidecar(app),
    }
    rebuild(app);
}

/// Makes a change, and shows it.
pub(super) fn change(app: &mut Parts, change: Change) {
    if let Some(document) = &mut app.state.document {
        document.change(change);
    }
    rebuild(app);
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
    let Some(document) = &app.state.document else { return };
    let mut sun = document.now().sun.clone();
    let sky = Sky::Picture(PictureSky::new(image, sun.nits_per_unit));
    (sun.kind, sun.has_sun, sun.has_sky) = (sky.kind(), false, true);
    let daylight = Daylight { sun: None, sky: Some(sky) };
    handle_edit(app, EditCommand::Change(Change::Daylight(daylight, Box::new(sun))));
}

/// Undoes or redoes an edit.
fn step(state: &mut AppState, is_undo: bool) {
    let Some(document) = &mut state.document else { return };
    let is_done = if is_undo { document.undo() } else { document.redo() };
    let views = document.now().views.len();
    state.navigation.view_index = state.navigation.view_index.min(views.saturating_sub(1));
    let mut playback = state.navigation.playback;
    playback.pause_at(state.path(), playback.at_secs);
    state.navigation.playback = playback;
    if !is_done {
        state.info(if is_undo { "there is nothing to undo" } else { "there is nothing to redo" });
    }
}

/// Starts to rebuild the scene with the current edit, unless it is shown or being rebuilt.
pub(super) fn rebuild(app: &mut Parts) {
    let (Some(document), Some(tracer), None) =
        (&app.state.document, app.current.tracer(), &app.services.edit)
    else {
        return;
    };
    if app.current.rendered_edit.as_ref() == Some(document.scene()) {
        return;
    }
    let (edit, base, wanted) = (document.scene().clone(), tracer.clone(), document.scene().clone());
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
    app.current.factors_of = None;
    // The references of the old scene are gone.
    app.state.selection.reference_view = None;
    // The next request has the render scale again, so that the edit is seen soon.
    app.current.sent = None;
}

/// Begins the document of a scene that was loaded. After a reload, what the user has changed stays,
/// and the rest follows the files.
pub(super) fn begin_document(app: &mut Parts, scene: &Scene, is_reload: bool) {
    let files = document_of(scene, app.state.scene.as_ref());
    app.current.rendered_edit = Some(files.scene.clone());
    app.services.edit = None;
    let document = match app.state.document.take().filter(|_| is_reload) {
        Some(document) => {
            let objects = scene.all_objects();
            let carried = document.carried_to(files, &|key| objects.keys().contains(key));
            say_dropped(&mut app.state, carried.dropped_steps);
            carried.document
        }
        None => OpenDocument::new(files, app.state.quality),
    };
    app.state.document = Some(document);
    if !is_reload {
        app.state.knows_lights = false;
        app.services.render.send(RenderCommand::KnowLights(false));
        app.state.selection = Selection::default();
        (app.services.plane, app.state.lighting.measured) = (None, None);
    }
    rebuild(app);
}

/// The document that the files of a scene hold.
fn document_of(scene: &Scene, info: Option<&SceneInfo>) -> Document {
    let mut sun = SunControls { nits_per_unit: scene.nits_per_unit(), ..SunControls::default() };
    let edit = scene.to_edit();
    sun.show(&edit.daylight);
    let views = info.map_or_else(Vec::new, |info| info.views.clone());
    Document { scene: edit, sun, views, ..Document::default() }
}

fn say_dropped(state: &mut AppState, dropped_steps: usize) {
    match dropped_steps {
        0 => {}
        1 => state.info("one change can no longer be undone: what it changed is no longer in the model"),
        n => state.info(format!(
            "{n} changes can no longer be undone: what they changed is no longer in the model"
        )),
    }
}

/// Saves materials, objects and daylight in the sidecar of the model.
pub(super) fn save_sidecar(app: &mut Parts) {
    let (Some(document), Some(scene)) = (&app.state.document, &app.state.scene) else { return };
    let SceneSource::File { path, .. } = &scene.source else {
        let text = format!(
            "{} is part of the program and has no sidecar; open a model file to keep changes",
            scene.source.label()
        );
        return app.state.error(text);
    };
    let (path, before, document) = (path.clone(), document.files().scene.clone(), document.now().clone());
    let (own, scene) = (app.services.own_writes.clone(), app.current.number);
    app.services.spawn("saving the sidecar", move || {
        let saved = own.write(|| import::save_edit(&path, &before, &document.scene));
        let path = saved.map_err(TaskError::failed)?;
        Ok(AppEvent::SavedEdit(Box::new(SavedEdit { path, scene, document })))
    });
}
