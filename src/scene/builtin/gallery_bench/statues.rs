//! The positions of the statues, and their plinths.

use super::{palette::Palette, terrace::PLATFORM_M};
use crate::scene::builtin::parts::{Figure, band, boulder, bust, knot, plinth, rings, ripples, spire, vase};
use crate::scene::builtin::shapes::Local;
use crate::scene::{MaterialId, SceneBuilder};

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
        let top = plinth(b, &p.parts(), &Local::turned(place.into(), bearing), height);
        figure(b, &top, material);
    }
}
