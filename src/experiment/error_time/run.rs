//! Measures one cell.

use super::pictures;
use super::plan::{REUSING, SPACING, poses, view_share};
use crate::experiment::measure::{Errors, References, Trial, truth_of};
use crate::experiment::run::{CellOutcome, ExperimentContext, ExperimentError, RunRecord};
use crate::experiment::tour::{TourEvent, TourSettings, run_tour};
use crate::render::{Frame, Mode, RenderSettings, Renderer, WalkthroughSettings};
use crate::trace::TraceSettings;
use std::sync::atomic::{AtomicBool, Ordering};

pub(crate) fn run_cell(context: &ExperimentContext<'_>, cell: &RunRecord) -> CellOutcome {
    let trace = |samples: f64| TraceSettings { samples: samples as u32, ..context.settings.trace() };
    let unknown = || ExperimentError::UnknownCell { experiment: "error-time", cell: cell.label() };
    match (cell.text("kind"), cell.number("samples"), cell.number("references")) {
        (Some("pictures"), _, _) => pictures::run(context),
        (Some("still"), Some(samples), Some(count)) => still(context, count as usize, trace(samples)),
        (Some("flown"), Some(samples), _) => {
            let mode =
                REUSING.into_iter().find(|m| cell.text("mode") == Some(m.name())).ok_or_else(unknown)?;
            flown(context, mode, trace(samples))
        }
        _ => Err(unknown()),
    }
}

/// Measures every view: in full without references, and in every other mode with them.
fn still(context: &ExperimentContext<'_>, count: usize, trace: TraceSettings) -> CellOutcome {
    let modes: &[Mode] = if count == 0 { &[Mode::Full] } else { &REUSING };
    let mut records = Vec::new();
    for view in 0..context.settings.views {
        let (camera, poses) = poses(context, view_share(context, view), count)?;
        let Some(truth) = truth_of(context, &camera) else { return Ok(None) };
        let Some(references) = References::trace(context, &poses, &trace) else { return Ok(None) };
        for &mode in modes {
            let trial = Trial { mode, trace, camera, references: &references };
            let Some(found) = trial.measure(context, &truth, &mut Renderer::default())? else {
                return Ok(None);
            };
            let spread = spread_secs(references.secs(mode), count, context.settings.frames);
            records.extend(found.into_iter().map(|r| {
                r.with("mode", mode.name()).with("view", view).with("spread_reference_secs", spread)
            }));
        }
    }
    Ok(Some(records))
}

/// Returns the share of reference time that every frame pays if references stand at [`SPACING`]
/// along the whole walk.
fn spread_secs(reference_secs: f64, count: usize, frames: u32) -> f64 {
    let stands = (1.0 / SPACING).round() + 1.0;
    reference_secs / count.max(1) as f64 * stands / f64::from(frames.max(1))
}

/// Flies the walk with the default placement policy. As many frames are measured as there are
/// views.
fn flown(context: &ExperimentContext<'_>, mode: Mode, trace: TraceSettings) -> CellOutcome {
    let walkthrough = WalkthroughSettings {
        render: RenderSettings { mode, trace },
        cache_bytes: context.settings.cache_bytes(),
        ..WalkthroughSettings::default()
    };
    let frames = context.settings.frames;
    let settings = TourSettings {
        walkthrough,
        size: context.settings.size,
        frames,
        budget: None,
        measure: None,
        store: None,
        warms_up: true,
    };
    let measured: Vec<u32> =
        (0..context.settings.views).map(|v| (view_share(context, v) * f64::from(frames)) as u32).collect();
    let (cancel, mut records, mut failure) = (AtomicBool::new(false), Vec::new(), None);
    let tour = run_tour(context.tracer, context.walk, &settings, &cancel, |event| {
        let TourEvent::Frame(record, walk) = event else { return };
        let mut flat = RunRecord::default()
            .with("frame", record.frame)
            .with("frame_secs", record.frame_secs)
            .with("flown_reference_secs", record.reference_secs)
            .with("references_held", record.references_held)
            .with_fields(&record.types);
        if measured.contains(&record.frame) {
            match errors(context, walk.frame()) {
                Ok(Some(found)) => flat = flat.with_fields(&found),
                Ok(None) => {}
                Err(error) => failure = failure.take().or(Some(error)),
            }
        }
        records.push(flat);
        cancel.store((context.stop)() || failure.is_some(), Ordering::Relaxed);
    })?;
    match failure {
        Some(failure) => Err(failure),
        None => Ok(tour.is_complete.then_some(records)),
    }
}

/// Compares a frame with its converged picture. `None` after a stop.
fn errors(context: &ExperimentContext<'_>, frame: &Frame) -> Result<Option<Errors>, ExperimentError> {
    let Some(truth) = truth_of(context, &frame.camera) else { return Ok(None) };
    Ok(Some(Errors::of(frame, &truth, context.settings.exposure_ev)?))
}
