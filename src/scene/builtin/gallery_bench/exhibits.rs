//! The wall of mirrors, the vitrine and the benches.

use super::plan::RoomName;
use super::{palette::Palette, terrace::PLATFORM_M};
use crate::scene::SceneBuilder;
use crate::scene::builtin::parts::{Facing, bench, framed, vitrine};
use crate::scene::builtin::shapes::Local;
use glam::DVec3;

/// World position of the middle of the vitrine on the floor.
const VITRINE: [f64; 3] = [29.6, 0.0, 3.2];

pub(super) fn add_to(b: &mut SceneBuilder, p: &Palette) {
    mirrors(b, p);
    vitrine(b, &p.parts(), &Local::at(VITRINE.into()));
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
        bench(b, &p.parts(), &Local::turned(place.into(), bearing));
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
