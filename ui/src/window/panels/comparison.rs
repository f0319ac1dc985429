//! Comparison of the picture with the full tracer's.

use super::super::state::{AppState, Command, Compare};
use super::{numbers::Number, widgets::key_hint};
use crate::window::input::keymap::{Action, keys_of};
use egui::{Sense, Ui};

/// Shows the controls and the results.
pub fn show(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let (mut shows, mut split) = (state.comparison.shows, state.comparison.split);
    ui.horizontal(|ui| {
        ui.label("Compare")
            .on_hover_text(format!("Hold {} to show the full tracer's picture", keys_of(Action::ShowFull)));
        ui.selectable_value(&mut shows, Compare::Off, "Off").accessible_name("Compare off");
        ui.selectable_value(&mut shows, Compare::Split, "Split")
            .on_hover_text(key_hint(Action::CompareSplit));
        ui.selectable_value(&mut shows, Compare::Errors, "Error map")
            .on_hover_text(format!("Key {}: FLIP, the perceived difference", keys_of(Action::CompareErrors)));
    });
    if shows == Compare::Split {
        ui.horizontal(|ui| {
            let label = ui.label("Split at");
            Number::percent(0.0..=100.0).slider(ui, &mut split).labelled_by(label.id);
        });
    }
    if (shows, split) != (state.comparison.shows, state.comparison.split) {
        commands.push(Command::Compare(shows, split));
    }
    for (name, value) in figures(state) {
        ui.horizontal(|ui| {
            ui.label(name);
            ui.monospace(value);
        });
    }
}

/// Names and values of the results; empty if nothing is compared.
pub fn figures(state: &AppState) -> Vec<(&'static str, String)> {
    let Some(progress) = state.comparison.progress_text() else { return Vec::new() };
    let mut figures = vec![("full tracer", progress)];
    if let Some((_, error)) = state.comparison.error {
        figures.push(("PSNR", format!("{:.1} dB", error.psnr_db)));
        figures.push(("FLIP", format!("{:.4}", error.flip_mean)));
    }
    figures
}

/// The draggable line between the two pictures.
pub fn split_line(ui: &Ui, viewport: egui::Rect, state: &AppState, commands: &mut Vec<Command>) {
    const REACH: f32 = 8.0;
    if state.comparison.shows != Compare::Split || state.comparison.full.is_none() || state.comparison.is_held
    {
        return;
    }
    let x = viewport.left() + viewport.width() * state.comparison.split;
    let line = egui::Rect::from_x_y_ranges(x - REACH..=x + REACH, viewport.y_range());
    let response = ui
        .interact(line, ui.scope_id().with("split"), Sense::drag())
        .on_hover_cursor(egui::CursorIcon::ResizeHorizontal);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Splitter, true, "Split line"));
    ui.painter().vline(x, viewport.y_range(), egui::Stroke::new(1.5, egui::Color32::WHITE));
    if let Some(at) = response.interact_pointer_pos().filter(|_| response.dragged()) {
        let split = ((at.x - viewport.left()) / viewport.width().max(1.0)).clamp(0.0, 1.0);
        commands.push(Command::Compare(Compare::Split, split));
    }
}
