//! Commands of views, paths and the way one moves, as deeds.

use crate::picture::pose_text::pose_of_flags;
use crate::window::app::App;
use crate::window::app::event::AppEvent;
use crate::window::export::screenshot;
use crate::window::input::fly_camera::MoveMode;
use crate::window::input::playback::Recording;
use crate::window::state::{NavigationCommand, SavedView};
use afterimage::camera::CameraPath;
use afterimage::raster::save::write_new_atomically;
use std::path::PathBuf;

impl App {
    /// Does what was asked for.
    pub(crate) fn move_on(&mut self, moving: NavigationCommand) {
        let views_before = match moving {
            NavigationCommand::SaveView(_)
            | NavigationCommand::AddView
            | NavigationCommand::RemoveView(_)
            | NavigationCommand::FinishRenaming => self.state.scene.as_ref().map(|s| s.views.clone()),
            _ => None,
        };
        self.carry_out(moving);
        views_before.into_iter().for_each(|before| self.note_views(before));
    }

    fn carry_out(&mut self, moving: NavigationCommand) {
        let state = &mut self.state;
        match moving {
            NavigationCommand::GoToView(index) => self.go_to_view(index),
            NavigationCommand::StepView(step) => self.step_view(step),
            NavigationCommand::GoToKey(key) => self.go_to_key(key),
            NavigationCommand::SaveView(key) => self.save_view(Some(key)),
            NavigationCommand::AddView => self.save_view(None),
            NavigationCommand::RemoveView(index) => {
                state.scene.iter_mut().for_each(|s| drop(s.views.remove(index)));
                state.navigation.renaming = None;
            }
            NavigationCommand::Rename(renaming) => state.navigation.renaming = renaming,
            NavigationCommand::FinishRenaming => self.finish_renaming(),
            NavigationCommand::PastePose(text) => match pose_of_flags(&text, state.navigation.fly.camera()) {
                Ok(camera) => state.navigation.fly.ease_to(camera),
                Err(cause) => state.error(format!("the clipboard holds no pose: {cause}")),
            },
            NavigationCommand::SetMoveMode(move_mode) => {
                state.navigation.fly.set_move_mode(move_mode);
                let text = if move_mode == MoveMode::Walk { "walking" } else { "flying" };
                state.info(text);
            }
            NavigationCommand::AddPathKey => {
                state.navigation.playback.add_key(state.navigation.fly.camera());
                let count = state.navigation.playback.path.keyframes.len();
                state.info(format!("key {count} of the camera path was set here"));
            }
            NavigationCommand::RemovePathKey(index) => state.navigation.playback.remove_key(index),
            NavigationCommand::SetPlayback(playback) => {
                state.navigation.playback = playback;
                let camera = state.navigation.playback.camera();
                camera.into_iter().for_each(|camera| state.navigation.fly.jump_to(camera));
            }
            NavigationCommand::PlayPath => state.navigation.playback.toggle(),
            NavigationCommand::ToggleRecording => self.toggle_recording(),
        }
    }

    fn go_to_view(&mut self, index: usize) {
        let view = self.state.scene.as_ref().and_then(|s| s.views.get(index));
        if let Some(camera) = view.map(|v| v.camera) {
            self.state.navigation.view_index = index;
            self.state.navigation.fly.ease_to(camera);
        }
    }

    fn go_to_key(&mut self, key: u8) {
        let views = self.state.scene.iter().flat_map(|s| s.views.iter());
        match views.enumerate().find(|(_, v)| v.key == Some(key)).map(|(index, _)| index) {
            Some(index) => self.go_to_view(index),
            None => self.state.info(format!("no view is saved as {key}; Ctrl+{key} saves one")),
        }
    }

    /// Saves the pose under a key, or as one more view without any.
    fn save_view(&mut self, key: Option<u8>) {
        let camera = *self.state.navigation.fly.camera();
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
        self.state.navigation.view_index = index;
        let name = scene.views[index].name.clone();
        let text = key
            .map_or(format!("{name} was {verb}"), |key| format!("{name} was {verb}; key {key} goes there"));
        self.state.info(text);
    }

    fn finish_renaming(&mut self) {
        let Some((index, name)) = self.state.navigation.renaming.take() else { return };
        let view = self.state.scene.as_mut().and_then(|s| s.views.get_mut(index));
        if let Some(view) = view.filter(|_| !name.trim().is_empty()) {
            name.trim().clone_into(&mut view.name);
        }
    }

    /// Begins to record a walk, or ends it and saves it beside the pictures.
    fn toggle_recording(&mut self) {
        let Some(recording) = self.state.navigation.recording.take() else {
            self.state.navigation.recording = Some(Recording::default());
            return;
        };
        match recording.finish() {
            None => self.state.info("nobody moved; there is no walk to save"),
            Some(walk) => self.save_walk(walk),
        }
    }

    fn save_walk(&mut self, walk: CameraPath) {
        let stem =
            format!("{}-walk", screenshot::stem(self.state.scene.as_ref().map_or("walk", |s| &s.name)));
        let folders = self.picture_folders();
        self.in_background("afterimage-save", move || AppEvent::Saved(save_walk(&walk, &stem, &folders)));
    }

    fn step_view(&mut self, step: isize) {
        let count = self.state.scene.as_ref().map_or(0, |s| s.views.len());
        if count > 0 {
            let next = (self.state.navigation.view_index as isize + step).rem_euclid(count as isize);
            self.go_to_view(next as usize);
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
