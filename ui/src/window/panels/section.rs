//! The section: a plane that cuts the model open for the camera.

use super::super::state::{AppState, Change, Command, EditCommand, SectionView};
use super::numbers::Number;
use super::widgets::key_hint;
use crate::window::input::keymap::Action;
use afterimage::Mode;
use egui::Ui;

/// Axes of the world, with the direction in which each of them is removed.
const AXES: [(&str, &str); 3] = [
    ("x", "A plane across the x axis, to the right on the plan"),
    ("Up", "A level plane, which opens the model from above or below"),
    ("z", "A plane across the z axis, down on the plan"),
];

/// Shows the switch of the lines along the edges of surfaces.
pub fn show_edges(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let mut options = state.options;
    ui.checkbox(&mut options.has_edges, "Draw edges as lines").on_hover_text(key_hint(Action::ToggleEdges));
    if options != state.options {
        commands.push(Command::SetOptions(options));
    }
}

/// Shows the switch of the section, and where its plane lies.
pub fn show(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let (Some(document), Some(scene)) = (&state.document, &state.scene) else {
        ui.weak("No scene yet.");
        return;
    };
    let camera = state.navigation.fly.camera();
    let before = document.now().section;
    let new = || SectionView::new(scene.building_m, camera.eye, camera.forward());
    let mut section = before.unwrap_or_else(|| SectionView { is_on: false, ..new() });
    ui.checkbox(&mut section.is_on, "Cut the model open").on_hover_text(key_hint(Action::ToggleSection));
    if section.is_on && state.quality.walk.render.mode == Mode::Paper {
        ui.weak("Mode paper warps pictures of the whole model and shows no section.");
    }
    if section.is_on {
        plane_rows(ui, scene.building_m, &mut section);
        ui.weak("Light is that of the whole model. Closed solids show where they are cut.");
    }
    if Some(section) != before && (before.is_some() || section.is_on) {
        commands.push(Command::Edit(EditCommand::Change(Change::Section(Some(section)))));
    }
}

fn plane_rows(ui: &mut Ui, [low, high]: [glam::DVec3; 2], section: &mut SectionView) {
    let plane = &mut section.plane;
    ui.spacing_mut().slider_width = 110.0;
    egui::Grid::new("section").num_columns(2).min_col_width(84.0).show(ui, |ui| {
        ui.label("Across");
        let before = plane.axis;
        ui.horizontal(|ui| {
            for (axis, (name, help)) in AXES.into_iter().enumerate() {
                let response = ui.radio_value(&mut plane.axis, axis, name).on_hover_text(help);
                response.accessible_name(format!("Section across {}", name.to_lowercase()));
            }
        });
        if plane.axis != before {
            plane.at_m = (low[plane.axis] + high[plane.axis]) / 2.0;
        }
        ui.end_row();
        let keys = [Action::SectionBack, Action::SectionForward].map(key_hint).join(", ");
        let label = ui.label("Section at").on_hover_text(&keys);
        let range = low[plane.axis]..=high[plane.axis];
        Number::new(range, 2, " m").slider(ui, &mut plane.at_m).labelled_by(label.id).on_hover_text(keys);
        ui.end_row();
        ui.label("Side");
        if ui.button("Flip").accessible_name("Show the other side of the section").clicked() {
            plane.keeps_above = !plane.keeps_above;
        }
        ui.end_row();
    });
}
