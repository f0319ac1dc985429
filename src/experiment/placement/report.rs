//! Which rule leaves least to wait for, at equal tracing.

use super::plan::{MODES, POLICIES};
use super::{floor_plan, walks};
use crate::experiment::run::report::{Axis, Block, Chart, Drawn, Picture, Point, Section, Series, Table};
use crate::experiment::run::{Identity, Report, RunRecord};
use serde_json::{Map, Value, json};

/// The policy the others are compared with.
const BASELINE: &str = "threshold";

pub(crate) fn report(_: &Identity, records: &[RunRecord]) -> Report {
    let mut report = Report::default();
    for mode in MODES.map(|m| m.name()) {
        let of_mode: Vec<&RunRecord> = records.iter().filter(|r| r.text("mode") == Some(mode)).collect();
        if of_mode.is_empty() {
            continue;
        }
        let verdicts: Vec<Verdict> =
            ["predictive", "greedy", "grid"].into_iter().map(|rule| verdict(mode, rule, &of_mode)).collect();
        report.headline.extend(verdicts.iter().map(Verdict::sentence));
        report.summary.insert(mode.to_owned(), summary(&of_mode, &verdicts));
        report.sections.push(section(mode, &of_mode));
    }
    report
}

/// What a mode makes the viewer wait for, in percent of the pixels: all of Type 3 where the paper's warp leaves it; where
/// light is looked up, only what no reference knows.
fn open_name(mode: &str) -> &'static str {
    if mode == "paper" { "type3_percent" } else { "unseen_percent" }
}

fn kind<'a>(records: &'a [&RunRecord], kind: &'a str) -> impl Iterator<Item = &'a RunRecord> + Clone {
    records.iter().copied().filter(move |r| r.text("kind") == Some(kind))
}

/// A rule against [`BASELINE`] with no more tracing, walk by walk.
struct Verdict {
    mode: &'static str,
    rule: &'static str,
    /// Its open pixels over those of the baseline, a value for every walk: the mean over all amounts of tracing that either
    /// of them spent and the other reached.
    ratios: Vec<f64>,
}

impl Verdict {
    /// The geometric mean.
    fn ratio(&self) -> Option<f64> {
        let logs: f64 = self.ratios.iter().map(|r| r.ln()).sum();
        (!self.ratios.is_empty()).then(|| (logs / self.ratios.len() as f64).exp())
    }

    fn sentence(&self) -> String {
        let (mode, rule) = (self.mode, self.rule);
        let Some(ratio) = self.ratio() else {
            return format!("Mode {mode}: {rule} and {BASELINE} cannot be compared; see the chart.");
        };
        let wins = self.ratios.iter().filter(|r| **r < 1.0).count();
        format!(
            "Mode {mode}: within the same limit of tracing {rule} leaves {ratio:.2} times as many open pixels as {BASELINE} \
             (geometric mean), fewer on {wins} of {} walks.",
            self.ratios.len()
        )
    }
}

fn verdict(mode: &'static str, rule: &'static str, records: &[&RunRecord]) -> Verdict {
    let ratios = walks::WALKS.iter().filter_map(|(walk, _)| {
        let baseline = curve(records, walk, BASELINE, mode);
        let ours = curve(records, walk, rule, mode);
        let ratio = |&[work, _]: &[f64; 2]| {
            let [open, usual] = [least_open(&ours, work)?, least_open(&baseline, work)?];
            (open > 0.0 && usual > 0.0).then(|| (open / usual).ln())
        };
        let logs: Vec<f64> = ours.iter().chain(&baseline).filter_map(ratio).collect();
        (!logs.is_empty()).then(|| (logs.iter().sum::<f64>() / logs.len() as f64).exp())
    });
    Verdict { mode, rule, ratios: ratios.collect() }
}

/// Tracing and open pixels of a rule at all its percentages on a walk, by tracing.
fn curve(records: &[&RunRecord], walk: &str, rule: &str, mode: &str) -> Vec<[f64; 2]> {
    let wanted = RunRecord::default().with("walk", walk).with("rule", rule);
    let mut points: Vec<[f64; 2]> = kind(records, "summary")
        .filter(|r| r.agrees_with(&wanted))
        .filter_map(|r| Some([r.number("traced_mrays")?, r.number(open_name(mode))?]))
        .collect();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    points
}

/// The fewest open pixels that a rule reaches at any of its percentages with no more tracing than this: more references
/// can spare the frames more than they cost, so that a curve runs back and has no value at an amount.
fn least_open(curve: &[[f64; 2]], work: f64) -> Option<f64> {
    curve.iter().filter(|p| p[0] <= work).map(|p| p[1]).min_by(f64::total_cmp)
}

fn summary(records: &[&RunRecord], verdicts: &[Verdict]) -> Value {
    let mut rules = Map::new();
    for v in verdicts {
        rules.insert(
            v.rule.to_owned(),
            json!({"open_ratio_with_no_more_tracing": v.ratio(), "walks": v.ratios.len()}),
        );
    }
    let rows: Vec<&RunRecord> = kind(records, "summary").collect();
    json!({ "against_threshold": rules, "policies": rows })
}

fn section(mode: &'static str, records: &[&RunRecord]) -> Section {
    let mut blocks = vec![
        Block::Text(ABOUT.to_owned()),
        Block::Table(policies(mode, records)),
        Block::Chart(open_against_tracing(mode, records)),
    ];
    for (walk, _) in walks::WALKS {
        blocks.push(Block::Chart(over_time(mode, walk, records)));
        let picture = |(rule, ..): &(&str, &[f64], &[f64])| {
            Picture::new(floor_plan::file_name(mode, walk, rule), format!("{walk}, {rule}"))
        };
        blocks.push(Block::Pictures(POLICIES.iter().map(picture).collect()));
    }
    Section { title: format!("Mode {mode}"), blocks }
}

const ABOUT: &str = "Open pixels are those that a frame has to light itself: Type 3 in mode paper, in modes that look up \
    what no reference knows. Tracing is all rays of frames and references together. Used is how much of what a reference \
    made ahead had lit one of the next 30 frames showed. In the plans wedges are references, the brighter the more they \
    supplied; the line is the walk.";

/// Values of a policy, averaged over walks.
const COLUMNS: [(&str, &str, f64); 11] = [
    ("references", "references", 1.0),
    ("reference_secs", "seconds on them", 1.0),
    ("traced_mrays", "million rays in all", 1.0),
    ("type3_percent", "Type 3, %", 1.0),
    ("unseen_percent", "unseen, %", 1.0),
    ("unseen_p95_percent", "95th percentile, %", 1.0),
    ("frame_secs", "frame, ms", 1e3),
    ("frame_p99_secs", "99th percentile, ms", 1e3),
    ("psnr_db", "PSNR, dB", 1.0),
    ("prediction_use_percent", "used, %", 1.0),
    ("cache_mb", "memory, MB", 1.0),
];

fn policies(mode: &str, records: &[&RunRecord]) -> Table {
    let row = |rule: &str, percent: f64| {
        let wanted = RunRecord::default().with("rule", rule).with("percent", percent);
        let found: Vec<&RunRecord> = kind(records, "summary").filter(|r| r.agrees_with(&wanted)).collect();
        let mean = |(name, _, factor): (&str, &str, f64)| {
            let values: Vec<f64> = found.iter().filter_map(|r| r.number(name)).collect();
            let mean = factor * values.iter().sum::<f64>() / values.len() as f64;
            if values.is_empty() { Value::Null } else { mean.into() }
        };
        let row = [Value::from(rule), percent.into()].into_iter().chain(COLUMNS.map(mean)).collect();
        (!found.is_empty()).then_some(row)
    };
    let of_rule = |(rule, dense, sparse): &(&'static str, &'static [f64], &'static [f64])| {
        let percents = if mode == "paper" { *dense } else { *sparse };
        percents.iter().filter_map(|percent| row(rule, *percent)).collect::<Vec<_>>()
    };
    let names = ["rule", "at, %"].into_iter().chain(COLUMNS.map(|c| c.1));
    Table {
        title: format!("Mode {mode}: means over the walks"),
        columns: names.map(str::to_owned).collect(),
        rows: POLICIES.iter().flat_map(of_rule).collect(),
    }
}

fn open_against_tracing(mode: &str, records: &[&RunRecord]) -> Chart {
    let point = |r: &RunRecord| {
        let at = [r.number("traced_mrays")?, r.number(open_name(mode))?];
        let words = [r.text("walk")?, r.text("rule")?];
        let label = format!(
            "{}, {} at {} %: {} references",
            words[0],
            words[1],
            r.number("percent")?,
            r.number("references")?
        );
        Some(Point::new(at[0], at[1], label))
    };
    let series = |(rule, ..): &(&str, &[f64], &[f64])| Series {
        name: (*rule).to_owned(),
        points: kind(records, "summary").filter(|r| r.text("rule") == Some(rule)).filter_map(point).collect(),
        ..Series::default()
    };
    Chart {
        name: format!("placement-{mode}"),
        title: format!("Mode {mode}: open pixels against tracing, every walk and percentage"),
        x: Axis::logarithmic("million rays traced, references included"),
        y: Axis::linear("open pixels, %"),
        series: POLICIES.iter().map(series).collect(),
        ..Chart::default()
    }
}

fn over_time(mode: &str, walk: &str, records: &[&RunRecord]) -> Chart {
    let series = |(rule, dense, sparse): &(&str, &[f64], &[f64])| {
        let percent = if mode == "paper" { dense[0] } else { sparse[0] };
        let wanted = RunRecord::default().with("walk", walk).with("rule", *rule).with("percent", percent);
        let point = |r: &RunRecord| {
            let at = [r.number("frame")?, r.number(open_name(mode))?];
            Some(Point::new(at[0], at[1], format!("frame {}: {:.1} %", at[0], at[1])))
        };
        Series {
            name: (*rule).to_owned(),
            drawn: Drawn::Line,
            points: kind(records, "frame").filter(|r| r.agrees_with(&wanted)).filter_map(point).collect(),
            ..Series::default()
        }
    };
    Chart {
        name: format!("placement-{mode}-{walk}"),
        title: format!("Mode {mode}, walk {walk}: open pixels over time"),
        x: Axis::linear("frame"),
        y: Axis::linear("open pixels, %"),
        series: POLICIES.iter().filter(|p| p.0 != "none").map(series).collect(),
        ..Chart::default()
    }
}

#[cfg(test)]
mod tests {
    use super::least_open;

    #[test]
    fn a_curve_that_runs_back_is_judged_by_what_it_reaches_so_far() {
        // Fewer references make the frames trace more: the second point is worse in both.
        let curve = [[16.0, 9.5], [18.0, 19.0], [22.0, 29.0], [28.0, 7.9]];
        let found = [15.9, 16.0, 20.0, 27.9, 28.0].map(|work| least_open(&curve, work));
        assert_eq!(found, [None, Some(9.5), Some(9.5), Some(9.5), Some(7.9)]);
    }
}
