//! The help overlay: all keys in groups, with a filter.

use super::super::state::{AppState, Command, Options};
use crate::window::input::keymap::{HelpGroup, help_groups};
use egui::{Id, RichText, TextEdit, Ui};

/// What the window shows, in a few sentences.
const SEEING: &str = "The picture is ray traced. Light that was traced for earlier views is reused where it still holds; \
    the heatmap (T) shows where: reused, mirror or glass, or traced for this picture. The tabs at the right follow a \
    visit: the scene, its look, the camera, the method, and its numbers.";

/// Width in points that fits two columns.
const WIDTH: f32 = 920.0;

/// Height in points of a line, and of a heading as lines, to share lines among columns.
const HEADING_LINES: usize = 2;

/// Shows the overlay.
pub fn show(ctx: &egui::Context, state: &AppState, commands: &mut Vec<Command>) {
    let room = ctx.content_rect().size() - egui::vec2(60.0, 200.0);
    let modal = egui::Modal::new(Id::unique("help")).show(ctx, |ui| {
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
        let filter = filter_field(ui);
        ui.separator();
        let height = room.y.max(80.0);
        let area = egui::ScrollArea::vertical().max_height(height).min_scrolled_height(height);
        area.auto_shrink([false, false]).show(ui, |ui| groups(ui, &filter));
    });
    if modal.should_close() {
        commands.push(Command::SetOptions(Options { shows_help: false, ..state.options }));
    }
}

/// Shows the field of the filter, and returns its text. It is empty and has the focus when the help
/// opens.
fn filter_field(ui: &mut Ui) -> String {
    let (id, now) = (Id::unique("help filter"), ui.ctx().cumulative_pass_nr());
    let last: Option<(u64, String)> = ui.data(|data| data.get_temp(id));
    let shown = last.filter(|(pass, _)| now <= pass + 1).map(|(_, text)| text);
    let has_opened = shown.is_none();
    let mut text = shown.unwrap_or_default();
    ui.horizontal(|ui| {
        let label = ui.label("Filter");
        let field = TextEdit::singleline(&mut text).hint_text("a key or a word").desired_width(180.0);
        let response = ui.add(field).labelled_by(label.id);
        if has_opened {
            response.request_focus();
        }
        ui.weak("Keys are named by their position on a US keyboard.");
    });
    ui.data_mut(|data| data.insert_temp(id, (now, text.clone())));
    text
}

/// Lists the groups that have lines for a filter, in one or two columns depending on the width.
fn groups(ui: &mut Ui, filter: &str) {
    let groups: Vec<HelpGroup> = help_groups()
        .into_iter()
        .map(|group| group.filtered(filter))
        .filter(|group| !group.lines.is_empty())
        .collect();
    if groups.is_empty() {
        ui.label("No key and no word of the help contains this.");
    }
    let count = if ui.available_width() < WIDTH - 40.0 { 1 } else { 2 };
    let all: usize = groups.iter().map(lines_of).sum();
    ui.columns(count, |columns| {
        let mut before = 0;
        for group in &groups {
            // A group is in the column where its middle falls.
            let middle = before + lines_of(group) / 2;
            show_group(&mut columns[(count * middle / all.max(1)).min(count - 1)], group);
            before += lines_of(group);
        }
    });
}

/// Lines that a group takes.
fn lines_of(group: &HelpGroup) -> usize {
    group.lines.len() + HEADING_LINES
}

fn show_group(ui: &mut Ui, group: &HelpGroup) {
    ui.add_space(4.0);
    ui.label(RichText::new(group.name).heading().size(15.0));
    egui::Grid::new(("help", group.name)).num_columns(2).min_col_width(110.0).spacing([14.0, 3.0]).show(
        ui,
        |ui| {
            for (keys, help) in &group.lines {
                ui.label(RichText::new(keys).strong());
                ui.add(egui::Label::new(*help).wrap());
                ui.end_row();
            }
        },
    );
    ui.add_space(6.0);
}
