//! Error over time at rest, against the full tracer's.

use super::run::{FULL, WINDOW, picture_name};
use crate::experiment::run::{
    Identity, Report, RunRecord, matching,
    report::{Axis, Block, Drawn, Picture, Point, Section, Series, fields, row},
};
use serde_json::json;

const HOW: &str = "The clock counts rendering from the first frame on: import, the hierarchy and measuring are left \
    out. In a window, drawing takes its share of the same processor. Every picture is compared at the same exposure \
    with the anti-aliased picture of mode full, which a refined picture converges to.";

/// Names in records and in reports, of the measures of error.
const METRICS: [(&str, &str); 2] = [("flip_mean", "FLIP, mean"), ("mse", "mean squared error")];

pub(crate) fn report(identity: &Identity, records: &[RunRecord]) -> Report {
    let of = |picture: &str| matching(records, &RunRecord::default().with("picture", picture));
    let (window, full) = (of(WINDOW), of(FULL).first().copied());
    let rises = window.windows(2).map(|pair| value(pair[1], "mse") / value(pair[0], "mse").max(1e-30));
    let largest_rise = rises.fold(0.0, f64::max);
    let names = ["seconds", "passes", "samples", "mse", "psnr_db", "flip_mean"];
    let numbers = |r: &RunRecord, names: &[&str]| {
        fields(names.iter().map(|n| ((*n).to_owned(), r.0.get(*n).cloned().unwrap_or_default())).collect())
    };
    let mut report = Report { headline: headline(&window, full, largest_rise), ..Report::default() };
    report.notes.extend(identity.light());
    report.summary = fields(json!({
        "first_frame_secs": window.first().and_then(|r| r.number("first_frame_secs")),
        "checkpoints": window.iter().map(|r| numbers(r, &names)).collect::<Vec<_>>(),
        "largest_mse_over_one_before": largest_rise,
        "full": full.map(|r| numbers(r, &["full_secs", "samples", "mse", "psnr_db", "flip_mean"])),
        "truth_samples": identity.settings.number("truth_samples"),
        "exposure_ev": window.first().and_then(|r| r.number("exposure_ev")),
    }));
    let charts = METRICS.map(|metric| chart(&window, full, metric));
    let blocks = [Block::text(HOW)].into_iter().chain(charts).chain([table(&window, full)]);
    report.sections.push(Section::new("Error over time", blocks.collect()));
    report.sections.push(Section::new("Pictures", pictures(&window, full)));
    report
}

fn value(record: &RunRecord, name: &str) -> f64 {
    record.number(name).unwrap_or(f64::NAN)
}

fn headline(window: &[&RunRecord], full: Option<&RunRecord>, largest_rise: f64) -> Vec<String> {
    let errors = |r: &RunRecord| {
        let (flip, psnr) = (value(r, "flip_mean"), value(r, "psnr_db"));
        format!("FLIP {flip:.4}, PSNR {psnr:.2} dB")
    };
    let first = window.first().and_then(|r| r.number("first_frame_secs"));
    let first = first.map(|secs| format!("The first picture is shown after {secs:.3} s."));
    let after = |r: &&RunRecord| format!("After {} s: {}.", value(r, "seconds"), errors(r));
    let rise = format!(
        "From one checkpoint to the next, the mean squared error becomes at most {largest_rise:.3} times the one before."
    );
    let full = full.map(|r| {
        let (samples, secs) = (value(r, "samples"), value(r, "full_secs"));
        format!("Mode full with {samples} samples: {} in {secs:.1} s.", errors(r))
    });
    let rise = (window.len() > 1).then_some(rise);
    first.into_iter().chain(window.iter().map(after)).chain(rise).chain(full).collect()
}

fn chart(window: &[&RunRecord], full: Option<&RunRecord>, (field, name): (&str, &str)) -> Block {
    let point = |r: &&RunRecord| {
        let (x, y) = (value(r, "seconds"), value(r, field));
        Point::new(x, y, format!("after {x} s\n{name} {y:.3e}\n{} samples", value(r, "samples")))
    };
    let ends = || window.first().into_iter().chain(window.last());
    let level = |r: &RunRecord| {
        let (samples, y) = (value(r, "samples"), value(r, field));
        let points = ends().map(move |end| Point::new(value(end, "seconds"), y, format!("{name} {y:.3e}")));
        Series::new(format!("full, {samples} samples"), Drawn::Dashes, points).in_color("#808080")
    };
    let at_rest = Series::new("window at rest", Drawn::MarksAndLine, window.iter().map(point));
    Block::chart(
        format!("at-rest-{}", field.replace('_', "-")),
        format!("{name} against seconds at rest"),
        [Axis::logarithmic("seconds"), Axis::logarithmic(name)],
        full.map(level).into_iter().chain([at_rest.in_color("#0072b2")]),
    )
}

fn table(window: &[&RunRecord], full: Option<&RunRecord>) -> Block {
    let names = ["samples", "flip_mean", "psnr_db", "mse", "ssim"];
    let line = |first: String, r: &RunRecord| row(first, names.map(|name| r.number(name)));
    let checkpoints = window.iter().map(|r| line(format!("after {} s", value(r, "seconds")), r));
    let full = full.map(|r| line(format!("full, {:.1} s", value(r, "full_secs")), r));
    Block::table(
        "Errors of display values",
        ["picture", "samples per pixel", "FLIP, mean", "PSNR, dB", "mean squared error", "SSIM"],
        checkpoints.chain(full),
    )
}

fn pictures(window: &[&RunRecord], full: Option<&RunRecord>) -> Vec<Block> {
    let truth = || Picture::new("truth.png", "converged");
    let compared = |name: &str, caption: String| Block::Slider {
        title: format!("{caption}, and converged"),
        before: Picture::new(format!("{name}.png"), caption),
        after: truth(),
    };
    let shown = |r: &&RunRecord| {
        let seconds = value(r, "seconds");
        compared(&picture_name(seconds), format!("after {seconds} s"))
    };
    let full = full.map(|r| compared(FULL, format!("full, {} samples", value(r, "samples"))));
    window.iter().map(shown).chain(full).collect()
}
