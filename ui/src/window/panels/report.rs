//! The scene that is shown, the way to another one, and what was doubtful in its files.

use super::super::state::{Command, State};
use egui::{Color32, RichText, Ui};

/// Shows scene, path field and warnings.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    if let Some(scene) = &state.scene {
        ui.label(RichText::new(&scene.name).strong());
        ui.weak(format!("{} triangles, {} lights", grouped(scene.triangles), scene.lights));
    } else {
        ui.weak("No scene yet.");
    }
    path_field(ui, state, commands);
    warnings(ui, state, commands);
}

fn path_field(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let label = ui.label("Model file");
    ui.horizontal(|ui| {
        let mut text = state.path_text.clone();
        let field = egui::TextEdit::singleline(&mut text).hint_text("path to an .obj").desired_width(165.0);
        let field = ui.add(field).labelled_by(label.id);
        if field.changed() {
            commands.push(Command::SetPathText(text.clone()));
        }
        let is_entered = field.lost_focus() && ui.input(|i| i.key_pressed(egui::Key::Enter));
        let is_clicked = ui.add_enabled(!text.trim().is_empty(), egui::Button::new("Load")).clicked();
        if (is_entered || is_clicked) && !text.trim().is_empty() {
            commands.push(Command::OpenPath(text.trim().into()));
        }
        if ui.button("...").accessible_name("Browse for a model").on_hover_text("Browse").clicked() {
            commands.push(Command::Browse);
        }
    });
}

fn warnings(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let Some(scene) = state.scene.as_ref().filter(|s| !s.warnings.is_empty()) else { return };
    let lines: Vec<String> = scene.warnings.iter().map(line).collect();
    let amber =
        if ui.visuals().dark_mode { Color32::from_rgb(240, 180, 60) } else { Color32::from_rgb(150, 90, 0) };
    let title = RichText::new(format!("{} import warnings", lines.len())).color(amber);
    egui::CollapsingHeader::new(title).id_salt("warnings").show(ui, |ui| {
        if ui.button("Copy all").accessible_name("Copy all warnings").clicked() {
            commands.push(Command::CopyText(lines.join("\n")));
        }
        let area = egui::ScrollArea::vertical().max_height(160.0).id_salt("warning list");
        let row_height = ui.text_style_height(&egui::TextStyle::Small);
        area.show_rows(ui, row_height, lines.len(), |ui, rows| {
            for line in &lines[rows] {
                ui.add(egui::Label::new(RichText::new(line).small()).truncate()).on_hover_text(line);
            }
        });
    });
}

fn line(warning: &afterimage::scene::Warning) -> String {
    match (warning.file.as_str(), warning.line) {
        ("", _) => warning.message.clone(),
        (file, 0) => format!("{file}: {}", warning.message),
        (file, line) => format!("{file}:{line}: {}", warning.message),
    }
}

/// 1234567 as 1,234,567.
fn grouped(number: usize) -> String {
    let digits = number.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}
