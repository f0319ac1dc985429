//! The statues. Each stands at the origin of its frame and faces along the z axis of the frame.

use crate::scene::builtin::shapes::{
    Closing, Grid, Local, bar, closed_tube, icosphere, on_circle, torus, torus_knot,
};
use crate::scene::{MaterialId, SceneBuilder};
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Adds a statue to a scene.
pub(in crate::scene::builtin) type Figure = fn(&mut SceneBuilder, &Local, MaterialId);

/// Sections of the bust from the chest to the crown: share of the height, half width, depth to the
/// front, depth to the back, and offset to the front; metres.
const BUST_SECTIONS: [[f64; 5]; 18] = [
    [0.000, 0.085, 0.065, 0.065, 0.000],
    [0.050, 0.115, 0.085, 0.080, 0.000],
    [0.120, 0.190, 0.125, 0.115, 0.000],
    [0.190, 0.275, 0.150, 0.135, 0.000],
    [0.250, 0.300, 0.145, 0.135, 0.000],
    [0.295, 0.255, 0.110, 0.120, 0.000],
    [0.335, 0.150, 0.080, 0.098, 0.004],
    [0.375, 0.098, 0.074, 0.088, 0.010],
    [0.430, 0.082, 0.076, 0.086, 0.018],
    [0.475, 0.084, 0.088, 0.088, 0.026],
    [0.510, 0.090, 0.118, 0.096, 0.032],
    [0.570, 0.103, 0.126, 0.110, 0.034],
    [0.650, 0.115, 0.127, 0.130, 0.034],
    [0.740, 0.121, 0.126, 0.147, 0.034],
    [0.820, 0.122, 0.126, 0.150, 0.032],
    [0.900, 0.106, 0.108, 0.132, 0.028],
    [0.960, 0.071, 0.074, 0.090, 0.024],
    [1.000, 0.000, 0.000, 0.000, 0.022],
];
const BUST_HEIGHT_M: f64 = 0.78;

/// Bumps of the face: bearing from the front in radians with its width, share of the height with
/// its width (second and fourth number), and how far the bump stands out in metres.
const BUST_FEATURES: [[f64; 5]; 13] = [
    [0.0, 0.13, 0.655, 0.020, 0.030],
    [0.0, 0.10, 0.695, 0.040, 0.016],
    [0.40, 0.20, 0.715, 0.020, -0.016],
    [-0.40, 0.20, 0.715, 0.020, -0.016],
    [0.40, 0.12, 0.715, 0.010, 0.006],
    [-0.40, 0.12, 0.715, 0.010, 0.006],
    [0.0, 0.55, 0.757, 0.015, 0.008],
    [0.0, 0.26, 0.596, 0.009, 0.009],
    [0.0, 0.22, 0.572, 0.009, 0.008],
    [0.0, 0.30, 0.584, 0.004, -0.005],
    [0.0, 0.30, 0.525, 0.018, 0.012],
    [1.62, 0.10, 0.675, 0.035, 0.018],
    [-1.62, 0.10, 0.675, 0.035, 0.018],
];

/// Adds a head on shoulders.
pub(in crate::scene::builtin) fn bust(b: &mut SceneBuilder, frame: &Local, material: MaterialId) {
    foot(b, frame, [0.085, 0.06], material);
    let stand = frame.moved(DVec3::Y * 0.05);
    Grid { nu: 96, nv: 80, u: Closing::Around, v: Closing::Poles }.add_to(b, &stand, material, |u, v| {
        // The first rows close the chest.
        let h = ((v - 0.03) / 0.97).max(0.0);
        let shrink = (v / 0.03).min(1.0);
        let [half_width, front, back, forward] = section(h);
        let bearing = (u - 0.5) * TAU;
        let depth = if bearing.abs() < PI / 2.0 { front } else { back };
        let lobe = DVec2::new(half_width * bearing.sin(), depth * bearing.cos());
        let out = DVec2::new(bearing.sin(), bearing.cos()) * relief(bearing, h);
        let p = (lobe + out) * shrink;
        DVec3::new(p.x, h * BUST_HEIGHT_M, p.y + forward)
    });
}

fn section(h: f64) -> [f64; 4] {
    let last = BUST_SECTIONS.len() - 1;
    let k = BUST_SECTIONS.iter().rposition(|s| s[0] <= h).unwrap_or(0).min(last - 1);
    let (from, to) = (BUST_SECTIONS[k], BUST_SECTIONS[k + 1]);
    let t = ((h - from[0]) / (to[0] - from[0])).clamp(0.0, 1.0);
    let (before, after) = (BUST_SECTIONS[k.saturating_sub(1)], BUST_SECTIONS[(k + 2).min(last)]);
    std::array::from_fn(|c| {
        let c = c + 1;
        let tangent = |a: [f64; 5], z: [f64; 5]| (z[c] - a[c]) / (z[0] - a[0]) * (to[0] - from[0]);
        let (m0, m1) = (tangent(before, to), tangent(from, after));
        let (t2, t3) = (t * t, t * t * t);
        let value = from[c] * (2.0 * t3 - 3.0 * t2 + 1.0)
            + m0 * (t3 - 2.0 * t2 + t)
            + to[c] * (3.0 * t2 - 2.0 * t3)
            + m1 * (t3 - t2);
        // The crown is round; interpolation would make it a cone.
        if h > 0.96 && c < 4 { from[c] * (1.0 - t * t).max(0.0).sqrt() } else { value.max(0.0) }
    })
}

/// Returns how far face and hair stand out at a bearing from the front and a share of the height.
fn relief(bearing: f64, h: f64) -> f64 {
    let bump = |[at, width, height, tall, out]: [f64; 5]| {
        let (s, t) = ((bearing - at) / width, (h - height) / tall);
        out * (-(s * s + t * t)).exp()
    };
    let face: f64 = BUST_FEATURES.iter().map(|&f| bump(f)).sum();
    let hair_line = 0.80 - 0.17 * (1.0 - (bearing * 0.85).cos()).clamp(0.0, 1.0);
    let in_hair = ((h - hair_line) / 0.03).clamp(0.0, 1.0) * ((1.0 - h) / 0.06).clamp(0.0, 1.0);
    let curls =
        0.008 + 0.0045 * (bearing * 14.0 + (h * 40.0).sin() * 2.0).sin() * (h * 70.0 + bearing * 3.0).cos();
    face + in_hair * curls
}

/// Adds a round foot below a statue.
fn foot(b: &mut SceneBuilder, frame: &Local, [radius, height]: [f64; 2], material: MaterialId) {
    Grid { nu: 40, nv: 16, u: Closing::Around, v: Closing::Open }.add_to(b, frame, material, |u, v| {
        let waist = 1.0 - 0.35 * (v * PI).sin() - 0.25 * v;
        on_circle(u, radius * waist, v * height)
    });
}

/// Adds a thin rod that carries a statue which touches its plinth at one point only.
fn rod(b: &mut SceneBuilder, frame: &Local, height: f64, material: MaterialId) {
    bar(b, [frame.origin, frame.point(DVec3::Y * height)], 0.025, 24, material);
}

/// Adds a twisted, ribbed vase.
pub(in crate::scene::builtin) fn vase(b: &mut SceneBuilder, frame: &Local, material: MaterialId) {
    let radius =
        |v: f64| 0.10 + 0.17 * (v.powf(0.8) * PI).sin().powf(1.3) + 0.09 * (v - 0.86).max(0.0) / 0.14;
    let grid = Grid { nu: 110, nv: 44, u: Closing::Around, v: Closing::Open };
    let at = |u: f64, v: f64, inner: f64| {
        let ribs = 1.0 + 0.07 * (9.0 * u * TAU + 5.0 * v).cos() * (v * PI).sin().powf(0.5);
        on_circle(u, radius(v) * ribs - inner, v * 0.95)
    };
    grid.add_to(b, frame, material, |u, v| at(u, v, 0.0));
    // The inside is visible over the rim. It runs downwards, which reverses its winding.
    let inside = Grid { nu: 110, nv: 10, u: Closing::Around, v: Closing::Open };
    inside.add_to(b, frame, material, |u, v| at(u, 1.0 - 0.4 * v, 0.018 * (v * 6.0).min(1.0)));
}

/// Adds a torus knot with `P` and `Q` windings.
pub(in crate::scene::builtin) fn knot<const P: u32, const Q: u32>(
    b: &mut SceneBuilder,
    frame: &Local,
    material: MaterialId,
) {
    rod(b, frame, 0.2, material);
    let middle = frame.moved(DVec3::Y * 0.62);
    torus_knot(b, &middle, [20, 300], [f64::from(P), f64::from(Q)], [0.3, 0.066], material);
}

/// Adds a sphere with ripples.
pub(in crate::scene::builtin) fn ripples(b: &mut SceneBuilder, frame: &Local, material: MaterialId) {
    foot(b, frame, [0.16, 0.07], material);
    let middle = frame.moved(DVec3::Y * 0.47);
    icosphere(b, &middle, 5, material, |d| {
        let angle = d.dot(DVec3::new(0.35, 0.8, 0.48)).clamp(-1.0, 1.0).acos();
        d * (0.42 + 0.022 * (angle * 22.0).cos() * (angle).sin().powi(2))
    });
}

/// Adds a sphere deformed into a smooth boulder.
pub(in crate::scene::builtin) fn boulder(b: &mut SceneBuilder, frame: &Local, material: MaterialId) {
    let middle = frame.moved(DVec3::Y * 0.44);
    icosphere(b, &middle, 5, material, |d| {
        let swell =
            0.16 * (2.4 * d.x + 1.0).sin() * (2.1 * d.z - 0.4).cos() + 0.10 * (4.2 * d.y + 2.0 * d.x).sin();
        let p = d * (0.40 * (1.0 + swell));
        // The lower side is flat.
        DVec3::new(p.x, (p.y * 1.15).max(-0.44), p.z)
    });
}

/// Adds a square pillar that twists and tapers towards its tip.
pub(in crate::scene::builtin) fn spire(b: &mut SceneBuilder, frame: &Local, material: MaterialId) {
    Grid { nu: 80, nv: 64, u: Closing::Around, v: Closing::Open }.add_to(b, frame, material, |u, v| {
        let angle = u * TAU;
        // Superellipse: a square with round edges.
        let square = (angle.cos().abs().powi(6) + angle.sin().abs().powi(6)).powf(-1.0 / 6.0);
        let half = (0.20 * (1.0 - v).powf(0.7) + 0.012) * (1.0 + 0.12 * (v * 3.0 * PI).sin());
        on_circle(u + 0.42 * v, half * square, v * 1.35)
    });
    let tip = frame.moved(DVec3::Y * 1.37);
    icosphere(b, &tip, 3, material, |d| d * 0.04);
}

/// Adds three linked rings.
pub(in crate::scene::builtin) fn rings(b: &mut SceneBuilder, frame: &Local, material: MaterialId) {
    let cells = [112, 22];
    for (x, y, tilt) in [(-0.17, 0.30, 78.0), (0.17, 0.34, 102.0), (0.0, 0.66, 90.0)] {
        let (sin, cos) = f64::to_radians(tilt).sin_cos();
        let turn = if y > 0.5 { 90.0 } else { 0.0 };
        let (turn_sin, turn_cos) = f64::to_radians(turn).sin_cos();
        let grid = Grid { nu: cells[0], nv: cells[1], u: Closing::Around, v: Closing::Around };
        grid.add_to(b, frame, material, |u, v| {
            let (tube_sin, tube_cos) = (v * TAU).sin_cos();
            let p = on_circle(u, 0.235 + 0.055 * tube_cos, 0.055 * tube_sin);
            // Turn all rings about x, and the top one also about the vertical axis.
            let p = DVec3::new(p.x, p.y * cos - p.z * sin, p.y * sin + p.z * cos);
            let p = DVec3::new(p.x * turn_cos + p.z * turn_sin, p.y, p.z * turn_cos - p.x * turn_sin);
            p + DVec3::new(x, y, 0.0)
        });
    }
    torus(b, &frame.moved(DVec3::Y * 0.02), [64, 14], [0.3, 0.02], material);
}

/// Adds a closed band of varying width.
pub(in crate::scene::builtin) fn band(b: &mut SceneBuilder, frame: &Local, material: MaterialId) {
    rod(b, frame, 0.2, material);
    let middle = frame.moved(DVec3::Y * 0.6);
    let curve = |v: f64| {
        let (sin, cos) = (v * TAU).sin_cos();
        let lift = 0.10 * (3.0 * v * TAU).sin();
        DVec3::new(0.34 * cos, 0.40 * sin, lift)
    };
    closed_tube(b, &middle, [26, 220], |v| 0.055 + 0.035 * (2.0 * v * TAU).cos().powi(2), curve, material);
}
