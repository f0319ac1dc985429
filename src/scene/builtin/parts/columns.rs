//! A fluted column.

use super::materials::Materials;
use crate::scene::SceneBuilder;
use crate::scene::builtin::shapes::{Faces, Local, block, fluted_shaft, lathe};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};

/// Half the side length of an abacus in metres.
const ABACUS_M: f64 = 0.46;
const SHAFT_M: [f64; 2] = [0.42, 3.98];
const FLUTES: [u32; 3] = [24, 5, 18];
const SEGMENTS: u32 = 36;

/// Adds a column with an Attic base. Its abacus ends at height `top`.
pub(in crate::scene::builtin) fn column(b: &mut SceneBuilder, p: &Materials, frame: &Local, top: f64) {
    let square = |y0: f64, y1: f64, half: f64| [DVec3::new(-half, y0, -half), DVec3::new(half, y1, half)];
    block(b, frame, square(0.0, 0.12, 0.5), Faces::ALL.without(Faces::BOTTOM), p.stone);
    // Attic base: a torus, a scotia between two fillets, another torus.
    lathe(b, frame, &bulge(0.12, 0.24, 0.44, 0.06), SEGMENTS, p.stone);
    lathe(b, frame, &[[0.42, 0.24], [0.45, 0.243], [0.45, 0.255], [0.40, 0.257]], SEGMENTS, p.stone);
    lathe(b, frame, &hollow([0.40, 0.257], [0.385, 0.325]), SEGMENTS, p.stone);
    lathe(b, frame, &bulge(0.325, SHAFT_M[0], 0.395, 0.045), SEGMENTS, p.stone);
    let shaft = frame.moved(DVec3::Y * SHAFT_M[0]);
    fluted_shaft(b, &shaft, FLUTES, entasis, SHAFT_M[1] - SHAFT_M[0], p.plaster);
    lathe(b, frame, &bulge(SHAFT_M[1], 4.04, 0.33, 0.03), SEGMENTS, p.stone);
    lathe(b, frame, &[[0.325, 4.04], [0.325, 4.17]], SEGMENTS, p.stone);
    lathe(b, frame, &echinus(), SEGMENTS, p.stone);
    // The lower edge of the abacus closes the gap around the echinus; its top lies on
    // what the column carries.
    block(b, frame, square(4.32, top, ABACUS_M), Faces::ALL.without(Faces::TOP), p.stone);
}

/// Returns the radius of the shaft at a share `v` of its height. A straight taper would look
/// concave.
fn entasis(v: f64) -> f64 {
    0.385 - 0.065 * v.powf(1.8)
}

/// Returns the profile of a half round from height `y0` to `y1` that stands out by `depth`.
fn bulge(y0: f64, y1: f64, radius: f64, depth: f64) -> Vec<[f64; 2]> {
    profile(10, |t| {
        let (sin, cos) = (t * PI).sin_cos();
        [radius + depth * sin - 0.01, y0 + (y1 - y0) * (1.0 - cos) / 2.0]
    })
}

/// Returns a concave profile between two points.
fn hollow(from: [f64; 2], to: [f64; 2]) -> Vec<[f64; 2]> {
    profile(8, |t| {
        let dip = 0.025 * (t * PI).sin();
        [from[0] + (to[0] - from[0]) * t - dip, from[1] + (to[1] - from[1]) * t]
    })
}

fn echinus() -> Vec<[f64; 2]> {
    profile(8, |t| {
        let (sin, cos) = (t * FRAC_PI_2).sin_cos();
        [0.325 + 0.125 * sin, 4.17 + 0.15 * (1.0 - cos)]
    })
}

/// Returns the points of a profile of `cells` cells, for parameters from 0 to 1.
fn profile(cells: u32, at: impl Fn(f64) -> [f64; 2]) -> Vec<[f64; 2]> {
    (0..=cells).map(|i| at(f64::from(i) / f64::from(cells))).collect()
}
