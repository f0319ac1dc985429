//! Growth as exponents, beside the goals.

use super::plan::{AXES, MODES};
use crate::experiment::run::report::{Axis, Block, Chart, Drawn, Point, Section, Series, Table};
use crate::experiment::run::{Identity, Report, RunRecord, counted};
use crate::experiment::statistics::{PowerLaw, median, power_law};
use serde_json::{Map, Value, json};

/// The names of all axes.
fn axes() -> impl Iterator<Item = &'static str> {
    AXES.into_iter().map(|a| a.0).chain(["threads"])
}

/// Value and median seconds of a frame.
type Curve = Vec<[f64; 2]>;

pub(crate) fn report(_: &Identity, records: &[RunRecord]) -> Report {
    let curves: Vec<(&str, Vec<Curve>)> =
        axes().map(|axis| (axis, MODES.iter().map(|m| curve(records, axis, m.name())).collect())).collect();
    let mut report = Report { headline: goals(&curves), ..Report::default() };
    let mut exponents = Map::new();
    for (axis, of_modes) in curves.iter().filter(|(_, c)| c.iter().any(|curve| !curve.is_empty())) {
        let mut of_axis = Map::new();
        for (mode, curve) in MODES.iter().zip(of_modes) {
            if let Some(law) = power_law(curve) {
                let law = json!({"exponent": law.exponent, "standard_error": law.standard_error});
                of_axis.insert(mode.name().to_owned(), law);
            }
        }
        exponents.insert((*axis).to_owned(), of_axis.into());
        report.sections.push(section(axis, of_modes));
    }
    report.summary.insert("exponents".to_owned(), exponents.into());
    report
}

fn curve(records: &[RunRecord], axis: &str, mode: &str) -> Curve {
    let wanted = RunRecord::default().with("axis", axis).with("mode", mode);
    let found = counted(records).filter(|r| r.agrees_with(&wanted));
    let mut values: Vec<f64> = found.clone().filter_map(|r| r.number("value")).collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    let secs = |value: f64| {
        median(
            found.clone().filter(|r| r.number("value") == Some(value)).filter_map(|r| r.number("frame_secs")),
        )
    };
    values.into_iter().filter_map(|value| Some([value, secs(value)?])).collect()
}

/// How much longer a frame takes at one value than at another.
fn growth(curve: &[[f64; 2]], from: f64, to: f64) -> Option<f64> {
    let secs = |value: f64| curve.iter().find(|p| p[0] == value).map(|p| p[1]);
    Some(secs(to)? / secs(from)?)
}

/// What is to hold in every mode.
fn goals(curves: &[(&str, Vec<Curve>)]) -> Vec<String> {
    let of_axis = |axis: &str| curves.iter().find(|c| c.0 == axis).map(|c| &c.1);
    let mut said = Vec::new();
    let mut say = |axis: &str, from: Option<f64>, to: Option<f64>, most: f64| {
        for (mode, curve) in MODES.iter().zip(of_axis(axis).into_iter().flatten()) {
            let ends = (from.or(curve.first().map(|p| p[0])), to.or(curve.last().map(|p| p[0])));
            let (Some(from), Some(to)) = ends else { continue };
            let Some(found) = growth(curve, from, to) else { continue };
            let verdict = if found <= most { "goal met" } else { "goal missed" };
            said.push(format!(
                "Mode {}: {found:.2} times the time from {from} to {to} {axis} (at most {most:.1}: {verdict}).",
                mode.name()
            ));
        }
    };
    say("triangles", None, None, 1.3);
    say("references", Some(2.0), None, 1.5);
    if let Some(pixels) = of_axis("pixels") {
        for (mode, curve) in MODES.iter().zip(pixels) {
            if let Some(law) = power_law(curve) {
                let verdict =
                    if law.exponent - law.standard_error <= 1.0 { "goal met" } else { "goal missed" };
                said.push(format!(
                    "Mode {}: time grows as pixels to the {} (at most 1: {verdict}).",
                    mode.name(),
                    words(&law)
                ));
            }
        }
    }
    said
}

fn words(law: &PowerLaw) -> String {
    format!("{:.2} +- {:.2}", law.exponent, law.standard_error)
}

fn section(axis: &str, of_modes: &[Curve]) -> Section {
    Section {
        title: format!("Growth with {axis}"),
        blocks: vec![Block::Table(table(axis, of_modes)), Block::Chart(chart(axis, of_modes))],
    }
}

/// Milliseconds by value, and the exponents below.
fn table(axis: &str, of_modes: &[Curve]) -> Table {
    let mut values: Vec<f64> = of_modes.iter().flatten().map(|p| p[0]).collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    let ms = |curve: &Curve, value: f64| {
        curve.iter().find(|p| p[0] == value).map_or(Value::Null, |p| (p[1] * 1e3).into())
    };
    let row = |value: &f64| {
        std::iter::once(Value::from(*value)).chain(of_modes.iter().map(|curve| ms(curve, *value))).collect()
    };
    let exponent = |curve: &Curve| power_law(curve).map_or(Value::Null, |law| words(&law).into());
    let exponents = std::iter::once("exponent".into()).chain(of_modes.iter().map(exponent)).collect();
    let columns = std::iter::once(axis.to_owned()).chain(MODES.map(|m| format!("{}, ms", m.name())));
    Table {
        title: "Milliseconds a frame, medians".to_owned(),
        columns: columns.collect(),
        rows: values.iter().map(row).chain([exponents]).collect(),
    }
}

fn chart(axis: &str, of_modes: &[Curve]) -> Chart {
    let series = |(mode, curve): (&crate::render::Mode, &Curve)| Series {
        name: mode.name().to_owned(),
        drawn: Drawn::MarksAndLine,
        points: curve
            .iter()
            .map(|p| Point::new(p[0], p[1] * 1e3, format!("{}: {:.2} ms", p[0], p[1] * 1e3)))
            .collect(),
        ..Series::default()
    };
    Chart {
        name: format!("scaling-{axis}"),
        title: format!("A frame by {axis}"),
        x: Axis::logarithmic(axis),
        y: Axis::logarithmic("frame, ms"),
        series: MODES.iter().zip(of_modes).map(series).collect(),
        ..Chart::default()
    }
}
