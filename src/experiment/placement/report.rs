//! Which rule leaves the fewest open pixels at equal tracing.

use super::policies::{MODES, POLICIES};
use super::{floor_plan, stored, walks::WALKS};
use crate::experiment::run::report::{Axis, Block, Drawn, Picture, Point, Section, Series, row};
use crate::experiment::run::{Identity, Report, RunRecord, matching};
use crate::render::Mode;
use serde_json::{Map, Value, json};

/// The rule that the others are compared with.
const BASELINE: &str = "threshold";

pub(crate) fn report(identity: &Identity, records: &[RunRecord]) -> Report {
    let mut report = Report { notes: Vec::from_iter(identity.light()), ..Report::default() };
    for mode in MODES {
        let rows = matching(records, &kind(mode, "summary"));
        if rows.is_empty() {
            continue;
        }
        let rules = ["predictive", "greedy", "grid"];
        let verdicts = rules.map(|rule| verdict(mode, rule, records));
        let rule = |v: &Verdict| json!({"open_ratio_with_no_more_tracing": geometric_mean(&v.ratios), "walks": v.ratios.len()});
        let against: Map<String, Value> = verdicts.iter().map(|v| (v.rule.to_owned(), rule(v))).collect();
        let summary = json!({ "against_threshold": against, "policies": rows });
        report.headline.extend(verdicts.iter().map(Verdict::sentence));
        report.summary.insert(mode.name().to_owned(), summary);
        report.sections.push(section(mode, records));
    }
    report
}

/// Returns the field of the pixels that the viewer waits for, in percent of the frame: all of Type
/// 3 for the paper's warp, and only those that no reference has seen in look-up modes.
fn open_name(mode: Mode) -> &'static str {
    if mode.looks_up() { "unseen_percent" } else { "type3_percent" }
}

/// The fields of one kind of records in a mode.
fn kind(mode: Mode, kind: &str) -> RunRecord {
    RunRecord::default().with("mode", mode.name()).with("kind", kind)
}

/// A rule compared with [`BASELINE`] at no more tracing, walk by walk.
struct Verdict {
    mode: &'static str,
    rule: &'static str,
    /// Open pixels of the rule over those of the baseline, one value per walk: the geometric mean
    /// over all amounts of tracing that either of them spent and the other reached.
    ratios: Vec<f64>,
}

fn geometric_mean(values: &[f64]) -> Option<f64> {
    let logs: f64 = values.iter().map(|r| r.ln()).sum();
    (!values.is_empty()).then(|| (logs / values.len() as f64).exp())
}

impl Verdict {
    fn sentence(&self) -> String {
        let (mode, rule) = (self.mode, self.rule);
        let Some(ratio) = geometric_mean(&self.ratios) else {
            return format!("Mode {mode}: {rule} and {BASELINE} cannot be compared; see the chart.");
        };
        let wins = self.ratios.iter().filter(|r| **r < 1.0).count();
        format!(
            "Mode {mode}: with the same limit of tracing, {rule} leaves {ratio:.2} times as many open pixels as {BASELINE} \
             (geometric mean), and fewer on {wins} of {} walks.",
            self.ratios.len()
        )
    }
}

fn verdict(mode: Mode, rule: &'static str, records: &[RunRecord]) -> Verdict {
    let ratios = WALKS.iter().filter_map(|(walk, _)| {
        let baseline = curve(records, walk, BASELINE, mode);
        let ours = curve(records, walk, rule, mode);
        let ratio = |&[work, _]: &[f64; 2]| {
            let [open, usual] = [least_open(&ours, work)?, least_open(&baseline, work)?];
            (open > 0.0 && usual > 0.0).then_some(open / usual)
        };
        geometric_mean(&ours.iter().chain(&baseline).filter_map(ratio).collect::<Vec<_>>())
    });
    Verdict { mode: mode.name(), rule, ratios: ratios.collect() }
}

/// Returns tracing and open pixels of a rule at all its percentages on a walk, ordered by tracing.
fn curve(records: &[RunRecord], walk: &str, rule: &str, mode: Mode) -> Vec<[f64; 2]> {
    let wanted = kind(mode, "summary").with("walk", walk).with("rule", rule);
    let mut points: Vec<[f64; 2]> = matching(records, &wanted)
        .into_iter()
        .filter_map(|r| Some([r.number("traced_mrays")?, r.number(open_name(mode))?]))
        .collect();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    points
}

/// Returns the fewest open pixels that a rule reaches at any of its percentages with no more
/// tracing than `work`. More references can save the frames more tracing than they cost, so a curve
/// may turn back and is not a function of tracing.
fn least_open(curve: &[[f64; 2]], work: f64) -> Option<f64> {
    curve.iter().filter(|p| p[0] <= work).map(|p| p[1]).min_by(f64::total_cmp)
}

fn section(mode: Mode, records: &[RunRecord]) -> Section {
    let mut blocks = vec![Block::text(ABOUT), policies(mode, records), open_against_tracing(mode, records)];
    blocks.extend(stored::table(mode, records));
    for (walk, _) in WALKS {
        let picture = |rule: &str| {
            Picture::new(floor_plan::file_name(mode.name(), walk, rule), format!("{walk}, {rule}"))
        };
        blocks.push(over_time(mode, walk, records));
        blocks.push(Block::Pictures(POLICIES.iter().map(|p| picture(p.rule)).collect()));
    }
    Section::new(format!("Mode {}", mode.name()), blocks)
}

const ABOUT: &str = "Open pixels are those that a frame has to light itself: Type 3 in mode paper, and pixels that no \
    reference has seen in look-up modes. Tracing counts all rays of frames and references. \"Used\" is the share of the \
    lit pixels of a reference traced ahead that one of the next 30 frames showed. In the floor plans wedges are \
    references, brighter if they supplied more pixels; the line is the walk.";

/// Columns of the table of policies: field, title and factor of the unit. Values are means over
/// walks.
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

fn policies(mode: Mode, records: &[RunRecord]) -> Block {
    let line = |rule: &str, percent: f64| {
        let wanted = kind(mode, "summary").with("rule", rule).with("percent", percent);
        let found = matching(records, &wanted);
        let mean = |(name, _, factor): (&str, &str, f64)| {
            let values: Vec<f64> = found.iter().filter_map(|r| r.number(name)).collect();
            // NaN without values, which becomes an empty cell.
            factor * values.iter().sum::<f64>() / values.len() as f64
        };
        (!found.is_empty()).then(|| row(rule, std::iter::once(percent).chain(COLUMNS.map(mean))))
    };
    Block::table(
        format!("Mode {}: means over the walks", mode.name()),
        ["rule", "at, %"].into_iter().chain(COLUMNS.map(|c| c.1)),
        POLICIES.iter().flat_map(|p| p.percents(mode).iter().filter_map(|percent| line(p.rule, *percent))),
    )
}

fn open_against_tracing(mode: Mode, records: &[RunRecord]) -> Block {
    let point = |r: &RunRecord| {
        let (walk, rule) = (r.text("walk")?, r.text("rule")?);
        let (percent, references) = (r.number("percent")?, r.number("references")?);
        let label = format!("{walk}, {rule} at {percent} %: {references} references");
        Some(Point::new(r.number("traced_mrays")?, r.number(open_name(mode))?, label))
    };
    let series = |rule: &str| {
        let found = matching(records, &kind(mode, "summary").with("rule", rule));
        Series::new(rule, Drawn::Marks, found.into_iter().filter_map(point))
    };
    let name = mode.name();
    Block::chart(
        format!("placement-{name}"),
        format!("Mode {name}: open pixels against tracing, every walk and percentage"),
        [Axis::logarithmic("million rays traced, references included"), Axis::linear("open pixels, %")],
        POLICIES.iter().map(|p| series(p.rule)),
    )
}

fn over_time(mode: Mode, walk: &str, records: &[RunRecord]) -> Block {
    let point = |r: &RunRecord| {
        let (frame, open) = (r.number("frame")?, r.number(open_name(mode))?);
        Some(Point::new(frame, open, format!("frame {frame}: {open:.1} %")))
    };
    let series = |rule: &str, percent: f64| {
        let wanted = kind(mode, "frame").with("walk", walk).with("rule", rule).with("percent", percent);
        Series::new(rule, Drawn::Line, matching(records, &wanted).into_iter().filter_map(point))
    };
    let shown = POLICIES.iter().filter(|p| p.rule != "none");
    let name = mode.name();
    Block::chart(
        format!("placement-{name}-{walk}"),
        format!("Mode {name}, walk {walk}: open pixels over time"),
        [Axis::linear("frame"), Axis::linear("open pixels, %")],
        shown.map(|p| series(p.rule, p.percents(mode)[0])),
    )
}

#[cfg(test)]
mod tests {
    use super::least_open;

    #[test]
    fn a_curve_that_turns_back_is_judged_by_the_least_value_so_far() {
        // With fewer references the frames trace more: the second point is worse in both.
        let curve = [[16.0, 9.5], [18.0, 19.0], [22.0, 29.0], [28.0, 7.9]];
        let found = [15.9, 16.0, 20.0, 27.9, 28.0].map(|work| least_open(&curve, work));
        assert_eq!(found, [None, Some(9.5), Some(9.5), Some(9.5), Some(7.9)]);
    }
}
