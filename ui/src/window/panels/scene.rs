//! The scene: its contents, a field to open another one, and warnings about its files.

use super::super::state::{AppState, Command, InspectCommand, ListCommand, Purpose, SceneInfo};
use super::widgets::{counted, grouped};
use crate::window::files::{Entry, completed, path_of, typed};
use egui::{Color32, Key, RichText, Ui, text::CCursorRange};

/// Shows the scene, the path field and the warnings.
pub fn show(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    if let Some(scene) = &state.scene {
        ui.label(RichText::new(&scene.name).strong());
        ui.weak(format!("{}, {}", counted(scene.triangles, "triangle"), counted(scene.lights, "light")));
        facts(ui, scene);
    } else {
        ui.weak("No scene yet.");
    }
    path_field(ui, state, commands);
    warnings(ui, state, commands);
}

/// Shows the numerical conditioning of the scene in sentences.
pub fn conditioning(ui: &mut Ui, state: &AppState) {
    for sentence in state.scene.iter().flat_map(|scene| &scene.conditioning) {
        ui.add(egui::Label::new(RichText::new(sentence).small()).wrap());
    }
}

/// Shows the features that the scene uses, those that are not rendered, and its size.
fn facts(ui: &mut Ui, scene: &SceneInfo) {
    let [x, y, z] = scene.extent_m;
    let (features, left_out) = (scene.features, scene.features.left_out());
    let used = [
        (features.mirror, "mirrors"),
        (features.glass, "glass"),
        (features.glossy || features.frosted, "rough surfaces"),
        (features.textures, "textures"),
        (features.alpha, "cut-outs"),
        (features.area_lights, "area lights"),
        (features.many_lights, "tree of many lamps"),
        (features.light_profiles, "light profiles"),
        (features.sky, "a sky"),
    ];
    let used: Vec<&str> = used.into_iter().filter_map(|(is, what)| is.then_some(what)).collect();
    let or_nothing = |list: Vec<&str>| if list.is_empty() { "nothing".to_owned() } else { list.join(", ") };
    egui::CollapsingHeader::new("Features").id_salt("features").show(ui, |ui| {
        ui.label(format!("Uses: {}.", or_nothing(used)));
        ui.label(format!("Not rendered: {}.", or_nothing(left_out)));
        ui.weak(format!("{x:.1} x {z:.1} m, {y:.1} m high"));
        ui.weak(format!("{} vertices, {}", grouped(scene.vertices), counted(scene.textures, "texture")));
    });
}

/// Shows the path field over the full width, its buttons, and names that complete its text.
fn path_field(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let label = ui.label("Model file");
    let mut text = state.files.path_text.clone();
    let width = f32::INFINITY;
    let field =
        egui::TextEdit::singleline(&mut text).hint_text("path to a model").desired_width(width).show(ui);
    let response = field.response.response.labelled_by(label.id);
    let has_text = !text.trim().is_empty();
    let is_entered = response.lost_focus() && ui.input(|i| i.key_pressed(Key::Enter));
    ui.horizontal(|ui| {
        let is_clicked = ui.add_enabled(has_text, egui::Button::new("Load")).clicked();
        if (is_entered || is_clicked) && has_text {
            commands.push(Command::OpenPath(path_of(&text)));
        }
        if ui.button("Browse...").accessible_name("Browse for a model").clicked() {
            commands.push(Command::List(ListCommand::Ask(Purpose::Open)));
        }
    });
    if response.changed() {
        commands.push(Command::SetPathText(text));
    } else {
        let is_at_end = response.has_focus() && field.cursor_range.is_some_and(|range| is_end(range, &text));
        let chosen = suggestions(ui, state, is_at_end);
        if let Some(text) = chosen {
            move_to_end(ui, field.state, response.id, &text);
            commands.push(Command::SetPathText(text));
        }
    }
}

/// Number of names that are suggested.
const SUGGESTIONS: usize = 5;

/// Shows names that complete the typed path; returns the completed text. The arrow to the right and
/// End take the first one where the cursor is at the end.
fn suggestions(ui: &mut Ui, state: &AppState, is_at_end: bool) -> Option<String> {
    let text = &state.files.path_text;
    let begun = typed::split(text).1.to_lowercase();
    let is_begun = |e: &&Entry| e.name.to_lowercase().starts_with(&begun) && e.name.to_lowercase() != begun;
    let fitting = state.files.nearby.entries.iter().filter(is_begun).take(SUGGESTIONS);
    let takes_first = is_at_end && ui.input(|i| i.key_pressed(Key::ArrowRight) || i.key_pressed(Key::End));
    let mut chosen = None;
    for (i, entry) in fitting.filter(|_| !text.is_empty()).enumerate() {
        let whole = completed(text, &entry.name, entry.is_folder);
        let button = ui.add(egui::Button::new(&whole).small().frame(false).truncate());
        if button.accessible_name(format!("Complete to {}", entry.name)).clicked() || (takes_first && i == 0)
        {
            chosen = Some(whole);
        }
    }
    chosen
}

fn is_end(range: CCursorRange, text: &str) -> bool {
    range.as_sorted_char_range().start == CCursorRange::select_all_str(text).as_sorted_char_range().end
}

fn move_to_end(ui: &Ui, mut state: egui::text_edit::TextEditState, field: egui::Id, text: &str) {
    let [_, end] = CCursorRange::select_all_str(text).sorted_cursors();
    state.cursor.set_char_range(Some(CCursorRange::one(end)));
    state.store(ui.ctx(), field);
    ui.memory_mut(|m| m.request_focus(field));
}

fn warnings(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let Some(scene) = state.scene.as_ref().filter(|s| !s.warnings.is_empty()) else { return };
    let amber =
        if ui.visuals().dark_mode { Color32::from_rgb(240, 180, 60) } else { Color32::from_rgb(150, 90, 0) };
    let title = RichText::new(counted(scene.warnings.len(), "import warning")).color(amber);
    egui::CollapsingHeader::new(title).id_salt("warnings").show(ui, |ui| {
        let mut filter = state.selection.report_filter.clone();
        let field = egui::TextEdit::singleline(&mut filter).hint_text("filter").desired_width(f32::INFINITY);
        if ui.add(field).accessible_name("Filter the warnings").changed() {
            commands.push(Command::Inspect(InspectCommand::FilterReport(filter.clone())));
        }
        let filter = filter.to_lowercase();
        let lines: Vec<String> =
            scene.warnings.iter().map(line).filter(|l| l.to_lowercase().contains(&filter)).collect();
        ui.horizontal(|ui| {
            if ui.button("Copy all").accessible_name("Copy all warnings").clicked() {
                commands.push(Command::CopyText(lines.join("\n")));
            }
            ui.weak(format!("{} shown; click one to copy it", lines.len()));
        });
        list(ui, &lines, commands);
    });
}

/// Number of warnings that are listed; the filter finds the others.
const MAX_LISTED: usize = 50;

fn list(ui: &mut Ui, lines: &[String], commands: &mut Vec<Command>) {
    for line in lines.iter().take(MAX_LISTED) {
        let label = egui::Label::new(RichText::new(line).small()).wrap().sense(egui::Sense::click());
        if ui.add(label).on_hover_text("Click to copy").clicked() {
            commands.push(Command::CopyText(line.clone()));
        }
    }
    if let Some(more) = lines.len().checked_sub(MAX_LISTED).filter(|more| *more > 0) {
        ui.weak(format!("{more} more: filter them, or copy all"));
    }
}

fn line(warning: &afterimage::scene::Warning) -> String {
    match (warning.file.as_str(), warning.line) {
        ("", _) => warning.message.clone(),
        (file, 0) => format!("{file}: {}", warning.message),
        (file, line) => format!("{file}:{line}: {}", warning.message),
    }
}
