//! Benches, the round settee of the salon, rugs, the desk at the entrance, and potted trees.

use super::palette::Palette;
use super::planting::crown;
use super::rooms::PLATFORM;
use crate::scene::SceneBuilder;
use crate::scene::builtin::parts::bench;
use crate::scene::builtin::shapes::{Faces, Local, bar, block, icosphere, lathe};
use glam::{DVec3, Vec2};
use std::f64::consts::FRAC_PI_2;

/// Segments of round furniture.
const SEGMENTS: u32 = 64;

pub(super) fn add_to(b: &mut SceneBuilder, p: &Palette) {
    for (place, bearing) in [
        ([22.7, 0.0, 20.2], 90.0),
        ([11.3, 0.0, 15.4], 90.0),
        ([1.9, 0.0, 11.4], 90.0),
        ([5.0, 0.0, 21.9], 0.0),
        ([7.6, 0.0, 7.4], 0.0),
        ([25.9, 0.0, 7.5], 0.0),
        ([28.95, PLATFORM.height_m, 22.3], 0.0),
        ([32.8, 0.0, 13.3], 90.0),
    ] {
        bench(b, &p.parts, &Local::turned(place.into(), bearing));
    }
    settee(b, p, &Local::at(DVec3::new(17.0, 0.0, 4.0)));
    rug(b, p, [14.4, 19.6, 2.1, 5.9]);
    rug(b, p, [26.9, 31.0, 2.0, 4.7]);
    desk(b, p, &Local::turned(DVec3::new(22.3, 0.0, 22.3), 180.0));
    for (place, height) in [
        ([24.75, 0.0, 9.75], 1.5),
        ([33.1, 0.0, 9.7], 1.4),
        ([24.9, PLATFORM.height_m, 18.2], 1.4),
        ([14.2, 0.0, 23.0], 1.5),
        ([19.8, 0.0, 23.0], 1.5),
        ([9.15, 0.0, 22.9], 1.4),
        ([9.2, 0.0, 8.2], 1.4),
    ] {
        potted_tree(b, p, &Local::at(place.into()), height);
    }
}

/// Adds a round settee with a conical back that carries a ball.
fn settee(b: &mut SceneBuilder, p: &Palette, frame: &Local) {
    lathe(b, frame, &[[0.86, 0.0], [0.86, 0.10]], SEGMENTS, p.parts.wood);
    let mut seat = vec![[0.88, 0.09], [0.93, 0.12], [0.95, 0.30]];
    seat.extend((0..=8).map(|i| {
        let (sin, cos) = (f64::from(i) / 8.0 * FRAC_PI_2).sin_cos();
        [0.87 + 0.08 * cos, 0.36 + 0.08 * sin]
    }));
    seat.extend([[0.7, 0.455], [0.42, 0.45]]);
    lathe(b, frame, &seat, SEGMENTS, p.velvet);
    let mut back = vec![[0.44, 0.44], [0.40, 0.55], [0.35, 0.75], [0.31, 0.92]];
    back.extend((0..=8).map(|i| {
        let (sin, cos) = (f64::from(i) / 8.0 * FRAC_PI_2).sin_cos();
        [0.23 + 0.07 * cos, 0.96 + 0.06 * sin]
    }));
    lathe(b, frame, &back, SEGMENTS, p.velvet);
    lathe(b, frame, &[[0.24, 1.015], [0.20, 1.04], [0.08, 1.05], [0.001, 1.05]], SEGMENTS, p.brushed_brass);
    icosphere(b, &frame.moved(DVec3::Y * 1.2), 4, p.brushed_brass, |d| d * 0.16);
}

/// Adds a rug with a border, 12 mm thick.
fn rug(b: &mut SceneBuilder, p: &Palette, [x0, x1, z0, z1]: [f64; 4]) {
    let faces = Faces::ALL.without(Faces::BOTTOM);
    let slab = |inset: f64, y0: f64, y1: f64| {
        [DVec3::new(x0 + inset, y0, z0 + inset), DVec3::new(x1 - inset, y1, z1 - inset)]
    };
    block(b, &Local::WORLD, slab(0.0, 0.0, 0.010), faces, p.rug);
    block(b, &Local::WORLD, slab(0.16, 0.010, 0.012), faces, p.rug_border);
    block(b, &Local::WORLD, slab(0.24, 0.012, 0.014), faces, p.rug);
}

fn desk(b: &mut SceneBuilder, p: &Palette, frame: &Local) {
    let body = Faces::ALL.without(Faces::BOTTOM).without(Faces::TOP);
    let slab = |x: f64, z: f64, y0: f64, y1: f64| [DVec3::new(-x, y0, -z), DVec3::new(x, y1, z)];
    block(b, frame, slab(1.05, 0.30, 0.0, 0.08), body, p.parts.black);
    block(b, frame, slab(1.1, 0.35, 0.08, 1.02), Faces::ALL.without(Faces::TOP), p.parts.wood);
    block(b, frame, slab(1.16, 0.41, 1.02, 1.07), Faces::ALL, p.parts.stone);
    // A screen on a foot, turned to those who enter.
    let foot = [DVec3::new(-0.6, 1.07, -0.1), DVec3::new(-0.3, 1.09, 0.1)];
    block(b, frame, foot, Faces::ALL.without(Faces::BOTTOM), p.parts.black);
    let back = [DVec3::new(-0.72, 1.12, -0.02), DVec3::new(-0.18, 1.45, 0.02)];
    block(b, frame, back, Faces::ALL, p.parts.black);
    let picture = [[-0.70, 1.14], [-0.20, 1.14], [-0.20, 1.43], [-0.70, 1.43]];
    b.add_quad(picture.map(|[x, y]| frame.point(DVec3::new(x, y, 0.025))), Vec2::ONE, p.screen);
    // A small stack of leaflets.
    let leaflets = [DVec3::new(0.5, 1.07, -0.12), DVec3::new(0.72, 1.13, 0.18)];
    block(b, frame, leaflets, Faces::ALL.without(Faces::BOTTOM), p.paper);
}

fn potted_tree(b: &mut SceneBuilder, p: &Palette, frame: &Local, height: f64) {
    let outside = [[0.20, 0.0], [0.24, 0.2], [0.28, 0.40], [0.29, 0.41], [0.31, 0.42], [0.315, 0.48]];
    lathe(b, frame, &outside, 40, p.terracotta);
    lathe(b, frame, &[[0.315, 0.48], [0.28, 0.485], [0.27, 0.42]], 40, p.terracotta);
    lathe(b, frame, &[[0.275, 0.425], [0.1, 0.435], [0.001, 0.44]], 40, p.soil);
    let stem = [0.42, height].map(|y| frame.point(DVec3::Y * y));
    bar(b, stem, 0.022, 12, p.bark);
    crown(b, &frame.moved(DVec3::Y * (height + 0.1)), [0.36, 0.40], 4, p.leaves[0]);
}
