//! The sheer curtains of the garden room.

use super::palette::Palette;
use super::rooms::PLATFORM;
use crate::scene::SceneBuilder;
use glam::{DVec3, Vec2};
use std::f64::consts::TAU;

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
