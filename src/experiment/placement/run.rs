//! Runs one walk under one policy.

use super::plan::{MODES, POLICIES};
use super::watch::Watch;
use super::{floor_plan, walks};
use crate::camera::Camera;
use crate::experiment::measure::{MeasureSettings, Measurement};
use crate::experiment::run::{CellOutcome, ExperimentContext, ExperimentError, RunRecord};
use crate::experiment::statistics::{median, percentile};
use crate::experiment::tour::{FrameRecord, TourEvent, TourRecord, TourSettings, fly};
use crate::reference::PlacementPolicy;
use crate::render::{Mode, RenderSettings, WalkthroughSettings};

/// Number of frames of a walk that are compared with converged pictures.
const MEASURED_FRAMES: u32 = 3;

pub(crate) fn run_cell(context: &ExperimentContext<'_>, cell: &RunRecord) -> CellOutcome {
    let unknown = || ExperimentError::UnknownCell(cell.label());
    let mode = MODES.into_iter().find(|m| cell.text("mode") == Some(m.name())).ok_or_else(unknown)?;
    let percent = cell.number("percent").ok_or_else(unknown)?;
    let policy =
        cell.text("rule").and_then(|rule| PlacementPolicy::named(rule, percent)).ok_or_else(unknown)?;
    let cameras = walks::cameras(context, cell.text("walk").unwrap_or_default()).ok_or_else(unknown)?;
    let settings = tour_settings(context, mode, policy, cameras.len() as u32);
    let mut watch = Watch::default();
    let tour = fly(context.tracer, &cameras, &settings, context.stop, |event| {
        if let TourEvent::Frame(record, walk) = event {
            watch.see(record.frame, walk);
        }
    })?;
    if !tour.is_complete {
        return Ok(None);
    }
    save_plan(context, cell, mode, &cameras, &watch)?;
    let mut records = vec![summary(&tour, &watch)];
    records.extend(tour.frames.iter().map(|frame| {
        RunRecord::default()
            .with("kind", "frame")
            .with("frame", frame.frame)
            .with("type3_percent", frame.types.type3_percent)
            .with("unseen_percent", frame.types.unseen_percent)
            .with("frame_secs", frame.frame_secs)
    }));
    records.extend(watch.records(cameras.len() as u32));
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
    };
    TourSettings { walkthrough, size: context.settings.size, frames, budget: None, measure: Some(measure) }
}

/// The record of the whole cell.
fn summary(tour: &TourRecord, watch: &Watch) -> RunRecord {
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
        .with("cache_mb", watch.max_bytes() as f64 / (1 << 20) as f64)
        .with("prediction_use_percent", watch.prediction_use_percent())
        .with("predictions", watch.predictions())
}

/// Saves one floor plan for each walk, mode and rule: that of the first percentage.
fn save_plan(
    context: &ExperimentContext<'_>,
    cell: &RunRecord,
    mode: Mode,
    cameras: &[Camera],
    watch: &Watch,
) -> Result<(), ExperimentError> {
    let [walk, rule] = ["walk", "rule"].map(|name| cell.text(name).unwrap_or_default());
    let policy = POLICIES.iter().find(|p| p.rule == rule);
    if policy.is_none_or(|p| cell.number("percent") != Some(p.percents(mode)[0])) {
        return Ok(());
    }
    let (size, picture) = floor_plan::draw(context.tracer, cameras, watch);
    context.save_picture(&floor_plan::file_name(mode.name(), walk, rule), size, &picture)
}
