//! The picture of the weave of sheer curtains.

use crate::scene::{Encoding, Texture};
use std::f64::consts::TAU;

/// Side length of the texture in texels.
const SIDE: u32 = 64;
/// Alpha of the thinnest and of the densest thread.
const ALPHA: [f64; 2] = [0.30, 0.62];

/// Returns a weave whose alpha is the share of it that threads cover.
pub(super) fn sheer() -> Texture {
    let wave = |i: u32, threads: f64| 0.5 - 0.5 * (TAU * threads * f64::from(i) / f64::from(SIDE)).cos();
    let texel = |x: u32, y: u32| {
        let alpha = ALPHA[0] + (ALPHA[1] - ALPHA[0]) * wave(x, 16.0).max(wave(y, 4.0) * 0.7);
        [255, 250, 240, (alpha * 255.0).round() as u8]
    };
    let texels = (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| texel(x, y))).collect();
    Texture { width: SIDE, height: SIDE, texels, encoding: Encoding::Srgb }
}
