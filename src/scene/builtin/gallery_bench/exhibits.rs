//! The wall of mirrors, the vitrine and the benches.

use super::plan::{Facing, RoomName};
use super::{palette::Palette, pictures::framed, terrace::PLATFORM_M};
use crate::scene::SceneBuilder;
use crate::scene::builtin::shapes::{Faces, Local, bar, block, gear, torus, torus_knot};
use glam::DVec3;

/// World position of the middle of the vitrine on the floor.
const VITRINE: [f64; 3] = [29.6, 0.0, 3.2];
const VITRINE_HALF_M: [f64; 2] = [0.7, 0.4];
const VITRINE_TABLE_M: f64 = 0.85;
const VITRINE_GLASS_M: f64 = 0.75;
const PANE_M: f64 = 0.01;
/// Gap between panes. Solids of glass must not share a plane.
const PANE_GAP_M: f64 = 0.002;

pub(super) fn add_to(b: &mut SceneBuilder, p: &Palette) {
    mirrors(b, p);
    vitrine(b, p);
    for (place, bearing) in [
        ([22.7, 0.0, 20.2], 90.0),
        ([11.3, 0.0, 16.4], 90.0),
        ([14.0, 0.0, 6.3], 0.0),
        ([20.0, 0.0, 6.3], 0.0),
        ([1.9, 0.0, 11.4], 90.0),
        ([5.2, 0.0, 21.8], 0.0),
        ([7.6, 0.0, 7.3], 0.0),
        ([25.6, 0.0, 7.4], 0.0),
        ([28.9, PLATFORM_M, 22.4], 0.0),
        ([32.6, 0.0, 13.2], 90.0),
    ] {
        bench(b, p, &Local::turned(place.into(), bearing));
    }
}

/// Adds five tall mirrors on the west wall. No other mirror faces them.
fn mirrors(b: &mut SceneBuilder, p: &Palette) {
    const SIZE_M: [f64; 2] = [1.3, 2.5];
    const SPACING_M: f64 = 1.6;
    let side = RoomName::Mirrors.room().side(Facing::West);
    for i in -2..=2 {
        let along = side.length / 2.0 + f64::from(i) * SPACING_M;
        let middle = DVec3::new(along, 0.3 + SIZE_M[1] / 2.0, 0.0);
        framed(b, &side.frame.moved(middle), SIZE_M, p.mirror, p.gilt);
    }
}

fn vitrine(b: &mut SceneBuilder, p: &Palette) {
    let frame = Local::at(VITRINE.into());
    let [x, z] = VITRINE_HALF_M;
    let slab = |grow: f64, y0: f64, y1: f64| {
        [DVec3::new(-x - grow, y0, -z - grow), DVec3::new(x + grow, y1, z + grow)]
    };
    let table = VITRINE_TABLE_M;
    let body = Faces::ALL.without(Faces::BOTTOM).without(Faces::TOP);
    block(b, &frame, slab(-0.08, 0.0, 0.08), body, p.black);
    block(b, &frame, slab(0.0, 0.08, table - 0.04), Faces::ALL.without(Faces::TOP), p.wood);
    block(b, &frame, slab(0.03, table - 0.04, table), Faces::ALL, p.black);
    panes(b, p, &frame.moved(DVec3::Y * (table + PANE_GAP_M)));
    let cloth = [DVec3::new(-0.45, table, -0.22), DVec3::new(0.45, table + 0.06, 0.22)];
    block(b, &frame, cloth, Faces::ALL.without(Faces::BOTTOM), p.red);
    clockwork(b, p, &frame.moved(DVec3::Y * (table + 0.06)));
}

/// Adds four walls and a lid of glass: five closed solids that touch neither each other nor the
/// table.
fn panes(b: &mut SceneBuilder, p: &Palette, frame: &Local) {
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
fn clockwork(b: &mut SceneBuilder, p: &Palette, frame: &Local) {
    let axle = |x: f64, y: f64, z: f64| frame.moved(DVec3::new(x, y, z));
    gear(b, &axle(-0.24, 0.2, 0.0), 24, [0.05, 0.155, 0.18], 0.03, p.gilt);
    gear(b, &axle(0.0, 0.115, 0.05), 12, [0.03, 0.075, 0.1], 0.03, p.bronze);
    let rod = |x: f64, y: f64| [axle(x, y, -0.16).origin, axle(x, y, 0.16).origin];
    bar(b, rod(-0.24, 0.2), 0.05, 24, p.iron);
    bar(b, rod(0.0, 0.115), 0.03, 24, p.iron);
    torus(b, &axle(0.28, 0.02, 0.0), [48, 12], [0.1, 0.02], p.gilt);
    torus_knot(b, &axle(0.28, 0.2, 0.0), [14, 150], [2.0, 5.0], [0.1, 0.022], p.jade);
}

fn bench(b: &mut SceneBuilder, p: &Palette, frame: &Local) {
    const HALF_M: [f64; 2] = [0.8, 0.22];
    const HEIGHT_M: f64 = 0.45;
    let [x, z] = HALF_M;
    let seat = [DVec3::new(-x, HEIGHT_M - 0.06, -z), DVec3::new(x, HEIGHT_M, z)];
    block(b, frame, seat, Faces::ALL, p.wood);
    let leg = Faces::ALL.without(Faces::BOTTOM).without(Faces::TOP);
    for side in [-1.0, 1.0] {
        let middle = side * (x - 0.15);
        let low = DVec3::new(middle - 0.04, 0.0, -z + 0.04);
        let high = DVec3::new(middle + 0.04, HEIGHT_M - 0.06, z - 0.04);
        block(b, frame, [low, high], leg, p.iron);
    }
}
