//! The side panel with its sections.

use super::{
    comparison, daylight, inspector, legend, lights, material, object, path, plan, plots, quality,
    references, scene, views,
};
use crate::window::state::{AppState, Command};
use egui::{RichText, Ui};

/// Shows the panel. Contents that are too wide are clipped: a wider panel would change the size of
/// the viewport, and thus of the picture and its references.
pub fn show(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let room = ui.available_rect_before_wrap();
    ui.allocate_rect(room, egui::Sense::hover());
    let ui = &mut ui.new_child(egui::UiBuilder::new().max_rect(room));
    egui::ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 5.0;
        section(ui, "Scene", true, |ui| scene::show(ui, state, commands));
        section(ui, "Views", true, |ui| views::show(ui, state, commands));
        section(ui, "Camera path", false, |ui| path::show(ui, state, commands));
        section(ui, "Pixel and distance", true, |ui| inspector::show(ui, state, commands));
        section(ui, "Material", true, |ui| material::show(ui, state, commands));
        section(ui, "Object", true, |ui| object::show(ui, state, commands));
        section(ui, "Sun and sky", false, |ui| daylight::show(ui, state, commands));
        section(ui, "Lights", false, |ui| lights::show(ui, state, commands));
        section(ui, "Plan", true, |ui| plan::show(ui, state, commands));
        section(ui, "Pixel types", true, |ui| legend::show(ui, state, commands));
        section(ui, "Full tracer", true, |ui| comparison::show(ui, state, commands));
        section(ui, "Quality", true, |ui| quality::show(ui, state, commands));
        section(ui, "References", true, |ui| references::show(ui, state, commands));
        section(ui, "Last minute", true, |ui| plots::show(ui, state));
    });
}

fn section(ui: &mut Ui, title: &str, is_open: bool, contents: impl FnOnce(&mut Ui)) {
    let header = egui::CollapsingHeader::new(RichText::new(title).strong()).default_open(is_open);
    header.show_unindented(ui, |ui| {
        ui.add_space(2.0);
        contents(ui);
        ui.add_space(6.0);
    });
}
