//! Times every stage on one view.

use super::figures::measure_throughput;
use super::plan::ThroughputSettings;
use crate::experiment::run::{CellOutcome, ExperimentContext, RunRecord};

pub(crate) fn run_cell(context: &ExperimentContext<'_>, _: &RunRecord) -> CellOutcome {
    let camera = context.camera_on_walk(0.0)?;
    let settings =
        ThroughputSettings { camera, size: context.settings.size, trace: context.settings.trace() };
    let measured = measure_throughput(context.tracer, &settings, context.stop, |_| ());
    Ok(measured.map(|(figures, _)| vec![RunRecord::default().with_fields(&figures)]))
}
