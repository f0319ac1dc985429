//! Statues on plinths, the wall of mirrors, and the glass case.

use super::palette::Palette;
use super::plan::RoomName;
use super::rooms::PLATFORM;
use crate::scene::builtin::parts::{
    Facing, Figure, band, boulder, bust, framed, knot, plinth, rings, ripples, spire, vase, vitrine,
};
use crate::scene::builtin::shapes::Local;
use crate::scene::{MaterialId, SceneBuilder};
use glam::DVec3;

/// World position of the middle of the glass case on the floor.
const VITRINE: [f64; 3] = [28.925, 0.0, 3.3];

pub(super) fn add_to(b: &mut SceneBuilder, p: &Palette) {
    statues(b, p);
    mirrors(b, p);
    vitrine(b, &p.parts, &Local::at(VITRINE.into()));
}

fn statues(b: &mut SceneBuilder, p: &Palette) {
    let raised = PLATFORM.height_m;
    // Figure, material, position on the floor, rotation in degrees, height of the plinth in metres.
    let statues: [(Figure, MaterialId, [f64; 3], f64, f64); 12] = [
        // The hall: a pair near the axis, and four in the aisles.
        (vase, p.ultramarine, [15.3, 0.0, 14.5], 0.0, 0.9),
        (knot::<2, 3>, p.terracotta, [18.7, 0.0, 14.5], -20.0, 0.9),
        (bust, p.marble, [11.5, 0.0, 18.4], 90.0, 1.05),
        (ripples, p.parts.plaster, [22.4, 0.0, 18.35], -90.0, 0.9),
        // The salon.
        (bust, p.parts.plaster, [17.0, 0.0, 0.95], 0.0, 1.05),
        // The mirror room.
        (spire, p.parts.plaster, [3.0, 0.0, 6.9], 30.0, 0.7),
        // The long gallery.
        (knot::<3, 4>, p.parts.bronze, [5.0, 0.0, 18.0], 20.0, 0.8),
        (rings, p.parts.jade, [2.2, 0.0, 15.0], 40.0, 0.9),
        (boulder, p.parts.plaster, [2.2, 0.0, 20.8], 60.0, 0.8),
        (band, p.ochre, [7.9, 0.0, 18.0], -30.0, 0.9),
        // The platform of the garden room.
        (vase, p.terracotta, [31.8, raised, 22.6], 0.0, 0.8),
        (knot::<2, 5>, p.parts.jade, [26.0, raised, 22.4], 0.0, 0.8),
    ];
    for (figure, material, place, bearing, height) in statues {
        let top = plinth(b, &p.parts, &Local::turned(place.into(), bearing), height);
        figure(b, &top, material);
    }
}

/// Adds five tall mirrors on the west wall. No other mirror faces them.
fn mirrors(b: &mut SceneBuilder, p: &Palette) {
    const SIZE_M: [f64; 2] = [1.2, 2.3];
    const SPACING_M: f64 = 1.6;
    let side = RoomName::Mirrors.room().side(Facing::West);
    for i in -2..=2 {
        let along = side.length / 2.0 + f64::from(i) * SPACING_M;
        let middle = DVec3::new(along, 1.06 + SIZE_M[1] / 2.0, 0.0);
        framed(b, &side.frame.moved(middle), SIZE_M, p.mirror, p.parts.gilt);
    }
}
