//! The positions of the statues, and their plinths.

use super::figures::Figure;
use super::palette::Palette;
use super::terrace::PLATFORM_M;
use crate::scene::builtin::shapes::{Faces, Local, block};
use crate::scene::{MaterialId, SceneBuilder};
use glam::DVec3;

/// A statue on a plinth.
struct Statue {
    figure: Figure,
    material: MaterialId,
    /// World position on the floor.
    place: [f64; 3],
    /// Rotation about the vertical axis in degrees.
    bearing: f64,
    /// Height of the plinth in metres.
    plinth: f64,
}

pub(super) fn add_to(b: &mut SceneBuilder, p: &Palette) {
    for statue in collection(p) {
        let frame = Local::turned(statue.place.into(), statue.bearing);
        let top = plinth(b, p, &frame, statue.plinth);
        statue.figure.add_to(b, &top, statue.material);
    }
}

fn collection(p: &Palette) -> Vec<Statue> {
    let statue =
        |figure, material, place, bearing, plinth| Statue { figure, material, place, bearing, plinth };
    vec![
        // The hall: a pair near the axis, and two in the aisles.
        statue(Figure::Vase, p.ultramarine, [15.3, 0.0, 14.5], 0.0, 0.9),
        statue(Figure::Knot(2, 3), p.terracotta, [18.7, 0.0, 14.5], -20.0, 0.9),
        statue(Figure::Bust, p.plaster, [11.6, 0.0, 20.2], 75.0, 1.05),
        statue(Figure::Ripples, p.plaster, [22.5, 0.0, 16.4], -90.0, 0.9),
        // The red room.
        statue(Figure::Bust, p.marble, [17.0, 0.0, 1.7], 0.0, 1.05),
        // The mirror room.
        statue(Figure::Spire, p.plaster, [3.0, 0.0, 6.6], 30.0, 0.7),
        // The court.
        statue(Figure::Knot(3, 4), p.bronze, [5.0, 0.0, 18.0], 20.0, 0.8),
        statue(Figure::Rings, p.jade, [2.2, 0.0, 15.4], 40.0, 0.9),
        statue(Figure::Boulder, p.plaster, [2.2, 0.0, 20.8], 60.0, 0.8),
        statue(Figure::Band, p.ochre, [7.9, 0.0, 17.4], -30.0, 0.9),
        // The platform of the terrace.
        statue(Figure::Vase, p.terracotta, [31.8, PLATFORM_M, 21.0], 0.0, 0.8),
        statue(Figure::Knot(2, 5), p.jade, [26.1, PLATFORM_M, 21.0], 0.0, 0.8),
    ]
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
