//! Twelve lamps. Each is an emissive quad below an opaque housing, because a quad emits from both
//! sides.

use super::{palette::Palette, plan::RoomName};
use crate::scene::builtin::shapes::{Faces, Local, block, ceiling};
use crate::scene::{Material, SceneBuilder};
use glam::{DVec3, Vec3};

/// Distance from the lid of a coffer down to its lamp.
const DROP_M: f64 = 0.05;
const HOUSING_GAP_M: f64 = 0.01;
/// How far a housing extends beyond its lamp. Less would let upward light through the gap onto the
/// coffer, where the visible sliver of the lamp causes noise.
const HOUSING_MARGIN_M: f64 = 0.12;
const LID_MARGIN_M: f64 = 0.15;
/// Colour of the lamps: a slightly warm white.
const TINT: Vec3 = Vec3::new(1.0, 0.95, 0.87);

/// One lamp in its coffer.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lamp {
    pub(super) room: RoomName,
    /// World x and z of the middle.
    pub(super) middle: [f64; 2],
    /// Side lengths of the quad along x and z.
    size: [f64; 2],
    /// Half the opening of the coffer along x and z.
    mouth: [f64; 2],
    radiance: f32,
}

const fn lamp(room: RoomName, middle: [f64; 2], size: [f64; 2], mouth: [f64; 2], radiance: f32) -> Lamp {
    Lamp { room, middle, size, mouth, radiance }
}

/// All lamps of the gallery.
pub(super) const LAMPS: [Lamp; 12] = [
    lamp(RoomName::Mirrors, [5.075, 4.575], [1.6, 1.6], [3.4, 2.9], 36.0),
    lamp(RoomName::Red, [13.7, 4.575], [1.6, 1.6], [2.4, 2.9], 30.0),
    lamp(RoomName::Red, [20.3, 4.575], [1.6, 1.6], [2.4, 2.9], 30.0),
    lamp(RoomName::Vitrine, [26.9, 4.575], [1.5, 1.5], [1.7, 2.9], 28.0),
    lamp(RoomName::Vitrine, [30.95, 4.575], [1.5, 1.5], [1.7, 2.9], 28.0),
    lamp(RoomName::Court, [5.075, 13.2], [1.6, 1.6], [3.4, 2.7], 28.0),
    lamp(RoomName::Court, [5.075, 19.6], [1.6, 1.6], [3.4, 2.7], 28.0),
    lamp(RoomName::Hall, [17.0, 12.6], [1.6, 1.6], [2.2, 1.65], 22.0),
    lamp(RoomName::Hall, [17.0, 16.4], [1.6, 1.6], [2.2, 1.65], 22.0),
    lamp(RoomName::Hall, [17.0, 20.2], [1.6, 1.6], [2.2, 1.65], 22.0),
    lamp(RoomName::Terrace, [28.925, 13.2], [1.6, 1.6], [3.4, 2.7], 28.0),
    lamp(RoomName::Terrace, [28.925, 19.6], [1.6, 1.6], [3.4, 2.7], 28.0),
];

impl Lamp {
    fn around(&self, half: [f64; 2]) -> [f64; 4] {
        let [x, z] = self.middle;
        [x - half[0], x + half[0], z - half[1], z + half[1]]
    }

    fn half_size(&self, margin: f64) -> [f64; 2] {
        self.size.map(|s| s / 2.0 + margin)
    }

    /// Returns the opening of the coffer as x0, x1, z0, z1.
    pub(super) fn coffer(&self) -> [f64; 4] {
        self.around(self.mouth)
    }

    /// Returns the lid of the coffer as x0, x1, z0, z1.
    pub(super) fn lid(&self) -> [f64; 4] {
        self.around(self.half_size(LID_MARGIN_M))
    }
}

pub(super) fn add_to(b: &mut SceneBuilder, p: &Palette) {
    for lamp in &LAMPS {
        let radiance = b.add_material(Material::emissive("lamp", TINT * lamp.radiance));
        let lid = lamp.room.room().lid();
        ceiling(b, lamp.around(lamp.half_size(0.0)), lid - DROP_M, radiance);
        let [x0, x1, z0, z1] = lamp.around(lamp.half_size(HOUSING_MARGIN_M));
        let low = DVec3::new(x0, lid - DROP_M + HOUSING_GAP_M, z0);
        let high = DVec3::new(x1, lid, z1);
        block(b, &Local::WORLD, [low, high], Faces::ALL.without(Faces::TOP), p.black);
    }
}
