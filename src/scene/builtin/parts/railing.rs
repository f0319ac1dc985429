//! The edge of a raised platform: stairs, and a railing of thin balusters.

use super::materials::Materials;
use crate::scene::SceneBuilder;
use crate::scene::builtin::shapes::{Closing, Grid, Local, bar, lathe, on_circle, stairs};
use glam::DVec3;

const RISER_TREAD_M: [f64; 2] = [0.15, 0.3];
const RISERS: u32 = 4;
const RAIL_INSET_M: f64 = 0.12;
const RAIL_HEIGHT_M: f64 = 1.0;
const BALUSTER_RADIUS_M: f64 = 0.015;
const BALUSTER_SPACING_M: f64 = 0.1;
const BALUSTER_CELLS: [u32; 2] = [12, 14];

/// A platform whose edge runs along x and faces -z.
#[derive(Clone, Copy, Debug)]
pub(in crate::scene::builtin) struct Platform {
    /// Height above the floor in metres; the stairs are made for 0.6 m.
    pub(in crate::scene::builtin) height_m: f64,
    /// World z of the edge.
    pub(in crate::scene::builtin) edge_z: f64,
}

/// Adds stairs that climb towards +z to the edge of a platform, between two values of world x.
pub(in crate::scene::builtin) fn stairs_up(
    b: &mut SceneBuilder,
    p: &Materials,
    platform: Platform,
    [x0, x1]: [f64; 2],
) {
    // The frame is turned by half a turn.
    let frame = Local { origin: DVec3::new(x1, 0.0, platform.edge_z), x: DVec3::NEG_X };
    stairs(b, &frame, x1 - x0, RISER_TREAD_M, RISERS, p.stone);
}

/// Adds a railing of thin balusters along the edge of a platform.
pub(in crate::scene::builtin) fn railing(
    b: &mut SceneBuilder,
    p: &Materials,
    platform: Platform,
    [x0, x1]: [f64; 2],
) {
    let z = platform.edge_z + RAIL_INSET_M;
    let at = |x: f64, y: f64| DVec3::new(x, platform.height_m + y, z);
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
fn baluster(b: &mut SceneBuilder, p: &Materials, foot: DVec3) {
    let [nu, nv] = BALUSTER_CELLS;
    Grid { nu, nv, u: Closing::Around, v: Closing::Open }.add_to(b, &Local::at(foot), p.iron, |u, v| {
        let knop = |at: f64| 0.6 * (-((v - at) / 0.045).powi(2)).exp();
        let radius = BALUSTER_RADIUS_M * (0.7 + knop(0.28) + knop(0.72)).min(1.0);
        on_circle(u, radius, v * RAIL_HEIGHT_M)
    });
}

fn newel(b: &mut SceneBuilder, p: &Materials, foot: DVec3) {
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
