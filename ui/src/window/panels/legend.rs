//! What the colours of the heatmap mean, and its switches.

use super::super::state::{AppState, Command};
use super::{TYPE_NAMES, swatch};
use crate::window::gpu::presentation::{Coloring, Heatmap};
use crate::window::input::keymap::{Action, keys_of};
use afterimage::Mode;
use afterimage::raster::pixel_types::TypeCounts;
use egui::{RichText, Ui};

/// Shows switches and legend.
pub fn show(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let mut options = state.options;
    ui.horizontal(|ui| {
        ui.label("Heatmap").on_hover_text(format!("Key {}", keys_of(Action::CycleHeatmap)));
        for (heatmap, name) in [(Heatmap::Off, "Off"), (Heatmap::Blend, "Blend"), (Heatmap::Only, "Only")] {
            let choice = ui.selectable_value(&mut options.heatmap, heatmap, name);
            choice.accessible_name(format!("Heatmap {}", name.to_lowercase()));
        }
    });
    ui.horizontal(|ui| {
        ui.label("Colour").on_hover_text(format!("Key {}", keys_of(Action::ToggleByReference)));
        ui.selectable_value(&mut options.coloring, Coloring::ByType, "By type");
        ui.selectable_value(&mut options.coloring, Coloring::ByReference, "By reference");
    });
    ui.checkbox(&mut options.has_outline, "Outline Type 3")
        .on_hover_text(format!("Key {}", keys_of(Action::ToggleOutline)));
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
        for (name, help, share) in parts(&types.unwrap_or_default()) {
            ui.label("");
            ui.label(RichText::new(format!("   {name}")).small()).on_hover_text(help);
            ui.label(RichText::new(percent(types.is_some(), share)).small());
            ui.end_row();
        }
        swatch(ui, TYPE_NAMES.len());
        ui.label("Filled until the next frame")
            .on_hover_text("While you move: the last frame did not see it");
        ui.end_row();
    });
}

fn percent(is_known: bool, share: f64) -> String {
    if is_known { format!("{share:.1} %") } else { "-".to_owned() }
}

/// Type 3 by what is done about it, in percent of all pixels.
fn parts(types: &TypeCounts) -> [(&'static str, &'static str, f64); 2] {
    let all = types.reused + types.secondary + types.unseen + types.uncertain;
    let share = |count: usize| 100.0 * count as f64 / all.max(1) as f64;
    [
        ("uncertain", "Traced and looked up, then checked by few rays", share(types.uncertain)),
        ("unseen", "Traced and lit in full: no reference saw it", share(types.unseen)),
    ]
}

/// What the types stand for in a mode.
fn meaning(mode: Mode) -> &'static str {
    match mode {
        Mode::Paper => "paper: pixels are moved here from reference pictures",
        Mode::Exact | Mode::Fast => "Every surface is met by a ray; what is reused is the light on it",
        Mode::Full => "full: nothing is reused, every pixel is traced",
    }
}
