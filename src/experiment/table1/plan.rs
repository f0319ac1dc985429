//! The cells of Table 1.

use crate::experiment::run::{
    Cell, Effort, ExperimentContext, ExperimentError, ExperimentSettings, RunRecord,
};
use crate::render::Mode;

/// Mode and number of references of each cell. The paper has none, one and two.
pub(super) const CELLS: [(Mode, usize); 7] = [
    (Mode::Full, 0),
    (Mode::Paper, 1),
    (Mode::Paper, 2),
    (Mode::Fast, 1),
    (Mode::Fast, 2),
    (Mode::Exact, 1),
    (Mode::Exact, 2),
];

pub(crate) fn settings(effort: Effort) -> ExperimentSettings {
    let (size, repetitions, truth_samples) = match effort {
        Effort::Quick => ([128, 128], 1, 128),
        Effort::Usual => ([256, 256], 5, 4096),
    };
    ExperimentSettings { effort, size, repetitions, truth_samples, views: 1, ..ExperimentSettings::default() }
}

pub(crate) fn cells(_: &ExperimentContext<'_>) -> Vec<Cell> {
    let cell = |(mode, references): (Mode, usize)| {
        Cell(RunRecord::default().with("mode", mode.name()).with("references", references))
    };
    CELLS.into_iter().map(cell).collect()
}

/// Returns the mode and the number of references of a cell.
pub(super) fn mode_and_references(cell: &RunRecord) -> Result<(Mode, usize), ExperimentError> {
    let find = |&(mode, count): &(Mode, usize)| {
        cell.text("mode") == Some(mode.name()) && cell.number("references") == Some(count as f64)
    };
    CELLS.into_iter().find(find).ok_or_else(|| ExperimentError::UnknownCell(cell.label()))
}
