//! The parts of the run: each walks for a fixed time.

use crate::experiment::run::{Cell, CellOutcome, Effort, ExperimentContext, ExperimentSettings, RunRecord};
use crate::experiment::statistics::percentile;
use crate::reference::{PlacementPolicy, placement::THRESHOLD};
use crate::render::{Mode, RenderSettings, Walkthrough, WalkthroughSettings};
use crate::trace::BounceLimit;
use serde_json::Value;
use std::sync::Arc;
use std::time::{Duration, Instant};
use sysinfo::{ProcessRefreshKind, ProcessesToUpdate, System};

pub(crate) fn settings(effort: Effort) -> ExperimentSettings {
    // Direct light: many frames, and references that come and go, in a short time.
    let usual = ExperimentSettings { effort, bounces: BounceLimit::NONE, ..ExperimentSettings::default() };
    ExperimentSettings { size: [320, 180], samples: 2, ..usual }
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

pub(crate) fn run_cell(context: &ExperimentContext<'_>, _: &RunRecord) -> CellOutcome {
    let length = parts(context.settings.effort).1;
    let start = Instant::now();
    // Every part does the same work, so that their times are comparable.
    let mut walk = Walkthrough::new(Arc::clone(context.tracer), walkthrough_settings(context, 0));
    let mut secs = Vec::new();
    let mut bad = 0usize;
    for frame in (0..).take_while(|_| start.elapsed() < length) {
        if (context.stop)() {
            return Ok(None);
        }
        disturb(context, &mut walk, frame);
        let Some(camera) = context.walk.camera(frame % context.settings.frames, context.settings.frames)
        else {
            break;
        };
        let shown = walk.render(&camera, size(context, frame), context.stop);
        bad += shown.radiance.iter().filter(|r| !(r.is_finite() && r.min_element() >= 0.0)).count();
        secs.push(shown.stats.secs.frame);
        if let Some(wanted) = walk.wanted_reference()
            && let Some(reference) = walk.reference_job(wanted, size(context, frame)).trace(context.stop)
        {
            walk.insert(reference);
        }
    }
    let record = RunRecord::default()
        .with("bad_values", bad)
        .with("frames_per_sec", secs.len() as f64 / start.elapsed().as_secs_f64())
        .with("frame_secs_p99", percentile(secs.iter().copied(), 99.0))
        .with("memory_mb_used", memory_mb())
        .with("handles_used", handles());
    Ok(Some(vec![record]))
}

/// Acts as a restless user: at fixed frames changes the mode, clears the cache, or edits the scene.
fn disturb(context: &ExperimentContext<'_>, walk: &mut Walkthrough, frame: u32) {
    match frame % 100 {
        25 | 75 => walk.set_settings(walkthrough_settings(context, frame / 25)),
        50 => walk.cache_mut().clear(),
        99 => {
            let scene = walk.tracer().scene();
            let edited = scene.with_edit(&scene.to_edit());
            let tracer = walk.tracer().with_same_geometry(Arc::new(edited));
            walk.set_tracer(Arc::new(tracer));
        }
        _ => {}
    }
}

fn walkthrough_settings(context: &ExperimentContext<'_>, turn: u32) -> WalkthroughSettings {
    let mode = [Mode::Exact, Mode::Paper, Mode::Fast][turn as usize % 3];
    WalkthroughSettings {
        render: RenderSettings { mode, trace: context.settings.trace() },
        placement: PlacementPolicy::new(&THRESHOLD, 10.0),
        cache_bytes: 64 << 20,
        ..WalkthroughSettings::default()
    }
}

/// Size of a frame: the window is resized every ten frames.
fn size(context: &ExperimentContext<'_>, frame: u32) -> [u32; 2] {
    let shrunk = frame / 10 % 4;
    context.settings.size.map(|side| (side - side * shrunk / 8).max(1))
}

/// Resident memory in megabytes; null if the system does not report it.
fn memory_mb() -> Value {
    let bytes = || {
        let own = sysinfo::get_current_pid().ok()?;
        let mut system = System::new().ok()?;
        let what = ProcessRefreshKind::nothing().with_memory();
        system.refresh_processes_specifics(ProcessesToUpdate::Some(&[own]), true, what);
        Some(system.process(own)?.memory())
    };
    bytes().map_or(Value::Null, |bytes| (bytes as f64 / f64::from(1 << 20)).into())
}

/// Number of open files; null if the system does not report it.
fn handles() -> Value {
    std::fs::read_dir("/proc/self/fd").map_or(Value::Null, |open| open.count().into())
}
