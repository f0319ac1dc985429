//! The findings in sentences: how much time each mode saves against full tracing, and when it saves
//! none.

use super::aggregate::{LEAD, METRICS, Metric, Setup, ViewResult};
use super::compare::{Bound, Factor, equal_error, full_at, full_error_at, full_medians, middle, pareto};
use super::plan::{DEFAULT_REFERENCES, REUSING};
use serde_json::{Value, json};

/// Returns the setups that the headline names: those with the default number of references on still
/// views, and all flown walks, at one sample count.
fn usual(setups: &[Setup], samples: usize) -> Vec<&Setup> {
    let is_usual = |s: &&Setup| s.samples == samples && s.references.is_none_or(|n| n == DEFAULT_REFERENCES);
    REUSING.iter().flat_map(|mode| setups.iter().filter(|s| s.mode == mode.name()).filter(is_usual)).collect()
}

/// Returns the factor of equal error in one metric, over the views of the walk: median, minimum,
/// maximum.
pub(super) fn factors(
    setups: &[Setup],
    setup: &Setup,
    metric: Metric,
    references_count: bool,
) -> Option<[Factor; 3]> {
    let at = |(view, found): (&usize, &ViewResult)| {
        // Full tracing has no view at a flown frame: the frame is compared with the medians of the
        // walk.
        let full = match setup.references {
            Some(_) => full_at(setups, *view, metric),
            None => full_medians(setups, metric),
        };
        equal_error(&full, [found.secs(references_count), metric.error(found.value(metric))])
    };
    let all: Vec<Factor> = setup.measured().filter_map(at).collect();
    let by_times = |a: &&Factor, b: &&Factor| a.times.total_cmp(&b.times);
    Some([middle(all.clone())?, *all.iter().min_by(by_times)?, *all.iter().max_by(by_times)?])
}

/// Returns the headline: all modes in one sentence, the Pareto front, then each mode.
pub(super) fn headline(setups: &[Setup], samples: usize) -> Vec<String> {
    let usual = usual(setups, samples);
    let mut lines = Vec::from_iter(overview(setups, &usual, samples));
    lines.extend(front(setups));
    lines.extend(usual.into_iter().filter_map(|setup| sentence(setups, setup)));
    lines
}

/// The factor of every mode at equal error, still and flown.
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
            "Against full ray tracing at equal FLIP error, {samples} samples: {still}, without the time of references; \
             {flown} on a flown walk with the time of references. Above 1x a mode is better than full ray tracing."
        )
    })
}

fn pays(factor: Factor) -> String {
    if factor.bound == Bound::AtMost && factor.times < 1.0 {
        return "does not pay off".to_owned();
    }
    times(factor)
}

fn sentence(setups: &[Setup], setup: &Setup) -> Option<String> {
    // A flown frame is judged with the time of its references.
    let counts = setup.references.is_none();
    let [typical, least, most] = factors(setups, setup, LEAD, counts)?;
    let (secs, flip) = (setup.secs(counts), setup.value(LEAD));
    let with = if counts { ", references included" } else { "" };
    let mut text = format!("{} ({}): {} per frame{with}; ", setup.mode, setup.label(), time(secs));
    text += &verdict(typical, secs);
    text += &format!(" (over the walk {} to {}).", times(least), times(most));
    if !counts && let Some([spread, ..]) = factors(setups, setup, LEAD, true) {
        text += &format!(" With the time of references spread over the walk: {}.", times(spread));
    }
    text += &match full_error_at(&full_medians(setups, LEAD), secs) {
        Some(error) => {
            format!(" In equal time full ray tracing has a FLIP of {error:.4}, this mode {flip:.4}.")
        }
        None => format!(" Full ray tracing is never as fast; the FLIP of this mode is {flip:.4}."),
    };
    Some(text)
}

fn verdict(factor: Factor, secs: f64) -> String {
    let full = time(factor.times * secs);
    let times = times(factor);
    match factor.bound {
        Bound::Between => format!("full ray tracing takes {full} for the same FLIP error: {times}"),
        Bound::AtLeast => {
            format!("full ray tracing has a larger error even in {full}, with the most samples: {times}")
        }
        Bound::AtMost => {
            format!("full ray tracing has a smaller error even in {full}, with the fewest samples: {times}")
        }
    }
}

/// Formats a factor, such as `9.40x` or `at least 12.00x`.
pub(super) fn times(factor: Factor) -> String {
    let prefix = match factor.bound {
        Bound::Between => "",
        Bound::AtLeast => "at least ",
        Bound::AtMost => "at most ",
    };
    format!("{prefix}{:.2}x", factor.times)
}

/// Formats seconds, below one second in milliseconds.
pub(super) fn time(secs: f64) -> String {
    match secs {
        s if s < 0.01 => format!("{:.2} ms", s * 1e3),
        s if s < 1.0 => format!("{:.1} ms", s * 1e3),
        s => format!("{s:.2} s"),
    }
}

/// Which mode is best in which time, and which errors only full tracing reaches; without
/// references.
fn front(setups: &[Setup]) -> Vec<String> {
    let still: Vec<&Setup> = setups.iter().filter(|s| s.references.is_some()).collect();
    let points: Vec<_> = still.iter().map(|s| s.secs_and_error(LEAD, false)).collect();
    let mut spans: Vec<(&str, f64, f64)> = Vec::new();
    for index in pareto(&points) {
        let (mode, secs) = (still[index].mode.as_str(), points[index][0]);
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
    let best =
        format!("Best in its time (the Pareto front of FLIP, without the time of references): {text}.");
    (!text.is_empty()).then_some(best).into_iter().chain(beyond_reuse(&still)).collect()
}

/// The least error of the reusing modes, and which samples of full tracing have less.
fn beyond_reuse(still: &[&Setup]) -> Option<String> {
    let flip = |s: &Setup| s.value(LEAD);
    let least = still
        .iter()
        .filter(|s| s.mode != "full")
        .min_by(|a, b| flip(a).total_cmp(&flip(b)))
        .filter(|s| flip(s).is_finite())?;
    let better = still.iter().filter(|s| s.mode == "full" && flip(s) < flip(least)).min_by_key(|s| s.samples);
    let what = format!(
        "The lowest FLIP of a mode that reuses references is {:.4} ({}, {})",
        flip(least),
        least.mode,
        least.label()
    );
    Some(match better {
        Some(full) => format!(
            "{what}; only full ray tracing goes below it, from {} on ({}).",
            full.label(),
            time(full.secs(false))
        ),
        None => format!("{what}; full ray tracing does not reach it with the measured sample counts."),
    })
}

/// Returns the factors behind the headline as JSON: for each setup and metric, the speed-up over
/// full tracing at equal error.
pub(super) fn summary(setups: &[Setup], samples: usize) -> Value {
    let factor = |[middle, least, most]: [Factor; 3]| {
        json!({
            "median": middle.times, "min": least.times, "max": most.times,
            "is": match middle.bound {
                Bound::Between => "between", Bound::AtLeast => "at_least", Bound::AtMost => "at_most",
            },
        })
    };
    let entry = |setup: &Setup| {
        let by_metric = |counts: bool| -> Value {
            let of = |m: Metric| factors(setups, setup, m, counts).map(factor);
            Value::Object(METRICS.iter().map(|m| (m.field.to_owned(), of(*m).into())).collect())
        };
        json!({
            "mode": setup.mode, "references": setup.references, "samples": setup.samples,
            "speedup_at_equal_error": by_metric(false),
            "speedup_at_equal_error_references_counted": by_metric(true),
        })
    };
    usual(setups, samples).into_iter().map(entry).collect()
}
