//! Charts, tables and pictures of error against run time.

use super::compare::pareto;
use super::measured::{METRICS, Setup};
use super::plan::{DEFAULT_REFERENCES, REUSING};
use super::words::{factors, headline, summary, time, times};
use crate::experiment::run::report::{Axis, Block, Chart, Drawn, Picture, Point, Section, Series, Table};
use crate::experiment::run::{Identity, Report, RunRecord, counted};
use crate::experiment::statistics::median;
use serde_json::{Map, Value, json};

/// The same in every chart.
const COLORS: [(&str, &str); 4] =
    [("full", "#808080"), ("paper", "#d55e00"), ("fast", "#009e73"), ("exact", "#0072b2")];

const LEFT_OUT: &str = "Gap and guard settings are not varied, for there are none: mode paper is the paper to the \
    letter, without any repair of gaps or see-through; fast and exact find every surface by its primary ray, so there \
    is no gap to fill and nothing to guard against.";

const HOW: &str = "Still views stand midway between two references, which stand at every 2 % of the walk, are traced \
    in full with as many samples as the frame, and are not counted in the first charts. Marks are medians over the \
    views; bars reach from the lower to the upper quartile, across over repetitions and views, up over views.";

const COUNTED: &str = "Here every frame pays its share of all references along the walk. Flown walks place their own \
    references as they go, and pay for exactly those.";

pub(crate) fn report(identity: &Identity, records: &[RunRecord]) -> Report {
    let samples = identity.settings.number("samples").unwrap_or(16.0) as usize;
    let setups = Setup::all(records);
    let sections = vec![
        section("Error against time, references not counted", against_time(&setups)),
        section("References counted", with_references(&setups)),
        section("What references and samples do", influences(&setups, samples)),
        section(
            "In figures",
            vec![
                Block::Table(equal_errors(&setups)),
                Block::Table(by_type(records, samples)),
                Block::Table(everything(&setups)),
                Block::Text(LEFT_OUT.to_owned()),
            ],
        ),
        section("Pictures", pictures(records, samples)),
    ];
    let mut numbers = Map::new();
    numbers.insert("equal_error".to_owned(), summary(&setups, samples));
    numbers.insert("setups".to_owned(), setups.iter().map(setup_json).collect());
    Report { headline: headline(&setups, samples), summary: numbers, sections, ..Report::default() }
}

fn section(title: &str, blocks: Vec<Block>) -> Section {
    Section { title: title.to_owned(), blocks }
}

fn setup_json(setup: &Setup) -> Value {
    let mut object = json!({
        "mode": setup.mode, "references": setup.references, "samples": setup.samples,
        "frame_secs": setup.secs(false), "frame_secs_references_counted": setup.secs(true),
    });
    for (number, metric) in METRICS.iter().enumerate() {
        object[metric.field] = setup.value(number).into();
    }
    object
}

fn against_time(setups: &[Setup]) -> Vec<Block> {
    let still: Vec<&Setup> = setups.iter().filter(|s| s.references.is_some()).collect();
    let mut blocks = vec![Block::Text(HOW.to_owned())];
    blocks.extend((0..METRICS.len()).map(|metric| {
        let mut series = vec![front(&still, metric, false)];
        series.extend(modes(&still, metric, false));
        Block::Chart(chart("time", metric, "seconds per frame", series))
    }));
    blocks
}

fn with_references(setups: &[Setup]) -> Vec<Block> {
    let (flown, still): (Vec<&Setup>, Vec<&Setup>) = setups.iter().partition(|s| s.references.is_none());
    let mut blocks = vec![Block::Text(COUNTED.to_owned())];
    blocks.extend([0, 1].map(|metric| {
        let mut series = vec![front(&still, metric, true)];
        series.extend(modes(&still, metric, true));
        series.extend(modes(&flown, metric, true).into_iter().map(|s| Series {
            name: format!("{}, flown", s.name),
            drawn: Drawn::MarksAndLine,
            ..s
        }));
        Block::Chart(chart("counted", metric, "seconds per frame, references counted", series))
    }));
    blocks
}

fn chart(name: &str, metric: usize, x: &str, series: Vec<Series>) -> Chart {
    let metric = METRICS[metric];
    let y = if metric.is_decibel { Axis::linear(metric.name) } else { Axis::logarithmic(metric.name) };
    Chart {
        name: format!("{name}-{}", metric.field.replace('_', "-")),
        title: format!("{} against {x}", metric.name),
        x: Axis::logarithmic(x),
        y,
        series,
        is_plan: false,
    }
}

/// A series a mode; full tracing's points are joined.
fn modes(setups: &[&Setup], metric: usize, references_count: bool) -> Vec<Series> {
    let series = |(mode, color): &(&str, &str)| {
        let of_mode = setups.iter().filter(|s| s.mode == *mode);
        let points: Vec<Point> = of_mode.map(|s| point(s, metric, references_count)).collect();
        let drawn = if *mode == "full" { Drawn::MarksAndLine } else { Drawn::Marks };
        Series { name: (*mode).to_owned(), drawn, color: (*color).to_owned(), points }
    };
    COLORS.iter().map(series).filter(|s| !s.points.is_empty()).collect()
}

fn point(setup: &Setup, metric: usize, references_count: bool) -> Point {
    let (x, y) = (setup.secs(references_count), setup.value(metric));
    let label = format!("{}\n{} a frame\n{} {y:.4}", setup.label(), time(x), METRICS[metric].name);
    Point {
        x_range: setup.secs_range(references_count),
        y_range: setup.value_range(metric),
        ..Point::new(x, y, label)
    }
}

fn front(setups: &[&Setup], metric: usize, references_count: bool) -> Series {
    let at = |s: &&Setup| [s.secs(references_count), METRICS[metric].error(s.value(metric))];
    let points: Vec<_> = setups.iter().map(at).collect();
    let on_front = |place: usize| {
        let setup = setups[place];
        Point::new(setup.secs(references_count), setup.value(metric), setup.label())
    };
    Series {
        name: "best in its time".to_owned(),
        drawn: Drawn::Dashes,
        color: "#8a6d9e".to_owned(),
        points: pareto(&points).into_iter().map(on_front).collect(),
    }
}

/// One setting varied, the other the usual one.
fn influences(setups: &[Setup], samples: usize) -> Vec<Block> {
    let lines = |x: &dyn Fn(&Setup) -> usize, is_it: &dyn Fn(&Setup) -> bool| -> Vec<Series> {
        let of_mode = |(mode, color): &(&str, &str)| {
            let mut points: Vec<Point> = setups
                .iter()
                .filter(|s| s.mode == *mode && is_it(s))
                .map(|s| Point { at: [x(s) as f64, s.value(0)], x_range: None, ..point(s, 0, false) })
                .collect();
            points.sort_by(|a, b| a.at[0].total_cmp(&b.at[0]));
            let name = (*mode).to_owned();
            Series { name, drawn: Drawn::MarksAndLine, color: (*color).to_owned(), points }
        };
        COLORS.iter().map(of_mode).filter(|s| !s.points.is_empty()).collect()
    };
    let chart = |name: &str, title: String, x: &str, series| {
        Block::Chart(Chart {
            name: name.to_owned(),
            title,
            x: Axis::logarithmic(x),
            y: Axis::logarithmic(METRICS[0].name),
            series,
            is_plan: false,
        })
    };
    let of_references = |s: &Setup| s.references.unwrap_or(0);
    let is_reusing = |s: &Setup| s.samples == samples && s.references.is_some_and(|n| n > 0);
    let is_usual =
        |s: &Setup| s.references.is_some_and(|n| n == DEFAULT_REFERENCES || n == 0 && s.mode == "full");
    let with = format!("FLIP by references, {samples} samples");
    let by = format!("FLIP by samples, {DEFAULT_REFERENCES} references");
    vec![
        chart("by-references", with, "references", lines(&of_references, &is_reusing)),
        chart("by-samples", by, "shadow rays per light and pixel", lines(&|s| s.samples, &is_usual)),
    ]
}

/// How many times as long full tracing takes for the same error.
fn equal_errors(setups: &[Setup]) -> Table {
    let text = |setup: &Setup, metric: usize, counts: bool| {
        let found = factors(setups, setup, metric, counts);
        found.map_or(Value::Null, |[middle, ..]| times(middle).into())
    };
    let row = |setup: &Setup| {
        let mut row = vec![Value::from(setup.mode.clone()), setup.label().into()];
        row.extend((0..METRICS.len()).map(|m| text(setup, m, false)));
        row.extend((0..METRICS.len()).map(|m| text(setup, m, true)));
        row
    };
    let names = METRICS.iter().map(|m| format!("by {}", m.name));
    let counted = METRICS.iter().map(|m| format!("by {}, references counted", m.name));
    Table {
        title: "Full tracing's seconds for the same error, over those of the mode: medians over the walk"
            .to_owned(),
        columns: ["mode".to_owned(), "with".to_owned()].into_iter().chain(names).chain(counted).collect(),
        rows: setups.iter().filter(|s| s.mode != "full").map(row).collect(),
    }
}

fn by_type(records: &[RunRecord], samples: usize) -> Table {
    let row = |mode: &str| {
        let references = if mode == "full" { 0 } else { DEFAULT_REFERENCES };
        let wanted = RunRecord::default()
            .with("kind", "still")
            .with("mode", mode)
            .with("references", references)
            .with("samples", samples);
        let found: Vec<&RunRecord> = counted(records).filter(|r| r.agrees_with(&wanted)).collect();
        let middle = |name: String| median(found.iter().filter_map(|r| r.number(&name)));
        let mut row = vec![Value::from(mode)];
        for part in ["percent", "error_percent", "mse"] {
            row.extend((1..=3).map(|t| middle(format!("type{t}_{part}")).map_or(Value::Null, Value::from)));
        }
        row
    };
    let parts = ["share of pixels, %", "share of squared error, %", "mean squared error"];
    let names = parts.iter().flat_map(|part| (1..=3).map(move |t| format!("Type {t}, {part}")));
    Table {
        title: format!("Error by type of pixel, {DEFAULT_REFERENCES} references, {samples} samples; medians"),
        columns: std::iter::once("mode".to_owned()).chain(names).collect(),
        rows: COLORS.iter().map(|(mode, _)| row(mode)).filter(|row| !row[1].is_null()).collect(),
    }
}

fn everything(setups: &[Setup]) -> Table {
    let row = |s: &Setup| {
        let mut row = vec![
            Value::from(s.mode.clone()),
            s.references.map_or("flown".into(), Value::from),
            s.samples.into(),
            (s.secs(false) * 1e3).into(),
            (s.secs(true) * 1e3).into(),
        ];
        row.extend((0..METRICS.len()).map(|m| Value::from(s.value(m))));
        row
    };
    let first = ["mode", "references", "samples", "ms a frame", "ms a frame, references counted"];
    Table {
        title: "Everything that was tried; medians over the walk".to_owned(),
        columns: first
            .iter()
            .map(|c| (*c).to_owned())
            .chain(METRICS.iter().map(|m| m.name.to_owned()))
            .collect(),
        rows: setups.iter().map(row).collect(),
    }
}

fn pictures(records: &[RunRecord], samples: usize) -> Vec<Block> {
    let flip = |mode: &str| {
        let wanted = RunRecord::default().with("kind", "pictures").with("mode", mode);
        records.iter().find(|r| r.agrees_with(&wanted)).and_then(|r| r.number("flip_mean"))
    };
    let name = |mode: &str| match mode {
        "full" => format!("full, {samples} samples"),
        mode => format!("{mode}, {DEFAULT_REFERENCES} references, {samples} samples"),
    };
    let file = |mode: &str, what: &str| format!("{mode}{what}.png");
    let mut blocks = Vec::new();
    for mode in REUSING.map(|m| m.name()) {
        blocks.push(Block::Slider {
            title: format!("The middle view: {mode} and the converged picture"),
            before: Picture::new(file(mode, ""), name(mode)),
            after: Picture::new("truth.png", "converged"),
        });
    }
    blocks
        .push(Block::Text("Where the modes' errors lie furthest apart, with FLIP's error maps:".to_owned()));
    blocks.push(Block::Pictures(
        std::iter::once(Picture::new("truth-part.png", "converged"))
            .chain(COLORS.iter().map(|(mode, _)| Picture::new(file(mode, "-part"), name(mode))))
            .collect(),
    ));
    let map = |mode: &str, what: &str| {
        let mean = flip(mode).map_or(String::new(), |f| format!(", mean of the whole {f:.4}"));
        Picture::new(file(mode, what), format!("FLIP of {mode}{mean}"))
    };
    blocks.push(Block::Pictures(COLORS.iter().map(|(mode, _)| map(mode, "-error-part")).collect()));
    blocks.push(Block::Text(
        "Types of pixels (1 blue, 2 yellow, 3 orange) and error maps of the whole:".to_owned(),
    ));
    let types = |mode: &str| Picture::new(file(mode, "-types"), format!("types of {mode}"));
    blocks.push(Block::Pictures(REUSING.iter().map(|m| types(m.name())).collect()));
    blocks.push(Block::Pictures(REUSING.iter().map(|m| map(m.name(), "-error")).collect()));
    blocks
}
