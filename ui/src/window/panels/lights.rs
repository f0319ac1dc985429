//! Groups of lights: each is switched, dimmed and coloured.

use super::super::state::{AppState, Change, Command, EditCommand};
use super::{color::color_button, numbers::Number};
use afterimage::scene::LightSetting;
use egui::Ui;

/// Largest intensity of the sliders, in percent. Stops go further.
const MAX_PERCENT: f64 = 200.0;

/// Range of a group's light in stops.
const STOPS: std::ops::RangeInclusive<f64> = -10.0..=10.0;

/// Shows a row for each group of lights.
pub fn show(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let (Some(document), Some(scene)) = (&state.document, &state.scene) else {
        ui.weak("No scene yet.");
        return;
    };
    if scene.light_groups.is_empty() {
        ui.weak("The scene has no lights.");
        return;
    }
    if !state.knows_lights {
        commands.push(Command::Edit(EditCommand::KnowLights));
    }
    ui.spacing_mut().slider_width = 110.0;
    for group in &scene.light_groups {
        let before = document.scene().lights.get(&group.name);
        let setting = row(ui, &group.name, before);
        if setting != before {
            commands.push(Command::Edit(EditCommand::Change(Change::Light(group.name.clone(), setting))));
        }
    }
}

/// Shows the controls of a group and returns what they are set to.
fn row(ui: &mut Ui, name: &str, before: LightSetting) -> LightSetting {
    let mut setting = before;
    ui.push_id(name, |ui| {
        ui.horizontal(|ui| {
            let color = color_button(ui, "Colour", &mut setting.color);
            color
                .on_hover_text("Colour that the light is multiplied with")
                .accessible_name(format!("{name}: colour"));
            let switch = egui::Checkbox::new(&mut setting.is_on, name);
            ui.add(switch).on_hover_text("Switches these lights on and off");
        });
        ui.add_enabled_ui(setting.is_on, |ui| {
            ui.horizontal(|ui| {
                let slider = Number::percent(0.0..=MAX_PERCENT).slider(ui, &mut setting.intensity);
                slider.accessible_name(format!("{name}: intensity"));
                let before = f64::from(setting.intensity).max(STOPS.start().exp2()).log2();
                let mut stops = before;
                let field = Number::new(STOPS, 1, " EV").speed(0.02).field(ui, "", &mut stops);
                field.on_hover_text("The same in stops").accessible_name(format!("{name}: stops"));
                if stops != before {
                    setting.intensity = stops.exp2() as f32;
                }
            });
        });
    });
    setting
}
