//! The menu bar.

use super::super::state::{
    AppState, Coloring, Command, Compare, EditCommand, FileCommand, Heatmap, InspectCommand, ListCommand,
    NavigationCommand, OpenDocument, Options, PictureCommand, Purpose, Statistics,
};
use super::lighting;
use super::regions::{self, Region};
use crate::window::input::keymap::{Action, keys_of};
use crate::window::rendering::Quantity;
use crate::window::{input::fly_camera::MoveMode, rendering::scene_loading::SceneSource};
use afterimage::{Mode, scene::builtin};
use egui::{Button, Ui};

/// Shows the menu bar with its menus.
pub fn show(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    egui::MenuBar::new().ui(ui, |ui| {
        regions::name(ui, Region::Menu);
        let file = ui.menu_button("File", |ui| file_menu(ui, state, commands));
        regions::note(&file.response, Region::Menu);
        ui.menu_button("Edit", |ui| edit_menu(ui, state, commands));
        ui.menu_button("View", |ui| view_menu(ui, state, commands));
        ui.menu_button("Camera", |ui| camera_menu(ui, state, commands));
        ui.menu_button("Method", |ui| method_menu(ui, state, commands));
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

fn file_menu(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
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
    if item(ui, "Save picture", Some(Action::Screenshot)) {
        commands.push(Command::Picture(PictureCommand::Save));
    }
    if item(ui, "Picture settings...", None) {
        commands.push(Command::Picture(PictureCommand::ShowDialog(true)));
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
    let named = |what: &str, name: Option<String>| match name {
        Some(name) => format!("{what} {name}"),
        None => what.to_owned(),
    };
    let undo = named("Undo", state.document.as_ref().and_then(OpenDocument::undo_name));
    entry(&undo, Some(Action::Undo), can(OpenDocument::can_undo), Command::Edit(EditCommand::Undo));
    let redo = named("Redo", state.document.as_ref().and_then(OpenDocument::redo_name));
    entry(&redo, Some(Action::Redo), can(OpenDocument::can_redo), Command::Edit(EditCommand::Redo));
    let save = Command::Edit(EditCommand::SaveSidecar);
    entry("Save changes of the scene", None, can(OpenDocument::differs_from_files), save);
    let text = if state.selection.measure.is_on { "Stop measuring distances" } else { "Measure distances" };
    entry(text, Some(Action::Measure), true, Command::Inspect(InspectCommand::ToggleMeasure));
}

fn view_menu(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    if item(ui, "Full screen", Some(Action::FullScreen)) {
        commands.push(Command::FullScreen);
    }
    let o = state.options;
    let mut switch = |ui: &mut Ui, text: &str, action: Action, options: Options| {
        if item(ui, text, Some(action)) {
            commands.push(Command::SetOptions(options));
        }
    };
    let figures = match o.statistics {
        Statistics::Off => "Show few figures",
        Statistics::Short => "Show all figures",
        Statistics::Full => "Hide the figures",
    };
    let statistics = o.statistics.next();
    switch(ui, figures, Action::ToggleStatistics, Options { statistics, ..o });
    let hidden = Options { shows_panels: false, ..o };
    switch(ui, "Hide panels", Action::TogglePanels, hidden);
    ui.separator();
    for (quantity, action) in Quantity::ALL.into_iter().zip(lighting::ACTIONS) {
        let mark = if o.quantity == quantity { "\u{2022} " } else { "" };
        switch(ui, &format!("{mark}{}", quantity.name()), action, Options { quantity, ..o });
    }
    ui.separator();
    let heatmap = match o.heatmap {
        Heatmap::Off => ("Show the heatmap", Heatmap::Blend),
        Heatmap::Blend => ("Show only the heatmap", Heatmap::Only),
        Heatmap::Only => ("Hide the heatmap", Heatmap::Off),
    };
    switch(ui, heatmap.0, Action::CycleHeatmap, Options { heatmap: heatmap.1, ..o });
    let coloring = match o.coloring {
        Coloring::ByType => ("Colour by reference", Coloring::ByReference),
        Coloring::ByReference => ("Colour by type", Coloring::ByType),
    };
    let colored = Options { coloring: coloring.1, ..o }.with_visible_colors(&o);
    switch(ui, coloring.0, Action::ToggleByReference, colored);
    let outlined = Options { has_outline: !o.has_outline, ..o };
    let text = if o.has_outline { "Hide the outline of Type 3" } else { "Outline what is traced" };
    switch(ui, text, Action::ToggleOutline, outlined);
}

fn camera_menu(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
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
    let play = if state.navigation.playback.is_playing { "Stop the path" } else { "Play the path" };
    let entries = [
        (move_mode, Action::ToggleWalk, Command::Navigate(NavigationCommand::SetMoveMode(other))),
        ("Level the horizon", Action::Level, Command::Level),
        ("Narrow the field of view", Action::NarrowFov, Command::ChangeFov(-1.0)),
        ("Widen the field of view", Action::WidenFov, Command::ChangeFov(1.0)),
        ("Next view", Action::NextView, Command::Navigate(NavigationCommand::StepView(1))),
        ("Previous view", Action::PreviousView, Command::Navigate(NavigationCommand::StepView(-1))),
        ("Add a key to the path", Action::AddPathKey, Command::Navigate(NavigationCommand::AddPathKey)),
        (play, Action::PlayPath, Command::Navigate(NavigationCommand::PlayPath)),
        ("Go back", Action::GoBack, Command::Navigate(NavigationCommand::GoBack)),
        ("Copy pose", Action::CopyPose, Command::CopyPose),
    ];
    list(ui, entries, commands);
}

fn method_menu(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let mut quality = state.quality;
    for mode in [Mode::Exact, Mode::Fast, Mode::Paper, Mode::Full] {
        ui.radio_value(&mut quality.walk.render.mode, mode, mode.name());
    }
    ui.separator();
    ui.checkbox(&mut quality.keeps_improving, "Go on improving until I move");
    if quality != state.quality {
        commands.push(Command::SetQuality(quality));
    }
    ui.separator();
    let comparison = &state.comparison;
    let compare = |wanted: Compare| {
        let shows = if comparison.shows == wanted { Compare::Off } else { wanted };
        Command::Compare(shows, comparison.split)
    };
    let o = state.options;
    let pause = if o.is_paused { "Go on rendering" } else { "Pause rendering" };
    let freeze = if o.is_frozen { "Stop freezing the frame" } else { "Freeze the frame" };
    let bake = if state.plan.baking.is_some() { "Cancel baking" } else { "Bake" };
    let entries = [
        ("Compare side by side", Action::CompareSplit, compare(Compare::Split)),
        ("Compare by error map", Action::CompareErrors, compare(Compare::Errors)),
        ("Add a reference here", Action::AddReference, Command::AddReference),
        ("Clear all references...", Action::ClearCache, Command::AskToClear),
        (bake, Action::Bake, Command::Bake),
        (pause, Action::Pause, Command::SetOptions(o.paused(!o.is_paused))),
        (freeze, Action::Freeze, Command::SetOptions(o.frozen(!o.is_frozen))),
    ];
    list(ui, entries, commands);
}

fn list<const N: usize>(ui: &mut Ui, entries: [(&str, Action, Command); N], commands: &mut Vec<Command>) {
    for (text, action, command) in entries {
        if item(ui, text, Some(action)) {
            commands.push(command);
        }
    }
}
