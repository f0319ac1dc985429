//! Charts of error against run time.

use super::aggregate::{LEAD, METRICS, Metric, Setup};
use super::{compare::pareto, headline::time, plan::DEFAULT_REFERENCES};
use crate::experiment::run::report::{Axis, Block, Drawn, Point, Series};

/// Colours of the modes, equal in every chart.
pub(super) const COLORS: [(&str, &str); 4] =
    [("full", "#808080"), ("paper", "#d55e00"), ("fast", "#009e73"), ("exact", "#0072b2")];

/// Error against frame time without references, a chart per metric.
pub(super) fn against_time(setups: &[Setup]) -> impl Iterator<Item = Block> {
    let still: Vec<&Setup> = setups.iter().filter(|s| s.references.is_some()).collect();
    METRICS.into_iter().map(move |metric| {
        let series = front(&still, metric, false).into_iter().chain(modes(&still, metric, false));
        chart("time", metric, "seconds per frame", series)
    })
}

/// Error against frame time with references, still and flown, in FLIP and PSNR.
pub(super) fn with_references(setups: &[Setup]) -> impl Iterator<Item = Block> {
    let (flown, still): (Vec<&Setup>, Vec<&Setup>) = setups.iter().partition(|s| s.references.is_none());
    METRICS.into_iter().take(2).map(move |metric| {
        let joined =
            |s: Series| Series { name: format!("{}, flown", s.name), drawn: Drawn::MarksAndLine, ..s };
        let series = front(&still, metric, true).into_iter().chain(modes(&still, metric, true));
        let series = series.chain(modes(&flown, metric, true).into_iter().map(joined));
        chart("counted", metric, "seconds per frame, references counted", series)
    })
}

fn chart(name: &str, metric: Metric, x: &str, series: impl Iterator<Item = Series>) -> Block {
    let y = if metric.is_decibel { Axis::linear(metric.name) } else { Axis::logarithmic(metric.name) };
    let name = format!("{name}-{}", metric.field.replace('_', "-"));
    Block::chart(name, format!("{} against {x}", metric.name), [Axis::logarithmic(x), y], series)
}

/// One series per mode; the points of full tracing are joined.
fn modes(setups: &[&Setup], metric: Metric, references_count: bool) -> Vec<Series> {
    let series = |(mode, color): &(&str, &str)| {
        let of_mode = setups.iter().filter(|s| s.mode == *mode);
        let drawn = if *mode == "full" { Drawn::MarksAndLine } else { Drawn::Marks };
        Series::new(*mode, drawn, of_mode.map(|s| point(s, metric, references_count))).in_color(color)
    };
    COLORS.iter().map(series).filter(|s| !s.points.is_empty()).collect()
}

fn point(setup: &Setup, metric: Metric, references_count: bool) -> Point {
    let (x, y) = (setup.secs(references_count), setup.value(metric));
    let label = format!("{}\n{} per frame\n{} {y:.4}", setup.label(), time(x), metric.name);
    Point {
        x_range: setup.secs_range(references_count),
        y_range: setup.value_range(metric),
        ..Point::new(x, y, label)
    }
}

/// The Pareto front.
fn front(setups: &[&Setup], metric: Metric, references_count: bool) -> Vec<Series> {
    let points: Vec<_> = setups.iter().map(|s| s.secs_and_error(metric, references_count)).collect();
    let on_front = |index: usize| {
        let setup = setups[index];
        Point::new(setup.secs(references_count), setup.value(metric), setup.label())
    };
    let points = pareto(&points).into_iter().map(on_front);
    vec![Series::new("best in its time", Drawn::Dashes, points).in_color("#8a6d9e")]
}

/// Error over references and over samples, the other setting at its default.
pub(super) fn influences(setups: &[Setup], samples: usize) -> [Block; 2] {
    let lines = |x: fn(&Setup) -> usize, is_shown: &dyn Fn(&Setup) -> bool| -> Vec<Series> {
        let of_mode = |(mode, color): &(&str, &str)| {
            let of_mode = setups.iter().filter(|s| s.mode == *mode && is_shown(s));
            let at = |s: &Setup| [x(s) as f64, s.value(LEAD)];
            let point = |s: &Setup| Point { at: at(s), x_range: None, ..point(s, LEAD, false) };
            let mut points: Vec<Point> = of_mode.map(point).collect();
            points.sort_by(|a, b| a.at[0].total_cmp(&b.at[0]));
            Series::new(*mode, Drawn::MarksAndLine, points).in_color(color)
        };
        COLORS.iter().map(of_mode).filter(|s| !s.points.is_empty()).collect()
    };
    let chart = |name: &str, title: String, x: &str, series: Vec<Series>| {
        Block::chart(name, title, [Axis::logarithmic(x), Axis::logarithmic(LEAD.name)], series)
    };
    let is_reusing = |s: &Setup| s.samples == samples && s.references.is_some_and(|n| n > 0);
    let is_usual =
        |s: &Setup| s.references.is_some_and(|n| n == DEFAULT_REFERENCES || n == 0 && s.mode == "full");
    let by_references = lines(|s| s.references.unwrap_or(0), &is_reusing);
    let by_samples = lines(|s| s.samples, &is_usual);
    let [with, by] = [
        format!("FLIP by references, {samples} samples"),
        format!("FLIP by samples, {DEFAULT_REFERENCES} references"),
    ];
    [
        chart("by-references", with, "references", by_references),
        chart("by-samples", by, "shadow rays per light and pixel", by_samples),
    ]
}
