//! The menu bar.

use super::super::state::{
    AppState, Command, EditCommand, FileCommand, InspectCommand, ListCommand, NavigationCommand,
    OpenDocument, Options, PictureCommand, Purpose,
};
use crate::window::input::keymap::{Action, keys_of};
use crate::window::{input::fly_camera::MoveMode, rendering::scene_loading::SceneSource};
use afterimage::scene::builtin;
use egui::{Button, Ui};

/// Shows the menu bar with its menus.
pub fn show(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    egui::MenuBar::new().ui(ui, |ui| {
        ui.menu_button("Scene", |ui| scene_menu(ui, state, commands));
        ui.menu_button("Edit", |ui| edit_menu(ui, state, commands));
        ui.menu_button("View", |ui| view_menu(ui, state, commands));
        if item(ui, "Settings", None) {
            commands.push(Command::ShowSettings(!state.dialogs.shows_settings));
        }
        let mut options = state.options;
        if item(ui, "Help", None) {
            options.shows_help = true;
            commands.push(Command::SetOptions(options));
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            if state.is_unsaved() {
                ui.label("Unsaved changes")
                    .on_hover_text(format!("{} saves all of it in a session", keys_of(Action::SaveSession)));
            }
            if let Some(adapter) = &state.software_adapter {
                ui.weak("no graphics card")
                    .on_hover_text(format!("The window is rendered in software by {adapter}."));
            }
        });
    });
}

fn item(ui: &mut Ui, text: &str, action: Option<Action>) -> bool {
    let button = Button::new(text);
    // Without a shortcut, no empty text is added to the accessible name.
    ui.add(match action {
        Some(action) => button.shortcut_text(keys_of(action)),
        None => button,
    })
    .clicked()
}

fn recent_menu(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    ui.add_enabled_ui(!state.files.recent.is_empty(), |ui| {
        ui.menu_button("Recent", |ui| {
            for path in &state.files.recent {
                let name =
                    path.file_name().map_or(path.display().to_string(), |n| n.to_string_lossy().into());
                if ui.button(name).on_hover_text(path.display().to_string()).clicked() {
                    commands.push(Command::OpenPath(path.clone()));
                }
            }
            ui.separator();
            if ui.button("Clear recent files").clicked() {
                commands.push(Command::Files(FileCommand::ForgetRecent));
            }
        });
    });
}

fn scene_menu(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    if item(ui, "Open...", Some(Action::Open)) {
        commands.push(Command::List(ListCommand::Ask(Purpose::Open)));
    }
    ui.menu_button("Built-in", |ui| {
        for name in builtin::NAMES {
            if item(ui, name, None) {
                commands.push(Command::Open(SceneSource::Builtin((*name).to_owned())));
            }
        }
    });
    recent_menu(ui, state, commands);
    if item(ui, "Save session", Some(Action::SaveSession)) {
        commands.push(Command::Files(FileCommand::SaveSession));
    }
    if state.scene.is_some() && item(ui, "Reload", Some(Action::Reload)) {
        commands.push(Command::Reload);
    }
    ui.separator();
    let bake = if state.plan.baking.is_some() { "Cancel baking" } else { "Bake" };
    if state.scene.is_some() && item(ui, bake, Some(Action::Bake)) {
        commands.push(Command::Bake);
    }
    if item(ui, "Save picture", Some(Action::Screenshot)) {
        commands.push(Command::Picture(PictureCommand::Save));
    }
    if item(ui, "Picture settings...", None) {
        commands.push(Command::Picture(PictureCommand::ShowDialog(true)));
    }
    if item(ui, "Copy pose", Some(Action::CopyPose)) {
        commands.push(Command::CopyPose);
    }
    ui.separator();
    if item(ui, "Quit", Some(Action::Quit)) {
        commands.push(Command::Quit);
    }
}

fn edit_menu(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let can = |test: fn(&OpenDocument) -> bool| state.document.as_ref().is_some_and(test);
    let mut entry = |text: &str, action: Option<Action>, is_enabled: bool, command: Command| {
        let keys = action.map(keys_of).unwrap_or_default();
        if ui.add_enabled(is_enabled, Button::new(text).shortcut_text(keys)).clicked() {
            commands.push(command);
        }
    };
    entry("Undo change", Some(Action::Undo), can(OpenDocument::can_undo), Command::Edit(EditCommand::Undo));
    entry("Redo change", Some(Action::Redo), can(OpenDocument::can_redo), Command::Edit(EditCommand::Redo));
    let save = Command::Edit(EditCommand::SaveSidecar);
    entry("Save changes of the scene", None, can(OpenDocument::differs_from_files), save);
    let text = if state.selection.measure.is_on { "Stop measuring distances" } else { "Measure distances" };
    entry(text, Some(Action::Measure), true, Command::Inspect(InspectCommand::ToggleMeasure));
}

fn view_menu(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    for (i, view) in state.views().iter().enumerate() {
        let key = view.key.map_or(String::new(), |key| format!("{key}  "));
        let button = ui.add(Button::new(format!("{key}{}", view.name)));
        // The section Views has a button with the same text.
        if button.accessible_name(format!("Go to {}", view.name)).clicked() {
            commands.push(Command::Navigate(NavigationCommand::GoToView(i)));
        }
    }
    ui.separator();
    let (move_mode, other) = match state.navigation.fly.move_mode() {
        MoveMode::Fly => ("Walk", MoveMode::Walk),
        MoveMode::Walk => ("Fly", MoveMode::Fly),
    };
    if item(ui, move_mode, Some(Action::ToggleWalk)) {
        commands.push(Command::Navigate(NavigationCommand::SetMoveMode(other)));
    }
    if item(ui, "Level", Some(Action::Level)) {
        commands.push(Command::Level);
    }
    if item(ui, "Full screen", Some(Action::FullScreen)) {
        commands.push(Command::FullScreen);
    }
    let o = state.options;
    let statistics = if o.shows_statistics { "Hide statistics" } else { "Show statistics" };
    if item(ui, statistics, Some(Action::ToggleStatistics)) {
        commands.push(Command::SetOptions(Options { shows_statistics: !o.shows_statistics, ..o }));
    }
    if item(ui, "Hide panels", Some(Action::TogglePanels)) {
        commands.push(Command::SetOptions(Options { shows_panels: false, ..o }));
    }
}
