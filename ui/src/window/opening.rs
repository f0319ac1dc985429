//! What opening a file means: a model is loaded, a picture leads back to its view.

use super::app::{App, News};
use super::load::SceneSource;
use super::session::is_session;
use super::state::Severity;
use crate::picture::restore::{PictureView, beside, is_picture, read_view};
use std::path::PathBuf;

impl App {
    /// Opens whatever a file is.
    pub(super) fn open_path(&mut self, path: PathBuf) {
        self.forget_awaited();
        if is_picture(&path) {
            return self.in_background("afterimage-picture", move || {
                News::View(read_view(&path).map(|view| beside(view, &path)))
            });
        }
        if is_session(&path) {
            return self.open_session(path);
        }
        self.open(SceneSource::file(path));
    }

    /// Goes where a picture was taken; its scene is loaded unless it is the one that is shown.
    pub(super) fn go_to_picture(&mut self, view: PictureView) {
        let shown = self.obstacles.as_ref().map(|o| o.tracer().scene().hash.clone());
        if shown.as_ref() == Some(&view.scene_hash) {
            self.state.fly.ease_to(view.camera);
            self.state.quality.exposure_ev = view.exposure_ev.unwrap_or(self.state.quality.exposure_ev);
            return self.state.notify(Severity::Info, "here the picture was taken".to_owned());
        }
        let source = SceneSource::named(&view.scene, Default::default());
        if let SceneSource::File { path, .. } = &source
            && !path.exists()
        {
            let text = format!(
                "the picture shows {}, which is not there; open the model, then drop the picture again",
                view.scene
            );
            return self.state.notify(Severity::Error, text);
        }
        if self.state.scene.as_ref().is_some_and(|s| s.source.label() == source.label()) {
            // Loaded again, one stays where one is.
            self.state.fly.jump_to(view.camera);
        }
        self.forget_awaited();
        self.request.camera = Some(view.camera);
        self.request.exposure_ev = view.exposure_ev.or(self.request.exposure_ev);
        self.expected_hash = Some(view.scene_hash);
        self.open(source);
    }

    /// Opens a scene for its own sake: what waited for another one is forgotten.
    pub(super) fn open_anew(&mut self, source: SceneSource) {
        self.forget_awaited();
        self.open(source);
    }

    /// Loads the scene that is shown again.
    pub(super) fn reload(&mut self) {
        let source = self.state.scene.as_ref().map(|s| s.source.clone());
        source.into_iter().for_each(|source| self.open(source));
    }

    pub(super) fn cancel_loading(&mut self) {
        self.loader = None;
        self.forget_awaited();
    }

    /// The scene that something waited for does not come.
    pub(super) fn forget_awaited(&mut self) {
        (self.request.camera, self.expected_hash, self.keeping.awaited) = (None, None, None);
    }

    /// Says where a picture's scene has changed since.
    pub(super) fn compare_hash(&mut self, hash: &str) {
        if self.expected_hash.take().is_some_and(|expected| expected != hash) {
            let text = "the scene has changed since the picture was taken; this is the same place in it";
            self.state.notify(Severity::Info, text.to_owned());
        }
    }
}
