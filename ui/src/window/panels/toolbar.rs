//! The toolbar: what a visit needs at any time, with one click.

use super::super::state::{
    AppState, Command, Compare, Heatmap, InspectCommand, NavigationCommand, Options, PictureCommand,
};
use super::regions::{self, Region};
use super::widgets::choice;
use crate::window::input::fly_camera::MoveMode;
use crate::window::input::keymap::{Action, keys_of};
use crate::window::rendering::Quantity;
use afterimage::Mode;
use egui::Ui;

/// Shows the toolbar. Its buttons wrap where the window is narrow.
pub fn show(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    ui.horizontal_wrapped(|ui| {
        regions::name(ui, Region::Toolbar);
        pictures(ui, state, commands);
        quantity(ui, state, commands);
        ui.separator();
        mode(ui, state, commands);
        if button(ui, "Add reference", "Trace a reference at the current camera", Action::AddReference, false)
        {
            commands.push(Command::AddReference);
        }
        ui.separator();
        moving(ui, state, commands);
    });
}

/// Shows a button that is marked while `is_on`; true where it was clicked.
fn button(ui: &mut Ui, text: &str, help: &str, action: Action, is_on: bool) -> bool {
    let button = ui.add(egui::Button::new(text).selected(is_on));
    regions::note(&button, Region::Toolbar);
    // Menus and panels have buttons with the same text.
    let button = button.on_hover_text(format!("{help} (key {})", keys_of(action)));
    button.accessible_name(format!("Toolbar: {}", text.to_lowercase())).clicked()
}

fn pictures(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let o = state.options;
    let is_on = o.heatmap != Heatmap::Off;
    let help = "Colour each pixel by where its light comes from";
    if button(ui, "Heatmap", help, Action::CycleHeatmap, is_on) {
        let heatmap = if is_on { Heatmap::Off } else { Heatmap::Blend };
        commands.push(Command::SetOptions(Options { heatmap, ..o }));
    }
    let is_on = state.comparison.shows != Compare::Off;
    let help = "Compare with the full tracer's picture, which reuses nothing";
    if button(ui, "Compare", help, Action::CompareSplit, is_on) {
        let shows = if is_on { Compare::Off } else { Compare::Split };
        commands.push(Command::Compare(shows, state.comparison.split));
    }
    if button(ui, "Picture", "Save a picture", Action::Screenshot, false) {
        commands.push(Command::Picture(PictureCommand::Save));
    }
}

/// A choice of what the viewport shows.
fn quantity(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let mut o = state.options;
    let name = o.quantity.name();
    let combo = choice(ui, "toolbar view", name, &mut o.quantity, Quantity::ALL.map(|q| (q, q.name())));
    let keys = [Action::ShowPicture, Action::ShowClay].map(keys_of);
    combo
        .on_hover_text(format!("What the viewport shows (keys {} to {})", keys[0], keys[1]))
        .accessible_name("Toolbar: view");
    if o != state.options {
        commands.push(Command::SetOptions(o));
    }
}

fn mode(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let mut quality = state.quality;
    let mode = &mut quality.walk.render.mode;
    let name = mode.name();
    let modes = [Mode::Exact, Mode::Fast, Mode::Paper, Mode::Full];
    let combo = choice(ui, "toolbar mode", name, mode, modes.map(|mode| (mode, mode.name())));
    combo
        .on_hover_text("How frames are rendered; the tab Method explains it")
        .accessible_name("Toolbar: mode");
    if quality != state.quality {
        commands.push(Command::SetQuality(quality));
    }
}

fn moving(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let is_walking = state.navigation.fly.move_mode() == MoveMode::Walk;
    if button(ui, "Walk", "Walk on the floor, or fly", Action::ToggleWalk, is_walking) {
        let other = if is_walking { MoveMode::Fly } else { MoveMode::Walk };
        commands.push(Command::Navigate(NavigationCommand::SetMoveMode(other)));
    }
    let is_on = state.selection.measure.is_on;
    if button(ui, "Measure", "Measure distances between two clicks", Action::Measure, is_on) {
        commands.push(Command::Inspect(InspectCommand::ToggleMeasure));
    }
    let is_paused = state.options.is_paused;
    let help = "Stop rendering until the camera moves, or go on";
    if button(ui, "Pause", help, Action::Pause, is_paused) {
        commands.push(Command::SetOptions(state.options.paused(!is_paused)));
    }
}
