//! The walks, modes and policies that are compared.

use super::walks::WALKS;
use crate::experiment::run::{Cell, Effort, ExperimentContext, ExperimentSettings, RunRecord};
use crate::render::Mode;

pub(super) const MODES: [Mode; 2] = [Mode::Paper, Mode::Exact];

/// Rule, percentages for the paper's references, percentages for sparse ones; the quick effort takes the first of each.
/// Above 20 % and, for sparse ones, below 1 % the percentage itself decides what is worth a reference.
pub(super) const POLICIES: [(&str, &[f64], &[f64]); 5] = [
    ("threshold", &[5.0, 2.0, 10.0, 20.0, 40.0], &[1.0, 0.25, 4.0, 16.0]),
    ("predictive", &[5.0, 30.0, 50.0], &[1.0, 0.25, 0.0625]),
    ("greedy", &[5.0, 30.0, 50.0], &[1.0, 0.25, 0.0625]),
    ("grid", &[0.0], &[0.0]),
    ("none", &[0.0], &[0.0]),
];

pub(crate) fn settings(effort: Effort) -> ExperimentSettings {
    let (size, frames, samples, truth_samples) = match effort {
        Effort::Quick => ([160, 90], 24, 1, 16),
        Effort::Usual => ([320, 180], 80, 4, 256),
    };
    ExperimentSettings {
        effort,
        size,
        frames,
        samples,
        truth_samples,
        views: 1,
        repetitions: 1,
        ..Default::default()
    }
}

pub(crate) fn cells(context: &ExperimentContext<'_>) -> Vec<Cell> {
    let is_quick = context.settings.effort == Effort::Quick;
    let mut cells = Vec::new();
    for mode in MODES {
        for (walk, _) in WALKS {
            for (rule, dense, sparse) in POLICIES {
                let percents = if mode.looks_up() { sparse } else { dense };
                let count = if is_quick { 1 } else { percents.len() };
                cells.extend(percents[..count].iter().map(|percent| cell(mode, walk, rule, *percent)));
            }
        }
    }
    cells
}

fn cell(mode: Mode, walk: &str, rule: &str, percent: f64) -> Cell {
    let record = RunRecord::default().with("mode", mode.name()).with("walk", walk);
    Cell(record.with("rule", rule).with("percent", percent))
}
