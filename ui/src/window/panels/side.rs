//! The side panel: tabs in the order of a visit, each with its sections.

use super::regions::{self, Region};
use super::{
    comparison, daylight, focus_ring, inspector, legend, lighting, lights, material, object, path, plan,
    plots, quality, references, scene, section, views,
};
use crate::settings::Tab;
use crate::window::state::{AppState, Appearance, Command};
use egui::{RichText, Ui};

/// Shows the panel. Contents that are too wide are clipped: a wider panel would change the size of
/// the viewport, and thus of the picture and its references.
pub fn show(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let room = ui.available_rect_before_wrap();
    ui.allocate_rect(room, egui::Sense::hover());
    let ui = &mut ui.new_child(egui::UiBuilder::new().max_rect(room));
    tabs(ui, state, commands);
    let tab = state.appearance.tab;
    // Each tab keeps its own place.
    let area = egui::ScrollArea::vertical().id_salt(tab.name()).auto_shrink([false, false]);
    let area = area.show(ui, |ui| {
        regions::name(ui, Region::Panel);
        ui.spacing_mut().item_spacing.y = 5.0;
        match tab {
            Tab::Scene => scene_tab(ui, state, commands),
            Tab::Look => look_tab(ui, state, commands),
            Tab::Camera => camera_tab(ui, state, commands),
            Tab::Method => method_tab(ui, state, commands),
            Tab::Numbers => numbers_tab(ui, state),
        }
        focus_ring::scroll_to(ui);
    });
    regions::note_rect(ui.ctx(), Region::Panel, area.inner_rect);
}

/// Shows the row of tabs. The chosen one is kept in the settings.
fn tabs(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let row = ui.horizontal_wrapped(|ui| {
        regions::name(ui, Region::Tabs);
        // All five in one row of the panel's usual width.
        ui.spacing_mut().item_spacing.x = 2.0;
        ui.spacing_mut().button_padding.x = 5.0;
        for (tab, title, help) in TABS {
            let is_shown = state.appearance.tab == tab;
            let button = ui.selectable_label(is_shown, RichText::new(title).strong()).on_hover_text(help);
            button.widget_info(|| egui::WidgetInfo::selected(egui::Role::Tab, true, is_shown, title));
            ui.ctx().accesskit_node_builder(button.id, |node| node.set_selected(is_shown));
            if is_shown {
                regions::note(&button, Region::Tabs);
            }
            if button.clicked() && !is_shown {
                commands.push(Command::SetAppearance(Appearance { tab, ..state.appearance }));
            }
        }
    });
    regions::note_rect(ui.ctx(), Region::Tabs, row.response.rect);
    ui.separator();
}

/// The tabs with their titles and explanations.
pub const TABS: [(Tab, &str, &str); 5] = [
    (Tab::Scene, "Scene", "The model: surfaces, materials and objects"),
    (Tab::Look, "Look", "Sun, sky, lamps and exposure"),
    (Tab::Camera, "Camera", "Views, paths, the plan and how you move"),
    (Tab::Method, "Method", "How pictures are made: reuse, comparison, quality, references"),
    (Tab::Numbers, "Numbers", "The last minute in plots, and numerical details"),
];

fn scene_tab(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    section(ui, "Scene", true, |ui| scene::show(ui, state, commands));
    section(ui, "Pixel and distance", true, |ui| inspector::show(ui, state, commands));
    section(ui, "Material", true, |ui| material::show(ui, state, commands));
    section(ui, "Object", true, |ui| object::show(ui, state, commands));
}

fn look_tab(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    section(ui, "Exposure", true, |ui| quality::show_look(ui, state, commands));
    section(ui, "Sun and sky", true, |ui| daylight::show(ui, state, commands));
    section(ui, "Section and edges", true, |ui| {
        section::show(ui, state, commands);
        section::show_edges(ui, state, commands);
    });
    section(ui, "Lighting analysis", true, |ui| lighting::show(ui, state, commands));
    section(ui, "Lights", false, |ui| lights::show(ui, state, commands));
}

fn camera_tab(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    section(ui, "Views", true, |ui| views::show(ui, state, commands));
    section(ui, "Movement", true, |ui| quality::show_movement(ui, state, commands));
    section(ui, "Plan", true, |ui| plan::show(ui, state, commands));
    section(ui, "Camera path", false, |ui| path::show(ui, state, commands));
}

fn method_tab(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    section(ui, "Pixel types", true, |ui| legend::show(ui, state, commands));
    section(ui, "Full tracer", true, |ui| comparison::show(ui, state, commands));
    section(ui, "Quality", true, |ui| quality::show(ui, state, commands));
    section(ui, "References", true, |ui| references::show(ui, state, commands));
}

fn numbers_tab(ui: &mut Ui, state: &AppState) {
    section(ui, "Last minute", true, |ui| plots::show(ui, state));
    section(ui, "Numerical conditioning", false, |ui| scene::conditioning(ui, state));
}

fn section(ui: &mut Ui, title: &str, is_open: bool, contents: impl FnOnce(&mut Ui)) {
    let header = egui::CollapsingHeader::new(RichText::new(title).strong()).default_open(is_open);
    // A tab may have the same name as its section.
    let shown = header.id_salt((title, "section")).show_unindented(ui, |ui| {
        ui.add_space(2.0);
        contents(ui);
        ui.add_space(6.0);
    });
    regions::note(&shown.header_response, Region::Panel);
}
