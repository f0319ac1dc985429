//! Times a task by the median of several rounds.

use crate::experiment::statistics::median;
use std::time::Instant;

/// Rounds timed of each figure.
pub(super) const ROUNDS: usize = 5;

/// The median seconds of a task, after a round that is not counted.
pub(super) fn median_secs(task: impl FnMut()) -> f64 {
    median_secs_after(|| (), task)
}

/// The same, with something done before each round that is not timed.
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
