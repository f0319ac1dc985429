//! The inspected surface point, and the measured distance.

use super::super::state::{AppState, Command, InspectCommand, Inspection, PixelFacts};
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
    measure(ui, state, commands);
}

fn pixel(ui: &mut Ui, state: &AppState, found: &Inspection, commands: &mut Vec<Command>) {
    let lines = lines(state, found);
    // Since the camera has moved, what is known about the pixel no longer describes the picture.
    let is_stale = found.camera != *state.navigation.fly.camera();
    egui::Grid::new("inspector").num_columns(2).min_col_width(72.0).show(ui, |ui| {
        for (i, (name, value)) in lines.iter().enumerate() {
            ui.weak(*name);
            let value = RichText::new(value);
            let value = if is_stale && i >= LINES_OF_POINT { value.weak() } else { value };
            ui.add(egui::Label::new(value).wrap());
            ui.end_row();
        }
    });
    if is_stale {
        ui.weak("The view has moved: grey lines are of the moment of the click.");
    }
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

/// Number of lines that describe the point, whatever the view; those of the pixel follow.
const LINES_OF_POINT: usize = 7;

/// Distance of the point from the eye and along the viewing axis, in metres, from where the camera
/// is now.
fn distances_m(state: &AppState, found: &Inspection) -> [f64; 2] {
    let camera = state.navigation.fly.camera();
    let to_point = found.position_m - camera.eye;
    [to_point.length(), to_point.dot(camera.forward())]
}

fn lines(state: &AppState, found: &Inspection) -> Vec<(&'static str, String)> {
    let of_scene = state.document.as_ref().and_then(|d| d.scene().materials.get(found.material.0 as usize));
    let material =
        of_scene.map_or_else(|| "added ground".to_owned(), |m| format!("{} ({})", m.name, m.kind_name()));
    // The ground that was added is no material of the model.
    let (types, why) = of_scene.map_or(("Type 1", "the ground that was added is matte"), Material::types);
    let [distance_m, depth_m] = distances_m(state, found);
    let mut lines = vec![
        ("material", material),
        ("traced as", format!("{types}: {why}")),
        ("object", found.object.as_ref().map_or_else(|| "none".to_owned(), ObjectKey::to_string)),
        ("position", format!("{} m", point(found.position_m, 3))),
        ("distance", format!("{distance_m:.3} m, depth {depth_m:.3} m")),
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

fn measure(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let measure = &state.selection.measure;
    let kept = state.document.as_ref().map_or(&[][..], |document| &document.now().measures);
    let mut ask = |command| commands.push(Command::Inspect(command));
    ui.horizontal(|ui| {
        let text = if measure.is_on { "Stop measuring" } else { "Measure" };
        let help =
            format!("Click two points; they snap to corners and edges (key {})", keys_of(Action::Measure));
        if ui.selectable_label(measure.is_on, text).on_hover_text(help).clicked() {
            ask(InspectCommand::ToggleMeasure);
        }
        if kept.len() > 1 && ui.button("Delete all").accessible_name("Delete all distances").clicked() {
            ask(InspectCommand::ClearMeasures);
        }
    });
    if let Some(ends) = measure.ends() {
        ui.weak(distance_text(ends));
    }
    for (i, ends) in kept.iter().enumerate() {
        distance(ui, i, *ends, commands);
    }
}

fn distance_text([a, b]: [DVec3; 2]) -> String {
    let d = b - a;
    format!("{:.3} m; horizontal {:.3} m, vertical {:.3} m", d.length(), d.x.hypot(d.z), d.y)
}

/// Shows a distance with its buttons.
fn distance(ui: &mut Ui, i: usize, ends: [DVec3; 2], commands: &mut Vec<Command>) {
    let text = distance_text(ends);
    ui.label(RichText::new(&text).strong());
    ui.horizontal(|ui| {
        let name = format!("distance {}", i + 1);
        if ui.small_button("Copy").accessible_name(format!("Copy {name}")).clicked() {
            let [a, b] = ends.map(|p| point(p, 4));
            commands.push(Command::CopyText(format!("{text}\nfrom {a} m\nto {b} m")));
        }
        if ui.small_button("Delete").accessible_name(format!("Delete {name}")).clicked() {
            commands.push(Command::Inspect(InspectCommand::RemoveMeasure(i)));
        }
    });
}
