//! The dialog "Settings": appearance of the window.

use super::super::state::{AppState, Appearance, Command};
use super::regions::{self, Region};
use super::{numbers::Number, widgets::choice};
use crate::settings::{Theme, UI_SCALES};
use egui::Ui;

/// Shows the dialog. Changes are saved in the settings file.
pub fn show(ctx: &egui::Context, state: &AppState, commands: &mut Vec<Command>) {
    let (mut is_open, mut appearance) = (true, state.appearance);
    let shown = egui::Window::new("Settings")
        .open(&mut is_open)
        .resizable(false)
        .default_pos([60.0, 80.0])
        .show(ctx, |ui| {
            regions::name(ui, Region::Dialog);
            egui::Grid::new("settings")
                .num_columns(3)
                .spacing([12.0, 6.0])
                .show(ui, |ui| rows(ui, &mut appearance));
            ui.separator();
            match &state.files.settings_file {
                Some(path) => ui.weak(format!("Saved in {}", path.display())),
                None => ui.weak("Not saved: no folder for settings was found"),
            };
            ui.weak("To change keys, edit [keys] in this file; F1 lists all keys.");
        });
    if let Some(shown) = shown {
        regions::note_rect(ctx, Region::Dialog, shown.response.rect);
    }
    if appearance != state.appearance {
        commands.push(Command::SetAppearance(appearance));
    }
    if !is_open {
        commands.push(Command::ShowSettings(false));
    }
}

fn rows(ui: &mut Ui, appearance: &mut Appearance) {
    let default = Appearance::default();
    let label = ui.label("Theme");
    let themes = [Theme::System, Theme::Dark, Theme::Light].map(|theme| (theme, theme.name()));
    let name = appearance.theme.name();
    let theme = choice(ui, "theme", name, &mut appearance.theme, themes).labelled_by(label.id);
    regions::note(&theme, Region::Dialog);
    reset(ui, "theme", &mut appearance.theme, default.theme);
    let label = ui.label("Text size");
    let mut scale = appearance.ui_scale;
    let [low, high] = [UI_SCALES.start(), UI_SCALES.end()].map(|s| f64::from(*s) * 100.0);
    let response = Number::percent(low..=high).step(5.0).slider(ui, &mut scale).labelled_by(label.id);
    // Scaling during a drag would move the slider away from the pointer.
    if response.drag_stopped() || (response.changed() && !response.dragged()) {
        appearance.ui_scale = scale;
    }
    reset(ui, "text size", &mut appearance.ui_scale, default.ui_scale);
    ui.label("Motion");
    ui.checkbox(&mut appearance.has_reduced_motion, "change views without animation");
    reset(ui, "motion", &mut appearance.has_reduced_motion, default.has_reduced_motion);
}

fn reset<T: PartialEq + Copy>(ui: &mut Ui, name: &str, value: &mut T, default: T) {
    let button = ui.add_enabled(*value != default, egui::Button::new("Reset").small());
    if button.accessible_name(format!("Reset {name}")).clicked() {
        *value = default;
    }
    ui.end_row();
}
