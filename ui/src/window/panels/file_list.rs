//! The program's own list of files, where the system has no dialog: a folder, places, and a field
//! whose text filters the list. Arrows choose, Enter opens, Backspace in an empty field goes up.

use super::super::state::{AppState, Command, FileList, ListCommand, Purpose};
use crate::window::files::path_of;
use egui::{Context, Key, RichText, Ui};
use std::path::Path;

/// Largest size of the list in points.
const SIZE: [f32; 2] = [680.0, 440.0];

/// Width of the places in points.
const PLACES_WIDTH: f32 = 140.0;

/// Rows by which Page Up and Page Down move.
const PAGE: isize = 10;

/// Shows the list, if it is open.
pub fn show(ctx: &Context, state: &AppState, commands: &mut Vec<Command>) {
    let Some(list) = &state.files.list else { return };
    let room = ctx.content_rect().size() - egui::vec2(60.0, 60.0);
    let size = egui::vec2(SIZE[0].min(room.x), SIZE[1].min(room.y)).max(egui::vec2(240.0, 160.0));
    let mut asked = Vec::new();
    let modal = egui::Modal::new(egui::Id::unique("files")).show(ctx, |ui| {
        ui.set_width(size.x);
        ui.heading(list.purpose.title());
        top(ui, list, &mut asked);
        ui.separator();
        let height = (size.y - 130.0).max(60.0);
        ui.horizontal_top(|ui| {
            ui.allocate_ui(egui::vec2(PLACES_WIDTH, height), |ui| {
                places(ui, state, list, height, &mut asked)
            });
            ui.separator();
            ui.vertical(|ui| rows(ui, list, height, &mut asked));
        });
        ui.separator();
        bottom(ui, list, &mut asked);
    });
    if modal.should_close() {
        asked.push(ListCommand::Close);
    }
    commands.extend(asked.into_iter().map(Command::List));
}

/// Shows the folder and the field, which has the keyboard unless a button has it.
fn top(ui: &mut Ui, list: &FileList, asked: &mut Vec<ListCommand>) {
    ui.horizontal(|ui| {
        if ui.add_enabled(list.folder.parent().is_some(), egui::Button::new("Up")).clicked() {
            asked.extend(parent(list));
        }
        ui.add(egui::Label::new(RichText::new(list.folder.display().to_string()).strong()).truncate());
    });
    let mut text = list.filter.clone();
    let hint = "type a part of a name, or a path";
    let field = egui::TextEdit::singleline(&mut text).hint_text(hint).desired_width(f32::INFINITY);
    let field = ui.add(field).accessible_name("Name or path");
    let is_entered = field.lost_focus() && ui.input(|i| i.key_pressed(Key::Enter));
    if is_entered || ui.memory(|m| m.focused()).is_none() {
        field.request_focus();
    }
    // Backspace in an empty field is also reported as a change.
    if text != list.filter {
        asked.push(ListCommand::Filter(text));
    } else if is_entered {
        asked.extend(entered(list));
    } else if field.has_focus() {
        asked.extend(ui.input(|i| moved(list, i)));
    }
}

fn parent(list: &FileList) -> Option<ListCommand> {
    list.folder.parent().map(|parent| ListCommand::Go(parent.to_owned()))
}

/// What Enter does: it goes to a path that was typed, or opens the chosen entry.
fn entered(list: &FileList) -> Option<ListCommand> {
    let text = list.filter.trim();
    let is_path = text.contains(['/', std::path::MAIN_SEPARATOR]) || text.starts_with('~');
    if is_path {
        return Some(ListCommand::Go(list.folder.join(path_of(text))));
    }
    opened(list, list.chosen)
}

/// Opens an entry: a folder is shown, a file is taken.
fn opened(list: &FileList, index: usize) -> Option<ListCommand> {
    let entry = list.entry(index)?;
    let path = entry.path.clone();
    Some(if entry.is_folder { ListCommand::Go(path) } else { ListCommand::Take(path) })
}

/// What the arrows and Backspace do.
fn moved(list: &FileList, input: &egui::InputState) -> Option<ListCommand> {
    let keys = [(Key::ArrowDown, 1), (Key::ArrowUp, -1), (Key::PageDown, PAGE), (Key::PageUp, -PAGE)];
    if let Some((_, step)) = keys.iter().find(|(key, _)| input.key_pressed(*key)) {
        let last = list.shown.len().saturating_sub(1);
        return Some(ListCommand::Choose(list.chosen.saturating_add_signed(*step).min(last)));
    }
    let goes_up = list.filter.is_empty() && input.key_pressed(Key::Backspace);
    goes_up.then(|| parent(list)).flatten()
}

fn places(ui: &mut Ui, state: &AppState, list: &FileList, height: f32, asked: &mut Vec<ListCommand>) {
    ui.set_width(PLACES_WIDTH);
    egui::ScrollArea::vertical().id_salt("places").max_height(height).min_scrolled_height(height).show(
        ui,
        |ui| {
            ui.vertical(|ui| {
                ui.set_width(PLACES_WIDTH - 10.0);
                for (name, path) in &list.places {
                    place(ui, name, path, ListCommand::Go(path.clone()), asked);
                }
                if list.purpose == Purpose::Open && !state.files.recent.is_empty() {
                    ui.separator();
                    ui.weak("Recent files");
                    for path in &state.files.recent {
                        place(ui, &file_name(path), path, ListCommand::Take(path.clone()), asked);
                    }
                }
            });
        },
    );
}

fn file_name(path: &Path) -> String {
    path.file_name().map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
}

fn place(ui: &mut Ui, name: &str, path: &Path, command: ListCommand, asked: &mut Vec<ListCommand>) {
    let button = egui::Button::new(name).truncate();
    if ui.add(button).on_hover_text(path.display().to_string()).clicked() {
        asked.push(command);
    }
}

fn rows(ui: &mut Ui, list: &FileList, height: f32, asked: &mut Vec<ListCommand>) {
    if list.shown.is_empty() {
        ui.set_min_height(height);
        let is_empty = list.listing.entries.is_empty();
        ui.weak(match (list.is_reading, is_empty) {
            (true, _) => "Reading the folder...",
            (false, true) => "There is nothing to open in this folder.",
            (false, false) => "No name contains this text.",
        });
        return;
    }
    let row_height = ui.spacing().interact_size.y;
    let mut area = egui::ScrollArea::vertical().id_salt(("files", &list.folder)).max_height(height);
    area = area.min_scrolled_height(height).auto_shrink([false, false]);
    if let Some(ListCommand::Choose(chosen)) = asked.last() {
        // The chosen row is kept in the middle.
        let row = row_height + ui.spacing().item_spacing.y;
        area = area.vertical_scroll_offset((*chosen as f32 * row - height / 2.0).max(0.0));
    }
    area.show_rows(ui, row_height, list.shown.len(), |ui, range| {
        for index in range {
            row(ui, list, index, asked);
        }
    });
}

fn row(ui: &mut Ui, list: &FileList, index: usize, asked: &mut Vec<ListCommand>) {
    let Some(entry) = list.entry(index) else { return };
    let text = if entry.is_folder { format!("{}/", entry.name) } else { entry.name.clone() };
    let response = ui.selectable_label(index == list.chosen, text);
    if response.double_clicked() {
        asked.extend(opened(list, index));
    } else if response.clicked() {
        asked.push(ListCommand::Choose(index));
    }
}

fn bottom(ui: &mut Ui, list: &FileList, asked: &mut Vec<ListCommand>) {
    ui.horizontal(|ui| {
        if list.purpose == Purpose::PictureFolder && ui.button("Use this folder").clicked() {
            asked.push(ListCommand::Take(list.folder.clone()));
        }
        if ui.add_enabled(!list.shown.is_empty(), egui::Button::new("Open")).clicked() {
            asked.extend(opened(list, list.chosen));
        }
        if ui.button("Cancel").clicked() {
            asked.push(ListCommand::Close);
        }
        let cut = format!("Only {} entries are shown.", list.listing.entries.len());
        let note = list.error.clone().or(list.listing.is_cut.then_some(cut));
        if let Some(note) = note {
            ui.add(egui::Label::new(RichText::new(note).color(ui.visuals().warn_fg_color)).wrap());
        }
    });
}
