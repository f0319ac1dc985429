//! The list of references: contribution, position, and actions.

use super::super::state::{AppState, Command, InspectCommand, Work};
use super::widgets::{counted, thumbnail};
use crate::window::input::keymap::{Action, keys_of};
use crate::window::rendering::exchange::{ReferenceInfo, supplier_byte};
use afterimage::reference::ReferenceId;
use egui::{Color32, ProgressBar, RichText, Ui};

/// Shows the buttons and the list.
pub fn show(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    buttons(ui, state, commands);
    let Some(frame) = &state.frame else {
        ui.weak("None yet.");
        return;
    };
    let [bytes, limit] = frame.cache_bytes;
    let share = bytes as f32 / limit.max(1) as f32;
    let megabytes = |bytes: usize| bytes as f64 / f64::from(1 << 20);
    let (count, used) = (frame.references.len(), megabytes(bytes));
    let text = format!("{}, {used:.0} of {:.0} MB", counted(count, "reference"), megabytes(limit));
    ui.add(ProgressBar::new(share.min(1.0)).text(RichText::new(text).small()).desired_height(16.0));
    if frame.references.is_empty() {
        ui.weak(if state.work == Work::AddingReference {
            "The first one is being traced."
        } else {
            "None yet."
        });
    }
    let mut list = |ui: &mut Ui, references: &mut dyn Iterator<Item = &ReferenceInfo>| {
        for reference in references {
            ui.separator();
            entry(ui, state, reference, "reference", commands);
        }
    };
    list(ui, &mut frame.references.iter().rev().take(MAX_LISTED));
    if let Some(older) = frame.references.len().checked_sub(MAX_LISTED).filter(|older| *older > 0) {
        let title = format!("{older} older");
        let header = egui::CollapsingHeader::new(title).id_salt("older references");
        header.show_unindented(ui, |ui| list(ui, &mut frame.references.iter().rev().skip(MAX_LISTED)));
    }
}

/// Number of references that are listed at first.
const MAX_LISTED: usize = 12;

fn buttons(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        let button = |ui: &mut Ui, text: &str, action, help: &str| {
            ui.button(text).on_hover_text(format!("{help} (key {})", keys_of(action))).clicked()
        };
        if button(ui, "Add here", Action::AddReference, "Trace a reference at the current camera") {
            commands.push(Command::AddReference);
        }
        if button(ui, "Clear...", Action::ClearCache, "Remove all references") {
            commands.push(Command::AskToClear);
        }
        let is_paused = state.options.is_paused;
        let text = if is_paused { "Resume" } else { "Pause" };
        if button(ui, text, Action::Pause, "Pause rendering until the camera moves, or resume it") {
            commands.push(Command::SetOptions(state.options.paused(!is_paused)));
        }
    });
}

/// Shows a reference with its picture, contribution and actions. `whose` distinguishes the
/// accessible names of buttons in two places.
pub fn entry(
    ui: &mut Ui,
    state: &AppState,
    reference: &ReferenceInfo,
    whose: &str,
    commands: &mut Vec<Command>,
) {
    let number = reference.id.0;
    ui.horizontal(|ui| {
        thumbnail(ui, state, &reference.camera);
        ui.vertical(|ui| {
            ui.horizontal(|ui| {
                swatch(ui, reference.id);
                let name = RichText::new(format!("#{number}"));
                let is_selected = state.selection.reference == Some(reference.id);
                let name = if reference.is_used { name.strong() } else { name };
                let help = if reference.is_used { "used by this frame" } else { "not used by this frame" };
                let label = ui.selectable_label(is_selected, name).on_hover_text(help);
                if label.accessible_name(format!("Select {whose} {number}")).clicked() {
                    let selected = (!is_selected).then_some(reference.id);
                    commands.push(Command::Inspect(InspectCommand::SelectReference(selected)));
                }
                ui.weak(age(reference.added.elapsed().as_secs()));
                if !reference.is_enabled {
                    ui.weak("off");
                }
            });
            ui.horizontal(|ui| actions(ui, reference, whose, commands));
        });
    });
    let share = reference.contribution.clamp(0.0, 1.0);
    let text = RichText::new(format!("contributes {:.0} %", share * 100.0)).small();
    ui.add(ProgressBar::new(share).text(text).desired_height(14.0));
    let eye = reference.camera.eye;
    let [width, height] = reference.size;
    let place = format!("{:.2}, {:.2}, {:.2} m   {width} x {height}", eye.x, eye.y, eye.z);
    ui.label(RichText::new(place).small().weak());
}

/// A square in the colour of the reference in the heatmap.
pub fn swatch(ui: &mut Ui, id: ReferenceId) {
    let (rect, response) = ui.allocate_exact_size(egui::vec2(12.0, 12.0), egui::Sense::hover());
    ui.painter().rect_filled(rect, 2.0, heatmap_color(supplier_byte(id)));
    response.on_hover_text("Its colour in the heatmap by reference");
}

/// Colour of a reference in the heatmap, as `color_of_reference` in present.wgsl.
fn heatmap_color(supplier: u8) -> Color32 {
    let hue = (f32::from(supplier) * 0.618_034 + 0.58).fract();
    let channel = |shift: f32| {
        let pure = (((hue + shift).fract() * 6.0 - 3.0).abs() - 1.0).clamp(0.0, 1.0);
        ((1.0 - 0.7 + 0.7 * pure) * 0.9 * 255.0 + 0.5) as u8
    };
    Color32::from_rgb(channel(0.0), channel(2.0 / 3.0), channel(1.0 / 3.0))
}

fn actions(ui: &mut Ui, reference: &ReferenceInfo, whose: &str, commands: &mut Vec<Command>) {
    ui.spacing_mut().item_spacing.x = 4.0;
    let (id, number) = (reference.id, reference.id.0);
    let mut action = |ui: &mut Ui, text: &str, name: &str, help: &str, command: Command| {
        let button = ui.small_button(text).accessible_name(format!("{name} {whose} {number}"));
        if button.on_hover_text(help).clicked() {
            commands.push(command);
        }
    };
    action(ui, "Go", "Go to", "Move the camera to its position", Command::EaseTo(reference.camera));
    let show = Command::Inspect(InspectCommand::ShowReference(id));
    action(ui, "Show", "Show", "Show its contents over the viewport", show);
    let (text, help) = match reference.is_enabled {
        true => ("Off", "Stop using it; it stays in memory"),
        false => ("On", "Use it again"),
    };
    let name = if reference.is_enabled { "Disable" } else { "Enable" };
    let enable = Command::Inspect(InspectCommand::EnableReference(id, !reference.is_enabled));
    action(ui, text, name, help, enable);
    action(ui, "Delete", "Delete", "Remove it", Command::Remove(id));
}

fn age(secs: u64) -> String {
    match secs {
        0..60 => format!("{secs} s old"),
        60..3600 => format!("{} min old", secs / 60),
        _ => format!("{} h old", secs / 3600),
    }
}
