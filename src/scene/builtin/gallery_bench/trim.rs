//! Skirting boards, architraves around doorways, and coves below the ceilings.

use super::palette::Palette;
use super::plan::{DOOR_M, Facing, RoomName, Side};
use crate::scene::SceneBuilder;
use crate::scene::builtin::shapes::{Closing, Faces, Grid, block};
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;

const SKIRTING_M: [f64; 2] = [0.14, 0.02];
const ARCHITRAVE_M: [f64; 2] = [0.14, 0.035];
/// Width and height of a cove, which is the part of a ceiling that the lamps light directly.
const COVE_M: [f64; 2] = [1.2, 0.9];
const HALL_COVE_M: [f64; 2] = [1.7, 1.0];
const COVE_CELLS: u32 = 16;

pub(super) fn add_to(b: &mut SceneBuilder, p: &Palette) {
    for name in RoomName::ALL {
        let room = name.room();
        for facing in Facing::ALL {
            let side = room.side(facing);
            skirting(b, p, &side, facing);
            for &door in &side.doors {
                architrave(b, p, &side, door);
            }
            let size = if name == RoomName::Hall { HALL_COVE_M } else { COVE_M };
            cove(b, p, &side, size, room.ceiling);
        }
    }
}

fn skirting(b: &mut SceneBuilder, p: &Palette, side: &Side, facing: Facing) {
    let [height, depth] = SKIRTING_M;
    // In each corner the board along x is continuous, and the one along z ends at it.
    let inset = if matches!(facing, Facing::East | Facing::West) { depth } else { 0.0 };
    let mut from = inset;
    let mut stretches = Vec::new();
    let mut doors = side.doors.clone();
    doors.sort_by(|a, b| a[0].total_cmp(&b[0]));
    for door in doors {
        stretches.push([from, door[0] - ARCHITRAVE_M[0]]);
        from = door[1] + ARCHITRAVE_M[0];
    }
    stretches.push([from, side.length - inset]);
    let faces =
        Faces::ALL.without(Faces::BACK).without(Faces::BOTTOM).without(Faces::LEFT).without(Faces::RIGHT);
    for [x0, x1] in stretches {
        let corners = [DVec3::new(x0, 0.0, 0.0), DVec3::new(x1, height, depth)];
        block(b, &side.frame, corners, faces, p.trim);
    }
}

fn architrave(b: &mut SceneBuilder, p: &Palette, side: &Side, [x0, x1]: [f64; 2]) {
    let [width, depth] = ARCHITRAVE_M;
    let head = DOOR_M[1];
    let mut bar = |low: [f64; 2], high: [f64; 2], faces: Faces| {
        let corners = [DVec3::new(low[0], low[1], 0.0), DVec3::new(high[0], high[1], depth)];
        block(b, &side.frame, corners, faces.without(Faces::BACK), p.trim);
    };
    let jamb = Faces::ALL.without(Faces::BOTTOM).without(Faces::TOP);
    bar([x0 - width, 0.0], [x0, head], jamb);
    bar([x1, 0.0], [x1 + width, head], jamb);
    // The head has a part of its own over each jamb, so that no face of it lies on a jamb.
    let ends = Faces::ALL.without(Faces::BOTTOM);
    bar([x0 - width, head], [x0, head + width], ends.without(Faces::RIGHT));
    bar([x0, head], [x1, head + width], Faces::ALL.without(Faces::LEFT).without(Faces::RIGHT));
    bar([x1, head], [x1 + width, head + width], ends.without(Faces::LEFT));
}

/// Adds a cove: a concave quarter of an ellipse from the wall to the ceiling, mitred in the
/// corners.
fn cove(b: &mut SceneBuilder, p: &Palette, side: &Side, [run, rise]: [f64; 2], ceiling: f64) {
    let grid = Grid { nu: 1, nv: COVE_CELLS, u: Closing::Open, v: Closing::Open };
    grid.add_to(b, &side.frame, p.coffer, |u, v| {
        let (sin, cos) = (v * FRAC_PI_2).sin_cos();
        let out = run * (1.0 - cos);
        let x = out + u * (side.length - 2.0 * out);
        DVec3::new(x, ceiling - rise * (1.0 - sin), out)
    });
}
