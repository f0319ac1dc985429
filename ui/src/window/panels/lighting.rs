//! Lighting analysis: what the viewport shows, its scale, and the work plane.

use super::super::state::{AppState, Area, Command, LightingCommand, Options};
use super::{numbers::Number, widgets::choice};
use crate::window::input::keymap::{Action, keys_of};
use crate::window::rendering::Quantity;
use egui::Ui;

/// The keys of the quantities, in their order.
pub const ACTIONS: [Action; 5] = [
    Action::ShowPicture,
    Action::ShowIlluminance,
    Action::ShowLuminance,
    Action::ShowDaylightFactor,
    Action::ShowClay,
];

/// Shows the controls.
pub fn show(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    quantities(ui, state, commands);
    scale(ui, state, commands);
    ui.separator();
    plane(ui, state, commands);
    results(ui, state, commands);
}

/// A choice of what the viewport shows.
fn quantities(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let mut quantity = state.options.quantity;
    ui.horizontal_wrapped(|ui| {
        for (other, action) in Quantity::ALL.into_iter().zip(ACTIONS) {
            let button = ui.selectable_value(&mut quantity, other, other.name());
            let help = format!("{} (key {})", other.help(), keys_of(action));
            button.on_hover_text(help).accessible_name(format!("View: {}", other.name().to_lowercase()));
        }
    });
    if quantity != state.options.quantity {
        commands.push(Command::SetOptions(Options { quantity, ..state.options }));
    }
}

fn scale(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let quantity = state.options.quantity;
    let Some(max) = state.lighting.max_of(quantity) else { return };
    ui.horizontal(|ui| {
        let (mut is_automatic, mut edited) = (state.lighting.chosen(quantity).is_none(), max);
        let text = "The end of the scale follows the picture, without patches of direct sun";
        ui.checkbox(&mut is_automatic, "Automatic scale").on_hover_text(text);
        let unit = match quantity {
            Quantity::Illuminance => " lx",
            Quantity::Luminance => " cd/m2",
            _ => " %",
        };
        let field = Number::new(0.01..=1e6, 2, unit).speed(f64::from(max) / 100.0).field(ui, "", &mut edited);
        field.on_hover_text("Value of the brightest colour").accessible_name("End of the scale");
        if edited != max {
            commands.push(Command::Lighting(LightingCommand::SetScale(quantity, Some(edited))));
        } else if is_automatic != state.lighting.chosen(quantity).is_none() {
            let chosen = (!is_automatic).then_some(max);
            commands.push(Command::Lighting(LightingCommand::SetScale(quantity, chosen)));
        }
    });
    let mut has_isolines = state.options.has_isolines;
    ui.checkbox(&mut has_isolines, "Lines of equal value");
    if has_isolines != state.options.has_isolines {
        commands.push(Command::SetOptions(Options { has_isolines, ..state.options }));
    }
}

/// The work plane, and the button that measures it.
fn plane(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let before = state.lighting.plane;
    let mut plane = before;
    ui.label("Work plane").on_hover_text("Level points at which the light from above is measured");
    ui.horizontal(|ui| {
        let height = Number::new(0.0..=10.0, 2, " m").field(ui, "height ", &mut plane.height_m);
        height
            .on_hover_text("Height above the floor: 0.85 m for desks")
            .accessible_name("Work plane: height");
        let grid = Number::new(0.05..=10.0, 2, " m").field(ui, "grid ", &mut plane.grid_m);
        grid.on_hover_text("Distance between points").accessible_name("Work plane: grid");
    });
    ui.horizontal(|ui| {
        let areas = [(Area::Room, "this room"), (Area::Floor, "whole floor")];
        let name = if plane.area == Area::Room { areas[0].1 } else { areas[1].1 };
        choice(ui, "work plane area", name, &mut plane.area, areas)
            .on_hover_text("The room around you, or the floor of the whole building that you are on")
            .accessible_name("Work plane: area");
        let of = [(false, "illuminance"), (true, "daylight factor")];
        let name = of[usize::from(plane.is_factor)].1;
        choice(ui, "work plane quantity", name, &mut plane.is_factor, of)
            .on_hover_text("Lux in the light of the scene, or percent under the overcast sky")
            .accessible_name("Work plane: quantity");
    });
    if plane != before {
        commands.push(Command::Lighting(LightingCommand::SetPlane(plane)));
    }
    measuring(ui, state, commands);
}

fn measuring(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        let (text, name) = match state.lighting.measuring {
            Some(_) => ("Cancel", "Cancel measuring the work plane"),
            None => ("Measure", "Measure the work plane"),
        };
        let button = ui.add_enabled(state.scene.is_some(), egui::Button::new(text));
        if button.accessible_name(name).clicked() {
            commands.push(Command::Lighting(LightingCommand::Measure));
        }
    });
    if let Some(progress) = &state.lighting.measuring {
        ui.label(&progress.phase);
        ui.add(egui::ProgressBar::new(progress.fraction.unwrap_or(0.0)).desired_height(8.0));
    }
}

fn results(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let Some(measured) = &state.lighting.measured else { return };
    egui::Grid::new("work plane").num_columns(2).spacing([8.0, 3.0]).show(ui, |ui| {
        for (name, value) in measured.rows() {
            ui.label(name);
            ui.label(value.replace("+-", "\u{b1}"));
            ui.end_row();
        }
    });
    ui.horizontal(|ui| {
        for (text, command) in
            [("Save CSV", LightingCommand::SaveTable), ("Save JSON", LightingCommand::SaveJson)]
        {
            let button = ui.button(text).on_hover_text("In the folder of pictures");
            if button.accessible_name(format!("{text} of the work plane")).clicked() {
                commands.push(Command::Lighting(command));
            }
        }
    });
}
