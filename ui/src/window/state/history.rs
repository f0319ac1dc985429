//! The frames of the last minute, for the plots.

use afterimage::render::frame::FrameStats;
use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// One frame in the plots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// Time at which the frame was shown.
    pub at: Instant,
    /// Shares of Type 1, 2 and 3, in percent.
    pub percent: [f32; 3],
    /// Time for selection with visibility and lookup (in mode `paper`: warping), for secondary rays
    /// and for tracing, in milliseconds.
    pub stage_ms: [f32; 3],
}

/// Time span of the plots.
pub const HISTORY: Duration = Duration::from_secs(60);

/// Adds a frame and drops those older than [`HISTORY`].
pub(super) fn record(history: &mut VecDeque<Sample>, stats: &FrameStats) {
    let now = Instant::now();
    let p = stats.types.percentages();
    let ms = |secs: f64| (secs * 1000.0) as f32;
    history.push_back(Sample {
        at: now,
        percent: [p.type1_percent, p.type2_percent, p.type3_percent].map(|v| v as f32),
        stage_ms: [
            stats.secs.select + stats.secs.visibility_and_lookup,
            stats.secs.secondary,
            stats.secs.trace,
        ]
        .map(ms),
    });
    while history.front().is_some_and(|s| now - s.at > HISTORY) {
        history.pop_front();
    }
}
