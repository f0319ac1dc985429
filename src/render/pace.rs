//! How many pixels a frame has while the view moves: as many as keep the rate of frames.

use super::frame::FrameStats;
use super::schedule::RENDER_SCALE;
use std::time::Duration;

/// From one scale to the next: the fourth root of a half, so that four steps halve the edge.
const STEP: f32 = 0.840_896_4;

/// Pixels of a frame after a step up, relative to those before.
const GROWTH: f32 = 1.0 / (STEP * STEP);

/// The coarsest scale: a quarter of the window's pixels along an edge.
const COARSEST: f32 = 0.25;

/// The share of a frame's budget that work for every pixel may take: first hits, look-ups and
/// filling. The rest of the budget traces what is not known.
const MOST: f32 = 0.5;

/// After a step up, this share is expected at most: below [`MOST`] by more than times vary, so that
/// the scale does not alternate.
const MOST_AFTER_STEP: f32 = 0.4;

/// Frames after which a scale may become coarser, and finer.
const FRAMES: [u32; 2] = [2, 12];

/// Weight of the newest frame in the mean over frames.
const NEWEST: f32 = 0.25;

/// The scale of frames while the view moves: rendered pixels per pixel of the window along an edge.
///
/// It follows from the measured times of earlier frames, within bounds: at once to fewer pixels,
/// one step at a time to more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pace {
    scale: f32,
    /// Mean share of the budget that work for every pixel took at this scale.
    share: f32,
    /// Frames in that mean.
    frames: u32,
}

impl Default for Pace {
    fn default() -> Self {
        Self { scale: RENDER_SCALE, share: 0.0, frames: 0 }
    }
}

impl Pace {
    /// Returns the scale of the next frame, at most `most`.
    pub fn scale(&self, most: f32) -> f32 {
        self.scale.min(most)
    }

    /// Notes the times of a frame of [`Self::scale`] that was rendered within a budget.
    pub fn note(&mut self, stats: &FrameStats, budget: Duration, most: f32) {
        let secs = &stats.secs;
        let of_all_pixels = secs.frame - secs.secondary - secs.trace - secs.audit;
        let share = (of_all_pixels / budget.as_secs_f64().max(1e-3)) as f32;
        if !share.is_finite() {
            return;
        }
        self.frames += 1;
        let weight = NEWEST.max(1.0 / self.frames as f32);
        self.share += (share - self.share) * weight;
        let scale = self.scale(most);
        let next = match () {
            () if self.share > MOST && self.frames >= FRAMES[0] => {
                scale * (MOST_AFTER_STEP / self.share).sqrt().min(STEP)
            }
            () if self.share * GROWTH < MOST_AFTER_STEP && self.frames >= FRAMES[1] => scale / STEP,
            () => return,
        };
        let next = next.clamp(COARSEST.min(most), most);
        if next != self.scale {
            *self = Self { scale: next, share: 0.0, frames: 0 };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BUDGET: Duration = Duration::from_millis(50);

    /// The scales of frames whose work takes this many seconds at scale one, and as much more or
    /// less as `noise` of the frame's number.
    fn scales(secs: f64, most: f32, noise: impl Fn(usize) -> f64) -> Vec<f32> {
        let mut pace = Pace::default();
        let frame = |i: usize| {
            let scale = pace.scale(most);
            let mut stats = FrameStats::default();
            stats.secs.trace = 0.03;
            stats.secs.frame = secs * f64::from(scale * scale) * noise(i) + stats.secs.trace;
            pace.note(&stats, BUDGET, most);
            scale
        };
        (0..400).map(frame).collect()
    }

    #[test]
    fn the_scale_keeps_the_work_within_its_share_and_stands_still() {
        for secs in [0.001, 0.01, 0.03, 0.1, 0.3] {
            let all = scales(secs, 1.0, |i| if i % 3 == 0 { 1.1 } else { 0.95 });
            let last = all[200];
            assert!(all[200..].iter().all(|&scale| scale == last), "{secs} s: the scale alternates");
            let share = secs * f64::from(last * last) / BUDGET.as_secs_f64();
            assert!(share < 0.55 && (share > 0.25 || last == 1.0), "{secs} s: scale {last}, share {share}");
        }
    }

    #[test]
    fn the_scale_is_bounded() {
        assert_eq!(scales(100.0, 1.0, |_| 1.0)[399], 0.25);
        assert_eq!(scales(1e-6, 1.0, |_| 1.0)[399], 1.0);
        assert_eq!(scales(1e-6, 0.6, |_| 1.0)[399], 0.6);
        assert_eq!(scales(100.0, 0.2, |_| 1.0)[399], 0.2);
        assert!(scales(f64::NAN, 1.0, |_| 1.0).iter().all(|scale| (0.25..=1.0).contains(scale)));
    }

    #[test]
    fn a_single_slow_frame_changes_nothing() {
        let all = scales(0.06, 1.0, |i| if i % 50 == 49 { 2.0 } else { 1.0 });
        assert!(all[100..].iter().all(|&scale| scale == all[100]));
    }
}
