//! The axes along which frame time is measured.

use crate::experiment::run::{Cell, Effort, ExperimentContext, ExperimentSettings, RunRecord};
use crate::render::Mode;

pub(super) const MODES: [Mode; 4] = [Mode::Full, Mode::Paper, Mode::Exact, Mode::Fast];

/// Names of the axes and their values; the quick effort leaves out the last value.
pub(super) const AXES: [(&str, &[u32]); 5] = [
    ("triangles", &[100_000, 316_000, 1_000_000, 3_160_000, 10_000_000]),
    ("pixels", &[160 * 90, 320 * 180, 640 * 360, 1280 * 720]),
    ("references", &[1, 2, 4, 8]),
    ("lights", &[1, 2, 4, 8, 16]),
    ("samples", &[1, 4, 16, 64]),
];

pub(crate) fn settings(effort: Effort) -> ExperimentSettings {
    let (size, repetitions, samples) = match effort {
        Effort::Quick => ([160, 90], 3, 4),
        Effort::Usual => ([640, 360], 5, 8),
    };
    ExperimentSettings { effort, size, repetitions, samples, views: 1, ..ExperimentSettings::default() }
}

pub(crate) fn cells(context: &ExperimentContext<'_>) -> Vec<Cell> {
    let threads: Vec<u32> = (1..=rayon::current_num_threads() as u32).collect();
    let is_quick = context.settings.effort == Effort::Quick;
    let mut cells = Vec::new();
    for (axis, values) in AXES {
        let values = if is_quick { &values[..values.len() - 1] } else { values };
        cells.extend(values.iter().map(|value| cell(axis, *value)));
    }
    cells.extend(threads.into_iter().filter(|n| n.is_power_of_two()).map(|value| cell("threads", value)));
    cells
}

fn cell(axis: &str, value: u32) -> Cell {
    Cell(RunRecord::default().with("axis", axis).with("value", value))
}
