//! Sections, tables and pictures of error against run time.

use super::aggregate::{METRICS, Metric, Setup};
use super::charts::{COLORS, against_time, influences, with_references};
use super::headline::{factors, headline, summary, times};
use super::plan::{DEFAULT_REFERENCES, REUSING};
use crate::experiment::run::report::{Block, Picture, Section, fields, row};
use crate::experiment::run::{Identity, Report, RunRecord, matching, median_of};
use serde_json::{Value, json};

const FIXED: &str = "Mode paper follows the paper exactly, without any repair of holes or of pixels that see through. \
    Modes fast and exact find every surface by its primary ray, so they have no such pixels. Therefore no setting of a \
    repair is varied here.";

const HOW: &str = "Still views stand midway between two references. References stand at every 2 % of the walk, are traced \
    in full with as many samples as the frame, and their time is not included in the first charts. Marks are medians \
    over the views. Bars reach from the lower to the upper quartile: horizontally over repetitions and views, vertically \
    over views.";

const COUNTED: &str = "Here every frame pays its share of all references along the walk. Flown walks place their own \
    references as they go, and pay for exactly those.";

pub(crate) fn report(identity: &Identity, records: &[RunRecord]) -> Report {
    let samples = identity.settings.number("samples").unwrap_or(16.0) as usize;
    let setups = Setup::all(records);
    let with_text = |text: &str, charts: Vec<Block>| [vec![Block::text(text)], charts].concat();
    let tables =
        vec![equal_errors(&setups), by_type(records, samples), everything(&setups), Block::text(FIXED)];
    let sections = vec![
        Section::new(
            "Error against time, references not counted",
            with_text(HOW, against_time(&setups).collect()),
        ),
        Section::new("References counted", with_text(COUNTED, with_references(&setups).collect())),
        Section::new("The influence of references and samples", influences(&setups, samples).into()),
        Section::new("Tables", tables),
        Section::new("Pictures", pictures(records, samples)),
    ];
    let summary = fields(json!({
        "equal_error": summary(&setups, samples),
        "setups": setups.iter().map(setup_json).collect::<Value>(),
    }));
    let notes = Vec::from_iter(identity.light());
    Report { headline: headline(&setups, samples), notes, summary, sections, failure: None }
}

fn setup_json(setup: &Setup) -> Value {
    let mut object = json!({
        "mode": setup.mode, "references": setup.references, "samples": setup.samples,
        "frame_secs": setup.secs(false), "frame_secs_references_counted": setup.secs(true),
    });
    for metric in METRICS {
        object[metric.field] = setup.value(metric).into();
    }
    object
}

/// How many times as long full tracing takes for the same error.
fn equal_errors(setups: &[Setup]) -> Block {
    let line = |setup: &Setup| {
        let factor = |m: Metric, counts| factors(setups, setup, m, counts).map(|[middle, ..]| times(middle));
        let factors = [false, true].into_iter().flat_map(|counts| METRICS.map(|m| factor(m, counts)));
        row(setup.mode.clone(), std::iter::once(Some(setup.label())).chain(factors))
    };
    let names = METRICS.map(|m| format!("by {}", m.name));
    let counted = METRICS.map(|m| format!("by {}, references counted", m.name));
    Block::table(
        "Time of full ray tracing for the same error over the time of the mode: medians over the walk",
        ["mode".to_owned(), "with".to_owned()].into_iter().chain(names).chain(counted),
        setups.iter().filter(|s| s.mode != "full").map(line),
    )
}

fn by_type(records: &[RunRecord], samples: usize) -> Block {
    let line = |(mode, _): &(&str, &str)| {
        let references = if *mode == "full" { 0 } else { DEFAULT_REFERENCES };
        let wanted = RunRecord::default().with("kind", "still").with("mode", *mode);
        let found = matching(records, &wanted.with("references", references).with("samples", samples));
        let value = |(part, t): (&str, u32)| median_of(&found, &format!("type{t}_{part}"));
        let parts = ["percent", "error_percent", "mse"];
        (!found.is_empty()).then(|| row(*mode, parts.iter().flat_map(|p| [1, 2, 3].map(|t| value((p, t))))))
    };
    let parts = ["share of pixels, %", "share of squared error, %", "mean squared error"];
    let names = parts.iter().flat_map(|part| [1, 2, 3].map(|t| format!("Type {t}, {part}")));
    Block::table(
        format!("Error by pixel type, {DEFAULT_REFERENCES} references, {samples} samples; medians"),
        std::iter::once("mode".to_owned()).chain(names),
        COLORS.iter().filter_map(line),
    )
}

fn everything(setups: &[Setup]) -> Block {
    let line = |s: &Setup| {
        let setting = [s.references.map_or("flown".into(), Value::from), s.samples.into()];
        let ms = [false, true].map(|counts| Value::from(s.secs(counts) * 1e3));
        let values = METRICS.map(|m| Value::from(s.value(m)));
        row(s.mode.clone(), setting.into_iter().chain(ms).chain(values))
    };
    let first = ["mode", "references", "samples", "ms per frame", "ms per frame, references counted"];
    Block::table(
        "All setups; medians over the walk",
        first.into_iter().chain(METRICS.map(|m| m.name)),
        setups.iter().map(line),
    )
}

fn pictures(records: &[RunRecord], samples: usize) -> Vec<Block> {
    let modes = COLORS.map(|(mode, _)| mode);
    let reusing = REUSING.map(|m| m.name());
    let name = |mode: &str| match mode {
        "full" => format!("full, {samples} samples"),
        mode => format!("{mode}, {DEFAULT_REFERENCES} references, {samples} samples"),
    };
    let file = |mode: &str, what: &str| format!("{mode}{what}.png");
    let error = |mode: &str, what: &str| {
        let wanted = RunRecord::default().with("kind", "pictures").with("mode", mode);
        let flip = median_of(&matching(records, &wanted), "flip_mean");
        let mean = flip.map_or(String::new(), |f| format!(", mean of the whole picture {f:.4}"));
        Picture::new(file(mode, what), format!("FLIP error of {mode}{mean}"))
    };
    let slider = |mode: &str| Block::Slider {
        title: format!("The middle view: {mode} and the converged picture"),
        before: Picture::new(file(mode, ""), name(mode)),
        after: Picture::new("truth.png", "converged"),
    };
    let parts = modes.map(|mode| Picture::new(file(mode, "-part"), name(mode)));
    let truth = Picture::new("truth-part.png", "converged");
    let types = reusing.map(|mode| Picture::new(file(mode, "-types"), format!("pixel types of {mode}")));
    let mut blocks: Vec<Block> = reusing.into_iter().map(slider).collect();
    blocks.extend([
        Block::text("The part in which the errors of the modes differ most, with FLIP error maps:"),
        Block::Pictures(std::iter::once(truth).chain(parts).collect()),
        Block::Pictures(modes.map(|mode| error(mode, "-error-part")).into()),
        Block::text("Pixel types (1 blue, 2 yellow, 3 orange) and error maps of the whole picture:"),
        Block::Pictures(types.into()),
        Block::Pictures(reusing.map(|mode| error(mode, "-error")).into()),
    ]);
    blocks
}
