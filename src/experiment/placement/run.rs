//! The cells of the experiment, and the run of one of them.

use super::policies::{MODES, POLICIES};
use super::reference_usage::ReferenceUsage;
use super::{floor_plan, stored, summary::summary, walks, walks::WALKS};
use crate::camera::Camera;
use crate::experiment::measure::MeasureSettings;
use crate::experiment::run::{
    Cell, CellOutcome, Effort, ExperimentContext, ExperimentError, ExperimentSettings, RunRecord,
};
use crate::experiment::tour::{TourEvent, TourSettings, fly};
use crate::reference::PlacementPolicy;
use crate::render::{Mode, RenderSettings, WalkthroughSettings};

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
        warms_up: true,
    }
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
