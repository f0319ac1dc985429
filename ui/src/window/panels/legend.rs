//! The legend of the heatmap, and its controls.

use super::super::state::{AppState, Command};
use super::regions::{self, Region};
use super::widgets::{TEXT, TYPE_NAMES, key_hint, swatch};
use super::{references, statistics};
use crate::window::input::keymap::Action;
use crate::window::state::{Coloring, Heatmap};
use afterimage::{Mode, raster::pixel_types::TypePercentages};
use egui::{RichText, Ui};

/// Shows the controls and the legend.
pub fn show(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let mut options = state.options;
    ui.horizontal(|ui| {
        ui.label("Heatmap").on_hover_text(key_hint(Action::CycleHeatmap));
        for (heatmap, name) in [(Heatmap::Off, "Off"), (Heatmap::Blend, "Blend"), (Heatmap::Only, "Only")] {
            let choice = ui.selectable_value(&mut options.heatmap, heatmap, name);
            choice.accessible_name(format!("Heatmap {}", name.to_lowercase()));
        }
    });
    ui.horizontal(|ui| {
        ui.label("Colour").on_hover_text(key_hint(Action::ToggleByReference));
        ui.selectable_value(&mut options.coloring, Coloring::ByType, "By type");
        ui.selectable_value(&mut options.coloring, Coloring::ByReference, "By reference");
    });
    ui.checkbox(&mut options.has_outline, "Outline Type 3").on_hover_text(key_hint(Action::ToggleOutline));
    if options != state.options {
        commands.push(Command::SetOptions(options.with_visible_colors(&state.options)));
    }
    ui.weak(meaning(state.quality.walk.render.mode));
    let types = state.frame.as_ref().map(|f| f.stats.types);
    egui::Grid::new("legend").num_columns(3).min_col_width(14.0).show(ui, |ui| {
        let p = types.map(|t| t.percentages()).unwrap_or_default();
        let shares = [p.type1_percent, p.type2_percent, p.type3_percent];
        for (number, name) in TYPE_NAMES.into_iter().enumerate() {
            swatch(ui, number);
            ui.label(name);
            ui.label(percent(types.is_some(), shares[number]));
            ui.end_row();
        }
        for (name, help, share) in parts(&p) {
            ui.label("");
            ui.label(RichText::new(format!("   {name}")).small()).on_hover_text(help);
            ui.label(RichText::new(percent(types.is_some(), share)).small());
            ui.end_row();
        }
        swatch(ui, TYPE_NAMES.len());
        ui.label("Filled until the next frame")
            .on_hover_text("While the camera moves: the last frame does not contain this surface");
        ui.end_row();
    });
}

/// Shows the meaning of the colours over the viewport, at the lower left of `room`. Drags go
/// through it.
pub fn over_viewport(ctx: &egui::Context, room: egui::Rect, state: &AppState) {
    let area = egui::Area::new(egui::Id::unique("legend")).pivot(egui::Align2::LEFT_BOTTOM);
    area.fixed_pos(room.left_bottom()).interactable(false).show(ctx, |ui| {
        let shown = statistics::ground().show(ui, |ui| {
            ui.style_mut().interaction.selectable_labels = false;
            match state.options.coloring {
                Coloring::ByType => types_over(ui, state),
                Coloring::ByReference => references_over(ui, state),
            }
        });
        regions::readable(ui, Region::Legend, shown.response.rect, spoken(state.options.coloring));
    });
}

/// The meaning of the colours for a screen reader.
fn spoken(coloring: Coloring) -> &'static str {
    match coloring {
        Coloring::ByType => "blue is reused, yellow is mirror or glass, orange is traced",
        Coloring::ByReference => "each colour is a reference, orange is traced or mirrored",
    }
}

fn types_over(ui: &mut Ui, state: &AppState) {
    let Some(frame) = &state.frame else { return };
    let p = frame.stats.types.percentages();
    let shares = [p.type1_percent, p.type2_percent, p.type3_percent];
    for (number, name) in ["reused", "mirror or glass", "traced"].into_iter().enumerate() {
        ui.horizontal(|ui| {
            swatch(ui, number);
            ui.label(RichText::new(format!("{name} {:.0} %", shares[number])).color(TEXT));
        });
    }
}

/// Number of references in the legend over the viewport.
const MAX_OVER: usize = 8;

fn references_over(ui: &mut Ui, state: &AppState) {
    let Some(frame) = &state.frame else { return };
    for reference in frame.references.iter().rev().filter(|r| r.is_used).take(MAX_OVER) {
        ui.horizontal(|ui| {
            references::swatch(ui, reference.id);
            let percent = reference.contribution.clamp(0.0, 1.0) * 100.0;
            let text = format!("reference {}: {percent:.0} %", reference.id.0);
            ui.label(RichText::new(text).color(TEXT));
        });
    }
    ui.horizontal(|ui| {
        swatch(ui, 2);
        ui.label(RichText::new("traced or mirrored").color(TEXT));
    });
}

fn percent(is_known: bool, share: f64) -> String {
    if is_known { format!("{share:.1} %") } else { "-".to_owned() }
}

/// The two kinds of Type 3: name, explanation, and percentage of all pixels.
fn parts(p: &TypePercentages) -> [(&'static str, &'static str, f64); 2] {
    [
        ("unseen", "Traced and shaded in full: no reference contains it", p.unseen_percent),
        ("uncertain", "Looked up in references, then checked with few rays", p.uncertain_percent),
    ]
}

/// One-line explanation of a mode.
fn meaning(mode: Mode) -> &'static str {
    match mode {
        Mode::Paper => "paper: pixels are reprojected from reference images",
        Mode::Exact | Mode::Fast => {
            "A primary ray finds the surface of every pixel; its light is reused from references"
        }
        Mode::Full => "full: every pixel is traced, nothing is reused",
    }
}
