//! Groups of lights: each is switched, dimmed and coloured.

use super::super::state::{AppState, Change, Command, EditCommand};
use afterimage::scene::LightSetting;
use egui::{DragValue, Slider, SliderClamping, Ui};
use glam::Vec3;

/// Largest intensity of the sliders, in percent. Stops go further.
const MAX_PERCENT: f32 = 200.0;

/// Range of a group's light in stops.
const STOPS: std::ops::RangeInclusive<f32> = -10.0..=10.0;

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
            let mut rgb = setting.color.to_array();
            let help = "Colour that the light is multiplied with";
            let color = ui.color_edit_button_rgb(&mut rgb).on_hover_text(help);
            if color.accessible_name(format!("{name}: colour")).changed() {
                setting.color = Vec3::from_array(rgb).clamp(Vec3::ZERO, Vec3::ONE);
            }
            let switch = egui::Checkbox::new(&mut setting.is_on, name);
            ui.add(switch).on_hover_text("Switches these lights on and off");
        });
        ui.add_enabled_ui(setting.is_on, |ui| {
            ui.horizontal(|ui| {
                let mut percent = setting.intensity * 100.0;
                let slider = Slider::new(&mut percent, 0.0..=MAX_PERCENT).clamping(SliderClamping::Edits);
                let slider = ui.add(slider.fixed_decimals(0).suffix(" %"));
                if slider.accessible_name(format!("{name}: intensity")).changed() {
                    setting.intensity = percent / 100.0;
                }
                let mut stops = setting.intensity.max(STOPS.start().exp2()).log2();
                let field = DragValue::new(&mut stops).range(STOPS).speed(0.02).fixed_decimals(1);
                let field = ui.add(field.suffix(" EV")).on_hover_text("The same in stops");
                if field.accessible_name(format!("{name}: stops")).changed() {
                    setting.intensity = stops.exp2();
                }
            });
        });
    });
    setting
}
