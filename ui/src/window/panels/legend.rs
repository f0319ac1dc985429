//! What the colours of the heatmap mean, and its switches.

use super::super::keymap::{Action, keys_of};
use super::super::presentation::{Coloring, Heatmap};
use super::super::state::{Command, Options, State};
use super::{TYPE_NAMES, swatch};
use egui::Ui;

/// Shows switches and legend.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Vec<Command>) {
    let mut options = state.options;
    ui.horizontal(|ui| {
        ui.label("Heatmap").on_hover_text(format!("Key {}", keys_of(Action::CycleHeatmap)));
        for (heatmap, name) in [(Heatmap::Off, "Off"), (Heatmap::Blend, "Blend"), (Heatmap::Only, "Only")] {
            ui.selectable_value(&mut options.heatmap, heatmap, name);
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
        commands.push(Command::SetOptions(shown(options, &state.options)));
    }
    let percent = state.frame.as_ref().map(|f| {
        let p = f.stats.types.percentages();
        [p.type1_percent, p.type2_percent, p.type3_percent]
    });
    egui::Grid::new("legend").num_columns(3).min_col_width(14.0).show(ui, |ui| {
        for (number, name) in TYPE_NAMES.into_iter().enumerate() {
            swatch(ui, number);
            ui.label(name);
            ui.label(percent.map_or("-".to_owned(), |p| format!("{:.1} %", p[number])));
            ui.end_row();
        }
        swatch(ui, TYPE_NAMES.len());
        ui.label("Filled until the next frame")
            .on_hover_text("While you move: the last frame did not see it");
        ui.end_row();
    });
}

/// Who asks for another colouring wants to see it.
pub fn shown(wanted: Options, before: &Options) -> Options {
    let is_unseen = wanted.coloring != before.coloring && wanted.heatmap == Heatmap::Off;
    Options { heatmap: if is_unseen { Heatmap::Blend } else { wanted.heatmap }, ..wanted }
}
