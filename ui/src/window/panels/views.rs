//! The list of saved views.

use super::super::state::{AppState, Command, NavigationCommand, SavedView};
use super::widgets::thumbnail;
use crate::window::input::keymap::{Action, keys_of};
use egui::{Key, RichText, Ui, text::CCursorRange};

/// Shows the list of saved views.
pub fn show(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    if state.document.is_none() {
        ui.weak("No scene yet.");
        return;
    }
    let help = format!("{} saves it under a number", keys_of(Action::SaveView));
    if ui.button("Save this view").on_hover_text(help).clicked() {
        commands.push(Command::Navigate(NavigationCommand::AddView));
    }
    for (i, view) in state.views().iter().enumerate() {
        entry(ui, state, i, view, commands);
    }
}

fn entry(ui: &mut Ui, state: &AppState, i: usize, view: &SavedView, commands: &mut Vec<Command>) {
    let mut ask = |command| commands.push(Command::Navigate(command));
    ui.horizontal(|ui| {
        // The button beside it does the same, so that the picture is no stop for the Tab key.
        let picture = thumbnail(ui, state, &view.camera).interact(egui::Sense::CLICK);
        if picture.on_hover_text("Go to this view").clicked() {
            ask(NavigationCommand::GoToView(i));
        }
        ui.vertical(|ui| {
            match &state.navigation.renaming {
                Some((index, text)) if *index == i => name_field(ui, i, text, &mut ask),
                _ => name_button(ui, state, i, view, &mut ask),
            }
            ui.horizontal(|ui| buttons(ui, state, i, view, &mut ask));
        });
    });
}

fn renamed(i: usize, view: &SavedView) -> NavigationCommand {
    NavigationCommand::Rename(Some((i, view.name.clone())))
}

/// Shows the name: a click goes there, a double click renames.
fn name_button(
    ui: &mut Ui,
    state: &AppState,
    i: usize,
    view: &SavedView,
    ask: &mut dyn FnMut(NavigationCommand),
) {
    let key = view.key.map(|key| format!("{key}  ")).unwrap_or_default();
    let is_last = state.navigation.view_index == i;
    let name = RichText::new(format!("{key}{}", view.name));
    let name = if is_last { name.strong() } else { name };
    let button = ui.add(egui::Button::new(name).truncate());
    let button = button.on_hover_text("Click goes to this view, a double click renames it");
    if button.double_clicked() {
        ask(renamed(i, view));
    } else if button.clicked() {
        ask(NavigationCommand::GoToView(i));
    }
}

fn buttons(
    ui: &mut Ui,
    state: &AppState,
    i: usize,
    view: &SavedView,
    ask: &mut dyn FnMut(NavigationCommand),
) {
    let update = ui.small_button("Update").on_hover_text("Move this view to where you are");
    if update.accessible_name(format!("Update {}", view.name)).clicked() {
        ask(NavigationCommand::UpdateView(i));
    }
    if ui.small_button("Rename").accessible_name(format!("Rename {}", view.name)).clicked() {
        ask(renamed(i, view));
    }
    // One view must remain.
    let is_deletable = state.views().len() > 1;
    let delete = ui.add_enabled(is_deletable, egui::Button::new("Delete").small());
    if delete.accessible_name(format!("Delete {}", view.name)).clicked() {
        ask(NavigationCommand::RemoveView(i));
    }
}

/// Shows the field for a new name. It begins with the old one selected.
fn name_field(ui: &mut Ui, i: usize, text: &str, ask: &mut dyn FnMut(NavigationCommand)) {
    let mut name = text.to_owned();
    let field = egui::TextEdit::singleline(&mut name).desired_width(130.0).show(ui);
    let response = field.response.response.accessible_name("Name of the view");
    if response.changed() {
        ask(NavigationCommand::Rename(Some((i, name))));
    } else if response.lost_focus() {
        let is_cancelled = ui.input(|input| input.key_pressed(Key::Escape));
        ask(if is_cancelled { NavigationCommand::Rename(None) } else { NavigationCommand::FinishRenaming });
    } else if !response.has_focus() {
        let mut edit = field.state;
        edit.cursor.set_char_range(Some(CCursorRange::select_all_str(text)));
        edit.store(ui.ctx(), response.id);
        response.request_focus();
    }
}
