//! Times a task by the median of several rounds.

use crate::experiment::statistics::median;
use std::time::Instant;

/// Number of timed rounds per figure.
pub(super) const ROUNDS: usize = 5;

/// Returns the median time of a task in seconds, after a round that is not counted.
pub(super) fn median_secs(task: impl FnMut()) -> f64 {
    median_secs_after(|| (), task)
}

/// Like [`median_secs`], with an untimed preparation before each round.
pub(super) fn median_secs_after(mut before: impl FnMut(), mut task: impl FnMut()) -> f64 {
    task();
    let timed = (0..ROUNDS).map(|_| {
        before();
        let start = Instant::now();
        task();
        start.elapsed().as_secs_f64()
    });
    median(timed).unwrap_or(f64::NAN)
}
