//! The auditor: traces a few pixels of every looked-up frame in full and compares them with what
//! was shown.
//!
//! Each pixel is traced twice with independent random numbers, so that the noise of the audit does
//! not count as an error of the picture (see `statistics`). A pixel that looks wrong is traced with
//! many samples, and the references whose light there is off are examined; a block of a reference
//! that is at fault forgets its light (see `blame`). The clock decides how many pixels are audited,
//! so an audited walk may differ from run to run where a reference is at fault; otherwise a picture
//! does not depend on being audited.

use super::statistics::{AuditEstimate, FrameSums, Window, display_error, looks_wrong};
use super::{
    audited::Audited,
    blame::{self, Blame},
};
use crate::math::key::Key;
use crate::reference::ReferenceCache;
use crate::trace::{
    PixelTrace, TraceSettings,
    parallel::{NEVER, trace_pixels},
};
use glam::Vec3;
use std::{collections::BTreeMap, time::Instant};

/// The share of a frame's time that its audit may take, 0..1.
const MAX_TIME: f64 = 0.05;

/// At most one pixel in this many is audited, however fast that is: more pixels hardly improve the
/// estimate.
const MIN_SPACING: usize = 16;

/// Pixels audited in the first frame, when their cost is not known.
const FIRST_PIXELS: usize = 32;

/// Weight, 0..1, of the newest frame in the moving average of a pixel's cost: it adapts fast enough
/// to follow a walk from room to room.
const NEWEST: f64 = 0.25;

/// Samples of an audit relative to the frame's. Fewer pixels are audited in the same time, but the
/// product of two errors has a sixteenth of the variance, and the curvature of the display curve
/// under noise has little effect.
const CHECKING_SAMPLES: u32 = 4;

/// Samples, relative to the frame's, of each of two traces of a pixel that looks wrong.
const CONFIRMING_SAMPLES: u32 = 16;

/// Keeps the random numbers of audits apart from those of frames and references, whose seeds count
/// upwards from small numbers.
const AUDIT_SEED: u64 = 0xa0d1_7000_0000_0000;

/// Unspent time is saved for this many frames, so that pixels are audited even where a single one
/// takes longer than one frame allows.
const SAVED_FRAMES: f64 = 4.0;

/// Audits frame after frame.
#[derive(Debug, Default)]
pub struct Auditor {
    frames: u64,
    budget: Budget,
    window: Window,
    blame: Blame,
    forgotten_blocks: usize,
    checks: Vec<Option<[Vec3; 2]>>,
    confirmed: Vec<Option<[PixelTrace; 2]>>,
}

/// The time left for audits.
#[derive(Debug, Default)]
struct Budget {
    secs: f64,
    /// Moving average of the cost of a pixel, seconds; `None` before the first audit.
    secs_per_pixel: Option<f64>,
}

impl Budget {
    /// The number of a frame's pixels that can be audited at the cost measured so far.
    fn pixels_to_check(&mut self, pixels: usize, frame_secs: f64) -> usize {
        let allowed = MAX_TIME * frame_secs;
        let one = self.secs_per_pixel.unwrap_or(0.0);
        self.secs = (self.secs + allowed).min((SAVED_FRAMES * allowed).max(one));
        let affordable = if one > 0.0 { (self.secs.max(0.0) / one) as usize } else { FIRST_PIXELS };
        affordable.min(pixels / MIN_SPACING)
    }

    fn spend(&mut self, secs: f64, pixels: usize) {
        self.secs -= secs;
        if pixels > 0 {
            let newest = secs / pixels as f64;
            let before = self.secs_per_pixel.unwrap_or(newest);
            self.secs_per_pixel = Some(before + NEWEST * (newest - before));
        }
    }
}

impl Auditor {
    /// Audits as many pixels of a frame as its time allows. Returns the seconds that took, and the
    /// estimate from the last frames.
    pub fn audit(&mut self, audited: &Audited<'_>, cache: &mut ReferenceCache) -> (f64, AuditEstimate) {
        let start = Instant::now();
        let frame = audited.frame;
        let count = self.budget.pixels_to_check(frame.radiance.len(), frame.stats.secs.frame);
        let estimate = self.check(audited, cache, count);
        let secs = start.elapsed().as_secs_f64();
        self.budget.spend(secs, count);
        (secs, estimate)
    }

    /// Audits `count` pixels of a frame. Blocks of references that are at fault forget their light.
    pub fn check(
        &mut self,
        audited: &Audited<'_>,
        cache: &mut ReferenceCache,
        count: usize,
    ) -> AuditEstimate {
        let frame = audited.frame;
        self.frames += 1;
        let pixels = chosen_pixels(self.frames, frame.radiance.len(), count);
        let exposure = audited.exposure();
        self.trace_twice(audited, &pixels);
        let suspects = self.suspects(audited, &pixels);
        self.confirm(audited, &suspects);
        let mut sums = FrameSums { secs: frame.stats.secs.frame, ..FrameSums::default() };
        let confirmed: BTreeMap<u32, [Vec3; 2]> = self.confirmed_radiance(&suspects).collect();
        for (pixel, checks) in pixels.iter().zip(self.checks.iter().flatten()) {
            let checks = confirmed.get(pixel).unwrap_or(checks);
            let shown = exposure * frame.radiance[*pixel as usize];
            sums.add(display_error(shown, checks.map(|check| exposure * check)));
        }
        sums.wrong = self.judge(audited, cache, &suspects);
        self.window.push(sums);
        AuditEstimate { forgotten_blocks: self.forgotten_blocks, ..self.window.estimate() }
    }

    /// Traces every chosen pixel twice, independently.
    fn trace_twice(&mut self, audited: &Audited<'_>, pixels: &[u32]) {
        let Audited { tracer, frame, trace } = *audited;
        let check = |which: u64| TraceSettings {
            samples: trace.samples.saturating_mul(CHECKING_SAMPLES),
            seed: trace.seed ^ AUDIT_SEED.wrapping_add(4 * self.frames + which),
            ..*trace
        };
        let settings = [check(0), check(1)];
        trace_pixels(pixels, &mut self.checks, NEVER, |pixel, rays| {
            settings.map(|s| tracer.pixel(&frame.view, pixel, &s, rays).radiance)
        });
    }

    /// The pixels that look wrong.
    fn suspects(&self, audited: &Audited<'_>, pixels: &[u32]) -> Vec<u32> {
        let checked = pixels.iter().zip(self.checks.iter().flatten());
        let wrong = checked.filter(|(pixel, checks)| is_wrong(audited, **pixel, **checks));
        wrong.map(|(pixel, _)| *pixel).collect()
    }

    /// Traces the pixels that look wrong again with many samples, twice.
    fn confirm(&mut self, audited: &Audited<'_>, suspects: &[u32]) {
        let Audited { tracer, frame, trace } = *audited;
        let settings = [2, 3].map(|which| self.confirming(trace, which));
        trace_pixels(suspects, &mut self.confirmed, NEVER, |pixel, rays| {
            settings.map(|s| tracer.pixel(&frame.view, pixel, &s, rays))
        });
    }

    fn confirmed_radiance<'a>(&'a self, suspects: &'a [u32]) -> impl Iterator<Item = (u32, [Vec3; 2])> + 'a {
        let confirmed = suspects.iter().zip(self.confirmed.iter().flatten());
        confirmed.map(|(pixel, right)| (*pixel, right.map(|traced| traced.radiance)))
    }

    fn confirming(&self, trace: &TraceSettings, which: u64) -> TraceSettings {
        let samples = trace.samples.saturating_mul(CONFIRMING_SAMPLES);
        TraceSettings {
            samples,
            seed: trace.seed ^ AUDIT_SEED.wrapping_add(4 * self.frames + which),
            ..*trace
        }
    }

    /// Counts the pixels that are wrong, and makes blocks of references at fault forget their
    /// light.
    fn judge(&mut self, audited: &Audited<'_>, cache: &mut ReferenceCache, suspects: &[u32]) -> usize {
        let settings = self.confirming(audited.trace, 2);
        let mut wrong = 0;
        for (&pixel, right) in suspects.iter().zip(self.confirmed.iter().flatten()) {
            if !is_wrong(audited, pixel, right.map(|traced| traced.radiance)) {
                continue;
            }
            wrong += 1;
            for block in self.blame.accuse(audited, cache, pixel, right, &settings) {
                let had_light = cache.forget_light(block.reference, block.corner, blame::BLOCK);
                self.forgotten_blocks += usize::from(had_light);
            }
        }
        wrong
    }
}

/// True where what a pixel shows is visibly off two independent traces of it, in the same
/// direction.
fn is_wrong(audited: &Audited<'_>, pixel: u32, right: [Vec3; 2]) -> bool {
    let exposure = audited.exposure();
    looks_wrong(exposure * audited.frame.radiance[pixel as usize], right.map(|right| exposure * right))
}

/// `count` pixels, one at a random position in each of `count` equal parts of the picture.
fn chosen_pixels(frame: u64, pixels: usize, count: usize) -> Vec<u32> {
    let pixel = |i: usize| {
        let [random, _] = Key::of_pixel(AUDIT_SEED.wrapping_add(frame), i as u32).pair();
        let at = (i as f64 + f64::from(random)) * pixels as f64 / count as f64;
        (at as usize).min(pixels - 1) as u32
    };
    (0..count).map(pixel).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn audits_take_a_twentieth_of_the_time_whatever_a_pixel_costs() {
        // Frames of 5 to 20 ms; pixels that take from a microsecond to longer than a frame allows,
        // varying from frame to frame.
        for [cheapest, dearest] in [[1e-6, 2e-6], [1e-5, 1e-4], [1e-3, 4e-3]] {
            let mut budget = Budget::default();
            let (mut frames, mut checks, mut checked) = (0.0, 0.0, 0);
            for i in 0..4000 {
                let [a, b] = Key::of_pixel(3, i).pair().map(f64::from);
                let frame_secs = 0.005 + 0.015 * a;
                let count = budget.pixels_to_check(100_000, frame_secs);
                let secs = count as f64 * (cheapest + (dearest - cheapest) * b);
                budget.spend(secs, count);
                (frames, checks, checked) = (frames + frame_secs, checks + secs, checked + count);
            }
            // Time spent in excess in one frame is saved in the next.
            let once =
                (FIRST_PIXELS as f64 * dearest).max(MAX_TIME * 0.02 * SAVED_FRAMES * dearest / cheapest);
            assert!(checks <= MAX_TIME * frames + once, "{checks} s of {frames} s");
            assert!(checked > 400, "{checked} pixels audited");
        }
        assert_eq!(Budget::default().pixels_to_check(100, 1.0), 100 / MIN_SPACING);
        assert_eq!(Budget::default().pixels_to_check(0, 1.0), 0);
    }

    #[test]
    fn chosen_pixels_are_spread_and_new_in_every_frame() {
        let [a, b] = [1, 2].map(|frame| chosen_pixels(frame, 6144, 384));
        assert!(a.windows(2).all(|w| w[0] < w[1] && w[1] - w[0] <= 32) && a != b);
        assert_eq!(a, chosen_pixels(1, 6144, 384));
        assert!(a.last().is_some_and(|last| *last < 6144));
    }
}
