//! Compares setups by error and time.

use super::aggregate::{Metric, Setup};

/// Seconds and error; lower is better for both.
pub(super) type SecsAndError = [f64; 2];

/// Time of full tracing for the same error, as a multiple.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Factor {
    pub(super) times: f64,
    pub(super) bound: Bound,
}

/// Whether a speed-up at equal error is a value or only a bound, because full tracing was not
/// measured at that error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Bound {
    /// Interpolated between two sample counts of full tracing.
    Between,
    /// Full tracing has a larger error even with the most samples that were measured.
    AtLeast,
    /// Full tracing has a smaller error even with the fewest samples that were measured.
    AtMost,
}

/// Returns the time of full tracing for an error, as a multiple of `secs`. `full` is ordered by
/// samples. Between two of its points, error is taken to be a power of time. `None` without points.
pub(super) fn equal_error(full: &[SecsAndError], [secs, error]: SecsAndError) -> Option<Factor> {
    let (first, last) = (full.first()?, full.last()?);
    let factor = |full_secs: f64, bound| Some(Factor { times: full_secs / secs, bound });
    if first[1] <= error {
        return factor(first[0], Bound::AtMost);
    }
    let crossing = full.windows(2).find(|w| w[0][1] > error && w[1][1] <= error);
    match crossing {
        Some(&[[t0, e0], [t1, e1]]) => {
            // The logarithm of a zero error is not finite; take the middle then.
            let share = ((error / e0).ln() / (e1 / e0).ln()).clamp(0.0, 1.0);
            let share = if share.is_nan() { 0.5 } else { share };
            factor(t0 * (t1 / t0).powf(share), Bound::Between)
        }
        _ => factor(last[0], Bound::AtLeast),
    }
}

/// Returns the error of full tracing in a given time; `None` if it takes longer even with the
/// fewest samples.
pub(super) fn full_error_at(full: &[SecsAndError], secs: f64) -> Option<f64> {
    let last = full.iter().rposition(|[t, _]| *t <= secs)?;
    let [t0, e0] = full[last];
    let Some(&[t1, e1]) = full.get(last + 1) else { return Some(e0) };
    // A power law cannot reach an error of zero, which every setup has in a black picture. Take the
    // error that is certainly reached.
    let share = (secs / t0).ln() / (t1 / t0).ln();
    Some(if e0 > 0.0 && e1 > 0.0 { e0 * (e1 / e0).powf(share) } else { e0 })
}

/// Returns the indices of the Pareto front in order of time.
pub(super) fn pareto(points: &[SecsAndError]) -> Vec<usize> {
    let mut order: Vec<usize> =
        (0..points.len()).filter(|p| points[*p].iter().all(|v| v.is_finite())).collect();
    order.sort_by(|a, b| {
        points[*a][0].total_cmp(&points[*b][0]).then(points[*a][1].total_cmp(&points[*b][1]))
    });
    let mut least = f64::INFINITY;
    order.retain(|p| {
        let is_better = points[*p][1] < least;
        least = least.min(points[*p][1]);
        is_better
    });
    order
}

/// Returns full tracing at one view of the walk, ordered by samples.
pub(super) fn full_at(setups: &[Setup], view: usize, metric: Metric) -> Vec<SecsAndError> {
    let point = |s: &Setup| {
        let view = s.views.get(&view)?;
        Some([view.secs(false), metric.error(view.value(metric))])
    };
    full(setups).into_iter().filter_map(point).collect()
}

/// Returns full tracing over the whole walk, ordered by samples.
pub(super) fn full_medians(setups: &[Setup], metric: Metric) -> Vec<SecsAndError> {
    full(setups).into_iter().map(|s| s.secs_and_error(metric, false)).collect()
}

fn full(setups: &[Setup]) -> Vec<&Setup> {
    let mut full: Vec<&Setup> = setups.iter().filter(|s| s.mode == "full").collect();
    full.sort_by_key(|s| s.samples);
    full
}

/// Returns the median factor; for an even number, the smaller of the two middle ones.
pub(super) fn middle(mut factors: Vec<Factor>) -> Option<Factor> {
    factors.sort_by(|a, b| a.times.total_cmp(&b.times));
    let middle = factors.len().checked_sub(1)? / 2;
    factors.get(middle).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Error halves when time is four times as long, as in Monte Carlo integration.
    const FULL: [SecsAndError; 3] = [[1.0, 0.8], [4.0, 0.4], [16.0, 0.2]];

    #[test]
    fn equal_errors_are_found_between_and_beyond_the_samples() {
        let factor = |at| equal_error(&FULL, at).unwrap();
        let between = factor([0.5, 0.8 / 2f64.sqrt()]);
        assert!((between.times - 4.0).abs() < 1e-12 && between.bound == Bound::Between, "{between:?}");
        assert_eq!(factor([0.5, 0.4]), Factor { times: 8.0, bound: Bound::Between });
        assert_eq!(factor([0.5, 0.1]), Factor { times: 32.0, bound: Bound::AtLeast });
        assert_eq!(factor([2.0, 0.9]), Factor { times: 0.5, bound: Bound::AtMost });
        assert_eq!(equal_error(&[], [1.0, 1.0]), None);
    }

    #[test]
    fn equal_times_are_found_between_the_samples() {
        assert_eq!(full_error_at(&FULL, 0.9), None);
        assert!((full_error_at(&FULL, 2.0).unwrap() - 0.8 / 2f64.sqrt()).abs() < 1e-12);
        assert_eq!(full_error_at(&FULL, 99.0), Some(0.2));
        assert_eq!(full_error_at(&[[1.0, 0.0], [4.0, 0.0]], 2.0), Some(0.0), "a black picture");
    }

    #[test]
    fn the_front_holds_what_nothing_beats() {
        let points = [[2.0, 0.5], [1.0, 0.9], [3.0, 0.5], [2.0, 0.4], [f64::NAN, 0.0], [5.0, 0.1]];
        assert_eq!(pareto(&points), [1, 3, 5]);
    }
}
