//! Messages and loading progress over the viewport.

use super::super::state::{AppState, Command, Notice, Severity};
use super::regions::{self, Region};
use crate::window::rendering::{scene_loading::SceneSource, task::Progress};
use egui::{Align2, Color32, ProgressBar, Rect, RichText, Ui};
use std::path::Path;

/// Shows messages and progress at the bottom of the viewport; statistics are at the top.
pub fn show(ctx: &egui::Context, viewport: Rect, state: &AppState, commands: &mut Vec<Command>) {
    if !state.notices.is_empty() {
        let above = if state.loading.is_some() { 90.0 } else { 56.0 };
        let at = viewport.center_bottom() - egui::vec2(0.0, above);
        area("notices", at, Align2::CENTER_BOTTOM).show(ctx, |ui| {
            regions::name(ui, Region::Messages);
            for notice in &state.notices {
                banner(ui, viewport.width(), notice, commands);
            }
        });
    }
    if let Some((source, progress)) = &state.loading {
        let at = viewport.center_bottom() - egui::vec2(0.0, 16.0);
        area("loading", at, Align2::CENTER_BOTTOM).show(ctx, |ui| loading(ui, source, progress, commands));
    }
}

fn area(name: &str, at: egui::Pos2, pivot: Align2) -> egui::Area {
    egui::Area::new(egui::Id::unique(name)).fixed_pos(at).pivot(pivot).order(egui::Order::Foreground)
}

fn banner(ui: &mut Ui, viewport_width: f32, notice: &Notice, commands: &mut Vec<Command>) {
    let (fill, name) = match notice.severity {
        Severity::Error => (Color32::from_rgb(130, 28, 28), "Error: "),
        Severity::Warning => (Color32::from_rgb(112, 72, 0), "Warning: "),
        Severity::Info => (Color32::from_rgb(28, 78, 52), ""),
    };
    egui::Frame::new().fill(fill).corner_radius(6.0).inner_margin(egui::Margin::symmetric(12, 8)).show(
        ui,
        |ui| {
            ui.set_max_width((viewport_width * 0.7).max(120.0));
            ui.horizontal_top(|ui| {
                let text = RichText::new(format!("{name}{}", notice.text)).color(Color32::WHITE);
                let buttons = if notice.file.is_some() { 220.0 } else { 70.0 };
                let width = (ui.available_width() - buttons).max(80.0);
                ui.scope(|ui| {
                    ui.set_max_width(width);
                    ui.add(egui::Label::new(text).wrap());
                });
                if let Some(file) = &notice.file {
                    open_buttons(ui, file, commands);
                }
                let dismiss = ui.button("Dismiss");
                regions::note(&dismiss, Region::Messages);
                if dismiss.clicked() {
                    commands.push(Command::Dismiss(notice.id));
                }
            });
        },
    );
    ui.add_space(4.0);
}

/// Shows buttons that open a saved file, or the folder that holds it, with the system's programs.
fn open_buttons(ui: &mut Ui, file: &Path, commands: &mut Vec<Command>) {
    if ui.button("Open").accessible_name("Open the saved file").clicked() {
        commands.push(Command::OpenOutside(file.to_owned()));
    }
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty());
    if let Some(folder) = folder.filter(|_| ui.button("Show in folder").clicked()) {
        commands.push(Command::OpenOutside(folder.to_owned()));
    }
}

fn loading(ui: &mut Ui, source: &SceneSource, progress: &Progress, commands: &mut Vec<Command>) {
    super::statistics::ground().show(ui, |ui| {
        ui.set_width(340.0);
        ui.label(RichText::new(format!("Loading {}", source.label())).color(Color32::WHITE));
        ui.horizontal(|ui| {
            let percent = progress.fraction.map(|f| format!(" {:.0} %", f * 100.0)).unwrap_or_default();
            let bar = ProgressBar::new(progress.fraction.unwrap_or(0.0));
            ui.add(bar.text(format!("{}{percent}", progress.phase)).desired_width(265.0));
            let cancel = ui.button("Cancel");
            regions::note(&cancel, Region::Messages);
            if cancel.clicked() {
                commands.push(Command::CancelLoading);
            }
        });
    });
}

/// Shows what dropping a file will do.
pub fn drop_hint(ui: &Ui, viewport: Rect) {
    ui.painter().rect_filled(viewport, 0.0, Color32::from_black_alpha(170));
    let font = egui::FontId::proportional(24.0);
    ui.painter().text(
        viewport.center(),
        Align2::CENTER_CENTER,
        "Drop to open the file",
        font,
        Color32::WHITE,
    );
}
