//! Shapes of plants: crowns of trees, cypresses and hedges.

use crate::scene::builtin::shapes::{Closing, Grid, Local, bar, icosphere, on_circle};
use crate::scene::{MaterialId, SceneBuilder};
use glam::{DVec3, Vec3};
use std::f64::consts::PI;

/// Returns the unevenness of leaves at a point, -1 to 1; one period is a unit long at most.
fn leafy(p: DVec3) -> f64 {
    let wave = |d: Vec3, f: f64, phase: f64| (p.dot(d.as_dvec3()) * f + phase).sin();
    let coarse = wave(Vec3::new(0.8, 0.5, 0.3), 7.0, 0.3) * wave(Vec3::new(-0.4, 0.7, 0.6), 8.0, 1.7);
    let middle = wave(Vec3::new(0.3, -0.8, 0.5), 15.0, 2.1) * wave(Vec3::new(0.7, 0.1, -0.7), 17.0, 0.9);
    let fine = wave(Vec3::new(-0.6, 0.3, 0.7), 34.0, 0.5) * wave(Vec3::new(0.5, 0.8, 0.2), 37.0, 2.7);
    (coarse + 0.8 * middle + 0.7 * fine) / 2.5
}

/// Adds the crown of a tree around the origin of the frame, with its radius across and upwards.
pub(super) fn crown(
    b: &mut SceneBuilder,
    frame: &Local,
    [across, up]: [f64; 2],
    levels: u32,
    material: MaterialId,
) {
    icosphere(b, frame, levels, material, |d| {
        let swell = 1.0 + 0.22 * leafy(d * 1.3 + frame.origin);
        DVec3::new(d.x * across, d.y * up, d.z * across) * swell
    });
}

/// Adds a tree with a round crown on a trunk.
pub(super) fn tree(b: &mut SceneBuilder, foot: DVec3, height: f64, [bark, leaves]: [MaterialId; 2]) {
    let top = foot + DVec3::Y * (height * 0.55);
    bar(b, [foot, top], 0.035 * height, 14, bark);
    let frame = Local::at(foot + DVec3::Y * (height * 0.64));
    crown(b, &frame, [height * 0.33, height * 0.36], 4, leaves);
}

/// Adds a cypress: a slender cone with a round foot.
pub(super) fn cypress(b: &mut SceneBuilder, foot: DVec3, height: f64, material: MaterialId) {
    let grid = Grid { nu: 32, nv: 40, u: Closing::Around, v: Closing::Poles };
    grid.add_to(b, &Local::at(foot), material, |u, v| {
        let radius = 0.13 * height * (v * PI).sin().powf(0.6) * (1.0 - 0.75 * v);
        let p = on_circle(u, radius, v * height);
        let swell = 1.0 + 0.2 * leafy(p * 1.2 + foot);
        DVec3::new(p.x * swell, p.y, p.z * swell)
    });
}

/// Adds a hedge between two points of the ground, with its width and its height.
pub(super) fn hedge(
    b: &mut SceneBuilder,
    [from, to]: [DVec3; 2],
    [width, height]: [f64; 2],
    material: MaterialId,
) {
    let length = (to - from).length();
    let frame = Local { origin: from, x: (to - from) / length };
    let cells = (length * 4.0).ceil() as u32;
    Grid { nu: cells, nv: 18, u: Closing::Open, v: Closing::Open }.add_to(b, &frame, material, |u, v| {
        // Half a superellipse, from the ground over the top to the ground.
        let (sin, cos) = (v * PI).sin_cos();
        let round = |t: f64| t.signum() * t.abs().powf(0.35);
        let p = DVec3::new(u * length, height * round(sin), -width / 2.0 * round(cos));
        let swell = 0.09 * leafy(p + from);
        p + DVec3::new(0.0, swell * sin, -swell * cos)
    });
}
