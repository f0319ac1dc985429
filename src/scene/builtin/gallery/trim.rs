//! Skirting boards, panelling up to the height of a chair, cornices, and architraves around
//! doorways and windows.

use super::palette::Palette;
use super::plan::RoomName;
use crate::scene::builtin::parts::{Facing, Side, architrave, skirting, stretches};
use crate::scene::builtin::shapes::{Closing, Faces, Grid, block};
use crate::scene::{MaterialId, SceneBuilder};
use glam::{DVec2, DVec3, Vec2};
use std::f64::consts::FRAC_PI_2;

/// Depths of the panelling: the boards, the raised panels and the rail.
const PANELLING_M: [f64; 3] = [0.012, 0.026, 0.036];
/// Heights of the panelling: its lower edge, the rail's lower and upper edge.
const RAIL_M: [f64; 3] = [0.14, 0.86, 0.92];
const PANEL_WIDTH_M: f64 = 1.15;

pub(super) fn add_to(b: &mut SceneBuilder, p: &Palette) {
    for name in RoomName::ALL {
        let room = name.room();
        for facing in Facing::ALL {
            let side = room.side(facing);
            skirting(b, &side, facing, p.trim);
            for opening in &side.openings {
                architrave(b, &side, opening, p.trim);
            }
            if let Some(material) = p.panelling(name) {
                panelling(b, &side, facing, material);
            }
            cornice(b, &side, room.ceiling, p.trim);
        }
    }
}

/// Adds boards with raised panels, and a rail on top of them.
fn panelling(b: &mut SceneBuilder, side: &Side, facing: Facing, material: MaterialId) {
    let [low, rail, top] = RAIL_M;
    let ends = Faces::ALL.without(Faces::BACK).without(Faces::LEFT).without(Faces::RIGHT);
    for (depth, [y0, y1]) in [(PANELLING_M[0], [low, rail]), (PANELLING_M[2], [rail, top])] {
        for [x0, x1] in stretches(side, facing, depth) {
            block(b, &side.frame, [DVec3::new(x0, y0, 0.0), DVec3::new(x1, y1, depth)], ends, material);
        }
    }
    for [x0, x1] in stretches(side, facing, PANELLING_M[0]) {
        panels(b, side, [x0, x1], material);
    }
}

fn panels(b: &mut SceneBuilder, side: &Side, [x0, x1]: [f64; 2], material: MaterialId) {
    let count = ((x1 - x0) / PANEL_WIDTH_M).round().max(1.0);
    let width = (x1 - x0) / count;
    for i in 0..count as u32 {
        let from = x0 + width * f64::from(i);
        let low = DVec3::new(from + 0.1, RAIL_M[0] + 0.1, PANELLING_M[0]);
        let high = DVec3::new(from + width - 0.1, RAIL_M[1] - 0.1, PANELLING_M[1]);
        block(b, &side.frame, [low, high], Faces::ALL.without(Faces::BACK), material);
    }
}

/// Adds a cornice, mitred in the corners: two fillets with a hollow between them. Its section is
/// given by the distances from the wall and from the ceiling.
fn cornice(b: &mut SceneBuilder, side: &Side, ceiling: f64, material: MaterialId) {
    const LOW: DVec2 = DVec2::new(0.03, 0.25);
    const HIGH: DVec2 = DVec2::new(0.23, 0.06);
    let at = |along: f64, p: DVec2| {
        let x = p.x + along * (side.length - 2.0 * p.x);
        DVec3::new(x, ceiling - p.y, p.x)
    };
    let section = [
        [DVec2::new(0.0, 0.28), DVec2::new(LOW.x, 0.28)],
        [DVec2::new(LOW.x, 0.28), LOW],
        [HIGH, DVec2::new(0.26, HIGH.y)],
        [DVec2::new(0.26, HIGH.y), DVec2::new(0.26, 0.0)],
    ];
    for [p, q] in section {
        let corners = [at(0.0, p), at(1.0, p), at(1.0, q), at(0.0, q)];
        b.add_quad(corners.map(|c| side.frame.point(c)), Vec2::ONE, material);
    }
    Grid { nu: 1, nv: 10, u: Closing::Open, v: Closing::Open }.add_to(b, &side.frame, material, |u, v| {
        let (sin, cos) = (v * FRAC_PI_2).sin_cos();
        let share = DVec2::new(1.0 - cos, sin);
        at(u, LOW + (HIGH - LOW) * share)
    });
}
