//! All keys, from the table that the window obeys.

use super::super::keymap::{BINDINGS, MOUSE};
use super::super::state::{Command, Options, State};
use egui::{RichText, Ui};

/// Shows the keys over everything else.
pub fn show(ctx: &egui::Context, state: &State, commands: &mut Vec<Command>) {
    let modal = egui::Modal::new(egui::Id::unique("help")).show(ctx, |ui| {
        ui.set_width(660.0_f32.min(ctx.content_rect().width() - 40.0));
        ui.horizontal(|ui| {
            ui.heading("Keys and mouse");
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                ui.button("Close help").clicked()
            })
            .inner
        });
        ui.weak("Keys are meant by their place on a US keyboard.");
        ui.separator();
        let height = ctx.content_rect().height() - 150.0;
        egui::ScrollArea::vertical().max_height(height.max(80.0)).show(ui, table);
    });
    if modal.should_close() {
        commands.push(Command::SetOptions(Options { shows_help: false, ..state.options }));
    }
}

/// Two columns of lines; the mouse comes last.
fn table(ui: &mut Ui) {
    let keys = BINDINGS.iter().map(|b| (b.keys(), b.help));
    let lines: Vec<(String, &str)> = keys.chain(MOUSE.iter().map(|(w, h)| ((*w).to_owned(), *h))).collect();
    let (left, right) = lines.split_at(lines.len().div_ceil(2));
    ui.columns(2, |columns| {
        for (side, (ui, lines)) in columns.iter_mut().zip([left, right]).enumerate() {
            egui::Grid::new(("help", side)).num_columns(2).spacing([12.0, 4.0]).show(ui, |ui| {
                for (keys, help) in lines {
                    ui.label(RichText::new(keys).monospace().strong());
                    ui.label(*help);
                    ui.end_row();
                }
            });
        }
    });
}
