//! The last minute, for the plots.

use super::State;
use std::time::{Duration, Instant};

/// One frame in the plots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    /// When.
    pub at: Instant,
    /// Type 1, 2 and 3 in percent.
    pub percent: [f32; 3],
    /// Selection and warp, secondary, tracing in milliseconds.
    pub stage_ms: [f32; 3],
}

/// The plots reach back so far.
pub const HISTORY: Duration = Duration::from_secs(60);

impl State {
    /// Adds the newest frame to the plots.
    pub fn record(&mut self) {
        let Some(frame) = &self.frame else { return };
        let (stats, now) = (&frame.stats, Instant::now());
        let p = stats.types.percentages();
        let ms = |secs: f64| (secs * 1000.0) as f32;
        self.history.push_back(Sample {
            at: now,
            percent: [p.type1_percent, p.type2_percent, p.type3_percent].map(|v| v as f32),
            stage_ms: [stats.secs.select + stats.secs.warp, stats.secs.secondary, stats.secs.trace].map(ms),
        });
        while self.history.front().is_some_and(|s| now - s.at > HISTORY) {
            self.history.pop_front();
        }
    }
}
