//! Skirting boards, architraves around doorways, and coves below the ceilings.

use super::palette::Palette;
use super::plan::RoomName;
use crate::scene::SceneBuilder;
use crate::scene::builtin::parts::{Facing, Side, architrave, skirting};
use crate::scene::builtin::shapes::{Closing, Grid};
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;

/// Width and height of a cove, which is the part of a ceiling that the lamps light directly.
const COVE_M: [f64; 2] = [1.2, 0.9];
const HALL_COVE_M: [f64; 2] = [1.7, 1.0];
const COVE_CELLS: u32 = 16;

pub(super) fn add_to(b: &mut SceneBuilder, p: &Palette) {
    for name in RoomName::ALL {
        let room = name.room();
        for facing in Facing::ALL {
            let side = room.side(facing);
            skirting(b, &side, facing, p.trim);
            for door in &side.openings {
                architrave(b, &side, door, p.trim);
            }
            let size = if name == RoomName::Hall { HALL_COVE_M } else { COVE_M };
            cove(b, p, &side, size, room.ceiling);
        }
    }
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
