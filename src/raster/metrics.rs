//! Measures of the difference between two pictures.
//!
//! Display values are sRGB in 0..1. Radiance is clipped at 1 ([`super::load::display_of`]), because
//! a tone curve would hide differences. The second picture of each pair is the ground truth.

use glam::Vec3;
use rayon::prelude::*;
use serde::Serialize;

/// PSNR of equal pictures in decibels. Replaces infinity, which JSON cannot express.
pub const PSNR_OF_EQUALS_DB: f64 = 999.0;

/// Offset that keeps relMSE finite on black, in squared radiance. The usual value in the
/// literature.
const REL_MSE_FLOOR: f64 = 0.01;

/// Two pictures cannot be compared.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CompareError {
    /// Their sizes differ.
    #[error("the pictures differ in size: {a:?} and {b:?}")]
    Sizes {
        /// Width and height of the first picture.
        a: [u32; 2],
        /// Width and height of the second picture.
        b: [u32; 2],
    },
    /// FLIP is not defined for them. Holds the reason.
    #[error("FLIP cannot be computed: {0}")]
    Flip(String),
}

/// FLIP error of a picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Flip {
    /// Mean over all pixels, in 0..1.
    #[serde(rename = "flip_mean")]
    pub mean: f64,
    /// 95th percentile over all pixels, in 0..1.
    #[serde(rename = "flip_p95")]
    pub p95: f64,
}

/// Returns the mean squared difference over pixels and channels.
pub fn mse(a: &[Vec3], b: &[Vec3]) -> f64 {
    // Sum fixed chunks, then their sums in order: the same bits at any thread count.
    let chunk = |(a, b): (&[Vec3], &[Vec3])| -> f64 {
        a.iter().zip(b).map(|(a, b)| f64::from((*a - *b).length_squared())).sum()
    };
    let sums: Vec<f64> = a.par_chunks(1 << 14).zip(b.par_chunks(1 << 14)).map(chunk).collect();
    sums.iter().sum::<f64>() / (3 * a.len().max(1)) as f64
}

/// Returns the peak signal-to-noise ratio of display values in decibels: `-10 log10` of the mean
/// squared difference over pixels and channels, with a peak of 1. [`PSNR_OF_EQUALS_DB`] for equal
/// pictures.
pub fn psnr_db(a: &[Vec3], b: &[Vec3]) -> f64 {
    psnr_of_mse(mse(a, b))
}

/// Returns the peak signal-to-noise ratio in decibels that belongs to a mean squared difference of
/// display values.
pub fn psnr_of_mse(mse: f64) -> f64 {
    if mse > 0.0 { -10.0 * mse.log10() } else { PSNR_OF_EQUALS_DB }
}

/// Returns the relative mean squared error: the mean of `(a - b)^2 / (b^2 + 0.01)` over pixels and
/// channels.
pub fn rel_mse(a: &[Vec3], b: &[Vec3]) -> f64 {
    let term = |a: f32, b: f32| {
        let (a, b) = (f64::from(a), f64::from(b));
        (a - b) * (a - b) / (b * b + REL_MSE_FLOOR)
    };
    let sum: f64 = a.iter().zip(b).flat_map(|(a, b)| (0..3).map(move |i| term(a[i], b[i]))).sum();
    sum / (3 * a.len().max(1)) as f64
}

/// Returns the largest absolute difference of any channel.
pub fn max_abs(a: &[Vec3], b: &[Vec3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| f64::from((*a - *b).abs().max_element())).fold(0.0, f64::max)
}

/// Returns the FLIP error of display values on a 4K monitor, 0.7 m wide and seen from 0.7 m (67
/// pixels per degree).
///
/// # Errors
/// [`CompareError::Flip`] for an empty picture or values that are not finite.
pub fn flip(a: &[Vec3], truth: &[Vec3], size: [u32; 2]) -> Result<Flip, CompareError> {
    let mut errors = flip_map(a, truth, size)?;
    let mean = errors.iter().map(|&e| f64::from(e)).sum::<f64>() / errors.len() as f64;
    let at = (errors.len() * 95).div_ceil(100).max(1) - 1;
    let (_, p95, _) = errors.select_nth_unstable_by(at, f32::total_cmp);
    Ok(Flip { mean, p95: f64::from(*p95) })
}

/// Returns the FLIP error of every pixel, in 0..1, under the conditions of [`flip`].
///
/// # Errors
/// [`CompareError::Flip`] for an empty picture or values that are not finite.
pub fn flip_map(a: &[Vec3], truth: &[Vec3], [width, height]: [u32; 2]) -> Result<Vec<f32>, CompareError> {
    let picture = |values: &[Vec3]| {
        let channels: Vec<f32> = values.iter().flat_map(|v| v.to_array()).collect();
        flip_rs::RgbImage::new(width as usize, height as usize, channels)
    };
    let map = picture(truth)
        .and_then(|truth| flip_rs::ldr_flip(&truth, &picture(a)?, flip_rs::DEFAULT_PPD))
        .map_err(|e| CompareError::Flip(e.to_string()))?;
    Ok(map.into_pixels())
}

/// Returns errors in 0..1 as 8-bit sRGB colours of the map Magma, as the FLIP tool does. No error
/// is dark.
pub fn error_picture(errors: &[f32]) -> Vec<[u8; 3]> {
    let color = |e: &f32| flip_rs::MAGMA[(e.clamp(0.0, 1.0) * 255.0 + 0.5) as usize];
    errors.iter().map(|e| color(e).map(|c| (c * 255.0 + 0.5) as u8)).collect()
}

/// Returns the structural similarity of the luma of display values; 1 for equal pictures.
///
/// Source: Wang et al. 2004: Gaussian window of 11x11 with sigma 1.5, K1 = 0.01, K2 = 0.03, the
/// mean over all windows that lie inside the picture. We differ: a picture smaller than the window
/// has its edge pixels repeated.
pub fn ssim(a: &[Vec3], b: &[Vec3], [width, height]: [u32; 2]) -> f64 {
    const C1: f64 = 0.01 * 0.01;
    const C2: f64 = 0.03 * 0.03;
    let size = [width as usize, height as usize];
    let luma = |v: &[Vec3]| v.iter().map(|c| f64::from(super::color::luminance(*c))).collect::<Vec<f64>>();
    let (a, b) = (luma(a), luma(b));
    let product = |p: &[f64], q: &[f64]| p.iter().zip(q).map(|(p, q)| p * q).collect::<Vec<f64>>();
    let [mean_a, mean_b, aa, bb, ab] =
        [a.clone(), b.clone(), product(&a, &a), product(&b, &b), product(&a, &b)].map(|v| blurred(&v, size));
    let index = |i: usize| {
        let (ma, mb) = (mean_a[i], mean_b[i]);
        let (va, vb, cov) = (aa[i] - ma * ma, bb[i] - mb * mb, ab[i] - ma * mb);
        (2.0 * ma * mb + C1) * (2.0 * cov + C2) / ((ma * ma + mb * mb + C1) * (va + vb + C2))
    };
    let inner = |count: usize| if count > 2 * RADIUS { RADIUS..count - RADIUS } else { 0..count };
    let windows = inner(size[0]).len() * inner(size[1]).len();
    let sum: f64 = inner(size[1]).flat_map(|y| inner(size[0]).map(move |x| y * size[0] + x)).map(index).sum();
    sum / windows.max(1) as f64
}

/// Radius of the window of [`ssim`] in pixels.
const RADIUS: usize = 5;

/// Returns the Gaussian mean around every pixel, one axis after the other.
fn blurred(values: &[f64], [width, height]: [usize; 2]) -> Vec<f64> {
    let weights: [f64; 2 * RADIUS + 1] =
        std::array::from_fn(|i| (-(i as f64 - RADIUS as f64).powi(2) / (2.0 * 1.5 * 1.5)).exp());
    let total: f64 = weights.iter().sum();
    let mean = |count: usize, at: usize, value: &dyn Fn(usize) -> f64| {
        let clamped = |i: usize| (at + i).saturating_sub(RADIUS).min(count - 1);
        weights.iter().enumerate().map(|(i, w)| w * value(clamped(i))).sum::<f64>() / total
    };
    let rows: Vec<f64> = (0..width * height)
        .into_par_iter()
        .map(|p| mean(width, p % width, &|x| values[p / width * width + x]))
        .collect();
    (0..width * height)
        .into_par_iter()
        .map(|p| mean(height, p / width, &|y| rows[y * width + p % width]))
        .collect()
}
