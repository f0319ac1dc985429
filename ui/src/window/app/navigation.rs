//! Commands about views, camera paths and the way the camera moves.

use super::{AppEvent, Services};
use crate::picture::pose_text::pose_of_flags;
use crate::window::export::Destination;
use crate::window::input::{MoveMode, Recording};
use crate::window::rendering::TaskError;
use crate::window::state::{AppState, NavigationCommand, SavedView};
use afterimage::camera::CameraPath;

/// Applies a command. Changes of the saved views can be undone.
pub(super) fn handle_navigation(state: &mut AppState, services: &mut Services, command: NavigationCommand) {
    let views_before = match command {
        NavigationCommand::SaveView(_)
        | NavigationCommand::AddView
        | NavigationCommand::RemoveView(_)
        | NavigationCommand::FinishRenaming => state.scene.as_ref().map(|s| s.views.clone()),
        _ => None,
    };
    apply(state, services, command);
    if let (Some(before), Some(scene), Some(edits)) = (views_before, &state.scene, &mut state.edits)
        && before != scene.views
    {
        edits.note_views(before);
    }
}

fn apply(state: &mut AppState, services: &mut Services, command: NavigationCommand) {
    let navigation = &mut state.navigation;
    match command {
        NavigationCommand::GoToView(index) => go_to_view(state, index),
        NavigationCommand::StepView(step) => step_view(state, step),
        NavigationCommand::GoToKey(key) => go_to_key(state, key),
        NavigationCommand::SaveView(key) => save_view(state, Some(key)),
        NavigationCommand::AddView => save_view(state, None),
        NavigationCommand::RemoveView(index) => {
            navigation.renaming = None;
            if let Some(scene) = &mut state.scene {
                scene.views.remove(index);
            }
        }
        NavigationCommand::Rename(renaming) => navigation.renaming = renaming,
        NavigationCommand::FinishRenaming => finish_renaming(state),
        NavigationCommand::PastePose(text) => match pose_of_flags(&text, navigation.fly.camera()) {
            Ok(camera) => navigation.fly.ease_to(camera),
            Err(cause) => state.error(format!("the clipboard holds no pose: {cause}")),
        },
        NavigationCommand::SetMoveMode(move_mode) => {
            navigation.fly.set_move_mode(move_mode);
            state.info(if move_mode == MoveMode::Walk { "walking" } else { "flying" });
        }
        NavigationCommand::AddPathKey => {
            navigation.playback.add_key(navigation.fly.camera());
            let count = navigation.playback.path.keyframes.len();
            state.info(format!("key {count} of the camera path was set here"));
        }
        NavigationCommand::RemovePathKey(index) => navigation.playback.remove_key(index),
        NavigationCommand::SetPlayback(playback) => {
            navigation.playback = playback;
            if let Some(camera) = navigation.playback.camera() {
                navigation.fly.jump_to(camera);
            }
        }
        NavigationCommand::PlayPath => navigation.playback.toggle(),
        NavigationCommand::ToggleRecording => toggle_recording(state, services),
    }
}

fn go_to_view(state: &mut AppState, index: usize) {
    let view = state.scene.as_ref().and_then(|s| s.views.get(index));
    if let Some(camera) = view.map(|v| v.camera) {
        state.navigation.view_index = index;
        state.navigation.fly.ease_to(camera);
    }
}

fn go_to_key(state: &mut AppState, key: u8) {
    let views = state.scene.iter().flat_map(|s| s.views.iter());
    match views.enumerate().find(|(_, v)| v.key == Some(key)).map(|(index, _)| index) {
        Some(index) => go_to_view(state, index),
        None => state.info(format!("no view is saved as {key}; Ctrl+{key} saves one")),
    }
}

fn step_view(state: &mut AppState, step: isize) {
    let count = state.scene.as_ref().map_or(0, |s| s.views.len());
    if count > 0 {
        let next = (state.navigation.view_index as isize + step).rem_euclid(count as isize);
        go_to_view(state, next as usize);
    }
}

/// Saves the pose under a key, or as one more view without a key.
fn save_view(state: &mut AppState, key: Option<u8>) {
    let camera = *state.navigation.fly.camera();
    let Some(scene) = &mut state.scene else { return };
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
    state.navigation.view_index = index;
    let name = &scene.views[index].name;
    let goes_there = key.map_or(String::new(), |key| format!("; key {key} goes there"));
    let text = format!("{name} was {verb}{goes_there}");
    state.info(text);
}

fn finish_renaming(state: &mut AppState) {
    let Some((index, name)) = state.navigation.renaming.take() else { return };
    let view = state.scene.as_mut().and_then(|s| s.views.get_mut(index));
    if let Some(view) = view.filter(|_| !name.trim().is_empty()) {
        name.trim().clone_into(&mut view.name);
    }
}

/// Starts to record a walk, or ends the recording and saves it.
fn toggle_recording(state: &mut AppState, services: &mut Services) {
    let Some(recording) = state.navigation.recording.take() else {
        state.navigation.recording = Some(Recording::default());
        return;
    };
    let Some(walk) = recording.finish() else {
        return state.info("the camera did not move; there is no walk to save");
    };
    let mut destination = services.destination(state);
    destination.stem += "-walk";
    services.spawn("saving the camera path", move || save_walk(&walk, &destination));
}

/// Writes a walk in the format of `tour --path`.
fn save_walk(walk: &CameraPath, destination: &Destination) -> Result<AppEvent, TaskError> {
    let text = serde_json::to_string_pretty(walk).map_err(TaskError::failed)? + "\n";
    match destination.write_new("json", text.as_bytes()) {
        Ok(path) => Ok(AppEvent::Saved(path)),
        Err(Some(error)) => Err(TaskError::failed(error)),
        Err(None) => Err(TaskError::failed("there is no folder to save the walk in")),
    }
}
