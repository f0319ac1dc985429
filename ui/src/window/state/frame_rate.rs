//! How often frames are rendered while the camera moves.

use std::collections::VecDeque;
use std::time::{Duration, Instant};

/// Time span over which frames are counted.
const SPAN: Duration = Duration::from_secs(1);

/// Weight of the newest frame in the mean time from its request to the window.
const NEWEST: f32 = 0.2;

/// Frames that come later than this after their pose was requested are late: a picture that stands
/// still for less is better than a reprojected one, in which surfaces are smeared.
const LATE: Duration = Duration::from_millis(500);

/// The frames that were rendered while the camera moved, each at the newest pose.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FrameRate {
    /// Times at which the frames of the last second were shown, the oldest first.
    shown: VecDeque<Instant>,
    /// Frames that were counted, since the start.
    total: u64,
    /// Mean time from the request of a frame's pose to its display, the newest counting most.
    delay_secs: f32,
    /// Frames per second of the last motion.
    per_sec: Option<f32>,
}

impl FrameRate {
    /// Notes that a frame whose rendering was `begun` then is shown now.
    pub fn note(&mut self, begun: Instant) {
        self.note_at(begun, Instant::now());
    }

    fn note_at(&mut self, begun: Instant, now: Instant) {
        let delay = now.saturating_duration_since(begun).as_secs_f32();
        let weight = if self.shown.is_empty() { 1.0 } else { NEWEST };
        self.delay_secs += (delay - self.delay_secs) * weight;
        // Motion that pauses for so long is another motion.
        if self.shown.back().is_some_and(|last| now - *last > SPAN) {
            self.shown.clear();
        }
        self.shown.push_back(now);
        while self.shown.front().is_some_and(|first| now - *first > SPAN) {
            self.shown.pop_front();
        }
        self.total += 1;
        let span = self.shown.front().map_or(0.0, |first| (now - *first).as_secs_f32());
        if self.shown.len() > 2 && span > 0.0 {
            self.per_sec = Some((self.shown.len() - 1) as f32 / span);
        }
    }

    /// Returns the frames per second of the last motion; `None` before there was one.
    pub fn per_sec(&self) -> Option<f32> {
        self.per_sec
    }

    /// Returns the number of frames that were counted since the start.
    pub fn total(&self) -> u64 {
        self.total
    }

    /// True where frames are shown so late after their pose that the picture must be reprojected to
    /// follow the hand.
    pub fn is_late(&self) -> bool {
        self.delay_secs > LATE.as_secs_f32()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rate(ms: u64, delay_ms: u64, count: u64) -> FrameRate {
        let (mut rate, start) = (FrameRate::default(), Instant::now());
        for i in 0..count {
            let begun = start + Duration::from_millis(ms * i);
            rate.note_at(begun, begun + Duration::from_millis(delay_ms));
        }
        rate
    }

    #[test]
    fn frames_of_the_last_second_are_counted() {
        assert_eq!(rate(50, 30, 1).per_sec(), None);
        for count in [3, 10, 200] {
            let rate = rate(50, 30, count);
            let per_sec = rate.per_sec().unwrap();
            assert!((per_sec - 20.0).abs() < 0.01, "{per_sec}");
            assert_eq!(rate.total(), count);
        }
    }

    #[test]
    fn a_renderer_that_is_behind_is_late_and_one_slow_frame_is_not() {
        assert!(rate(600, 610, 4).is_late());
        let mut rate = rate(50, 45, 20);
        assert!(!rate.is_late());
        let begun = Instant::now();
        rate.note_at(begun, begun + Duration::from_millis(1500));
        assert!(!rate.is_late());
    }
}
