//! The positions of the statues, and their plinths.

use super::figures::{Figure, band, boulder, bust, knot, rings, ripples, spire, vase};
use super::{palette::Palette, terrace::PLATFORM_M};
use crate::scene::builtin::shapes::{Faces, Local, block};
use crate::scene::{MaterialId, SceneBuilder};
use glam::DVec3;

pub(super) fn add_to(b: &mut SceneBuilder, p: &Palette) {
    // Figure, material, position on the floor, rotation in degrees, height of the plinth in metres.
    let statues: [(Figure, MaterialId, [f64; 3], f64, f64); 12] = [
        // The hall: a pair near the axis, and two in the aisles.
        (vase, p.ultramarine, [15.3, 0.0, 14.5], 0.0, 0.9),
        (knot::<2, 3>, p.terracotta, [18.7, 0.0, 14.5], -20.0, 0.9),
        (bust, p.plaster, [11.6, 0.0, 20.2], 75.0, 1.05),
        (ripples, p.plaster, [22.5, 0.0, 16.4], -90.0, 0.9),
        // The red room.
        (bust, p.marble, [17.0, 0.0, 1.7], 0.0, 1.05),
        // The mirror room.
        (spire, p.plaster, [3.0, 0.0, 6.6], 30.0, 0.7),
        // The court.
        (knot::<3, 4>, p.bronze, [5.0, 0.0, 18.0], 20.0, 0.8),
        (rings, p.jade, [2.2, 0.0, 15.4], 40.0, 0.9),
        (boulder, p.plaster, [2.2, 0.0, 20.8], 60.0, 0.8),
        (band, p.ochre, [7.9, 0.0, 17.4], -30.0, 0.9),
        // The platform of the terrace.
        (vase, p.terracotta, [31.8, PLATFORM_M, 21.0], 0.0, 0.8),
        (knot::<2, 5>, p.jade, [26.1, PLATFORM_M, 21.0], 0.0, 0.8),
    ];
    for (figure, material, place, bearing, height) in statues {
        let top = plinth(b, p, &Local::turned(place.into(), bearing), height);
        figure(b, &top, material);
    }
}

/// Adds a plinth with base and cap. Returns the frame on top of it.
fn plinth(b: &mut SceneBuilder, p: &Palette, frame: &Local, height: f64) -> Local {
    const BASE_M: f64 = 0.1;
    const CAP_M: f64 = 0.05;
    let slab = |half: f64, y0: f64, y1: f64| [DVec3::new(-half, y0, -half), DVec3::new(half, y1, half)];
    let body = Faces::ALL.without(Faces::BOTTOM).without(Faces::TOP);
    block(b, frame, slab(0.42, 0.0, BASE_M), Faces::ALL.without(Faces::BOTTOM), p.stone);
    block(b, frame, slab(0.36, BASE_M, height - CAP_M), body, p.white);
    block(b, frame, slab(0.40, height - CAP_M, height), Faces::ALL, p.stone);
    frame.moved(DVec3::Y * height)
}
