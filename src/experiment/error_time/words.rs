//! The findings in sentences: what each mode saves against full tracing, and where it saves nothing.

use super::compare::{Bound, Factor, equal_error, full_at, full_error_at, full_medians, middle, pareto};
use super::measured::{METRICS, Setup};
use super::plan::{DEFAULT_REFERENCES, REUSING};
use serde_json::{Value, json};

/// The metric that sentences lead with.
const LEAD: usize = 0;

/// What is compared in words: still with the usual number of references, and flown.
pub(super) fn usual(setups: &[Setup], samples: usize) -> Vec<&Setup> {
    let is_usual = |s: &&Setup| s.samples == samples && s.references.is_none_or(|n| n == DEFAULT_REFERENCES);
    REUSING.iter().flat_map(|mode| setups.iter().filter(|s| s.mode == mode.name()).filter(is_usual)).collect()
}

/// Equal error in one metric, over the places of the walk: the middle, the least, the most.
pub(super) fn factors(
    setups: &[Setup],
    setup: &Setup,
    metric: usize,
    references_count: bool,
) -> Option<[Factor; 3]> {
    let measure = METRICS[metric];
    let at = |(place, found): (&usize, &super::measured::SurfaceKey)| {
        // A flown frame has no view of full tracing of its own: it is held against the walk's medians.
        let full = match setup.references {
            Some(_) => full_at(setups, *place, measure, metric),
            None => full_medians(setups, measure, metric),
        };
        equal_error(&full, [found.secs(references_count), measure.error(found.values[metric])])
    };
    let all: Vec<Factor> = setup.measured().filter_map(at).collect();
    let by_times = |a: &&Factor, b: &&Factor| a.times.total_cmp(&b.times);
    Some([middle(all.clone())?, *all.iter().min_by(by_times)?, *all.iter().max_by(by_times)?])
}

/// The headline: all modes in one sentence, the front, then each mode.
pub(super) fn headline(setups: &[Setup], samples: usize) -> Vec<String> {
    let usual = usual(setups, samples);
    let mut lines = Vec::from_iter(overview(setups, &usual, samples));
    lines.extend(front(setups));
    lines.extend(usual.into_iter().filter_map(|setup| sentence(setups, setup)));
    lines
}

/// What every mode saves at equal error, still and flown.
fn overview(setups: &[Setup], usual: &[&Setup], samples: usize) -> Option<String> {
    let saved = |counts: bool| {
        let of = usual.iter().filter(|s| s.references.is_none() == counts);
        let words =
            of.filter_map(|s| Some(format!("{} {}", s.mode, pays(factors(setups, s, LEAD, counts)?[0]))));
        words.collect::<Vec<_>>().join(", ")
    };
    let (still, flown) = (saved(false), saved(true));
    (!still.is_empty() && !flown.is_empty()).then(|| {
        format!(
            "Against full ray tracing at equal FLIP error, {samples} samples: {still}, references not counted; {flown} \
             on a flown walk with its references counted. Above 1x a mode dominates full ray tracing."
        )
    })
}

fn pays(factor: Factor) -> String {
    if factor.bound == Bound::AtMost && factor.times < 1.0 {
        return "does not pay".to_owned();
    }
    times(factor)
}

fn sentence(setups: &[Setup], setup: &Setup) -> Option<String> {
    // Flown, a frame is worth what it costs together with its references.
    let counts = setup.references.is_none();
    let [typical, least, most] = factors(setups, setup, LEAD, counts)?;
    let (secs, flip) = (setup.secs(counts), setup.value(LEAD));
    let with = if counts { ", references counted" } else { "" };
    let mut text = format!("{} ({}): {} a frame{with}; ", setup.mode, setup.label(), time(secs));
    text += &verdict(typical, secs);
    text += &format!(" (over the walk {} to {}).", times(least), times(most));
    if !counts && let Some([spread, ..]) = factors(setups, setup, LEAD, true) {
        text += &format!(" With the references' cost spread over the walk {}.", times(spread));
    }
    let full = full_medians(setups, METRICS[LEAD], LEAD);
    text += &match full_error_at(&full, secs) {
        Some(error) => format!(" In equal time full ray tracing has a FLIP of {error:.4}, this {flip:.4}."),
        None => format!(" Full ray tracing is never as fast; the FLIP here is {flip:.4}."),
    };
    Some(text)
}

fn verdict(factor: Factor, secs: f64) -> String {
    let full = time(factor.times * secs);
    match factor.bound {
        Bound::Between => format!("full ray tracing takes {full} for the same FLIP error: {}", times(factor)),
        Bound::AtLeast => {
            format!("full ray tracing errs more even in {full}, its most samples: {}", times(factor))
        }
        Bound::AtMost => {
            format!("full ray tracing errs less even in {full}, its fewest samples: {}", times(factor))
        }
    }
}

/// `9.4x`, `at least 12x`.
pub(super) fn times(factor: Factor) -> String {
    let prefix = match factor.bound {
        Bound::Between => "",
        Bound::AtLeast => "at least ",
        Bound::AtMost => "at most ",
    };
    format!("{prefix}{:.2}x", factor.times)
}

/// Of less than a second in milliseconds.
pub(super) fn time(secs: f64) -> String {
    match secs {
        s if s < 0.01 => format!("{:.2} ms", s * 1e3),
        s if s < 1.0 => format!("{:.1} ms", s * 1e3),
        s => format!("{s:.2} s"),
    }
}

/// Which mode is best in which time, and what only full tracing reaches; references not counted.
fn front(setups: &[Setup]) -> Vec<String> {
    let still: Vec<&Setup> = setups.iter().filter(|s| s.references.is_some()).collect();
    let metric = METRICS[LEAD];
    let points: Vec<_> = still.iter().map(|s| [s.secs(false), metric.error(s.value(LEAD))]).collect();
    let best = pareto(&points);
    let mut spans: Vec<(&str, f64, f64)> = Vec::new();
    for &place in &best {
        let (mode, secs) = (still[place].mode.as_str(), points[place][0]);
        match spans.last_mut() {
            Some((last, _, end)) if *last == mode => *end = secs,
            _ => spans.push((mode, secs, secs)),
        }
    }
    let span = |(mode, from, to): &(&str, f64, f64)| match from == to {
        true => format!("{mode} at {}", time(*from)),
        false => format!("{mode} from {} to {}", time(*from), time(*to)),
    };
    let text = spans.iter().map(span).collect::<Vec<_>>().join(", ");
    let mut lines = Vec::new();
    if !text.is_empty() {
        lines.push(format!("Best in its time (the Pareto front of FLIP, references not counted): {text}."));
    }
    lines.extend(beyond_reuse(&still));
    lines
}

/// What error no reusing mode reaches, and who does.
fn beyond_reuse(still: &[&Setup]) -> Option<String> {
    let least = still
        .iter()
        .filter(|s| s.mode != "full")
        .min_by(|a, b| a.value(LEAD).total_cmp(&b.value(LEAD)))
        .filter(|s| s.value(LEAD).is_finite())?;
    let mut better: Vec<_> =
        still.iter().filter(|s| s.mode == "full" && s.value(LEAD) < least.value(LEAD)).collect();
    better.sort_by_key(|s| s.samples);
    let what = format!(
        "The least FLIP of a mode that reuses is {:.4} ({}, {})",
        least.value(LEAD),
        least.mode,
        least.label()
    );
    Some(match better.first() {
        Some(full) => format!(
            "{what}; below it there is only full ray tracing, from {} on ({}).",
            full.label(),
            time(full.secs(false))
        ),
        None => format!("{what}; full ray tracing does not reach it with the samples that were tried."),
    })
}

/// The sentences in numbers.
pub(super) fn summary(setups: &[Setup], samples: usize) -> Value {
    let factor = |f: Option<[Factor; 3]>| match f {
        Some([middle, least, most]) => json!({
            "median": middle.times, "min": least.times, "max": most.times,
            "is": match middle.bound {
                Bound::Between => "between", Bound::AtLeast => "at_least", Bound::AtMost => "at_most",
            },
        }),
        None => Value::Null,
    };
    let entry = |setup: &Setup| {
        let by_metric = |counts: bool| {
            let pairs = (0..METRICS.len())
                .map(|m| (METRICS[m].field.to_owned(), factor(factors(setups, setup, m, counts))));
            Value::Object(pairs.collect())
        };
        json!({
            "mode": setup.mode, "references": setup.references, "samples": setup.samples,
            "speedup_at_equal_error": by_metric(false),
            "speedup_at_equal_error_references_counted": by_metric(true),
        })
    };
    usual(setups, samples).into_iter().map(entry).collect()
}
