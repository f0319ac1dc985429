//! Whether memory and frame times stayed constant.

use super::plan::parts;
use crate::experiment::run::report::{Axis, Block, Chart, Drawn, Point, Section, Series};
use crate::experiment::run::{Effort, Identity, Report, RunRecord};
use serde_json::Map;

/// Memory may grow so fast at most, MB per minute.
const MAX_GROWTH: f64 = 1.0;

/// The last minute's slowest frames may take so many times the first's.
const MAX_SLOWER: f64 = 1.1;

/// The slope of a straight line through points of equal distance.
fn slope(values: &[f64]) -> f64 {
    let middle = (values.len() as f64 - 1.0) / 2.0;
    let at = |i: usize| i as f64 - middle;
    let up: f64 = values.iter().enumerate().map(|(i, v)| at(i) * v).sum();
    let across: f64 = (0..values.len()).map(|i| at(i) * at(i)).sum();
    if across > 0.0 { up / across } else { 0.0 }
}

pub(crate) fn report(identity: &Identity, records: &[RunRecord]) -> Report {
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
