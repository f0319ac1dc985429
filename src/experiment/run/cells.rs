//! Runs the cells of a run folder.

use super::{context::ExperimentContext, error::ExperimentError, experiment::Experiment, folder::RunFolder};
use super::{identity::Cell, journal::Done};
use std::time::Instant;

/// Progress of a run.
#[derive(Clone, Copy, Debug)]
pub enum CellEvent<'a> {
    /// A cell begins. The number counts the finished cells of the shard.
    Begins(&'a Cell, usize),
    /// A cell is finished, now or in an earlier session. The number counts the finished cells of
    /// the shard.
    Done(&'a Cell, usize),
}

/// Runs the cells of the folder's shard that are not finished yet. Returns true if all are
/// finished, false after a stop; finished cells are kept.
///
/// # Errors
/// [`ExperimentError`] if a cell fails or cannot be stored. The cells before it are kept.
pub fn run_cells(
    experiment: &Experiment,
    context: &ExperimentContext<'_>,
    folder: &mut RunFolder,
    mut observe: impl FnMut(CellEvent<'_>),
) -> Result<bool, ExperimentError> {
    let identity = folder.manifest().identity.clone();
    let shard = folder.manifest().shard;
    let cells: Vec<Cell> = (experiment.cells)(context);
    let own_cells = cells.iter().enumerate().filter(|(place, _)| shard.has(*place));
    for (done, (place, cell)) in own_cells.enumerate() {
        let key = identity.key(cell);
        if !folder.has(&key) {
            observe(CellEvent::Begins(cell, done));
            let start = Instant::now();
            let records = if (context.stop)() { None } else { (experiment.run_cell)(context, &cell.0)? };
            let Some(records) = records else { return Ok(false) };
            let records = records.into_iter().map(|r| cell.0.clone().with_fields(&r)).collect();
            folder.add(Done { place, key, records, cell_secs: start.elapsed().as_secs_f64() })?;
        }
        observe(CellEvent::Done(cell, done + 1));
    }
    Ok(true)
}
