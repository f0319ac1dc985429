//! Estimates the error of pictures from audited pixels.
//!
//! The estimator: a pixel that shows s is traced twice, independently; a and b are unbiased
//! estimates of the correct value m, so the mean of (s - a)(s - b) is (s - m)^2, whatever the noise
//! of a and b. In display values (sRGB, clipped at one, as PSNR is measured everywhere here) the
//! product is scaled by the square of the display curve's slope between s and (a + b) / 2. The mean
//! over pixels, drawn evenly from the picture, and over the last frames estimates the mean squared
//! error against a converged picture; its standard error follows from the variance of the products.
//! For a pixel that looks wrong, two traces of many samples take the place of a and b: clipped,
//! the noise of few would hide how wrong the pixel is.

use crate::raster::color::srgb_from_linear;
use glam::Vec3;
use serde::Serialize;
use std::collections::VecDeque;

/// Seconds of frames that the estimate covers.
const WINDOW_SECS: f64 = 4.0;

/// Frames that the estimate covers at least, however long each takes.
const MIN_FRAMES: usize = 16;

/// Standard errors on either side of the mean that contain the true mean with a probability of 95
/// %.
const STANDARD_ERRORS: f64 = 1.96;

/// Audited pixels needed before the variance is used to estimate the standard error.
const MIN_PIXELS: usize = 64;

/// A pixel looks wrong where a channel is off by more than this in display values, where white is
/// 1.
const VISIBLE: f32 = 0.1;

/// The error of the last frames, estimated from audited pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct AuditEstimate {
    /// Pixels audited.
    pub pixels: usize,
    /// Estimated PSNR of display values against a converged picture, in decibels; `None` where the
    /// error cannot be distinguished from zero, or before enough pixels were audited.
    pub psnr_db: Option<f64>,
    /// Lower end of the 95 % confidence interval; `None` before enough pixels were audited.
    pub psnr_low_db: Option<f64>,
    /// Upper end of the 95 % confidence interval; `None` where the error cannot be distinguished
    /// from zero.
    pub psnr_high_db: Option<f64>,
    /// Share of the audited pixels, in percent, that are visibly wrong.
    pub wrong_percent: f64,
    /// Blocks of references whose light was forgotten because it was wrong, since the walk began.
    pub forgotten_blocks: usize,
}

impl AuditEstimate {
    /// Half the width of the 95 % confidence interval, in decibels; `None` where an end is open.
    pub fn plus_minus_db(&self) -> Option<f64> {
        Some((self.psnr_high_db? - self.psnr_low_db?) / 2.0)
    }
}

/// Sums over the audited pixels of one frame.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct FrameSums {
    /// Seconds that the frame took.
    pub(super) secs: f64,
    pub(super) pixels: usize,
    pub(super) error: f64,
    pub(super) error_squared: f64,
    pub(super) wrong: usize,
}

impl FrameSums {
    pub(super) fn add(&mut self, error: f64) {
        self.pixels += 1;
        self.error += error;
        self.error_squared += error * error;
    }
}

/// The sums of the last frames.
#[derive(Debug, Default)]
pub(super) struct Window {
    frames: VecDeque<FrameSums>,
}

impl Window {
    pub(super) fn push(&mut self, frame: FrameSums) {
        self.frames.push_back(frame);
        let mut secs: f64 = self.frames.iter().map(|f| f.secs).sum();
        while self.frames.len() > MIN_FRAMES && secs > WINDOW_SECS {
            secs -= self.frames.pop_front().map_or(0.0, |f| f.secs);
        }
    }

    pub(super) fn estimate(&self) -> AuditEstimate {
        let sum = |of: fn(&FrameSums) -> f64| self.frames.iter().map(of).sum::<f64>();
        let pixels: usize = self.frames.iter().map(|f| f.pixels).sum();
        let wrong: usize = self.frames.iter().map(|f| f.wrong).sum();
        let count = pixels.max(1) as f64;
        let mean = sum(|f| f.error) / count;
        let variance = (sum(|f| f.error_squared) / count - mean * mean).max(0.0);
        let bound = STANDARD_ERRORS * (variance / (count - 1.0).max(1.0)).sqrt();
        let decibels = |error: f64| (error > 0.0).then(|| -10.0 * error.log10());
        let is_enough = pixels >= MIN_PIXELS;
        AuditEstimate {
            pixels,
            psnr_db: decibels(mean).filter(|_| is_enough),
            psnr_low_db: decibels(mean.max(0.0) + bound).filter(|_| is_enough),
            psnr_high_db: decibels(mean - bound).filter(|_| is_enough),
            wrong_percent: 100.0 * wrong as f64 / count,
            forgotten_blocks: 0,
        }
    }
}

/// Display value of a linear channel, 0..1.
fn display(linear: f32) -> f32 {
    srgb_from_linear(linear.clamp(0.0, 1.0))
}

/// Estimated squared display error of a pixel, mean over channels, unbiased by the noise of the two
/// audits; may be negative.
pub(super) fn display_error(shown: Vec3, [a, b]: [Vec3; 2]) -> f64 {
    let channel = |k: usize| {
        let (s, m) = (shown[k], (a[k] + b[k]) / 2.0);
        let slope = f64::from(slope(s, m));
        f64::from(s - a[k]) * f64::from(s - b[k]) * slope * slope
    };
    (channel(0) + channel(1) + channel(2)) / 3.0
}

/// Mean slope of the display curve between two values.
fn slope(a: f32, b: f32) -> f32 {
    // The difference of closer values is dominated by rounding; this step keeps three digits.
    const MIN_STEP: f32 = 1.0 / 1024.0;
    let (low, high) = (a.min(b), a.max(b));
    let (low, high) = if high - low < MIN_STEP { (low, low + MIN_STEP) } else { (low, high) };
    (display(high) - display(low)) / (high - low)
}

/// By how much `shown` is brighter than `right` in the display value that differs most; `None`
/// where the difference is not visible.
fn visibly_brighter(shown: Vec3, right: Vec3) -> Option<f32> {
    let off = |k: usize| display(shown[k]) - display(right[k]);
    let most = (0..3).map(off).max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
    (most.abs() > VISIBLE).then_some(most)
}

/// True where two independent traces find a pixel visibly off in the same direction.
pub(super) fn looks_wrong(shown: Vec3, [a, b]: [Vec3; 2]) -> bool {
    match (visibly_brighter(shown, a), visibly_brighter(shown, b)) {
        (Some(a), Some(b)) => a * b > 0.0,
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::key::Key;

    /// Uniform noise around `middle`.
    fn noisy(key: Key, middle: f32, width: f32) -> Vec3 {
        let [x, y] = key.pair();
        Vec3::new(middle + (x - 0.5) * width, middle + (y - 0.5) * width, middle)
    }

    #[test]
    fn the_noise_of_the_audit_is_no_error_of_the_picture() {
        for (shown, right) in [(0.5f32, 0.5f32), (0.52, 0.5), (0.2, 0.25)] {
            let mut sums = FrameSums::default();
            for i in 0..20_000 {
                let key = Key::of_pixel(1, i);
                let checks = [0, 1].map(|half| noisy(key.with(half), right, 0.2));
                sums.add(display_error(Vec3::splat(shown), checks));
            }
            let mut window = Window::default();
            window.push(sums);
            let truth = f64::from(display(shown) - display(right)).powi(2);
            let estimate = window.estimate();
            let low = 10f64.powf(-estimate.psnr_low_db.unwrap() / 10.0);
            let high = estimate.psnr_high_db.map_or(0.0, |db| 10f64.powf(-db / 10.0));
            // The curvature of the display curve under a noise of 0.1 adds a little.
            assert!(truth <= low * 1.2 && truth >= high * 0.8, "{truth} not in {high}..{low}");
            assert!(low - high < 2e-4, "{high}..{low}");
        }
    }

    #[test]
    fn visibly_wrong_pixels_are_distinguished_from_noise() {
        let white = Vec3::splat(0.6);
        assert!(looks_wrong(white, [Vec3::splat(0.2), Vec3::splat(0.1)]));
        assert!(!looks_wrong(white, [Vec3::splat(0.2), Vec3::splat(0.9)]), "in both directions");
        assert!(!looks_wrong(white, [Vec3::splat(0.55), Vec3::splat(0.1)]), "only one");
        assert!(
            !looks_wrong(Vec3::splat(2.0), [Vec3::splat(5.0), Vec3::splat(9.0)]),
            "both white on a screen"
        );
        assert_eq!(display_error(Vec3::splat(2.0), [Vec3::splat(5.0), Vec3::splat(9.0)]), 0.0);
        // Black where it should be white has an error of one, not more.
        let error = display_error(Vec3::ZERO, [Vec3::ONE, Vec3::ONE]);
        assert!((error - 1.0).abs() < 1e-3, "{error}");
    }

    #[test]
    fn only_the_last_seconds_count() {
        let mut window = Window::default();
        for i in 0..100 {
            let mut sums = FrameSums { secs: 0.1, ..FrameSums::default() };
            (0..10).for_each(|_| sums.add(if i < 50 { 1.0 } else { 1e-4 }));
            window.push(sums);
        }
        let estimate = window.estimate();
        assert!((estimate.psnr_db.unwrap() - 40.0).abs() < 1e-6, "{estimate:?}");
        assert!((380..=400).contains(&estimate.pixels), "{}", estimate.pixels);
        assert_eq!(Window::default().estimate().psnr_db, None);
    }
}
