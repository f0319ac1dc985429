//! The lantern over the hall: an opening in ceiling and roof with white sides, below a gabled roof
//! of glazing bars.
//!
//! The panes are left out: nobody sees reflections in them from the floor, and all rays of daylight
//! would have to pass them.

use super::palette::Palette;
use super::plan::RoomName;
use crate::scene::builtin::shapes::{Faces, Local, block};
use crate::scene::{MaterialId, SceneBuilder};
use glam::{DVec3, Vec2};

/// Extent of the opening as x0, x1, z0, z1.
pub(super) const OPENING: [f64; 4] = [14.3, 19.7, 11.2, 21.6];
/// Height of the upper edge of the opening's sides, where the glazing bars begin.
const CURB_TOP_M: f64 = 5.9;
const RIDGE_M: f64 = 7.1;
/// Fields between glazing bars along the ridge.
const FIELDS: u32 = 8;
const BAR_M: [f64; 2] = [0.05, 0.09];
const EAVES_M: [f64; 2] = [0.12, 0.14];

pub(super) fn add_to(b: &mut SceneBuilder, p: &Palette) {
    sides(b, p);
    bars(b, p.iron_white);
    moulding(b, p);
}

/// Adds the four sides, which face the inside of the opening.
fn sides(b: &mut SceneBuilder, p: &Palette) {
    let [x0, x1, z0, z1] = OPENING;
    let ceiling = RoomName::Hall.room().ceiling;
    let corners = [[x0, z0], [x1, z0], [x1, z1], [x0, z1]];
    for (i, [x, z]) in corners.into_iter().enumerate() {
        let [to_x, to_z] = corners[(i + 1) % 4];
        let at = |x, y, z| DVec3::new(x, y, z);
        let quad =
            [at(x, ceiling, z), at(to_x, ceiling, to_z), at(to_x, CURB_TOP_M, to_z), at(x, CURB_TOP_M, z)];
        b.add_quad(quad, Vec2::ONE, p.ceiling);
    }
}

/// Adds a frame of boards below the edge of the opening.
fn moulding(b: &mut SceneBuilder, p: &Palette) {
    let [x0, x1, z0, z1] = OPENING;
    let y = RoomName::Hall.room().ceiling;
    let mut board = |[x0, x1, z0, z1]: [f64; 4]| {
        let corners = [DVec3::new(x0, y - 0.07, z0), DVec3::new(x1, y + 0.05, z1)];
        block(b, &Local::WORLD, corners, Faces::ALL, p.trim);
    };
    let width = 0.12;
    board([x0 - width, x0 + 0.03, z0 - width, z1 + width]);
    board([x1 - 0.03, x1 + width, z0 - width, z1 + width]);
    board([x0 + 0.03, x1 - 0.03, z0 - width, z0 + 0.03]);
    board([x0 + 0.03, x1 - 0.03, z1 - 0.03, z1 + width]);
}

fn bars(b: &mut SceneBuilder, material: MaterialId) {
    let [x0, x1, z0, z1] = OPENING;
    let middle = (x0 + x1) / 2.0;
    let (curb, ridge) = (CURB_TOP_M, RIDGE_M);
    let at = |x, y, z| DVec3::new(x, y, z);
    for field in 0..=FIELDS {
        let z = z0 + (z1 - z0) * f64::from(field) / f64::from(FIELDS);
        for x in [x0, x1] {
            straight_bar(b, [at(x, curb, z), at(middle, ridge, z)], BAR_M, material);
        }
    }
    for x in [x0, x1] {
        straight_bar(b, [at(x, curb, z0 - 0.06), at(x, curb, z1 + 0.06)], EAVES_M, material);
        for share in [1.0 / 3.0, 2.0 / 3.0] {
            let (x, y) = (x + (middle - x) * share, curb + (ridge - curb) * share);
            straight_bar(b, [at(x, y, z0), at(x, y, z1)], [0.035, 0.05], material);
        }
    }
    straight_bar(b, [at(middle, ridge, z0 - 0.03), at(middle, ridge, z1 + 0.03)], EAVES_M, material);
    for z in [z0, z1] {
        gable(b, z, material);
    }
}

/// Adds the bars of the triangle at an end of the lantern.
fn gable(b: &mut SceneBuilder, z: f64, material: MaterialId) {
    let [x0, x1, ..] = OPENING;
    straight_bar(b, [DVec3::new(x0, CURB_TOP_M, z), DVec3::new(x1, CURB_TOP_M, z)], EAVES_M, material);
    for share in [0.25, 0.5, 0.75] {
        let height = (RIDGE_M - CURB_TOP_M) * (1.0 - (2.0 * share - 1.0_f64).abs());
        let foot = DVec3::new(x0 + (x1 - x0) * share, CURB_TOP_M, z);
        straight_bar(b, [foot, foot + DVec3::Y * height], [0.04, 0.05], material);
    }
}

/// Adds a bar with a rectangular section, given by its width and its height. The ends are open,
/// because they lie in other bars.
fn straight_bar(
    b: &mut SceneBuilder,
    [from, to]: [DVec3; 2],
    [width, height]: [f64; 2],
    material: MaterialId,
) {
    let axis = (to - from).normalize_or(DVec3::Z);
    let across = axis.cross(DVec3::Y).normalize_or(DVec3::X);
    let (side, up) = (across * (width / 2.0), across.cross(axis) * (height / 2.0));
    let edges = [-side - up, side - up, side + up, -side + up];
    for (i, &edge) in edges.iter().enumerate() {
        let next = edges[(i + 1) % 4];
        b.add_quad([from + edge, from + next, to + next, to + edge], Vec2::ONE, material);
    }
}
