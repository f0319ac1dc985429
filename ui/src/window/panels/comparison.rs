//! Comparison of the picture with the full tracer's.

use super::super::state::{AppState, Command, Compare};
use super::numbers::Number;
use super::widgets::{GROUND, TEXT, key_hint};
use crate::window::input::keymap::{Action, keys_of};
use afterimage::raster::metrics::error_picture;
use egui::{Align2, Sense, Ui};

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

/// Explains the comparison over the viewport: which half is which, or what the colours mean.
pub fn explain(ui: &Ui, viewport: egui::Rect, state: &AppState) {
    let comparison = &state.comparison;
    let Some(progress) = comparison.progress_text().filter(|_| comparison.full.is_some()) else { return };
    let truth = format!("full tracer, {progress}");
    match comparison.shows {
        _ if comparison.is_held => sign(ui, viewport.center_top() + GAP, Align2::CENTER_TOP, &truth),
        Compare::Split => {
            let x = viewport.left() + viewport.width() * comparison.split;
            let at = |aside: f32| egui::pos2(x + aside, viewport.top()) + GAP;
            sign(ui, at(-10.0), Align2::RIGHT_TOP, "this picture");
            sign(ui, at(10.0), Align2::LEFT_TOP, &truth);
        }
        Compare::Errors => error_bar(ui, viewport),
        Compare::Off => {}
    }
}

/// Distance of signs from the top of the viewport.
const GAP: egui::Vec2 = egui::vec2(0.0, 10.0);

fn sign(ui: &Ui, at: egui::Pos2, align: Align2, text: &str) {
    let font = egui::TextStyle::Body.resolve(ui.style());
    let galley = ui.painter().layout_no_wrap(text.to_owned(), font, TEXT);
    let rect = align.anchor_size(at, galley.size() + egui::vec2(16.0, 8.0));
    ui.painter().rect_filled(rect, 5.0, GROUND);
    ui.painter().galley(rect.min + egui::vec2(8.0, 4.0), galley, TEXT);
}

/// Steps of the bar that shows the colours of errors.
const BAR_STEPS: usize = 32;

/// Shows the colours of the error map from equal to the largest difference.
fn error_bar(ui: &Ui, viewport: egui::Rect) {
    let bar = Align2::CENTER_BOTTOM.anchor_size(viewport.center_bottom() - GAP, egui::vec2(192.0, 14.0));
    ui.painter().rect_filled(bar.expand(4.0), 4.0, GROUND);
    let errors: Vec<f32> = (0..BAR_STEPS).map(|i| i as f32 / (BAR_STEPS - 1) as f32).collect();
    let width = bar.width() / BAR_STEPS as f32;
    for (i, [r, g, b]) in error_picture(&errors).into_iter().enumerate() {
        let corner = bar.min + egui::vec2(width * i as f32, 0.0);
        let step = egui::Rect::from_min_size(corner, egui::vec2(width + 0.5, bar.height()));
        ui.painter().rect_filled(step, 0.0, egui::Color32::from_rgb(r, g, b));
    }
    sign(ui, bar.left_center() - egui::vec2(8.0, 0.0), Align2::RIGHT_CENTER, "equal");
    sign(ui, bar.right_center() + egui::vec2(8.0, 0.0), Align2::LEFT_CENTER, "black for white");
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
