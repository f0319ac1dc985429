//! What lies round the viewport and over it. A panel reads the state and asks for changes by commands.

pub mod comparison;
pub mod daylight;
pub mod files;
pub mod help;
pub mod hud;
pub mod inspector;
pub mod legend;
pub mod material;
pub mod menu;
pub mod notices;
pub mod overlay;
pub mod path;
pub mod picture;
pub mod plan;
pub mod plots;
pub mod quality;
pub mod questions;
pub mod references;
pub mod report;
pub mod views;

use super::state::{AppState, Command};
use afterimage::raster::pixel_types::TYPE_SRGB;
use egui::{Color32, RichText, Ui};

/// Type 1, 2 and 3, told apart by colour-blind people; Type 3 is also hatched.
pub const TYPE_COLORS: [Color32; 3] = [type_color(0), type_color(1), type_color(2)];

const fn type_color(index: usize) -> Color32 {
    let [r, g, b] = TYPE_SRGB[index];
    Color32::from_rgb(r, g, b)
}

/// A pixel that the last frame did not see, filled from beside it until the next one; as in present.wgsl.
pub const FILLED_COLOR: Color32 = Color32::from_rgb(0xCC, 0x79, 0xA7);

/// What the types are called.
pub const TYPE_NAMES: [&str; 3] = ["Type 1, reused", "Type 2, mirror or glass", "Type 3, traced"];

/// Sets egui's look: its labels are greyer than small figures can bear (4.5 : 1 against the panel is asked for), and its
/// small letters smaller than can be read at an arm's length.
pub fn install_style(ctx: &egui::Context) {
    ctx.all_styles_mut(|style| {
        if let Some(small) = style.text_styles.get_mut(&egui::TextStyle::Small) {
            small.size = 10.5;
        }
        let visuals = &mut style.visuals;
        let gray = if visuals.dark_mode { 190 } else { 50 };
        visuals.widgets.noninteractive.fg_stroke.color = Color32::from_gray(gray);
        visuals.weak_text_alpha = 0.8;
    });
}

/// The panel on the right. What is too wide in it is cut: were the panel to grow, the picture would be rendered anew at
/// another size, and its references with it.
pub fn side(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let room = ui.available_rect_before_wrap();
    ui.allocate_rect(room, egui::Sense::hover());
    let ui = &mut ui.new_child(egui::UiBuilder::new().max_rect(room));
    egui::ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        ui.spacing_mut().item_spacing.y = 5.0;
        section(ui, "Scene", |ui| report::show(ui, state, commands));
        section(ui, "Views", |ui| views::show(ui, state, commands));
        closed_section(ui, "Camera path", |ui| path::show(ui, state, commands));
        section(ui, "Pixel and distance", |ui| inspector::show(ui, state, commands));
        section(ui, "Material", |ui| material::show(ui, state, commands));
        closed_section(ui, "Sun and sky", |ui| daylight::show(ui, state, commands));
        section(ui, "Plan", |ui| plan::show(ui, state, commands));
        section(ui, "Pixel types", |ui| legend::show(ui, state, commands));
        section(ui, "Full tracer", |ui| comparison::show(ui, state, commands));
        section(ui, "Quality", |ui| quality::show(ui, state, commands));
        section(ui, "References", |ui| references::show(ui, state, commands));
        section(ui, "Last minute", |ui| plots::show(ui, state));
    });
}

fn section(ui: &mut Ui, title: &str, contents: impl FnOnce(&mut Ui)) {
    collapsing(ui, egui::CollapsingHeader::new(RichText::new(title).strong()).default_open(true), contents);
}

/// What is not needed by everyone is opened by whoever does.
fn closed_section(ui: &mut Ui, title: &str, contents: impl FnOnce(&mut Ui)) {
    collapsing(ui, egui::CollapsingHeader::new(RichText::new(title).strong()), contents);
}

fn collapsing(ui: &mut Ui, header: egui::CollapsingHeader, contents: impl FnOnce(&mut Ui)) {
    header.show_unindented(ui, |ui| {
        ui.add_space(2.0);
        contents(ui);
        ui.add_space(6.0);
    });
}

/// A small picture of a pose, grey until it is there.
pub fn thumbnail(ui: &mut Ui, state: &AppState, camera: &afterimage::Camera) {
    let (rect, _) = ui.allocate_exact_size(egui::vec2(72.0, 45.0), egui::Sense::hover());
    ui.painter().rect_filled(rect, 3.0, Color32::from_gray(70));
    if let Some(texture) = state.thumbnails.of(camera) {
        egui::Image::new(texture).corner_radius(3.0).paint_at(ui, rect);
    }
}

/// A small square of a type's colour, hatched for Type 3; past the types, of what is filled.
pub fn swatch(ui: &mut Ui, number: usize) {
    let (rect, _) = ui.allocate_exact_size(egui::vec2(14.0, 14.0), egui::Sense::hover());
    let painter = ui.painter().with_clip_rect(rect);
    painter.rect_filled(rect, 2.0, TYPE_COLORS.get(number).copied().unwrap_or(FILLED_COLOR));
    if number >= 2 {
        let stroke = egui::Stroke::new(1.5, Color32::from_rgb(0x70, 0x30, 0x00));
        for step in 0..6 {
            let x = rect.left() + step as f32 * 5.0;
            let end = egui::pos2(x - rect.height(), rect.bottom());
            painter.line_segment([egui::pos2(x, rect.top()), end], stroke);
        }
    }
}
