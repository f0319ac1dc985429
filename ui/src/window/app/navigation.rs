//! Commands about views, camera paths and the way the camera moves.

use super::{AppEvent, Parts, Services};
use crate::picture::pose_text::pose_of_flags;
use crate::window::export::Destination;
use crate::window::input::Recording;
use crate::window::input::playback::{
    key_pose, lasting, with_key, with_key_moved, with_key_secs, without_key,
};
use crate::window::rendering::TaskError;
use crate::window::state::{AppState, Change, Navigation, NavigationCommand, SavedView};
use afterimage::Camera;
use afterimage::camera::CameraPath;

/// Applies a command. Changes of the saved views and of the path can be undone.
pub(super) fn handle_navigation(state: &mut AppState, services: &mut Services, command: NavigationCommand) {
    let navigation = &mut state.navigation;
    match command {
        NavigationCommand::GoToView(index) => go_to_view(state, index),
        NavigationCommand::StepView(step) => step_view(state, step),
        NavigationCommand::GoToKey(key) => go_to_key(state, key),
        NavigationCommand::SaveView(key) => save_view(state, Some(key)),
        NavigationCommand::AddView => save_view(state, None),
        NavigationCommand::RemoveView(index) => {
            navigation.renaming = None;
            change_views(state, |views| drop(views.remove(index)));
        }
        NavigationCommand::Rename(renaming) => navigation.renaming = renaming,
        NavigationCommand::FinishRenaming => finish_renaming(state),
        NavigationCommand::UpdateView(index) => update_view(state, index),
        NavigationCommand::GoBack => match navigation.pose_before() {
            Some(camera) => navigation.fly.ease_to(camera),
            None => state.info("there is no earlier position to go back to"),
        },
        NavigationCommand::PastePose(text) => match pose_of_flags(&text, navigation.fly.camera()) {
            Ok(camera) => go_to(navigation, camera),
            Err(cause) => state.error(format!("the clipboard holds no pose: {cause}")),
        },
        NavigationCommand::SetMoveMode(move_mode) => navigation.fly.set_move_mode(move_mode),
        NavigationCommand::AddPathKey => {
            let own = state.document.as_ref().and_then(|document| document.now().path.as_ref());
            let path = with_key(own, navigation.fly.camera());
            let count = path.keyframes.len();
            change_path(state, path, f64::INFINITY);
            state.info(format!("key {count} of the camera path was set here"));
        }
        NavigationCommand::RemovePathKey(index) => edit_path(state, |path, _| without_key(path, index)),
        NavigationCommand::UpdatePathKey(index) => {
            edit_path(state, |path, camera| with_key_moved(path, index, camera));
        }
        NavigationCommand::SetKeySecs(index, secs) => {
            edit_path(state, |path, _| with_key_secs(path, index, secs));
        }
        NavigationCommand::SetPathSecs(secs) => edit_path(state, |path, _| lasting(path, secs)),
        NavigationCommand::GoToPathKey(index) => {
            if let Some(camera) = key_pose(state.path(), index) {
                state.navigation.playback.is_playing = false;
                go_to(&mut state.navigation, camera);
            }
        }
        NavigationCommand::SetPlayback(playback) => {
            navigation.playback = playback;
            if let Some(camera) = playback.camera(state.path()) {
                state.navigation.fly.jump_to(camera);
            }
        }
        NavigationCommand::PlayPath => {
            let mut playback = navigation.playback;
            playback.toggle(state.path());
            state.navigation.playback = playback;
        }
        NavigationCommand::ToggleRecording => toggle_recording(state, services),
    }
}

/// Changes the saved views in one step.
fn change_views(state: &mut AppState, change: impl FnOnce(&mut Vec<SavedView>)) {
    let Some(document) = &mut state.document else { return };
    let mut views = document.now().views.clone();
    change(&mut views);
    if views != document.now().views {
        document.change(Change::Views(views));
    }
}

/// Changes the user's path, and pauses it at a time.
fn change_path(state: &mut AppState, path: CameraPath, at_secs: f64) {
    let Some(document) = &mut state.document else { return };
    state.navigation.playback.pause_at(&path, at_secs);
    document.change(Change::Path(Some(path)));
}

/// Changes the path that is shown, which the user's follows from; the time stays. `change` is given
/// the pose of the camera as well.
fn edit_path(state: &mut AppState, change: impl FnOnce(&CameraPath, &Camera) -> CameraPath) {
    let path = change(state.path(), state.navigation.fly.camera());
    change_path(state, path, state.navigation.playback.at_secs);
}

fn go_to_view(state: &mut AppState, index: usize) {
    if let Some(camera) = state.views().get(index).map(|v| v.camera) {
        state.navigation.view_index = index;
        go_to(&mut state.navigation, camera);
    }
}

/// Sends the camera to a pose, from which the user can go back.
pub(super) fn go_to(navigation: &mut Navigation, camera: Camera) {
    navigation.leave_pose();
    navigation.fly.ease_to(camera);
}

/// Moves a saved view to the current pose.
fn update_view(state: &mut AppState, index: usize) {
    let camera = *state.navigation.fly.camera();
    let Some(name) = state.views().get(index).map(|view| view.name.clone()) else { return };
    change_views(state, |views| views[index].camera = camera);
    state.navigation.view_index = index;
    state.info(format!("{name} was moved here"));
}

/// Returns the first number of the keys 1 to 9 under which no view is saved.
fn free_key(views: &[SavedView]) -> Option<u8> {
    (1..=9).find(|key| views.iter().all(|view| view.key != Some(*key)))
}

/// Returns a name that no view has.
fn free_name(views: &[SavedView], key: Option<u8>) -> String {
    let numbers = key.map(usize::from).into_iter().chain(1..=views.len() + 1);
    let names = numbers.map(|number| format!("view {number}"));
    names.into_iter().find(|name| views.iter().all(|view| view.name != *name)).unwrap_or_default()
}

fn go_to_key(state: &mut AppState, key: u8) {
    match state.views().iter().enumerate().find(|(_, v)| v.key == Some(key)).map(|(index, _)| index) {
        Some(index) => go_to_view(state, index),
        None => state.info(format!("no view is saved as {key}; Ctrl+{key} saves one")),
    }
}

fn step_view(state: &mut AppState, step: isize) {
    let count = state.views().len();
    if count > 0 {
        let next = (state.navigation.view_index as isize + step).rem_euclid(count as isize);
        go_to_view(state, next as usize);
    }
}

/// Saves the pose under a key, or as one more view under the next free one.
fn save_view(state: &mut AppState, key: Option<u8>) {
    let camera = *state.navigation.fly.camera();
    if state.document.is_none() {
        return;
    }
    let taken = state.views().iter().position(|v| key.is_some() && v.key == key);
    let key = key.or_else(|| free_key(state.views()));
    let name = free_name(state.views(), key);
    let count = state.views().len();
    change_views(state, |views| match taken {
        Some(index) => views[index].camera = camera,
        None => views.push(SavedView { name, camera, key }),
    });
    let (index, verb) = taken.map_or((count, "saved"), |index| (index, "replaced"));
    state.navigation.view_index = index;
    let name = &state.views()[index].name;
    let goes_there = key.map_or(String::new(), |key| format!("; key {key} goes there"));
    let text = format!("{name} was {verb}{goes_there}");
    state.info(text);
}

fn finish_renaming(state: &mut AppState) {
    let Some((index, name)) = state.navigation.renaming.take() else { return };
    change_views(state, |views| {
        if let Some(view) = views.get_mut(index).filter(|_| !name.trim().is_empty()) {
            name.trim().clone_into(&mut view.name);
        }
    });
}

/// Starts to record a walk, or ends the recording and saves it.
fn toggle_recording(state: &mut AppState, services: &mut Services) {
    match state.navigation.recording.take() {
        None => state.navigation.recording = Some(Recording::default()),
        Some(recording) => save_recording(state, services, recording),
    }
}

/// Ends the recording of a walk, if there is one, and saves it.
pub(super) fn end_recording(app: &mut Parts) {
    if let Some(recording) = app.state.navigation.recording.take() {
        save_recording(&mut app.state, &mut app.services, recording);
    }
}

fn save_recording(state: &mut AppState, services: &mut Services, recording: Recording) {
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
