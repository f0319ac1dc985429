//! Two rows of fluted columns that carry two architraves.

use super::{palette::Palette, plan::RoomName};
use crate::scene::SceneBuilder;
use crate::scene::builtin::shapes::{Faces, Local, block, fluted_shaft, lathe};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};

/// World x of each row of columns.
pub(super) const ROWS_X: [f64; 2] = [13.5, 20.5];
/// World z of each column in a row.
pub(super) const COLUMNS_Z: [f64; 4] = [10.7, 14.5, 18.3, 22.1];
const HALL_AXIS_X: f64 = 17.0;
const ARCHITRAVE_HALF_M: f64 = 0.48;
/// Height of the architraves. Deeper ones would shade the aisles from the lamps.
const ARCHITRAVE_DROP_M: f64 = 0.15;
const BEAM_HALF_M: f64 = 0.14;
const BEAM_DROP_M: f64 = 0.12;
const SHAFT_M: [f64; 2] = [0.42, 3.98];
const FLUTES: [u32; 3] = [24, 5, 18];
const SEGMENTS: u32 = 36;

pub(super) fn add_to(b: &mut SceneBuilder, p: &Palette) {
    for x in ROWS_X {
        for z in COLUMNS_Z {
            column(b, p, &Local::at(DVec3::new(x, 0.0, z)));
        }
    }
    beams(b, p);
}

fn column(b: &mut SceneBuilder, p: &Palette, frame: &Local) {
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
    let top = RoomName::Hall.room().ceiling - ARCHITRAVE_DROP_M;
    // The lower edge of the abacus closes the gap around the echinus; its top lies on the
    // architrave.
    block(b, frame, square(4.32, top, 0.46), Faces::ALL.without(Faces::TOP), p.stone);
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

/// Adds the architraves over the columns, and the beams across the nave between the coffers.
fn beams(b: &mut SceneBuilder, p: &Palette) {
    let room = RoomName::Hall.room();
    let [_, _, z0, z1] = room.area;
    let ends = Faces::ALL.without(Faces::TOP).without(Faces::BACK);
    for x in ROWS_X {
        let low = DVec3::new(x - ARCHITRAVE_HALF_M, room.ceiling - ARCHITRAVE_DROP_M, z0);
        let high = DVec3::new(x + ARCHITRAVE_HALF_M, room.ceiling, z1);
        block(b, &Local::WORLD, [low, high], ends, p.trim);
    }
    let half = (ROWS_X[1] - ROWS_X[0]) / 2.0 - ARCHITRAVE_HALF_M;
    for z in COLUMNS_Z {
        let low = DVec3::new(HALL_AXIS_X - half, room.ceiling - BEAM_DROP_M, z - BEAM_HALF_M);
        let high = DVec3::new(HALL_AXIS_X + half, room.ceiling, z + BEAM_HALF_M);
        let between = Faces::ALL.without(Faces::TOP).without(Faces::LEFT).without(Faces::RIGHT);
        block(b, &Local::WORLD, [low, high], between, p.trim);
    }
}
