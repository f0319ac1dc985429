//! What opening a file means: a model is loaded, a picture leads back to its view.

use crate::picture::restore::{PictureView, beside, is_picture, read_view};
use crate::window::app::App;
use crate::window::app::event::AppEvent;
use crate::window::app::session::is_session;
use crate::window::input::playback::Playback;
use crate::window::input::walking::Obstacles;
use crate::window::rendering::render_thread::RenderCommand;
use crate::window::rendering::scene_loading::{Loader, SceneSource};
use crate::window::state::SceneInfo;
use afterimage::{Camera, Tracer};
use std::path::PathBuf;
use std::sync::Arc;

impl App {
    /// Begins to load a scene; the old one stays until the new one is complete.
    pub(crate) fn load(&mut self, source: SceneSource) {
        match Loader::start(source, self.wake.clone()) {
            Ok(loader) => self.loader = Some(loader),
            Err(error) => {
                self.discards = false;
                self.state.error(format!("loading cannot be started: {error}"));
            }
        }
    }

    pub(crate) fn poll_loader(&mut self) {
        let Some(loader) = &self.loader else {
            self.state.loading = None;
            return;
        };
        let source = loader.source().clone();
        match loader.result() {
            None => self.state.loading = Some((source, loader.progress())),
            Some(result) => {
                (self.loader, self.state.loading) = (None, None);
                match result {
                    Ok(tracer) => self.show_or_ask(source, tracer),
                    Err(message) => {
                        self.discards = false;
                        self.forget_awaited();
                        self.state.error(message);
                    }
                }
            }
        }
    }

    pub(crate) fn show_scene(&mut self, source: SceneSource, tracer: Arc<Tracer>) {
        let is_reload = self.state.scene.as_ref().is_some_and(|s| s.source.label() == source.label());
        let scene = SceneInfo::new(source, &tracer);
        let (view_index, start) = self.start_pose(&scene);
        self.compare_hash(&tracer.scene().hash);
        // A scene that was edited is looked at from where one was.
        if !is_reload {
            self.state.navigation.fly.jump_to(start);
            self.state.navigation.view_index = view_index;
        }
        if !scene.warnings.is_empty() {
            let count = scene.warnings.len();
            let text = format!("{}: {count} import warnings, listed in the Scene panel", scene.name);
            self.state.info(text);
        }
        let is_model = matches!(scene.source, SceneSource::File { .. });
        self.state.scene = Some(scene);
        self.state.history.clear();
        self.obstacles = Some(Obstacles::new(tracer.clone()));
        self.scenes_opened += 1;
        (self.state.plan.cut, self.is_planning) = (None, false);
        self.state.thumbnails.iter_mut().for_each(|t| t.set_tracer(tracer.clone()));
        self.begin_edits(tracer.scene(), is_reload);
        if !is_reload {
            self.state.plan.view = Default::default();
            self.state.navigation.playback = Playback::of_scene(tracer.scene().walk.clone());
            (self.state.navigation.recording, self.state.navigation.renaming) = (None, None);
        }
        let generation = self.threads.send(RenderCommand::SetTracer(tracer));
        self.scene_since = generation;
        if !is_reload {
            let given = self.request.settings.render.trace.bounces;
            let bounces = if is_model { self.request.model_bounces } else { given };
            // A reset goes back to what suits the scene.
            for quality in [&mut self.state.quality, &mut self.state.default_quality] {
                quality.walk.render.trace.bounces = bounces;
            }
            self.state.quality.exposure_ev = self.state.default_quality.exposure_ev;
            let is_metered = is_model && self.request.exposure_ev.is_none();
            self.meters_from = is_metered.then_some(generation);
        }
        let source = self.state.scene.as_ref().map(|s| s.source.clone());
        source.iter().for_each(|source| self.keep_scene(source, is_reload));
        self.sent = None;
    }

    /// The number of the saved view to start at and the pose. Only the first scene starts where the request says.
    fn start_pose(&mut self, scene: &SceneInfo) -> (usize, Camera) {
        let name = self.request.view.take();
        let index = name.as_ref().and_then(|name| scene.views.iter().position(|v| v.name == *name));
        if let (Some(name), None) = (&name, index) {
            let known: Vec<&str> = scene.views.iter().map(|v| v.name.as_str()).collect();
            let text = format!("{} has no view '{name}'; it has: {}", scene.name, known.join(", "));
            self.state.error(text);
        }
        let index = index.unwrap_or(0);
        let mut camera = self.request.camera.take().unwrap_or(scene.views[index].camera);
        if let Some(degrees) = self.request.fov_y_deg.take() {
            camera.fov_y = degrees.to_radians();
        }
        (index, camera)
    }

    /// Opens whatever a file is.
    pub(crate) fn open_path(&mut self, path: PathBuf) {
        self.forget_awaited();
        if is_picture(&path) {
            return self.in_background("afterimage-picture", move || {
                AppEvent::View(read_view(&path).map(|view| beside(view, &path)).map_err(|e| e.to_string()))
            });
        }
        if is_session(&path) {
            return self.open_session(path);
        }
        self.open(SceneSource::file(path));
    }

    /// Goes where a picture was taken; its scene is loaded unless it is the one that is shown.
    pub(crate) fn go_to_picture(&mut self, view: PictureView) {
        let shown = self.obstacles.as_ref().map(|o| o.tracer().scene().hash.clone());
        if shown.as_ref() == Some(&view.scene_hash) {
            self.state.navigation.fly.ease_to(view.camera);
            self.state.quality.exposure_ev = view.exposure_ev.unwrap_or(self.state.quality.exposure_ev);
            return self.state.info("here the picture was taken");
        }
        let source = SceneSource::named(&view.scene, Default::default());
        if let SceneSource::File { path, .. } = &source
            && !path.exists()
        {
            let text = format!(
                "the picture shows {}, which is not there; open the model, then drop the picture again",
                view.scene
            );
            return self.state.error(text);
        }
        if self.state.scene.as_ref().is_some_and(|s| s.source.label() == source.label()) {
            // Loaded again, one stays where one is.
            self.state.navigation.fly.jump_to(view.camera);
        }
        self.forget_awaited();
        self.request.camera = Some(view.camera);
        self.request.exposure_ev = view.exposure_ev.or(self.request.exposure_ev);
        self.expected_hash = Some(view.scene_hash);
        self.open(source);
    }

    /// Opens a scene for its own sake: what waited for another one is forgotten.
    pub(crate) fn open_anew(&mut self, source: SceneSource) {
        self.forget_awaited();
        self.open(source);
    }

    /// Loads the scene that is shown again.
    pub(crate) fn reload(&mut self) {
        let source = self.state.scene.as_ref().map(|s| s.source.clone());
        source.into_iter().for_each(|source| self.open(source));
    }

    pub(crate) fn cancel_loading(&mut self) {
        (self.loader, self.discards) = (None, false);
        self.forget_awaited();
    }

    /// The scene that something waited for does not come.
    pub(crate) fn forget_awaited(&mut self) {
        (self.request.camera, self.expected_hash, self.keeping.awaited) = (None, None, None);
    }

    /// Says where a picture's scene has changed since.
    pub(crate) fn compare_hash(&mut self, hash: &str) {
        if self.expected_hash.take().is_some_and(|expected| expected != hash) {
            let text = "the scene has changed since the picture was taken; this is the same place in it";
            self.state.info(text);
        }
    }
}
