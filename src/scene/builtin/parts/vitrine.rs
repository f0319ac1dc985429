//! A glass case on a table.

use super::materials::Materials;
use crate::scene::SceneBuilder;
use crate::scene::builtin::shapes::{Faces, Local, bar, block, gear, torus, torus_knot};
use glam::DVec3;

const VITRINE_HALF_M: [f64; 2] = [0.7, 0.4];
const VITRINE_TABLE_M: f64 = 0.85;
const VITRINE_GLASS_M: f64 = 0.75;
const PANE_M: f64 = 0.01;
/// Gap between panes. Solids of glass must not share a plane.
const PANE_GAP_M: f64 = 0.002;

/// Adds a table that carries a glass case with a clockwork, in the middle of the frame.
pub(in crate::scene::builtin) fn vitrine(b: &mut SceneBuilder, p: &Materials, frame: &Local) {
    let [x, z] = VITRINE_HALF_M;
    let slab = |grow: f64, y0: f64, y1: f64| {
        [DVec3::new(-x - grow, y0, -z - grow), DVec3::new(x + grow, y1, z + grow)]
    };
    let table = VITRINE_TABLE_M;
    let body = Faces::ALL.without(Faces::BOTTOM).without(Faces::TOP);
    block(b, frame, slab(-0.08, 0.0, 0.08), body, p.black);
    block(b, frame, slab(0.0, 0.08, table - 0.04), Faces::ALL.without(Faces::TOP), p.wood);
    block(b, frame, slab(0.03, table - 0.04, table), Faces::ALL, p.black);
    panes(b, p, &frame.moved(DVec3::Y * (table + PANE_GAP_M)));
    let cloth = [DVec3::new(-0.45, table, -0.22), DVec3::new(0.45, table + 0.06, 0.22)];
    block(b, frame, cloth, Faces::ALL.without(Faces::BOTTOM), p.cloth);
    clockwork(b, p, &frame.moved(DVec3::Y * (table + 0.06)));
}

/// Adds four walls and a lid of glass: five closed solids that touch neither each other nor the
/// table.
fn panes(b: &mut SceneBuilder, p: &Materials, frame: &Local) {
    let [x, z] = VITRINE_HALF_M;
    let (h, t, g) = (VITRINE_GLASS_M, PANE_M, PANE_GAP_M);
    let mut pane = |low: [f64; 3], high: [f64; 3]| {
        block(b, frame, [DVec3::from(low), DVec3::from(high)], Faces::ALL, p.glass);
    };
    pane([-x, 0.0, -z], [x, h, -z + t]);
    pane([-x, 0.0, z - t], [x, h, z]);
    pane([-x, 0.0, -z + t + g], [-x + t, h, z - t - g]);
    pane([x - t, 0.0, -z + t + g], [x, h, z - t - g]);
    pane([-x, h + g, -z], [x, h + g + t, z]);
}

/// Adds the exhibit in the vitrine: two gears on their axles, a ring and a small knot.
fn clockwork(b: &mut SceneBuilder, p: &Materials, frame: &Local) {
    let axle = |x: f64, y: f64, z: f64| frame.moved(DVec3::new(x, y, z));
    gear(b, &axle(-0.24, 0.2, 0.0), 24, [0.05, 0.155, 0.18], 0.03, p.gilt);
    gear(b, &axle(0.0, 0.115, 0.05), 12, [0.03, 0.075, 0.1], 0.03, p.bronze);
    let rod = |x: f64, y: f64| [axle(x, y, -0.16).origin, axle(x, y, 0.16).origin];
    bar(b, rod(-0.24, 0.2), 0.05, 24, p.iron);
    bar(b, rod(0.0, 0.115), 0.03, 24, p.iron);
    torus(b, &axle(0.28, 0.02, 0.0), [48, 12], [0.1, 0.02], p.gilt);
    torus_knot(b, &axle(0.28, 0.2, 0.0), [14, 150], [2.0, 5.0], [0.1, 0.022], p.jade);
}
