//! Commands as deeds: the only place where a panel's or a key's wish changes anything.

use super::app::{App, News};
use super::fly_camera::Gait;
use super::load::SceneSource;
use super::pose_text::{pose_flags, pose_of_flags};
use super::playback::Recording;
use super::render_thread::Order;
use super::screenshot;
use super::state::{Command, SavedView, Severity};
use afterimage::camera_path::CameraPath;
use afterimage::raster::save::write_new_atomically;
use egui::{Context, ViewportCommand};
use std::path::PathBuf;

impl App {
    /// Does what was asked for.
    pub(super) fn apply(&mut self, ctx: &Context, command: Command) {
        let state = &mut self.state;
        match command {
            Command::Open(source) => self.open(source),
            Command::Browse => self.browse(),
            Command::CancelLoading => self.loader = None,
            Command::Reload => {
                let source = state.scene.as_ref().map(|s| s.source.clone());
                source.into_iter().for_each(|source| self.open(source));
            }
            Command::SetPathText(text) => state.path_text = text,
            Command::SetQuality(quality) => state.quality = quality,
            Command::SetOptions(options) => {
                state.options = options;
                state.fly.set_view_change(options.view_change);
            }
            Command::SetSpeed(speed) => state.fly.set_speed(speed),
            Command::SetFovDegrees(degrees) => state.fly.set_fov_degrees(degrees),
            Command::EaseTo(camera) => state.fly.ease_to(camera),
            Command::GoToView(index) => self.go_to_view(index),
            Command::GoToKey(key) => self.go_to_key(key),
            Command::SaveView(key) => self.save_view(Some(key)),
            Command::AddView => self.save_view(None),
            Command::RemoveView(index) => {
                state.scene.iter_mut().for_each(|s| drop(s.views.remove(index)));
                state.renaming = None;
            }
            Command::Rename(renaming) => state.renaming = renaming,
            Command::FinishRenaming => self.finish_renaming(),
            Command::PastePose(text) => match pose_of_flags(&text, state.fly.camera()) {
                Ok(camera) => state.fly.ease_to(camera),
                Err(cause) => state.notify(Severity::Error, format!("the clipboard holds no pose: {cause}")),
            },
            Command::SetGait(gait) => {
                state.fly.set_gait(gait);
                let text = if gait == Gait::Walk { "walking" } else { "flying" };
                state.notify(Severity::Info, text.to_owned());
            }
            Command::AddPathKey => {
                state.playback.add_key(state.fly.camera());
                let count = state.playback.path.keyframes.len();
                state.notify(Severity::Info, format!("key {count} of the camera path was set here"));
            }
            Command::RemovePathKey(index) => state.playback.remove_key(index),
            Command::SetPlayback(playback) => {
                state.playback = playback;
                let camera = state.playback.camera();
                camera.into_iter().for_each(|camera| state.fly.jump_to(camera));
            }
            Command::PlayPath => state.playback.toggle(),
            Command::ToggleRecording => self.toggle_recording(),
            Command::Say(severity, text) => state.notify(severity, text),
            Command::StepView(step) => self.step_view(step),
            Command::Level => state.fly.level(),
            Command::ChangeFov(steps) => state.fly.change_fov(steps),
            Command::AskToClear => state.asks_to_clear = true,
            Command::KeepReferences => state.asks_to_clear = false,
            Command::Clear => {
                state.asks_to_clear = false;
                self.threads.order(Order::Clear);
            }
            Command::AddReference => self.order(Order::AddReference(*self.state.fly.camera())),
            Command::Remove(id) => self.order(Order::Remove(id)),
            Command::Screenshot => self.order(Order::Picture),
            Command::CopyPose => {
                let flags = pose_flags(state.fly.camera());
                state.notify(Severity::Info, format!("copied {flags}"));
                ctx.copy_text(flags);
            }
            Command::CopyText(text) => ctx.copy_text(text),
            Command::Dismiss(id) => state.notices.retain(|n| n.id != id),
            Command::FullScreen => {
                let is_full = ctx.input(|i| i.viewport().fullscreen.unwrap_or(false));
                ctx.send_viewport_cmd(ViewportCommand::Fullscreen(!is_full));
            }
            Command::Escape => self.escape(ctx),
        }
        // What a command changed is shown, though no event may follow.
        ctx.request_repaint();
    }

    fn order(&mut self, order: Order) {
        self.threads.order(order);
    }

    fn go_to_view(&mut self, index: usize) {
        let view = self.state.scene.as_ref().and_then(|s| s.views.get(index));
        if let Some(camera) = view.map(|v| v.camera) {
            self.state.view_index = index;
            self.state.fly.ease_to(camera);
        }
    }

    fn go_to_key(&mut self, key: u8) {
        let views = self.state.scene.iter().flat_map(|s| s.views.iter());
        match views.enumerate().find(|(_, v)| v.key == Some(key)).map(|(index, _)| index) {
            Some(index) => self.go_to_view(index),
            None => self.state.notify(Severity::Info, format!("no view is saved as {key}; Ctrl+{key} saves one")),
        }
    }

    /// Saves the pose under a key, or as one more view without any.
    fn save_view(&mut self, key: Option<u8>) {
        let camera = *self.state.fly.camera();
        let Some(scene) = &mut self.state.scene else { return };
        let taken = scene.views.iter_mut().position(|v| key.is_some() && v.key == key);
        let (index, verb) = match taken {
            Some(index) => {
                scene.views[index].camera = camera;
                (index, "replaced")
            }
            None => {
                let name = format!("view {}", key.map_or(scene.views.len() + 1, usize::from));
                scene.views.push(SavedView { name, camera, key });
                (scene.views.len() - 1, "saved")
            }
        };
        self.state.view_index = index;
        let name = scene.views[index].name.clone();
        let text = key.map_or(format!("{name} was {verb}"), |key| format!("{name} was {verb}; key {key} goes there"));
        self.state.notify(Severity::Info, text);
    }

    fn finish_renaming(&mut self) {
        let Some((index, name)) = self.state.renaming.take() else { return };
        let view = self.state.scene.as_mut().and_then(|s| s.views.get_mut(index));
        if let Some(view) = view.filter(|_| !name.trim().is_empty()) {
            name.trim().clone_into(&mut view.name);
        }
    }

    /// Begins to record a walk, or ends it and saves it beside the pictures.
    fn toggle_recording(&mut self) {
        let Some(recording) = self.state.recording.take() else {
            self.state.recording = Some(Recording::default());
            return;
        };
        match recording.finish() {
            None => self.state.notify(Severity::Info, "nobody moved; there is no walk to save".to_owned()),
            Some(walk) => self.save_walk(walk),
        }
    }

    fn save_walk(&mut self, walk: CameraPath) {
        let stem = format!("{}-walk", screenshot::stem(self.state.scene.as_ref().map_or("walk", |s| &s.name)));
        let folders = self.request.pictures.clone().map_or_else(screenshot::default_folders, |f| vec![f]);
        self.in_background("afterimage-save", move || News::Saved(save_walk(&walk, &stem, &folders)));
    }

    /// Does something slow on a thread of its own.
    pub(super) fn in_background(&mut self, name: &str, work: impl FnOnce() -> News + Send + 'static) {
        let (news, wake) = (self.news.0.clone(), self.wake.clone());
        let work = move || {
            // The window may be gone.
            let _ = news.send(work());
            wake();
        };
        if let Err(error) = std::thread::Builder::new().name(name.to_owned()).spawn(work) {
            self.state.notify(Severity::Error, format!("a thread cannot be started: {error}"));
        }
    }

    fn step_view(&mut self, step: isize) {
        let count = self.state.scene.as_ref().map_or(0, |s| s.views.len());
        if count > 0 {
            let next = (self.state.view_index as isize + step).rem_euclid(count as isize);
            self.go_to_view(next as usize);
        }
    }

    /// Leaves what is open, the last opened first; never quits.
    fn escape(&mut self, ctx: &Context) {
        let state = &mut self.state;
        if state.asks_to_clear {
            state.asks_to_clear = false;
        } else if state.options.shows_help {
            state.options.shows_help = false;
        } else if state.notices.pop().is_none() && ctx.input(|i| i.viewport().fullscreen.unwrap_or(false)) {
            ctx.send_viewport_cmd(ViewportCommand::Fullscreen(false));
        }
    }

    /// Asks for a file on a thread of its own: the system's dialog blocks.
    fn browse(&mut self) {
        if std::mem::replace(&mut self.is_browsing, true) {
            return;
        }
        let (news, wake) = (self.news.0.clone(), self.wake.clone());
        let work = move || {
            let dialog = rfd::FileDialog::new().set_title("Open a model").add_filter("Models", &["obj"]);
            // The window may be gone.
            let _ = news.send(News::Chosen(dialog.pick_file()));
            wake();
        };
        if let Err(error) = std::thread::Builder::new().name("afterimage-dialog".to_owned()).spawn(work) {
            self.is_browsing = false;
            self.state.notify(Severity::Error, format!("the file dialog cannot be started: {error}"));
        }
    }
}

/// Writes a walk into the first folder that takes it, as `tour --path` reads it.
fn save_walk(walk: &CameraPath, stem: &str, folders: &[PathBuf]) -> anyhow::Result<PathBuf> {
    let text = serde_json::to_string_pretty(walk)? + "\n";
    let mut result = Err(anyhow::anyhow!("there is no folder to save the walk in"));
    for folder in folders {
        result = write_new_atomically(folder, stem, "json", text.as_bytes()).map_err(Into::into);
        if result.is_ok() {
            break;
        }
    }
    result
}

impl App {
    /// What is being loaded, if anything.
    pub fn loading(&self) -> Option<&SceneSource> {
        self.loader.as_ref().map(super::load::Loader::source)
    }
}
