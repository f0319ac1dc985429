//! The inspected surface point, and the measured distance.

use super::super::state::{AppState, Command, InspectCommand, Inspection, Measure, PixelFacts};
use crate::window::input::keymap::{Action, keys_of};
use afterimage::raster::pixel_types::PixelType;
use afterimage::scene::{Material, ObjectKey};
use egui::{RichText, Ui};
use glam::DVec3;

/// Shows both parts.
pub fn show(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    match &state.selection.inspection {
        None => {
            ui.weak("Click a surface to inspect it.");
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
        if ui.button("Copy").accessible_name("Copy the inspected values").clicked() {
            let text: Vec<String> = lines.iter().map(|(name, value)| format!("{name}: {value}")).collect();
            commands.push(Command::CopyText(text.join("\n")));
        }
        if ui.button("Close").accessible_name("Close the inspector").clicked() {
            commands.push(Command::Inspect(InspectCommand::CloseInspector));
        }
    });
}

fn lines(state: &AppState, found: &Inspection) -> Vec<(&'static str, String)> {
    let of_scene = state.document.as_ref().and_then(|d| d.scene().materials.get(found.material.0 as usize));
    let material = of_scene.map_or_else(String::new, |m| format!("{} ({})", m.name, m.kind_name()));
    let (types, why) = of_scene.map_or(("", ""), Material::types);
    let mut lines = vec![
        ("material", material),
        ("traced as", format!("{types}: {why}")),
        ("object", found.object.as_ref().map_or_else(|| "none".to_owned(), ObjectKey::to_string)),
        ("position", format!("{} m", point(found.position_m, 3))),
        ("distance", format!("{:.3} m, depth {:.3} m", found.distance_m, found.depth_m)),
        ("normal", point(found.normal.as_dvec3(), 3)),
        ("triangle", found.triangle.to_string()),
    ];
    match &found.pixel {
        Some(facts) => lines.extend(pixel_lines(facts)),
        None => lines.push(("pixel", "not rendered yet; click again".to_owned())),
    }
    lines
}

fn pixel_lines(facts: &PixelFacts) -> Vec<(&'static str, String)> {
    let [x, y] = facts.at;
    let supplier = facts.supplier.map_or("none".to_owned(), |id| format!("#{}", id.0));
    let c = facts.radiance;
    vec![
        ("pixel", format!("{x}, {y}")),
        ("type", type_text(facts.kind).to_owned()),
        ("reference", supplier),
        ("radiance", format!("{:.4}, {:.4}, {:.4}", c.x, c.y, c.z)),
    ]
}

/// One-line explanation of a type.
fn type_text(kind: PixelType) -> &'static str {
    match kind {
        PixelType::Reused => "Type 1: light reused from a reference",
        PixelType::Secondary => "Type 2: mirror, glass or gloss, secondary rays traced",
        PixelType::Uncertain => "Type 3, uncertain: looked up, then checked with few rays",
        PixelType::Unseen => "Type 3, unseen: traced and shaded in full",
    }
}

fn point(p: DVec3, digits: usize) -> String {
    format!("{:.digits$}, {:.digits$}, {:.digits$}", p.x, p.y, p.z)
}

fn measure(ui: &mut Ui, measure: &Measure, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        let text = if measure.is_on { "Stop measuring" } else { "Measure" };
        let help =
            format!("Click two points; they snap to corners and edges (key {})", keys_of(Action::Measure));
        if ui.selectable_label(measure.is_on, text).on_hover_text(help).clicked() {
            commands.push(Command::Inspect(InspectCommand::ToggleMeasure));
        }
        if !measure.points.is_empty() && ui.button("Clear").accessible_name("Clear the measurement").clicked()
        {
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
    let d = b - a;
    let text = format!("{:.3} m; horizontal {:.3} m, vertical {:.3} m", d.length(), d.x.hypot(d.z), d.y);
    ui.label(RichText::new(&text).strong());
    if measure.points.len() == 2 && ui.button("Copy").accessible_name("Copy the distance").clicked() {
        commands.push(Command::CopyText(format!("{text}\nfrom {} m\nto {} m", point(a, 4), point(b, 4))));
    }
}
