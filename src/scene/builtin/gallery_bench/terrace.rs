//! The raised platform with its stairs and its railing of thin balusters.

use super::{palette::Palette, plan::RoomName};
use crate::scene::SceneBuilder;
use crate::scene::builtin::shapes::{Closing, Grid, Local, bar, floor, lathe, on_circle, stairs};
use glam::{DVec3, Vec2};

/// Height of the platform in metres.
pub(super) const PLATFORM_M: f64 = 0.6;
/// World z of the edge of the platform.
pub(super) const EDGE_Z: f64 = 17.4;
const STAIRS_X: [f64; 2] = [27.8, 30.2];
const RISER_TREAD_M: [f64; 2] = [0.15, 0.3];
const RISERS: u32 = 4;
const RAIL_INSET_M: f64 = 0.12;
const RAIL_HEIGHT_M: f64 = 1.0;
const BALUSTER_RADIUS_M: f64 = 0.015;
const BALUSTER_SPACING_M: f64 = 0.1;
const BALUSTER_CELLS: [u32; 2] = [12, 14];

pub(super) fn add_to(b: &mut SceneBuilder, p: &Palette) {
    let [x0, x1, _, z1] = RoomName::Terrace.room().area;
    floor(b, [x0, x1, EDGE_Z, z1], PLATFORM_M, p.wood_floor);
    let front = [[x1, 0.0], [x0, 0.0], [x0, PLATFORM_M], [x1, PLATFORM_M]];
    let size = Vec2::new((x1 - x0) as f32, PLATFORM_M as f32);
    b.add_quad(front.map(|[x, y]| DVec3::new(x, y, EDGE_Z)), size, p.stone);
    flight(b, p);
    railing(b, p, [x0 + 0.1, STAIRS_X[0] - 0.06]);
    railing(b, p, [STAIRS_X[1] + 0.06, x1 - 0.1]);
}

/// Adds the stairs. They climb towards +z, so their frame is turned by half a turn.
fn flight(b: &mut SceneBuilder, p: &Palette) {
    let frame = Local { origin: DVec3::new(STAIRS_X[1], 0.0, EDGE_Z), x: DVec3::NEG_X };
    stairs(b, &frame, STAIRS_X[1] - STAIRS_X[0], RISER_TREAD_M, RISERS, p.stone);
}

fn railing(b: &mut SceneBuilder, p: &Palette, [x0, x1]: [f64; 2]) {
    let z = EDGE_Z + RAIL_INSET_M;
    let at = |x: f64, y: f64| DVec3::new(x, PLATFORM_M + y, z);
    let count = ((x1 - x0) / BALUSTER_SPACING_M).round() as u32;
    for i in 1..count {
        let x = x0 + (x1 - x0) * f64::from(i) / f64::from(count);
        baluster(b, p, at(x, 0.0));
    }
    for x in [x0, x1] {
        newel(b, p, at(x, 0.0));
    }
    bar(b, [at(x0, RAIL_HEIGHT_M), at(x1, RAIL_HEIGHT_M)], 0.03, 20, p.wood);
    bar(b, [at(x0, 0.1), at(x1, 0.1)], 0.012, 12, p.iron);
}

/// Adds a baluster: a lathed rod with two slightly thicker knops that ends inside the hand rail.
fn baluster(b: &mut SceneBuilder, p: &Palette, foot: DVec3) {
    let [nu, nv] = BALUSTER_CELLS;
    Grid { nu, nv, u: Closing::Around, v: Closing::Open }.add_to(b, &Local::at(foot), p.iron, |u, v| {
        let knop = |at: f64| 0.6 * (-((v - at) / 0.045).powi(2)).exp();
        let radius = BALUSTER_RADIUS_M * (0.7 + knop(0.28) + knop(0.72)).min(1.0);
        on_circle(u, radius, v * RAIL_HEIGHT_M)
    });
}

fn newel(b: &mut SceneBuilder, p: &Palette, foot: DVec3) {
    let profile: Vec<[f64; 2]> = (0..=24)
        .map(|i| {
            let v = f64::from(i) / 24.0;
            let ball = ((v - 0.9) / 0.1 * std::f64::consts::FRAC_PI_2).cos().max(0.0).sqrt();
            let radius = if v < 0.8 { 0.035 } else { (0.05 * ball).max(0.018) };
            [if i == 24 { 0.001 } else { radius }, v * (RAIL_HEIGHT_M + 0.16)]
        })
        .collect();
    lathe(b, &Local::at(foot), &profile, 24, p.iron);
}
