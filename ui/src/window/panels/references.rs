//! The references held: what they are worth, where they stand.

use super::super::frames::ReferenceInfo;
use super::super::keymap::{Action, keys_of};
use super::super::state::{Command, Options, State, Work};
use egui::{ProgressBar, RichText, Ui};

/// Shows buttons and list.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    buttons(ui, state, commands);
    let Some(frame) = &state.frame else {
        ui.weak("None yet.");
        return;
    };
    let [bytes, limit] = frame.cache_bytes;
    let share = bytes as f32 / limit.max(1) as f32;
    let megabytes = |bytes: usize| bytes as f64 / f64::from(1 << 20);
    let (count, used) = (frame.references.len(), megabytes(bytes));
    let text = format!("{count} held, {used:.0} of {:.0} MB", megabytes(limit));
    ui.add(ProgressBar::new(share.min(1.0)).text(RichText::new(text).small()).desired_height(16.0));
    if frame.references.is_empty() {
        ui.weak(if state.work == Work::AddingReference {
            "The first one is being traced."
        } else {
            "None yet."
        });
    }
    egui::ScrollArea::vertical().id_salt("references").max_height(LIST_HEIGHT).show(ui, |ui| {
        for reference in frame.references.iter().rev() {
            ui.separator();
            entry(ui, reference, commands);
        }
    });
}

/// Three references and a bit: that there are more is seen, and the plots stay within reach.
const LIST_HEIGHT: f32 = 230.0;

fn buttons(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        let button = |ui: &mut Ui, text: &str, action, help: &str| {
            ui.button(text).on_hover_text(format!("{help} (key {})", keys_of(action))).clicked()
        };
        if button(ui, "Add here", Action::AddReference, "Trace a reference from where you are") {
            commands.push(Command::AddReference);
        }
        if button(ui, "Clear...", Action::ClearCache, "Drop all references") {
            commands.push(Command::AskToClear);
        }
        let is_paused = state.options.is_paused;
        let text = if is_paused { "Resume" } else { "Pause" };
        if button(ui, text, Action::Pause, "Stop rendering, or go on") {
            commands.push(Command::SetOptions(Options { is_paused: !is_paused, ..state.options }));
        }
    });
}

fn entry(ui: &mut Ui, reference: &ReferenceInfo, commands: &mut Vec<Command>) {
    let number = reference.id.0;
    ui.horizontal(|ui| {
        let name = RichText::new(format!("#{number}"));
        ui.label(if reference.is_used { name.strong() } else { name.weak() })
            .on_hover_text(if reference.is_used { "used by this frame" } else { "not used by this frame" });
        ui.weak(age(reference.added.elapsed().as_secs()));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let delete = ui.small_button("Delete").accessible_name(format!("Delete reference {number}"));
            if delete.clicked() {
                commands.push(Command::Remove(reference.id));
            }
            let go = ui.small_button("Go there").accessible_name(format!("Go to reference {number}"));
            if go.clicked() {
                commands.push(Command::EaseTo(reference.camera));
            }
        });
    });
    let share = reference.contribution.clamp(0.0, 1.0);
    let text = RichText::new(format!("supplies {:.0} %", share * 100.0)).small();
    ui.add(ProgressBar::new(share).text(text).desired_height(14.0));
    let eye = reference.camera.eye;
    let [width, height] = reference.size;
    let place = format!("{:.2}, {:.2}, {:.2} m   {width} x {height}", eye.x, eye.y, eye.z);
    ui.label(RichText::new(place).small().weak());
}

fn age(secs: u64) -> String {
    match secs {
        0..60 => format!("{secs} s old"),
        60..3600 => format!("{} min old", secs / 60),
        _ => format!("{} h old", secs / 3600),
    }
}
