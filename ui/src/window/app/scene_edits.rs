//! Changes of the scene, as deeds: the look is changed at once, the scene follows on a thread of its own, and the old
//! picture stays until there is one of the new scene.

use crate::window::app::App;
use crate::window::app::event::AppEvent;
use crate::window::input::walking::Obstacles;
use crate::window::rendering::render_thread::{RenderCommand, panic_text};
use crate::window::rendering::scene_loading::SceneSource;
use crate::window::state::{Answer, EditCommand, Edits, SavedView, Selection};
use afterimage::Tracer;
use afterimage::import;
use afterimage::scene::{Scene, SceneEdit};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::Arc;

/// A scene with a look that was asked for.
#[derive(Debug)]
pub(crate) struct Edited {
    /// The scene it was made from.
    pub(crate) base: Arc<Tracer>,
    pub(crate) look: SceneEdit,
    pub(crate) made: Result<Arc<Tracer>, String>,
}

/// A look that was to be saved beside its scene.
#[derive(Debug)]
pub(crate) struct SavedLook {
    look: SceneEdit,
    result: Result<PathBuf, String>,
}

impl App {
    /// Does what was asked for.
    pub(crate) fn edit(&mut self, editing: EditCommand) {
        let state = &mut self.state;
        match editing {
            EditCommand::Change(change) => {
                if let (Some(edits), Some(scene)) = (&mut state.edits, &mut state.scene) {
                    edits.change(change, &mut scene.views);
                }
            }
            EditCommand::SetSun(sun) => state.sun = sun,
            EditCommand::Undo => self.step_edits(true),
            EditCommand::Redo => self.step_edits(false),
            EditCommand::SaveBeside => self.save_beside(),
        }
        self.follow_look();
    }

    fn step_edits(&mut self, is_back: bool) {
        let state = &mut self.state;
        let (Some(edits), Some(scene)) = (&mut state.edits, &mut state.scene) else { return };
        let daylight = edits.now().daylight;
        let has_moved = if is_back { edits.undo(&mut scene.views) } else { edits.redo(&mut scene.views) };
        if edits.now().daylight != daylight {
            let now = edits.now().daylight;
            (state.sun.is_by_place, state.navigation.view_index) = (false, 0);
            state.sun.show(&now);
        }
        state.navigation.view_index = state.navigation.view_index.min(scene.views.len().saturating_sub(1));
        if !has_moved {
            let text = if is_back { "there is nothing to undo" } else { "there is nothing to redo" };
            self.state.info(text);
        }
    }

    /// Makes the scene that looks as it should, unless it is shown or in the making.
    pub(crate) fn follow_look(&mut self) {
        let (Some(edits), Some(obstacles)) = (&self.state.edits, &self.obstacles) else { return };
        if self.is_editing || self.shown_look.as_ref() == Some(edits.now()) {
            return;
        }
        let (look, base) = (edits.now().clone(), obstacles.tracer().clone());
        self.is_editing = true;
        self.in_background("afterimage-edit", move || {
            let make = || Arc::new(base.with_same_geometry(Arc::new(base.scene().with_edit(&look))));
            let made = catch_unwind(AssertUnwindSafe(make)).map_err(|panic| panic_text(&*panic));
            AppEvent::Edited(Box::new(Edited { base, look, made }))
        });
    }

    /// Shows a scene that was made, unless another one has been opened meanwhile.
    pub(crate) fn take_edited(&mut self, edited: Edited) {
        self.is_editing = false;
        let is_current = self.obstacles.as_ref().is_some_and(|o| o.tracer().epoch() == edited.base.epoch());
        if is_current {
            self.shown_look = Some(edited.look);
            match edited.made {
                Ok(tracer) => self.show_edited(tracer),
                Err(text) => self.state.error(format!("the change failed: {text}")),
            }
        }
        self.follow_look();
    }

    fn show_edited(&mut self, tracer: Arc<Tracer>) {
        if let Some(scene) = &mut self.state.scene {
            scene.relight(tracer.scene());
        }
        self.obstacles = Some(Obstacles::new(tracer.clone()));
        self.state.thumbnails.iter_mut().for_each(|t| t.set_tracer(tracer.clone()));
        self.threads.send(RenderCommand::SetTracer(tracer));
        // Its references are of the scene before.
        self.state.selection.reference_view = None;
        // The change is seen at once, at the render scale.
        self.sent = None;
    }

    /// Takes over the look of a scene that was opened; of the same scene read again unsaved changes are kept.
    pub(crate) fn begin_edits(&mut self, scene: &Scene, is_reload: bool) {
        let look = scene.to_edit();
        self.shown_look = Some(look.clone());
        let carried = self.state.edits.as_ref().filter(|e| is_reload && e.is_unsaved());
        let edits = match carried {
            Some(edits) => edits.carried_to(look),
            None => Edits::new(look),
        };
        self.state.sun.show(&edits.now().daylight);
        self.state.edits = Some(edits);
        if !is_reload {
            self.state.selection = Selection::default();
        }
        self.follow_look();
    }

    pub(crate) fn save_beside(&mut self) {
        let (Some(edits), Some(scene)) = (&self.state.edits, &self.state.scene) else { return };
        let SceneSource::File { path, .. } = &scene.source else {
            let text = format!(
                "{} is part of the program and has no folder to save beside; open a model file to keep changes",
                scene.source.label()
            );
            return self.state.error(text);
        };
        let (path, before, look) = (path.clone(), edits.saved().clone(), edits.now().clone());
        self.in_background("afterimage-save", move || {
            let saved = import::save_look_beside(&path, &before, &look);
            AppEvent::SavedLook(Box::new(SavedLook { look, result: saved.map_err(|e| e.to_string()) }))
        });
    }

    /// Says how saving went, and does what waited for it.
    pub(crate) fn take_saved_look(&mut self, ctx: &egui::Context, saved: SavedLook) {
        match saved.result {
            Ok(path) => {
                self.state.edits.iter_mut().for_each(|e| e.set_saved(saved.look.clone()));
                self.state.info(format!("saved {}", path.display()));
                self.leave(ctx);
            }
            Err(text) => {
                if self.state.dialogs.leaving.is_some() {
                    self.answer(ctx, Answer::Stay);
                }
                self.state.error(text);
            }
        }
    }

    /// Views that were changed can be had back.
    pub(crate) fn note_views(&mut self, before: Vec<SavedView>) {
        let now = self.state.scene.as_ref().map(|s| &s.views);
        if now.is_some_and(|now| *now != before) {
            self.state.edits.iter_mut().for_each(|e| e.note_views(before.clone()));
        }
    }
}
