//! The walks, modes, rules and thresholds that are compared, and the run of one of them.

use super::{floor_plan, stored, walks};
use super::{reference_usage::ReferenceUsage, walks::WALKS};
use crate::camera::Camera;
use crate::experiment::measure::{MeasureSettings, Measurement};
use crate::experiment::run::{
    Cell, CellOutcome, Effort, ExperimentContext, ExperimentError, ExperimentSettings, RunRecord,
};
use crate::experiment::statistics::{median, percentile};
use crate::experiment::tour::{FrameRecord, TourEvent, TourRecord, TourSettings, fly};
use crate::raster::exposure::decimal;
use crate::reference::PlacementPolicy;
use crate::render::{Mode, RenderSettings, WalkthroughSettings};

pub(super) const MODES: [Mode; 2] = [Mode::Paper, Mode::Exact];

/// A placement rule and the percentages at which it is measured. Above 20 %, and for sparse
/// references below 1 %, the percentage alone decides whether a reference is worth tracing.
pub(super) struct Policy {
    pub(super) rule: &'static str,
    /// Percentages for the dense references of the paper; the quick effort takes the first.
    dense: &'static [f64],
    /// Percentages for the sparse references of the look-up; the quick effort takes the first.
    sparse: &'static [f64],
}

impl Policy {
    /// The percentages for the references of a mode.
    pub(super) fn percents(&self, mode: Mode) -> &'static [f64] {
        if mode.looks_up() { self.sparse } else { self.dense }
    }
}

/// The rules and thresholds that are compared.
pub(super) const POLICIES: &[Policy] = &[
    Policy { rule: "threshold", dense: &[5.0, 2.0, 10.0, 20.0, 40.0], sparse: &[1.0, 0.25, 4.0, 16.0] },
    Policy { rule: "predictive", dense: &[5.0, 30.0, 50.0], sparse: &[1.0, 0.25, 0.0625] },
    Policy { rule: "greedy", dense: &[5.0, 30.0, 50.0], sparse: &[1.0, 0.25, 0.0625] },
    Policy { rule: "grid", dense: &[0.0], sparse: &[0.0] },
    Policy { rule: "none", dense: &[0.0], sparse: &[0.0] },
];

pub(crate) fn settings(effort: Effort) -> ExperimentSettings {
    let usual = ExperimentSettings { effort, views: 1, repetitions: 1, ..Default::default() };
    let (size, frames, samples, truth_samples) = match effort {
        Effort::Quick => ([160, 90], 24, 1, 16),
        Effort::Usual => ([320, 180], 80, 4, 256),
    };
    ExperimentSettings { size, frames, samples, truth_samples, ..usual }
}

pub(crate) fn cells(context: &ExperimentContext<'_>) -> Vec<Cell> {
    let is_quick = context.settings.effort == Effort::Quick;
    let mut cells = Vec::new();
    for mode in MODES {
        for (walk, _) in WALKS {
            for policy in POLICIES {
                let percents = policy.percents(mode);
                let count = if is_quick { 1 } else { percents.len() };
                let record = RunRecord::default().with("mode", mode.name()).with("walk", walk);
                let record = record.with("rule", policy.rule);
                cells.extend(percents[..count].iter().map(|p| Cell(record.clone().with("percent", *p))));
            }
        }
    }
    cells.extend(stored::cells());
    cells
}

/// Number of frames of a walk that are compared with converged pictures.
const MEASURED_FRAMES: u32 = 3;

pub(crate) fn run_cell(context: &ExperimentContext<'_>, cell: &RunRecord) -> CellOutcome {
    let unknown = || ExperimentError::UnknownCell { experiment: "placement", cell: cell.label() };
    let mode = MODES.into_iter().find(|m| cell.text("mode") == Some(m.name())).ok_or_else(unknown)?;
    let percent = cell.number("percent").ok_or_else(unknown)?;
    let policy =
        cell.text("rule").and_then(|rule| PlacementPolicy::named(rule, percent)).ok_or_else(unknown)?;
    let cameras = walks::cameras(context, cell.text("walk").unwrap_or_default()).ok_or_else(unknown)?;
    let settings = tour_settings(context, mode, policy, cameras.len() as u32);
    if let Some(store) = cell.text("store") {
        return stored::run(context, (&cameras, &settings), store);
    }
    let mut usage = ReferenceUsage::default();
    let tour = fly(context.tracer, &cameras, &settings, context.stop, |event| {
        if let TourEvent::Frame(record, walk) = event {
            usage.see(record.frame, walk);
        }
    })?;
    if !tour.is_complete {
        return Ok(None);
    }
    save_plan(context, cell, mode, &cameras, &usage)?;
    let mut records = vec![summary(&tour, &usage)];
    records.extend(tour.frames.iter().map(|frame| {
        RunRecord::default()
            .with("kind", "frame")
            .with("frame", frame.frame)
            .with("type3_percent", frame.types.type3_percent)
            .with("unseen_percent", frame.types.unseen_percent)
            .with("frame_secs", frame.frame_secs)
    }));
    records.extend(usage.records(cameras.len() as u32));
    Ok(Some(records))
}

fn tour_settings(
    context: &ExperimentContext<'_>,
    mode: Mode,
    placement: PlacementPolicy,
    frames: u32,
) -> TourSettings {
    let walkthrough = WalkthroughSettings {
        render: RenderSettings { mode, trace: context.settings.trace() },
        placement,
        cache_bytes: context.settings.cache_bytes(),
        ..WalkthroughSettings::default()
    };
    let measure = MeasureSettings {
        every: frames.div_ceil(MEASURED_FRAMES),
        truth_samples: context.settings.truth_samples,
        truth_folder: context.truth_folder.map(Into::into),
        exposure_ev: context.settings.exposure_ev,
    };
    TourSettings {
        walkthrough,
        size: context.settings.size,
        frames,
        budget: None,
        measure: Some(measure),
        store: None,
    }
}

/// The record of the whole cell.
pub(super) fn summary(tour: &TourRecord, usage: &ReferenceUsage) -> RunRecord {
    let frames = &tour.frames;
    let of = |value: fn(&FrameRecord) -> f64| frames.iter().map(value);
    let mean =
        |value: fn(&FrameRecord) -> f64| of(value).fold(0.0, |a, b| a + b) / frames.len().max(1) as f64;
    let in_references: u64 = tour.references.iter().map(|r| r.rays.total()).sum();
    let in_frames: u64 = frames.iter().map(|f| f.rays.total()).sum();
    let measured = |value: fn(&Measurement) -> f64| {
        median(frames.iter().filter_map(|f| f.measurement.as_ref()).map(value))
    };
    let tracing_secs = tour.reference_secs_total + of(|f| f.trace_secs + f.secondary_secs).sum::<f64>();
    RunRecord::default()
        .with("kind", "summary")
        .with("references", tour.references_added)
        .with("reference_secs", tour.reference_secs_total)
        .with("tracing_secs", tracing_secs)
        .with("reference_mrays", in_references as f64 / 1e6)
        .with("traced_mrays", (in_references + in_frames) as f64 / 1e6)
        .with("type3_percent", mean(|f| f.types.type3_percent))
        .with("unseen_percent", mean(|f| f.types.unseen_percent))
        .with("unseen_p95_percent", percentile(of(|f| f.types.unseen_percent), 95.0))
        .with("frame_secs", median(of(|f| f.frame_secs)))
        .with("frame_p99_secs", percentile(of(|f| f.frame_secs), 99.0))
        .with("psnr_db", measured(|m| m.psnr_db))
        .with("flip_mean", measured(|m| m.flip_mean))
        .with("exposure_ev", measured(|m| decimal(m.exposure_ev)))
        .with("cache_mb", usage.max_bytes() as f64 / (1 << 20) as f64)
        .with("prediction_use_percent", usage.prediction_use_percent())
        .with("predictions", usage.predictions())
}

/// Saves one floor plan for each walk, mode and rule: that of the first percentage.
fn save_plan(
    context: &ExperimentContext<'_>,
    cell: &RunRecord,
    mode: Mode,
    cameras: &[Camera],
    usage: &ReferenceUsage,
) -> Result<(), ExperimentError> {
    let [walk, rule] = ["walk", "rule"].map(|name| cell.text(name).unwrap_or_default());
    let policy = POLICIES.iter().find(|p| p.rule == rule);
    if policy.is_none_or(|p| cell.number("percent") != Some(p.percents(mode)[0])) {
        return Ok(());
    }
    let (size, picture) = floor_plan::draw(context.tracer, cameras, usage);
    context.save_picture(&floor_plan::file_name(mode.name(), walk, rule), size, &picture)
}
