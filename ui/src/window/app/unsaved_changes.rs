//! Changes that are not saved are asked about before they are lost: when the window is closed, and when another scene is
//! opened.

use crate::window::app::App;
use crate::window::rendering::scene_loading::SceneSource;
use crate::window::state::{Answer, Edits, Leaving};
use afterimage::Tracer;
use egui::{Context, ViewportCommand};
use std::sync::Arc;

impl App {
    /// Begins to load a scene, at once or when it is known what becomes of the changes of this one. They survive a
    /// reload.
    pub(crate) fn open(&mut self, source: SceneSource) {
        let is_reload = self.state.scene.as_ref().is_some_and(|s| s.source.label() == source.label());
        if is_reload || !self.has_unsaved_changes() {
            return self.load(source);
        }
        self.state.dialogs.leaving = Some(Leaving::Open(source));
    }

    /// Shows a scene that was loaded, or asks first what becomes of changes made while it was.
    pub(crate) fn show_or_ask(&mut self, source: SceneSource, tracer: Arc<Tracer>) {
        let is_reload = self.state.scene.as_ref().is_some_and(|s| s.source.label() == source.label());
        if is_reload || self.discards || !self.has_unsaved_changes() {
            self.discards = false;
            return self.show_scene(source, tracer);
        }
        self.state.dialogs.leaving = Some(Leaving::Show(source, tracer));
    }

    /// Holds the window open where closing it would lose changes.
    pub(crate) fn hold_close(&mut self, ctx: &Context) {
        let is_asked = ctx.input(|i| i.viewport().close_requested());
        if is_asked && !self.may_close && self.has_unsaved_changes() {
            ctx.send_viewport_cmd(ViewportCommand::CancelClose);
            self.forget_awaited();
            self.state.dialogs.leaving = Some(Leaving::Close);
        }
    }

    fn has_unsaved_changes(&self) -> bool {
        self.state.edits.as_ref().is_some_and(Edits::is_unsaved)
    }

    /// Goes on as the question was answered.
    pub(crate) fn answer(&mut self, ctx: &Context, answer: Answer) {
        match answer {
            // Goes on once they are saved.
            Answer::Save => self.save_beside(),
            Answer::Discard => {
                self.discards = matches!(self.state.dialogs.leaving, Some(Leaving::Open(_)));
                self.leave(ctx);
            }
            Answer::Stay => {
                self.state.dialogs.leaving = None;
                self.forget_awaited();
            }
        }
    }

    /// Does what waited for the answer, if anything did.
    pub(crate) fn leave(&mut self, ctx: &Context) {
        match self.state.dialogs.leaving.take() {
            Some(Leaving::Close) => {
                self.may_close = true;
                ctx.send_viewport_cmd(ViewportCommand::Close);
            }
            Some(Leaving::Open(source)) => self.load(source),
            Some(Leaving::Show(source, tracer)) => self.show_scene(source, tracer),
            None => {}
        }
    }
}
