//! The list of saved views.

use super::super::state::{AppState, Command, NavigationCommand, SavedView};
use super::widgets::thumbnail;
use crate::window::input::keymap::{Action, keys_of};
use egui::{Key, RichText, Ui};

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
    let area = egui::ScrollArea::vertical().id_salt("views").max_height(LIST_HEIGHT);
    // As wide as the panel, so that the scroll bar does not cover buttons; the height is kept
    // inside the scrolled panel.
    area.min_scrolled_height(LIST_HEIGHT).auto_shrink([false, true]).show(ui, |ui| {
        for (i, view) in state.views().iter().enumerate() {
            entry(ui, state, i, view, commands);
        }
    });
}

/// Height of the list in points: four views.
const LIST_HEIGHT: f32 = 196.0;

fn entry(ui: &mut Ui, state: &AppState, i: usize, view: &SavedView, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        thumbnail(ui, state, &view.camera);
        ui.vertical(|ui| {
            match &state.navigation.renaming {
                Some((index, text)) if *index == i => name_field(ui, i, text, commands),
                _ => {
                    let key = view.key.map(|key| format!("{key}  ")).unwrap_or_default();
                    let is_last = state.navigation.view_index == i;
                    let name = RichText::new(format!("{key}{}", view.name));
                    let name = if is_last { name.strong() } else { name };
                    if ui.button(name).on_hover_text("Go to this view").clicked() {
                        commands.push(Command::Navigate(NavigationCommand::GoToView(i)));
                    }
                }
            }
            ui.horizontal(|ui| {
                let rename = ui.small_button("Rename").accessible_name(format!("Rename {}", view.name));
                if rename.clicked() {
                    commands.push(Command::Navigate(NavigationCommand::Rename(Some((i, view.name.clone())))));
                }
                // One view must remain.
                let is_deletable = state.views().len() > 1;
                let delete = ui.add_enabled(is_deletable, egui::Button::new("Delete").small());
                if delete.accessible_name(format!("Delete {}", view.name)).clicked() {
                    commands.push(Command::Navigate(NavigationCommand::RemoveView(i)));
                }
            });
        });
    });
}

fn name_field(ui: &mut Ui, i: usize, text: &str, commands: &mut Vec<Command>) {
    let mut name = text.to_owned();
    let field = ui.add(egui::TextEdit::singleline(&mut name).desired_width(130.0));
    let field = field.accessible_name("Name of the view");
    if field.changed() {
        commands.push(Command::Navigate(NavigationCommand::Rename(Some((i, name)))));
    }
    if field.lost_focus() {
        let is_cancelled = ui.input(|input| input.key_pressed(Key::Escape));
        commands.push(if is_cancelled {
            Command::Navigate(NavigationCommand::Rename(None))
        } else {
            Command::Navigate(NavigationCommand::FinishRenaming)
        });
    } else if !field.has_focus() {
        field.request_focus();
    }
}
