//! Hours in minutes: walking, changing mode and size, adding and clearing references, editing the scene, for so long
//! that a leak or a slowdown would be seen.

use super::run::report::{Axis, Block, Chart, Drawn, Point, Section, Series};
use super::run::{
    Cell, CellOutcome, Effort, Experiment, ExperimentContext, ExperimentSettings, Identity, Report, RunRecord,
};
use super::statistics::percentile;
use crate::reference::PlacementPolicy;
use crate::reference::placement::THRESHOLD;
use crate::render::{Mode, RenderSettings, Walkthrough, WalkthroughSettings};
use serde_json::{Map, Value};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// See the module.
pub(super) const EXPERIMENT: Experiment = Experiment {
    name: "soak",
    about: "walking for half an hour: memory and frame times must stay",
    settings: |effort| ExperimentSettings {
        effort,
        size: [320, 180],
        samples: 2,
        ..ExperimentSettings::default()
    },
    cells,
    run_cell,
    report,
};

/// Memory may grow so fast at most, MB per minute.
const MAX_GROWTH: f64 = 1.0;

/// The last minute's slowest frames may take so many times the first's.
const MAX_SLOWER: f64 = 1.1;

/// Parts of a run, and how long each is.
fn parts(effort: Effort) -> (u32, Duration) {
    match effort {
        Effort::Quick => (6, Duration::from_secs(5)),
        Effort::Usual => (30, Duration::from_secs(60)),
    }
}

fn cells(context: &ExperimentContext<'_>) -> Vec<Cell> {
    (0..parts(context.settings.effort).0).map(|part| Cell(RunRecord::default().with("part", part))).collect()
}

fn run_cell(context: &ExperimentContext<'_>, _: &RunRecord) -> CellOutcome {
    let length = parts(context.settings.effort).1;
    let start = Instant::now();
    // Every part does the same work, so that their times can be compared.
    let mut walk = Walkthrough::new(Arc::clone(context.tracer), settings(context, 0));
    let mut secs = Vec::new();
    let mut bad = 0usize;
    for frame in (0..).take_while(|_| start.elapsed() < length) {
        if (context.stop)() {
            return Ok(None);
        }
        trouble(context, &mut walk, frame);
        let Some(camera) = context.walk.camera(frame % context.settings.frames, context.settings.frames)
        else {
            break;
        };
        let shown = walk.render(&camera, size(context, frame), context.stop);
        bad += shown.radiance.iter().filter(|r| !(r.is_finite() && r.min_element() >= 0.0)).count();
        secs.push(shown.stats.secs.frame);
        if let Some(wanted) = walk.wanted_reference() {
            let made = walk.reference_job(wanted, size(context, frame)).trace(context.stop);
            made.map(|reference| walk.insert(reference));
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

/// What a restless user does: every so many frames another mode, nothing held, or the scene edited.
fn trouble(context: &ExperimentContext<'_>, walk: &mut Walkthrough, frame: u32) {
    match frame % 100 {
        25 | 75 => walk.set_settings(settings(context, frame / 25)),
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

fn settings(context: &ExperimentContext<'_>, turn: u32) -> WalkthroughSettings {
    let mode = [Mode::Exact, Mode::Paper, Mode::Fast][turn as usize % 3];
    WalkthroughSettings {
        render: RenderSettings { mode, trace: context.settings.trace() },
        placement: PlacementPolicy::new(&THRESHOLD, 10.0),
        cache_bytes: 64 << 20,
        ..WalkthroughSettings::default()
    }
}

/// The window is resized every ten frames.
fn size(context: &ExperimentContext<'_>, frame: u32) -> [u32; 2] {
    let shrunk = frame / 10 % 4;
    context.settings.size.map(|side| (side - side * shrunk / 8).max(1))
}

/// A number of `/proc/self/status`, where there is one.
fn memory_mb() -> Value {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    let kilobytes = line.and_then(|line| line.trim().split(' ').next()?.parse::<f64>().ok());
    kilobytes.map_or(Value::Null, |kb| (kb / 1024.0).into())
}

fn handles() -> Value {
    std::fs::read_dir("/proc/self/fd").map_or(Value::Null, |open| open.count().into())
}

/// The slope of a straight line through points of equal distance.
fn slope(values: &[f64]) -> f64 {
    let middle = (values.len() as f64 - 1.0) / 2.0;
    let at = |i: usize| i as f64 - middle;
    let up: f64 = values.iter().enumerate().map(|(i, v)| at(i) * v).sum();
    let across: f64 = (0..values.len()).map(|i| at(i) * at(i)).sum();
    if across > 0.0 { up / across } else { 0.0 }
}

fn report(identity: &Identity, records: &[RunRecord]) -> Report {
    let of = |name: &str| records.iter().filter_map(|r| r.number(name)).collect::<Vec<f64>>();
    let effort =
        if identity.settings.text("effort") == Some("quick") { Effort::Quick } else { Effort::Usual };
    let minutes = parts(effort).1.as_secs_f64() / 60.0;
    let memory = of("memory_mb_used");
    // Buffers and caches fill in the first tenth.
    let settled = &memory[(memory.len() / 10).max(1).min(memory.len())..];
    let growth = slope(settled) / minutes;
    let slowest = of("frame_secs_p99");
    let slower = slowest.last().zip(slowest.first()).map_or(1.0, |(last, first)| last / first);
    let bad: f64 = of("bad_values").iter().sum();
    let handles = of("handles_used");
    let more_handles = handles.last().zip(handles.first()).map_or(0.0, |(last, first)| last - first);
    let mut summary = Map::new();
    for (name, value) in [
        ("minutes", minutes * records.len() as f64),
        ("memory_growth_mb_per_minute", growth),
        ("frame_secs_p99_last_over_first", slower),
        ("bad_values", bad),
        ("handles_more", more_handles),
    ] {
        summary.insert(name.to_owned(), value.into());
    }
    let is_ok = growth < MAX_GROWTH && slower <= MAX_SLOWER && bad == 0.0 && more_handles <= 0.0;
    summary.insert("ok".to_owned(), is_ok.into());
    let headline = vec![
        format!(
            "{:.1} minutes: memory grows by {growth:.2} MB a minute (at most {MAX_GROWTH})",
            minutes * records.len() as f64
        ),
        format!(
            "the slowest frames of the last part take {slower:.2} times those of the first (at most {MAX_SLOWER})"
        ),
        format!("{bad} bad values; {more_handles} more open files at the end than at the beginning"),
    ];
    Report {
        headline,
        summary,
        sections: vec![Section {
            title: "Memory".to_owned(),
            blocks: vec![Block::Chart(chart(&memory, minutes))],
        }],
        failure: (!is_ok).then(|| "memory, time or values did not stay".to_owned()),
        ..Report::default()
    }
}

fn chart(memory: &[f64], minutes: f64) -> Chart {
    let points = memory.iter().enumerate().map(|(i, mb)| Point::new((i + 1) as f64 * minutes, *mb, ""));
    Chart {
        name: "memory".to_owned(),
        title: "Memory held".to_owned(),
        x: Axis::linear("minutes"),
        y: Axis::linear("MB"),
        series: vec![Series {
            name: "resident".to_owned(),
            drawn: Drawn::MarksAndLine,
            points: points.collect(),
            ..Series::default()
        }],
        ..Chart::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_leak_is_told_from_noise() {
        let identity = Identity {
            experiment: "soak".to_owned(),
            version: String::new(),
            scene: String::new(),
            scene_sha256: String::new(),
            settings: RunRecord::default().with("effort", "usual"),
        };
        let run = |growth: f64| {
            let part = |i: u32| {
                let noise = f64::from(i * 7 % 5) * 0.1;
                RunRecord::default()
                    .with("memory_mb_used", 100.0 + growth * f64::from(i) + noise)
                    .with("frame_secs_p99", 0.1)
            };
            report(&identity, &(0..30).map(part).collect::<Vec<_>>())
        };
        assert!(run(0.0).failure.is_none());
        assert!(run(1.5).failure.is_some());
        assert!((slope(&[1.0, 3.0, 5.0]) - 2.0).abs() < 1e-12);
    }
}
