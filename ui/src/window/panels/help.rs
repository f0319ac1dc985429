//! The help overlay with all keys.

use super::super::state::{AppState, Command, Options};
use crate::window::input::keymap::{MOUSE, bindings};
use egui::{RichText, Ui};

/// Shows the overlay that lists all keys.
pub fn show(ctx: &egui::Context, state: &AppState, commands: &mut Vec<Command>) {
    let room = ctx.content_rect().size() - egui::vec2(60.0, 170.0);
    let modal = egui::Modal::new(egui::Id::unique("help")).show(ctx, |ui| {
        ui.set_width(room.x.clamp(200.0, WIDTH));
        ui.horizontal(|ui| {
            ui.heading("Keys and mouse");
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if ui.button("Close help").clicked() {
                    ui.close();
                }
            });
        });
        ui.label(SEEING);
        ui.label("Keys are named by their position on a US keyboard.");
        ui.separator();
        let height = room.y.max(80.0);
        egui::ScrollArea::vertical().max_height(height).min_scrolled_height(height).show(ui, table);
    });
    if modal.should_close() {
        commands.push(Command::SetOptions(Options { shows_help: false, ..state.options }));
    }
}

/// What the window shows, in a few sentences.
const SEEING: &str = "The picture is ray traced. Light that was traced for earlier views is reused where it still holds; \
    the heatmap (T) shows where: reused, mirror or glass, or traced for this picture. The tabs at the right follow a \
    visit: the scene, its look, the camera, the method, and its numbers.";

/// Width in points that fits both columns.
const WIDTH: f32 = 920.0;

/// Lists the keys and then the mouse, in one or two columns depending on the width.
fn table(ui: &mut Ui) {
    let keys = bindings().iter().map(|b| (b.keys(), b.help));
    let lines: Vec<(String, &str)> = keys.chain(MOUSE.iter().map(|(w, h)| ((*w).to_owned(), *h))).collect();
    let count = if ui.available_width() < WIDTH - 40.0 { 1 } else { 2 };
    ui.columns(count, |columns| {
        let parts = lines.chunks(lines.len().div_ceil(count));
        for (side, (ui, lines)) in columns.iter_mut().zip(parts).enumerate() {
            egui::Grid::new(("help", side)).num_columns(2).spacing([14.0, 3.0]).show(ui, |ui| {
                for (keys, help) in lines {
                    ui.label(RichText::new(keys).strong());
                    ui.label(*help);
                    ui.end_row();
                }
            });
        }
    });
}
