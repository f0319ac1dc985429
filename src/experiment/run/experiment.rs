//! An experiment as data: a name and four functions.

use super::identity::{Cell, Identity};
use super::settings::{Effort, ExperimentSettings};
use super::{context::ExperimentContext, error::ExperimentError, record::RunRecord, report::Report};
use crate::trace::BounceLimit;

/// A named experiment. The command line and the run folder need nothing else to run it.
#[derive(Clone, Copy, Debug)]
pub struct Experiment {
    /// Name on the command line.
    pub name: &'static str,
    /// Description in one line.
    pub about: &'static str,
    /// Limit of diffuse bounces that no flag changes; `None` where the settings decide.
    pub fixed_bounces: Option<BounceLimit>,
    /// Returns the default settings of an effort.
    pub settings: fn(Effort) -> ExperimentSettings,
    /// Lists the cells, in an order that depends on the settings alone.
    pub cells: fn(&ExperimentContext<'_>) -> Vec<Cell>,
    /// Runs one cell and returns its records.
    pub run_cell: fn(&ExperimentContext<'_>, &RunRecord) -> CellOutcome,
    /// Builds the report from the records of the finished cells.
    pub report: fn(&Identity, &[RunRecord]) -> Report,
}

/// The records of a cell; `None` if the run was stopped before the cell was finished.
pub type CellOutcome = Result<Option<Vec<RunRecord>>, ExperimentError>;
