//! The sheer curtains of the garden room, and the picture of their weave.

use super::palette::Palette;
use super::rooms::PLATFORM;
use crate::scene::{Encoding, SceneBuilder, Texture};
use glam::{DVec3, Vec2};
use std::f64::consts::TAU;

/// Side length of the texture in texels.
const SIDE: u32 = 64;
/// Alpha of the thinnest and of the densest thread.
const ALPHA: [f64; 2] = [0.30, 0.62];
/// Lower and upper edge, metres; the upper one is above the window.
const HEIGHT_M: [f64; 2] = [PLATFORM.height_m + 0.04, 4.0];
/// Distance from the inner face of the wall, and depth of a fold, metres.
const FROM_WALL_M: f64 = 0.28;
const FOLD_M: f64 = 0.05;
const FOLDS: u32 = 7;
const STRIPS_PER_FOLD: u32 = 8;
/// Extents of both curtains along x, metres, beside the middle of the window.
const EXTENTS_M: [[f64; 2]; 2] = [[26.7, 28.3], [29.6, 31.2]];
/// Inner face of the southern wall, metres.
const WALL_Z_M: f64 = 23.7;

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

pub(super) fn add_to(b: &mut SceneBuilder, p: &Palette) {
    let strips = FOLDS * STRIPS_PER_FOLD;
    for [x0, x1] in EXTENTS_M {
        let at = |i: u32, y: f64| {
            let share = f64::from(i) / f64::from(strips);
            let fold = (TAU * f64::from(FOLDS) * share).sin() * FOLD_M;
            DVec3::new(x0 + (x1 - x0) * share, y, WALL_Z_M - FROM_WALL_M + fold)
        };
        for i in 0..strips {
            let [low, high] = HEIGHT_M;
            let corners = [at(i + 1, low), at(i, low), at(i, high), at(i + 1, high)];
            b.add_quad(corners, Vec2::new(0.05, 3.0), p.curtain);
        }
    }
}
