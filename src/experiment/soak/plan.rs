//! The parts of the run and their length.

use crate::experiment::run::{Cell, Effort, ExperimentContext, ExperimentSettings, RunRecord};
use std::time::Duration;

pub(crate) fn settings(effort: Effort) -> ExperimentSettings {
    ExperimentSettings { effort, size: [320, 180], samples: 2, ..ExperimentSettings::default() }
}

/// Returns the number of parts of a run and the length of each.
pub(super) fn parts(effort: Effort) -> (u32, Duration) {
    match effort {
        Effort::Quick => (6, Duration::from_secs(5)),
        Effort::Usual => (30, Duration::from_secs(60)),
    }
}

pub(crate) fn cells(context: &ExperimentContext<'_>) -> Vec<Cell> {
    (0..parts(context.settings.effort).0).map(|part| Cell(RunRecord::default().with("part", part))).collect()
}
