//! The camera path: its keys, a timeline, and recording.

use super::super::state::{AppState, Command, NavigationCommand, PictureCommand};
use super::numbers::Number;
use super::widgets::{counted, key_hint};
use crate::window::input::keymap::Action;
use crate::window::input::playback::{Playback, key_secs, path_secs};
use afterimage::camera::CameraPath;
use egui::Ui;

/// Shows the timeline, the keys and the recording button.
pub fn show(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let (playback, path) = (&state.navigation.playback, state.path());
    let count = path.keyframes.len();
    let whose = if state.has_own_path() { "Your path" } else { "The scene's path" };
    let (keys_text, secs) = (counted(count, "key"), path_secs(path));
    ui.weak(format!("{whose}: {keys_text}, {secs:.1} s, {:.1} m", path.length_m()));
    ui.horizontal_wrapped(|ui| {
        let play = if playback.is_playing { "Pause path" } else { "Play path" };
        let button = ui.add_enabled(count > 0, egui::Button::new(play));
        if button.on_hover_text(key_hint(Action::PlayPath)).clicked() {
            commands.push(Command::Navigate(NavigationCommand::PlayPath));
        }
        if ui.button("Add key").on_hover_text(key_hint(Action::AddPathKey)).clicked() {
            commands.push(Command::Navigate(NavigationCommand::AddPathKey));
        }
        let mut loops = playback.loops;
        if ui.checkbox(&mut loops, "Loop").changed() {
            commands.push(Command::Navigate(NavigationCommand::SetPlayback(Playback { loops, ..*playback })));
        }
    });
    timeline(ui, playback, path, commands);
    if state.has_own_path() {
        keys(ui, path, commands);
    }
    let is_free = state.picture.exporting.is_none() && count > 1;
    let film = ui.add_enabled(is_free, egui::Button::new("Save as film (MP4)"));
    if film.on_hover_text(key_hint(Action::SaveFilm)).clicked() {
        commands.push(Command::Picture(PictureCommand::SaveFilm));
    }
    let text = match &state.navigation.recording {
        None => "Record path".to_owned(),
        Some(recording) => format!("Stop and save path ({:.0} s)", recording.secs()),
    };
    let help = "Records your movement as a file for `afterimage tour --path` and the experiments";
    if ui.button(text).on_hover_text(help).clicked() {
        commands.push(Command::Navigate(NavigationCommand::ToggleRecording));
    }
}

fn timeline(ui: &mut Ui, playback: &Playback, path: &CameraPath, commands: &mut Vec<Command>) {
    let label = ui.label("Time");
    let mut at_secs = playback.at_secs;
    ui.spacing_mut().slider_width = (ui.available_width() - 70.0).max(60.0);
    let is_enabled = !path.keyframes.is_empty();
    let number = Number::new(0.0..=path_secs(path), 1, " s");
    let slider = ui.add_enabled_ui(is_enabled, |ui| number.slider(ui, &mut at_secs)).inner;
    slider.labelled_by(label.id);
    if at_secs != playback.at_secs {
        commands.push(Command::Navigate(NavigationCommand::SetPlayback(Playback {
            at_secs,
            is_playing: false,
            ..*playback
        })));
    }
}

/// Shows a row for each key with its time to the next one, and the time of the whole path.
fn keys(ui: &mut Ui, path: &CameraPath, commands: &mut Vec<Command>) {
    let mut navigate = |command| commands.push(Command::Navigate(command));
    let times = key_secs(path);
    for i in 0..path.keyframes.len() {
        let number = i + 1;
        ui.horizontal(|ui| {
            ui.label(format!("Key {number}"));
            if ui.small_button("Go").accessible_name(format!("Go to path key {number}")).clicked() {
                navigate(NavigationCommand::GoToPathKey(i));
            }
            let update = ui.small_button("Update").accessible_name(format!("Update path key {number}"));
            if update.on_hover_text("Set this key to the present view").clicked() {
                navigate(NavigationCommand::UpdatePathKey(i));
            }
            if ui.small_button("Delete").accessible_name(format!("Delete path key {number}")).clicked() {
                navigate(NavigationCommand::RemovePathKey(i));
            }
            if let Some(before) = times.get(i) {
                let mut secs = *before;
                let field = Number::new(0.0..=600.0, 1, " s").field(ui, "", &mut secs);
                let name = format!("Seconds from path key {number} to the next");
                field.accessible_name(name).on_hover_text("Time from this key to the next one");
                if secs != *before {
                    navigate(NavigationCommand::SetKeySecs(i, secs));
                }
            }
        });
    }
    if !times.is_empty() {
        ui.horizontal(|ui| {
            let label = ui.label("Whole path");
            let before = path_secs(path);
            let mut secs = before;
            Number::new(0.1..=3600.0, 1, " s").field(ui, "", &mut secs).labelled_by(label.id);
            if secs != before {
                navigate(NavigationCommand::SetPathSecs(secs));
            }
        });
    }
}
