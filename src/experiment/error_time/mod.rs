//! Error against run time: every mode over references and samples, full tracing over samples.
//!
//! Two ways of having references. *Still*: they stand at even distances along the walk, and views are taken midway
//! between two of them, where they are worst. *Flown*: the walk is flown with the cache and its placement policy. Only
//! the first can be given any number of references; only the second is what a user meets.

mod compare;
mod measured;
mod pictures;
mod report;
mod words;

use crate::camera::Camera;
use crate::experiment::errors::Errors;
use crate::experiment::run::{
    Cell, CellOutcome, Effort, Experiment, ExperimentContext, ExperimentError, ExperimentSettings, RunRecord,
};
use crate::experiment::tour::{TourEvent, TourSettings, run_tour};
use crate::experiment::trial::{References, Trial, camera_on_walk, truth_of};
use crate::render::{Frame, Mode, RenderSettings, Renderer, WalkthroughSettings};
use crate::trace::TraceSettings;
use std::sync::atomic::{AtomicBool, Ordering};

/// See the module.
pub(crate) const EXPERIMENT: Experiment = Experiment {
    name: "error-time",
    about: "error against seconds per frame, every mode against full ray tracing",
    settings,
    cells,
    run_cell,
    report: report::report,
};

/// Those that reuse.
const REUSING: [Mode; 3] = [Mode::Paper, Mode::Fast, Mode::Exact];

/// Between two references of a still view, as a share of the walk.
const SPACING: f64 = 0.02;

/// References the modes are compared with in words; about what a walk has at hand of one place.
const DEFAULT_REFERENCES: usize = 4;

/// What is varied.
struct Steps {
    full_samples: &'static [u32],
    references: &'static [usize],
    samples: &'static [u32],
    flown_samples: &'static [u32],
}

fn steps(effort: Effort) -> Steps {
    match effort {
        Effort::Quick => Steps {
            full_samples: &[1, 4, 16, 64],
            references: &[1, DEFAULT_REFERENCES],
            samples: &[4, 16],
            flown_samples: &[16],
        },
        Effort::Usual => Steps {
            full_samples: &[1, 2, 4, 8, 16, 32, 64, 128, 256],
            references: &[1, 2, DEFAULT_REFERENCES, 8],
            samples: &[1, 4, 16, 64],
            flown_samples: &[4, 16],
        },
    }
}

fn settings(effort: Effort) -> ExperimentSettings {
    let usual = ExperimentSettings { effort, truth_samples: 2048, ..ExperimentSettings::default() };
    match effort {
        Effort::Usual => usual,
        Effort::Quick => ExperimentSettings { size: [160, 90], views: 3, truth_samples: 512, ..usual },
    }
}

fn cells(context: &ExperimentContext<'_>) -> Vec<Cell> {
    let steps = steps(context.settings.effort);
    let cell = |kind: &str| RunRecord::default().with("kind", kind);
    let mut cells = vec![cell("pictures")];
    cells.extend(steps.full_samples.iter().map(|s| cell("still").with("references", 0).with("samples", *s)));
    for references in steps.references {
        let with = |samples: &u32| cell("still").with("references", *references).with("samples", *samples);
        cells.extend(steps.samples.iter().map(with));
    }
    for mode in REUSING {
        let flown = |samples: &u32| cell("flown").with("mode", mode.name()).with("samples", *samples);
        cells.extend(steps.flown_samples.iter().map(flown));
    }
    cells.into_iter().map(Cell).collect()
}

fn run_cell(context: &ExperimentContext<'_>, cell: &RunRecord) -> CellOutcome {
    let trace = |samples: f64| TraceSettings { samples: samples as u32, ..context.settings.trace() };
    match (cell.text("kind"), cell.number("samples"), cell.number("references")) {
        (Some("pictures"), _, _) => pictures::run(context),
        (Some("still"), Some(samples), Some(count)) => still(context, count as usize, trace(samples)),
        (Some("flown"), Some(samples), _) => {
            let mode = REUSING.into_iter().find(|m| cell.text("mode") == Some(m.name()));
            mode.map_or_else(|| Err(unknown(cell)), |mode| flown(context, mode, trace(samples)))
        }
        _ => Err(unknown(cell)),
    }
}

fn unknown(cell: &RunRecord) -> ExperimentError {
    ExperimentError::Unsuitable(format!("error-time has no cell '{}'", cell.label()))
}

/// The middles of equal parts of the walk.
fn view_share(context: &ExperimentContext<'_>, view: u32) -> f64 {
    (f64::from(view) + 0.5) / f64::from(context.settings.views)
}

/// The view, and the poses of the nearest references around it: behind, ahead, further behind, further ahead.
fn poses(
    context: &ExperimentContext<'_>,
    share: f64,
    count: usize,
) -> Result<(Camera, Vec<Camera>), ExperimentError> {
    let offset = |n: usize| (n / 2) as f64 + 0.5;
    let side = |n: usize| if n.is_multiple_of(2) { -SPACING } else { SPACING };
    let references = (0..count).map(|n| camera_on_walk(context, share + side(n) * offset(n)));
    Ok((camera_on_walk(context, share)?, references.collect::<Result<_, _>>()?))
}

/// Every view, in full without references and in every other mode with them.
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
            let spread = spread_secs(references.secs(), count, context.settings.frames);
            records.extend(found.into_iter().map(|r| {
                r.with("mode", mode.name()).with("view", view).with("spread_reference_secs", spread)
            }));
        }
    }
    Ok(Some(records))
}

/// What every frame pays where references stand at [`SPACING`] along the whole walk, each used by all frames near it.
fn spread_secs(reference_secs: f64, count: usize, frames: u32) -> f64 {
    let stands = (1.0 / SPACING).round() + 1.0;
    reference_secs / count.max(1) as f64 * stands / f64::from(frames.max(1))
}

/// The walk with references of the program's own placing. As many frames as there are views are measured.
fn flown(context: &ExperimentContext<'_>, mode: Mode, trace: TraceSettings) -> CellOutcome {
    let walkthrough = WalkthroughSettings {
        render: RenderSettings { mode, trace },
        cache_bytes: usize::try_from(context.settings.cache_mb << 20).unwrap_or(usize::MAX),
        ..WalkthroughSettings::default()
    };
    let frames = context.settings.frames;
    let settings =
        TourSettings { walkthrough, size: context.settings.size, frames, budget: None, measure: None };
    let measured: Vec<u32> =
        (0..context.settings.views).map(|v| (view_share(context, v) * f64::from(frames)) as u32).collect();
    let (cancel, mut records, mut trouble) = (AtomicBool::new(false), Vec::new(), None);
    let tour = run_tour(context.tracer, context.walk, &settings, &cancel, |event| {
        let TourEvent::Frame(record, walk) = event else { return };
        let flat = RunRecord::default()
            .with("frame", record.frame)
            .with("frame_secs", record.frame_secs)
            .with("flown_reference_secs", record.reference_secs)
            .with("references_held", record.references_held)
            .with_fields(&record.types);
        let errors = if measured.contains(&record.frame) { errors(context, walk.frame()) } else { Ok(None) };
        trouble = trouble.take().or(errors.as_ref().err().map(ToString::to_string));
        records.push(errors.ok().flatten().map_or(flat.clone(), |found| flat.with_fields(&found)));
        cancel.store((context.stop)() || trouble.is_some(), Ordering::Relaxed);
    });
    let tour = tour.map_err(|e| ExperimentError::Unsuitable(e.to_string()))?;
    match trouble {
        Some(trouble) => Err(ExperimentError::Unsuitable(trouble)),
        None => Ok(tour.is_complete.then_some(records)),
    }
}

/// `None` after a stop.
fn errors(context: &ExperimentContext<'_>, frame: &Frame) -> Result<Option<Errors>, ExperimentError> {
    let Some(truth) = truth_of(context, &frame.camera) else { return Ok(None) };
    Ok(Some(Errors::of(frame, &truth, context.exposure_ev(&truth))?))
}
