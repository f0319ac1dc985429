//! Whether memory and frame times stayed constant.

use super::run::parts;
use crate::experiment::run::report::{Axis, Block, Drawn, Point, Section, Series, fields};
use crate::experiment::run::{Effort, Identity, Report, RunRecord};
use serde_json::json;

/// Maximum growth of memory in MB per minute.
const MAX_GROWTH_MB_PER_MIN: f64 = 1.0;

/// Maximum 99th percentile of frame time in the last part, as a multiple of that in the first.
const MAX_SLOWDOWN: f64 = 1.1;

/// Slope of the line fitted to values at equal distances, per step.
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
    let part_minutes = parts(effort).1.as_secs_f64() / 60.0;
    let minutes = part_minutes * records.len() as f64;
    let memory = of("memory_mb_used");
    // Buffers and caches fill during the first tenth.
    let settled = &memory[(memory.len() / 10).max(1).min(memory.len())..];
    let growth = slope(settled) / part_minutes;
    let ends = |values: &[f64]| values.first().copied().zip(values.last().copied());
    let slower = ends(&of("frame_secs_p99")).map_or(1.0, |(first, last)| last / first);
    let bad: f64 = of("bad_values").iter().sum();
    let more_handles = ends(&of("handles_used")).map_or(0.0, |(first, last)| last - first);
    let is_ok = growth < MAX_GROWTH_MB_PER_MIN && slower <= MAX_SLOWDOWN && bad == 0.0 && more_handles <= 0.0;
    let headline = vec![
        format!(
            "In {minutes:.1} minutes memory grows by {growth:.2} MB per minute (limit {MAX_GROWTH_MB_PER_MIN})."
        ),
        format!(
            "The 99th percentile of frame time in the last part is {slower:.2} times that of the first (limit \
             {MAX_SLOWDOWN})."
        ),
        format!("{bad} invalid pixel values; {more_handles} more open files at the end than at the start."),
    ];
    let summary = fields(json!({
        "minutes": minutes,
        "memory_growth_mb_per_minute": growth,
        "frame_secs_p99_last_over_first": slower,
        "bad_values": bad,
        "handles_more": more_handles,
        "ok": is_ok,
    }));
    let failure =
        (!is_ok).then(|| "memory, frame time, pixel values or open files exceeded a limit".to_owned());
    let sections = vec![Section::new("Memory", vec![chart(&memory, part_minutes)])];
    Report { headline, summary, sections, failure, ..Report::default() }
}

fn chart(memory: &[f64], minutes: f64) -> Block {
    let points = memory.iter().enumerate().map(|(i, mb)| Point::new((i + 1) as f64 * minutes, *mb, ""));
    let series = Series::new("resident", Drawn::MarksAndLine, points);
    Block::chart("memory", "Resident memory", [Axis::linear("minutes"), Axis::linear("MB")], [series])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_leak_is_distinguished_from_noise() {
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
