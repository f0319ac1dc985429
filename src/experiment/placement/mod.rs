//! Where references should stand: every placement rule on the same walks.
//!
//! A cell is a walk in a mode under a policy. What is compared is what the viewer waits for (pixels that no reference
//! knows) with no more tracing, in frames and references together: a rule that traces more may well know more.

mod plan;
mod report;
mod walks;
mod watch;

use crate::camera::Camera;
use crate::experiment::measure::MeasureSettings;
use crate::experiment::record::TourRecord;
use crate::experiment::run::{
    Cell, CellOutcome, Effort, Experiment, ExperimentContext, ExperimentError, ExperimentSettings, RunRecord,
};
use crate::experiment::statistics::{median, percentile};
use crate::experiment::tour::{TourEvent, TourSettings, fly};
use crate::reference::PlacementPolicy;
use crate::render::{Mode, RenderSettings, WalkthroughSettings};
use watch::Watch;

/// See the module.
pub(crate) const EXPERIMENT: Experiment = Experiment {
    name: "placement",
    about: "where references should stand: all rules on the same walks",
    settings,
    cells,
    run_cell,
    report: report::report,
};

const MODES: [Mode; 2] = [Mode::Paper, Mode::Exact];

/// Rule, percentages for the paper's references, percentages for sparse ones; the quick effort takes the first of each.
/// Above 20 % and, for sparse ones, below 1 % the percentage itself decides what is worth a reference.
const POLICIES: [(&str, &[f64], &[f64]); 5] = [
    ("threshold", &[5.0, 2.0, 10.0, 20.0, 40.0], &[1.0, 0.25, 4.0, 16.0]),
    ("predictive", &[5.0, 30.0, 50.0], &[1.0, 0.25, 0.0625]),
    ("greedy", &[5.0, 30.0, 50.0], &[1.0, 0.25, 0.0625]),
    ("grid", &[0.0], &[0.0]),
    ("none", &[0.0], &[0.0]),
];

/// Frames of a walk that are measured against the truth.
const MEASURED: u32 = 3;

fn settings(effort: Effort) -> ExperimentSettings {
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

fn cells(context: &ExperimentContext<'_>) -> Vec<Cell> {
    let is_quick = context.settings.effort == Effort::Quick;
    let mut cells = Vec::new();
    for mode in MODES {
        for (walk, _) in walks::WALKS {
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

fn run_cell(context: &ExperimentContext<'_>, cell: &RunRecord) -> CellOutcome {
    let unknown = || ExperimentError::Unsuitable(format!("placement has no cell '{}'", cell.label()));
    let mode = MODES.into_iter().find(|m| cell.text("mode") == Some(m.name())).ok_or_else(unknown)?;
    let percent = cell.number("percent").ok_or_else(unknown)?;
    let policy =
        cell.text("rule").and_then(|rule| PlacementPolicy::named(rule, percent)).ok_or_else(unknown)?;
    let cameras = walks::cameras(context, cell.text("walk").unwrap_or_default()).ok_or_else(unknown)?;
    let settings = tour_settings(context, mode, policy, cameras.len() as u32);
    let mut watch = Watch::default();
    let flown = fly(context.tracer, &cameras, &settings, context.stop, |event| {
        if let TourEvent::Frame(record, walk) = event {
            watch.see(record.frame, walk);
        }
    });
    let tour = flown.map_err(|e| ExperimentError::Unsuitable(e.to_string()))?;
    if !tour.is_complete {
        return Ok(None);
    }
    save_plan(context, cell, &cameras, &watch)?;
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
        cache_bytes: usize::try_from(context.settings.cache_mb << 20).unwrap_or(usize::MAX),
        ..WalkthroughSettings::default()
    };
    let measure = MeasureSettings {
        every: frames.div_ceil(MEASURED),
        truth_samples: context.settings.truth_samples,
        truth_folder: context.truth_folder.map(Into::into),
    };
    TourSettings { walkthrough, size: context.settings.size, frames, budget: None, measure: Some(measure) }
}

/// The line of a cell.
fn summary(tour: &TourRecord, watch: &Watch) -> RunRecord {
    let frames = &tour.frames;
    let mean =
        |values: &mut dyn Iterator<Item = f64>| values.fold(0.0, |a, b| a + b) / frames.len().max(1) as f64;
    let unseen = || frames.iter().map(|f| f.types.unseen_percent);
    let in_references: u64 = tour.references.iter().map(|r| r.rays.total()).sum();
    let in_frames: u64 = frames.iter().map(|f| f.rays.total()).sum();
    let measured = |of: fn(&crate::experiment::Measurement) -> f64| {
        median(frames.iter().filter_map(|f| f.measurement.as_ref()).map(of))
    };
    RunRecord::default()
        .with("kind", "summary")
        .with("references", tour.references_added)
        .with("reference_secs", tour.reference_secs_total)
        .with(
            "tracing_secs",
            tour.reference_secs_total + frames.iter().map(|f| f.trace_secs + f.secondary_secs).sum::<f64>(),
        )
        .with("reference_mrays", in_references as f64 / 1e6)
        .with("traced_mrays", (in_references + in_frames) as f64 / 1e6)
        .with("type3_percent", mean(&mut frames.iter().map(|f| f.types.type3_percent)))
        .with("unseen_percent", mean(&mut unseen()))
        .with("unseen_p95_percent", percentile(unseen(), 95.0))
        .with("frame_secs", median(frames.iter().map(|f| f.frame_secs)))
        .with("frame_p99_secs", percentile(frames.iter().map(|f| f.frame_secs), 99.0))
        .with("psnr_db", measured(|m| m.psnr_db))
        .with("flip_mean", measured(|m| m.flip_mean))
        .with("cache_mb", watch.most_bytes() as f64 / (1 << 20) as f64)
        .with("prediction_use_percent", watch.prediction_use_percent())
        .with("predictions", watch.predictions())
}

/// One picture for each walk, mode and rule: that of the percentage named first.
fn save_plan(
    context: &ExperimentContext<'_>,
    cell: &RunRecord,
    cameras: &[Camera],
    watch: &Watch,
) -> Result<(), ExperimentError> {
    let [mode, walk, rule] = ["mode", "walk", "rule"].map(|name| cell.text(name).unwrap_or_default());
    let usual = |p: &&(&str, &[f64], &[f64])| p.0 == rule;
    let Some((_, dense, sparse)) = POLICIES.iter().find(usual) else { return Ok(()) };
    let first = if mode == Mode::Paper.name() { dense[0] } else { sparse[0] };
    if cell.number("percent") != Some(first) {
        return Ok(());
    }
    let (size, picture) = plan::draw(context.tracer, cameras, watch);
    context.save_picture(&plan::file_name(mode, walk, rule), size, &picture)
}
