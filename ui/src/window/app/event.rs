//! What happened in the background since the last picture of the window.

use crate::picture::restore::PictureView;
use crate::window::app::App;
use crate::window::app::scene_edits::{Edited, SavedLook};
use crate::window::gpu::viewport;
use crate::window::rendering::comparison::Measured;
use crate::window::rendering::exchange::locked;
use crate::window::rendering::plan::Plan;
use crate::window::rendering::render_thread::Message;
use crate::window::state::Pair;
use std::path::PathBuf;

/// What background work of the app itself brings back.
pub(crate) enum AppEvent {
    /// The file dialog was closed.
    Chosen(Option<PathBuf>),
    /// Two pictures of a size were measured.
    Measured(Pair, [u32; 2], Measured),
    /// Something failed that nobody waits for.
    Failed(String),
    /// Something was saved, or not.
    Saved(anyhow::Result<PathBuf>),
    /// The scene with a look that was asked for.
    Edited(Box<Edited>),
    /// A look was saved beside its scene, or not.
    SavedLook(Box<SavedLook>),
    /// A plan of the so-manieth scene.
    Plan(u64, Plan),
    /// A session was saved, or not.
    Session(Result<PathBuf, String>),
    /// Something was kept for the next start; only failure is told.
    Kept(Result<(), String>),
    /// The files of this model have changed.
    Changed(PathBuf),
    /// The view of a picture was read, or not.
    View(Result<PictureView, String>),
}

impl App {
    /// Sets the exposure by the first complete picture of a model that was just opened.
    fn meter(&mut self) {
        // Beyond these a picture is meant to be dark or bright.
        const RANGE_EV: std::ops::RangeInclusive<f32> = -4.0..=6.0;
        let Some(frame) = &self.state.frame else { return };
        let is_awaited = self.meters_from.is_some_and(|from| frame.generation >= from);
        if let Some(ev) = frame.metered_ev.filter(|_| is_awaited) {
            self.state.quality.exposure_ev = ev.clamp(*RANGE_EV.start(), *RANGE_EV.end());
            self.meters_from = None;
        }
    }

    /// Takes in all that has happened since the last frame of the window.
    pub(crate) fn poll(&mut self, ctx: &egui::Context) {
        self.poll_loader();
        self.poll_export();
        let messages: Vec<Message> = self.threads.messages().collect();
        for message in messages {
            match message {
                Message::Reference(reference) => self.show_reference(ctx, &reference),
                Message::Picture(picture) => self.save_from_references(picture),
                Message::Failed(text) => self.state.error(text),
            }
        }
        let news: Vec<AppEvent> = self.news.1.try_iter().collect();
        for news in news {
            match news {
                AppEvent::Chosen(path) => {
                    self.is_browsing = false;
                    path.into_iter().for_each(|path| self.open_path(path));
                }
                AppEvent::Measured(pair, size, measured) => {
                    let graphics = self.graphics.clone();
                    self.take_measured(pair, size, measured, graphics.as_ref());
                }
                AppEvent::Failed(text) => self.state.error(text),
                AppEvent::Saved(Ok(path)) => {
                    self.state.info(format!("saved {}", path.display()));
                }
                AppEvent::Edited(edited) => self.take_edited(*edited),
                AppEvent::SavedLook(saved) => self.take_saved_look(ctx, *saved),
                AppEvent::Plan(scene, plan) => self.take_plan(scene, plan),
                AppEvent::Session(saved) => self.session_saved(saved),
                AppEvent::Kept(Ok(())) => {}
                AppEvent::Kept(Err(message)) => self.state.error(message),
                AppEvent::Changed(path) => self.reload_changed(&path),
                AppEvent::View(Ok(view)) => self.go_to_picture(view),
                AppEvent::View(Err(message)) => self.state.error(message),
                AppEvent::Saved(Err(error)) => self.state.error(format!("{error:#}")),
            }
        }
        let trouble = std::mem::take(&mut *locked(&self.trouble));
        trouble.into_iter().for_each(|text| self.state.error(text));
        if self.threads.take_frame(&mut self.state.frame) {
            if self.state.frame.as_ref().is_some_and(|f| !f.is_refinement) {
                self.state.record();
            }
            self.meter();
            if let (Some(graphics), Some(frame)) = (&self.graphics, &self.state.frame) {
                viewport::upload(graphics, frame);
            }
        }
        self.state.notices.retain(|n| !n.is_expired());
        self.follow_plan();
        self.want_thumbnails(ctx);
    }
}
