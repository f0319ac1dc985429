//! Recent files, and the looks of the window.

use super::super::state::{AppState, Appearance, Command, FileCommand};
use crate::settings::{Theme, UI_SCALES};
use egui::{Slider, Ui};

/// The submenu of files that were open before.
pub fn recent_menu(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
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
            if ui.button("Forget these").clicked() {
                commands.push(Command::Files(FileCommand::ForgetRecent));
            }
        });
    });
}

/// The looks of the window, each with a way back. What is changed is kept for the next start.
pub fn settings(ctx: &egui::Context, state: &AppState, commands: &mut Vec<Command>) {
    let (mut is_open, mut appearance) = (true, state.appearance);
    egui::Window::new("Settings").open(&mut is_open).resizable(false).default_pos([60.0, 80.0]).show(
        ctx,
        |ui| {
            egui::Grid::new("settings")
                .num_columns(3)
                .spacing([12.0, 6.0])
                .show(ui, |ui| rows(ui, &mut appearance));
            ui.separator();
            match &state.files.settings_file {
                Some(path) => ui.weak(format!("Kept in {}", path.display())),
                None => ui.weak("Not kept: there is no folder for settings"),
            };
            ui.weak("Keys are bound anew in its [keys]; F1 lists them.");
        },
    );
    if appearance != state.appearance {
        commands.push(Command::SetAppearance(appearance));
    }
    if !is_open {
        commands.push(Command::ShowSettings(false));
    }
}

fn rows(ui: &mut Ui, appearance: &mut Appearance) {
    let usual = Appearance::default();
    let label = ui.label("Theme");
    egui::ComboBox::from_id_salt("theme")
        .selected_text(appearance.theme.name())
        .show_ui(ui, |ui| {
            for theme in [Theme::System, Theme::Dark, Theme::Light] {
                ui.selectable_value(&mut appearance.theme, theme, theme.name());
            }
        })
        .response
        .labelled_by(label.id);
    reset(ui, "theme", &mut appearance.theme, usual.theme);
    let label = ui.label("Size of letters");
    let mut percent = appearance.ui_scale * 100.0;
    let range = *UI_SCALES.start() * 100.0..=*UI_SCALES.end() * 100.0;
    let slider = Slider::new(&mut percent, range).step_by(5.0).fixed_decimals(0).suffix(" %");
    // Scaling under the pointer would move the slider away from it.
    let response = ui.add(slider).labelled_by(label.id);
    if response.drag_stopped() || (response.changed() && !response.dragged()) {
        appearance.ui_scale = percent / 100.0;
    }
    reset(ui, "size of letters", &mut appearance.ui_scale, usual.ui_scale);
    ui.label("Motion");
    ui.checkbox(&mut appearance.has_reduced_motion, "views change at once");
    reset(ui, "motion", &mut appearance.has_reduced_motion, usual.has_reduced_motion);
}

fn reset<T: PartialEq + Copy>(ui: &mut Ui, name: &str, value: &mut T, usual: T) {
    let button = ui.add_enabled(*value != usual, egui::Button::new("Reset").small());
    if button.accessible_name(format!("Reset {name}")).clicked() {
        *value = usual;
    }
    ui.end_row();
}
