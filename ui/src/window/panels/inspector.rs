//! What a click found, and what was measured.

use super::super::state::{AppState, Command, InspectCommand, Inspection, Measure, PixelFacts};
use crate::window::input::keymap::{Action, keys_of};
use afterimage::raster::pixel_types::PixelType;
use egui::{RichText, Ui};
use glam::DVec3;

/// Shows both.
pub fn show(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    match &state.selection.inspection {
        None => {
            ui.weak("Click a surface to see what it is.");
        }
        Some(found) => pixel(ui, state, found, commands),
    }
    ui.separator();
    measure(ui, &state.selection.measure, commands);
}

fn pixel(ui: &mut Ui, state: &AppState, found: &Inspection, commands: &mut Vec<Command>) {
    let lines = lines(state, found);
    egui::Grid::new("inspector").num_columns(2).min_col_width(72.0).show(ui, |ui| {
        for (name, value) in &lines {
            ui.weak(*name);
            ui.add(egui::Label::new(value).wrap());
            ui.end_row();
        }
    });
    ui.horizontal(|ui| {
        if ui.button("Copy").accessible_name("Copy what was inspected").clicked() {
            let text: Vec<String> = lines.iter().map(|(name, value)| format!("{name}: {value}")).collect();
            commands.push(Command::CopyText(text.join("\n")));
        }
        if ui.button("Close").accessible_name("Close the inspector").clicked() {
            commands.push(Command::Inspect(InspectCommand::CloseInspector));
        }
    });
}

fn lines(state: &AppState, found: &Inspection) -> Vec<(&'static str, String)> {
    let material = state.edits.as_ref().and_then(|e| e.now().materials.get(found.material.0 as usize));
    let material = material.map_or_else(String::new, |m| format!("{} ({})", m.name, m.kind_name()));
    let mut lines = vec![
        ("material", material),
        ("position", format!("{} m", point(found.position_m, 3))),
        ("distance", format!("{:.3} m, depth {:.3} m", found.distance_m, found.depth_m)),
        ("normal", point(found.normal.as_dvec3(), 3)),
        ("triangle", found.triangle.to_string()),
    ];
    match &found.pixel {
        Some(facts) => lines.extend(pixel_lines(facts)),
        None => lines.push(("pixel", "not in the picture yet; click again".to_owned())),
    }
    lines
}

fn pixel_lines(facts: &PixelFacts) -> Vec<(&'static str, String)> {
    let [x, y] = facts.at;
    let supplier = facts.supplier.map_or("none".to_owned(), |id| format!("reference {}", id.0));
    let c = facts.radiance;
    vec![
        ("pixel", format!("{x}, {y}")),
        ("type", type_text(facts.kind).to_owned()),
        ("light from", supplier),
        ("radiance", format!("{:.4}, {:.4}, {:.4}", c.x, c.y, c.z)),
    ]
}

/// What a type means, in a line.
fn type_text(kind: PixelType) -> &'static str {
    match kind {
        PixelType::Reused => "Type 1: its light is reused",
        PixelType::Secondary => "Type 2: mirror or glass, secondary rays traced",
        PixelType::Uncertain => "Type 3, uncertain: looked up, checked by few rays",
        PixelType::Unseen => "Type 3, unseen: traced and lit in full",
    }
}

fn point(p: DVec3, digits: usize) -> String {
    format!("{:.digits$}, {:.digits$}, {:.digits$}", p.x, p.y, p.z)
}

fn measure(ui: &mut Ui, measure: &Measure, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        let text = if measure.is_on { "Stop measuring" } else { "Measure" };
        let help = format!("Two clicks; corners and edges attract (key {})", keys_of(Action::Measure));
        if ui.selectable_label(measure.is_on, text).on_hover_text(help).clicked() {
            commands.push(Command::Inspect(InspectCommand::ToggleMeasure));
        }
        if !measure.points.is_empty() && ui.button("Clear").accessible_name("Clear the measure").clicked() {
            commands.push(Command::Inspect(InspectCommand::ClearMeasure));
        }
    });
    let Some([a, b]) = measure.ends() else {
        if measure.is_on {
            ui.weak(if measure.points.is_empty() {
                "Click the first point."
            } else {
                "Click the second point."
            });
        }
        return;
    };
    let way = b - a;
    let text = format!("{:.3} m, {:.3} m level, {:.3} m in height", way.length(), way.x.hypot(way.z), way.y);
    ui.label(RichText::new(&text).strong());
    if measure.points.len() == 2 && ui.button("Copy").accessible_name("Copy the distance").clicked() {
        commands.push(Command::CopyText(format!("{text}\nfrom {} m\nto {} m", point(a, 4), point(b, 4))));
    }
}
