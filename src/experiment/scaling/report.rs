//! Growth of frame time as exponents, compared with the goals.

use super::run::{AXES, MODES};
use crate::experiment::run::report::{Axis, Block, Drawn, Point, Section, Series, row};
use crate::experiment::run::{Identity, Report, RunRecord, matching, median_of};
use crate::experiment::statistics::{PowerLaw, power_law};
use serde_json::{Map, Value, json};

/// Names of all axes.
fn axes() -> impl Iterator<Item = &'static str> {
    AXES.into_iter().map(|a| a.0).chain(["threads"])
}

/// Values of an axis and median seconds of a frame.
type Curve = Vec<[f64; 2]>;

pub(crate) fn report(_: &Identity, records: &[RunRecord]) -> Report {
    let curves: Vec<(&str, Vec<Curve>)> =
        axes().map(|axis| (axis, MODES.iter().map(|m| curve(records, axis, m.name())).collect())).collect();
    let mut report = Report { headline: goals(&curves), ..Report::default() };
    let mut exponents = Map::new();
    for (axis, of_modes) in curves.iter().filter(|(_, c)| c.iter().any(|curve| !curve.is_empty())) {
        let law = |(mode, curve): (&crate::render::Mode, &Curve)| {
            let law = power_law(curve)?;
            let numbers = json!({"exponent": law.exponent, "standard_error": law.standard_error});
            Some((mode.name().to_owned(), numbers))
        };
        let of_axis: Map<String, Value> = MODES.iter().zip(of_modes).filter_map(law).collect();
        exponents.insert((*axis).to_owned(), of_axis.into());
        let blocks = vec![table(axis, of_modes), chart(axis, of_modes)];
        report.sections.push(Section::new(format!("Growth with {axis}"), blocks));
    }
    report.summary.insert("exponents".to_owned(), exponents.into());
    report
}

fn curve(records: &[RunRecord], axis: &str, mode: &str) -> Curve {
    let wanted = RunRecord::default().with("axis", axis).with("mode", mode);
    let found = matching(records, &wanted);
    let secs = |value: f64| {
        let of_value: Vec<&RunRecord> =
            found.iter().copied().filter(|r| r.number("value") == Some(value)).collect();
        Some([value, median_of(&of_value, "frame_secs")?])
    };
    distinct(found.iter().filter_map(|r| r.number("value"))).into_iter().filter_map(secs).collect()
}

fn distinct(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut values: Vec<f64> = values.collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}

fn at(curve: &Curve, value: f64) -> Option<f64> {
    curve.iter().find(|p| p[0] == value).map(|p| p[1])
}

/// Compares the growth of every mode with the goals.
fn goals(curves: &[(&str, Vec<Curve>)]) -> Vec<String> {
    let of_axis = |name: &str| {
        let curves = curves.iter().filter(|(axis, _)| *axis == name).flat_map(|(_, curves)| curves);
        MODES.iter().map(|m| m.name()).zip(curves).collect::<Vec<_>>()
    };
    let verdict = |is_met: bool| if is_met { "goal met" } else { "goal missed" };
    let mut lines = Vec::new();
    let mut growth = |axis: &str, from: Option<f64>, limit: f64| {
        for (mode, curve) in of_axis(axis) {
            let ends = (from.or(curve.first().map(|p| p[0])), curve.last().map(|p| p[0]));
            let (Some(from), Some(to)) = ends else { continue };
            let (Some(first), Some(last)) = (at(curve, from), at(curve, to)) else { continue };
            let found = last / first;
            lines.push(format!(
                "Mode {mode}: {found:.2} times the time from {from} to {to} {axis} (limit {limit:.1}: {}).",
                verdict(found <= limit)
            ));
        }
    };
    growth("triangles", None, 1.3);
    growth("references", Some(2.0), 1.5);
    for (mode, curve) in of_axis("pixels") {
        let Some(law) = power_law(curve) else { continue };
        lines.push(format!(
            "Mode {mode}: time grows with the number of pixels to the power of {} (limit 1: {}).",
            words(&law),
            verdict(law.exponent - law.standard_error <= 1.0)
        ));
    }
    lines
}

fn words(law: &PowerLaw) -> String {
    format!("{:.2} +- {:.2}", law.exponent, law.standard_error)
}

/// Milliseconds by value, and the exponents in the last row.
fn table(axis: &str, of_modes: &[Curve]) -> Block {
    let line = |value: f64| row(value, of_modes.iter().map(|curve| at(curve, value).map(|secs| secs * 1e3)));
    let exponents = row("exponent", of_modes.iter().map(|curve| power_law(curve).map(|law| words(&law))));
    let values = distinct(of_modes.iter().flatten().map(|p| p[0]));
    let columns = std::iter::once(axis.to_owned()).chain(MODES.map(|m| format!("{}, ms", m.name())));
    Block::table("Milliseconds per frame, medians", columns, values.into_iter().map(line).chain([exponents]))
}

fn chart(axis: &str, of_modes: &[Curve]) -> Block {
    let point = |p: &[f64; 2]| Point::new(p[0], p[1] * 1e3, format!("{}: {:.2} ms", p[0], p[1] * 1e3));
    let series = MODES.iter().zip(of_modes);
    Block::chart(
        format!("scaling-{axis}"),
        format!("Frame time by {axis}"),
        [Axis::logarithmic(axis), Axis::logarithmic("frame, ms")],
        series.map(|(mode, curve)| Series::new(mode.name(), Drawn::MarksAndLine, curve.iter().map(point))),
    )
}
