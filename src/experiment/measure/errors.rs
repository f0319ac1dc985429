//! The error of a frame against the converged picture of its view, in total and by pixel type.

use crate::raster::metrics::{CompareError, flip, psnr_db, rel_mse, ssim};
use crate::raster::{exposure::serialize_decimal, load::exposed};
use crate::render::Frame;
use glam::Vec3;
use serde::Serialize;

/// Errors of a frame against the converged picture of its view.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[allow(missing_docs, reason = "the names are those of `afterimage compare`")]
pub struct Errors {
    /// Exposure in stops of the display values that are compared.
    #[serde(serialize_with = "serialize_decimal")]
    pub exposure_ev: f32,
    pub psnr_db: f64,
    pub rel_mse: f64,
    pub ssim: f64,
    pub flip_mean: f64,
    pub flip_p95: f64,
    /// Mean squared difference of display values over the pixels of Type 1; 0 without such pixels.
    pub type1_mse: f64,
    /// Mean squared difference of display values over the pixels of Type 2; 0 without such pixels.
    pub type2_mse: f64,
    /// Mean squared difference of display values over the pixels of Type 3; 0 without such pixels.
    pub type3_mse: f64,
    /// Share of the picture's squared error in the pixels of Type 1, in percent.
    pub type1_error_percent: f64,
    /// Share of the picture's squared error in the pixels of Type 2, in percent.
    pub type2_error_percent: f64,
    /// Share of the picture's squared error in the pixels of Type 3, in percent.
    pub type3_error_percent: f64,
}

impl Errors {
    /// Compares a frame with the linear radiance of its converged picture. relMSE compares
    /// radiance; the other metrics compare display values at an exposure in stops.
    ///
    /// # Errors
    /// [`CompareError`] for a frame without pixels.
    pub fn of(frame: &Frame, truth: &[Vec3], exposure_ev: f32) -> Result<Self, CompareError> {
        let size = frame.view.size;
        let [shown, right] = [&frame.radiance[..], truth].map(|r| exposed(r, exposure_ev));
        let flip = flip(&shown, &right, size)?;
        let types = by_type(frame, &shown, &right);
        let sum: f64 = types[0].0 + types[1].0 + types[2].0;
        let mean = |(squared, pixels): (f64, usize)| squared / (3 * pixels.max(1)) as f64;
        let share = |(squared, _): (f64, usize)| if sum > 0.0 { 100.0 * squared / sum } else { 0.0 };
        let [type1_mse, type2_mse, type3_mse] = types.map(mean);
        let [type1_error_percent, type2_error_percent, type3_error_percent] = types.map(share);
        Ok(Self {
            exposure_ev,
            psnr_db: psnr_db(&shown, &right),
            rel_mse: rel_mse(&frame.radiance, truth),
            ssim: ssim(&shown, &right, size),
            flip_mean: flip.mean,
            flip_p95: flip.p95,
            type1_mse,
            type2_mse,
            type3_mse,
            type1_error_percent,
            type2_error_percent,
            type3_error_percent,
        })
    }
}

/// Sums the squared differences over the pixels of each type, and counts the pixels.
fn by_type(frame: &Frame, shown: &[Vec3], right: &[Vec3]) -> [(f64, usize); 3] {
    let mut sums = [(0.0, 0); 3];
    for ((t, a), b) in frame.types.iter().zip(shown).zip(right) {
        let (squared, pixels) = &mut sums[usize::from(t.number()) - 1];
        *squared += f64::from((*a - *b).length_squared());
        *pixels += 1;
    }
    sums
}
