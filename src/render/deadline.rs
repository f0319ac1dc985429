//! How a picture divides a time that is known in advance.

#[cfg(feature = "pictures")]
use std::time::Duration;
use std::time::Instant;

/// Share of the time, as its divisor, that goes to points of the pixels: light has more error than
/// edges while there is little of either.
const FRAMES_DIVISOR: f64 = 32.0;

/// Points of each pixel, at most.
const MAX_FRAMES: u32 = 16;

/// The end of the time for a picture, and how much of it is needed to show light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Deadline {
    end: Instant,
    total_secs: f64,
    /// Time of the filter, seconds: estimated, or that of the last time.
    pub(super) filter_secs: f64,
    /// Time of a looked-up frame, seconds: estimated, or that of the last.
    pub(super) frame_secs: f64,
}

impl Deadline {
    /// A deadline at the end of a time that begins now.
    #[cfg(feature = "pictures")]
    pub(super) fn after(time: Duration) -> Self {
        /// A year: the clock does not go on for ever.
        const MAX: Duration = Duration::from_secs(31_536_000);
        let end = Instant::now() + time.min(MAX);
        Self { end, total_secs: time.as_secs_f64(), filter_secs: 0.0, frame_secs: 0.0 }
    }

    /// Number of frames, through different points of the pixels, that show light: a power of two.
    pub(super) fn frames(&self) -> u32 {
        let affordable = self.total_secs / FRAMES_DIVISOR / self.frame_secs.max(f64::MIN_POSITIVE);
        let count = (affordable as u32).clamp(1, MAX_FRAMES);
        1 << count.ilog2()
    }

    /// True where the time that is left is needed to show light, in this number of frames.
    pub(super) fn is_due(&self, frames: u32) -> bool {
        self.left_secs() <= self.show_secs(frames)
    }

    /// True where light can be added for as long as it takes to show it.
    pub(super) fn has_time_for_more(&self, frames: u32) -> bool {
        self.left_secs() > 2.0 * self.show_secs(frames)
    }

    fn left_secs(&self) -> f64 {
        self.end.saturating_duration_since(Instant::now()).as_secs_f64()
    }

    fn show_secs(&self, frames: u32) -> f64 {
        self.filter_secs + f64::from(frames) * self.frame_secs
    }
}

#[cfg(all(test, feature = "pictures"))]
mod tests {
    use super::*;

    #[test]
    fn a_time_is_divided_into_light_and_frames() {
        let hour =
            Deadline { filter_secs: 1.0, frame_secs: 2.0, ..Deadline::after(Duration::from_secs(3600)) };
        assert_eq!(hour.frames(), 16);
        assert!(!hour.is_due(16) && hour.has_time_for_more(16));
        let slow = Deadline { frame_secs: 30.0, ..hour };
        assert_eq!(slow.frames(), 2, "3600 / 32 / 30 is 3.75");
        assert!(slow.is_due(120) && !slow.has_time_for_more(60) && !slow.is_due(60));
        let over = Deadline::after(Duration::ZERO);
        assert!(over.is_due(1) && !over.has_time_for_more(1));
        assert!(!Deadline::after(Duration::MAX).is_due(1));
    }
}
