//! The selected object: moving, hiding and deleting it; and the objects that are not shown.

use super::super::state::{AppState, Change, Command, EditCommand, InspectCommand, OpenDocument};
use super::{numbers::Number, widgets::key_hint};
use crate::window::input::keymap::Action;
use afterimage::scene::{ObjectEdit, ObjectKey, Objects};
use egui::Ui;

/// Names of the axes of the world.
const AXES: [&str; 3] = ["x", "y", "z"];

/// Shows the selected object with its controls, and the list of hidden and deleted ones.
pub fn show(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let (Some(document), Some(scene)) = (&state.document, &state.scene) else {
        ui.weak("No scene yet.");
        return;
    };
    if scene.objects.keys().is_empty() {
        ui.weak("This model names no objects.");
        return;
    }
    let chosen = state.selection.object.as_ref();
    choice(ui, &scene.objects, chosen, commands);
    match chosen {
        None => {
            ui.weak("Click an object or select one.");
        }
        Some(key) => controls(ui, key, &document.object(key), scene.reach_m(), commands),
    }
    gone(ui, document, commands);
}

fn choice(ui: &mut Ui, objects: &Objects, chosen: Option<&ObjectKey>, commands: &mut Vec<Command>) {
    let keys = objects.keys();
    let name = chosen.map_or_else(|| "none selected".to_owned(), ObjectKey::to_string);
    let combo = egui::ComboBox::from_id_salt("chosen object").selected_text(name).width(230.0).truncate();
    let response = combo.show_ui(ui, |ui| {
        // Only visible rows are laid out: a model may have many thousands of objects.
        let height = ui.text_style_height(&egui::TextStyle::Button) + 2.0 * ui.spacing().button_padding.y;
        egui::ScrollArea::vertical().max_height(240.0).show_rows(ui, height, keys.len(), |ui, rows| {
            for key in &keys[rows] {
                if ui.selectable_label(chosen == Some(key), key.to_string()).clicked() {
                    commands.push(Command::Inspect(InspectCommand::SelectObject(key.clone())));
                }
            }
        });
    });
    response.response.accessible_name("Object to change");
}

/// Shows the controls of an object, which may go `reach_m` metres far along each axis.
fn controls(ui: &mut Ui, key: &ObjectKey, now: &ObjectEdit, reach_m: f64, commands: &mut Vec<Command>) {
    let mut edited = *now;
    ui.horizontal(|ui| {
        ui.label("Move");
        for (axis, name) in AXES.into_iter().enumerate() {
            let value = &mut edited.moved_m[axis];
            let number = Number::new(-reach_m..=reach_m, 3, " m").speed(0.01);
            let drag = number.field(ui, &format!("{name} "), value);
            drag.on_hover_text(format!("Drag, or click and type; keys {}", key_hint(Action::ObjectAway)))
                .accessible_name(format!("Way of the object along {name}, metres"));
        }
    });
    ui.horizontal(|ui| {
        let label = ui.label("Turn");
        let number = Number::new(-180.0..=180.0, 1, "°").speed(1.0);
        let drag = number.field(ui, "", &mut edited.turned_deg);
        drag.labelled_by(label.id).accessible_name("Angle of the object, degrees");
        let hide = ui.selectable_label(edited.is_hidden, "Hide").on_hover_text(key_hint(Action::HideObject));
        edited.is_hidden ^= hide.accessible_name("Hide the object").clicked();
        let delete = ui.add_enabled(!edited.is_deleted, egui::Button::new("Delete"));
        let delete = delete.on_hover_text(key_hint(Action::DeleteObject));
        edited.is_deleted |= delete.accessible_name("Delete the object").clicked();
        let reset = ui.add_enabled(!now.is_none(), egui::Button::new("Reset"));
        let reset = reset.on_hover_text("As the model has it").accessible_name("Reset the object");
        if reset.clicked() {
            edited = ObjectEdit::default();
        }
    });
    if edited != *now {
        commands.push(Command::Edit(EditCommand::Change(Change::Object(key.clone(), edited))));
    }
}

/// Lists the objects that are hidden or deleted.
fn gone(ui: &mut Ui, document: &OpenDocument, commands: &mut Vec<Command>) {
    let gone: Vec<_> = document.scene().objects.iter().filter(|(_, edit)| edit.is_gone()).collect();
    if gone.is_empty() {
        return;
    }
    ui.weak("Not shown:");
    // A list that scrolls inside a list loses the wheel.
    let (first, others) = gone.split_at(gone.len().min(MAX_LISTED));
    gone_rows(ui, first, commands);
    if !others.is_empty() {
        let header = egui::CollapsingHeader::new(format!("{} more", others.len())).id_salt("gone objects");
        header.show_unindented(ui, |ui| gone_rows(ui, others, commands));
    }
}

/// Number of objects that are not shown and are listed at first.
const MAX_LISTED: usize = 12;

fn gone_rows(ui: &mut Ui, gone: &[(&ObjectKey, &ObjectEdit)], commands: &mut Vec<Command>) {
    for (key, edit) in gone {
        ui.horizontal(|ui| {
            if ui.small_button("Show").accessible_name(format!("Show {key}")).clicked() {
                let shown = ObjectEdit { is_hidden: false, is_deleted: false, ..**edit };
                let change = Change::Object((*key).clone(), shown);
                commands.push(Command::Edit(EditCommand::Change(change)));
            }
            let how = if edit.is_deleted { "deleted" } else { "hidden" };
            ui.add(egui::Label::new(format!("{key} ({how})")).truncate());
        });
    }
}
