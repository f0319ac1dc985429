//! Framed paintings on the walls.

use super::palette::Palette;
use super::plan::RoomName;
use crate::scene::SceneBuilder;
use crate::scene::builtin::parts::{Facing, framed};
use glam::DVec3;

/// A framed painting.
struct Picture {
    room: RoomName,
    facing: Facing,
    /// Position of the middle along the wall in metres.
    middle: f64,
    /// Width and height in metres.
    size: [f64; 2],
    /// Index into the paintings of the palette.
    painting: usize,
}

const fn hung(room: RoomName, facing: Facing, middle: f64, size: [f64; 2], painting: usize) -> Picture {
    Picture { room, facing, middle, size, painting }
}

const PICTURES: [Picture; 24] = [
    hung(RoomName::Red, Facing::North, 2.2, [1.6, 1.6], 0),
    hung(RoomName::Red, Facing::North, 4.6, [1.2, 1.6], 3),
    hung(RoomName::Red, Facing::North, 9.1, [1.2, 1.6], 4),
    hung(RoomName::Red, Facing::North, 11.5, [1.6, 1.6], 1),
    hung(RoomName::Red, Facing::South, 2.6, [2.4, 1.5], 5),
    hung(RoomName::Red, Facing::South, 11.1, [2.4, 1.5], 2),
    hung(RoomName::Red, Facing::East, 1.4, [1.0, 1.3], 2),
    hung(RoomName::Red, Facing::East, 7.1, [1.0, 1.3], 3),
    hung(RoomName::Vitrine, Facing::North, 2.4, [1.4, 1.4], 4),
    hung(RoomName::Vitrine, Facing::North, 4.8, [1.4, 1.4], 0),
    hung(RoomName::Vitrine, Facing::North, 7.2, [1.4, 1.4], 3),
    hung(RoomName::Vitrine, Facing::East, 4.2, [2.6, 1.6], 1),
    hung(RoomName::Mirrors, Facing::North, 2.6, [1.5, 1.5], 5),
    hung(RoomName::Mirrors, Facing::North, 6.9, [1.5, 1.5], 1),
    hung(RoomName::Hall, Facing::South, 6.85, [3.2, 2.2], 1),
    hung(RoomName::Hall, Facing::North, 2.4, [1.6, 1.9], 2),
    hung(RoomName::Hall, Facing::North, 11.3, [1.6, 1.9], 5),
    hung(RoomName::Court, Facing::West, 3.4, [1.8, 1.5], 0),
    hung(RoomName::Court, Facing::West, 7.3, [1.8, 1.5], 4),
    hung(RoomName::Court, Facing::West, 11.2, [1.8, 1.5], 2),
    hung(RoomName::Court, Facing::South, 4.8, [2.8, 1.8], 3),
    hung(RoomName::Terrace, Facing::East, 2.6, [1.8, 1.5], 5),
    hung(RoomName::Terrace, Facing::East, 5.6, [1.8, 1.5], 3),
    hung(RoomName::Terrace, Facing::South, 4.8, [2.6, 1.7], 0),
];
const EYE_LEVEL_M: f64 = 1.65;

pub(super) fn add_to(b: &mut SceneBuilder, p: &Palette) {
    for (i, picture) in PICTURES.iter().enumerate() {
        let side = picture.room.room().side(picture.facing);
        // The south wall of the terrace stands on the platform.
        let raised = picture.room == RoomName::Terrace && picture.facing == Facing::South;
        let lift = if raised { super::terrace::PLATFORM_M } else { 0.0 };
        let middle = DVec3::new(picture.middle, EYE_LEVEL_M.max(picture.size[1] / 2.0 + 0.7) + lift, 0.0);
        let border = if i % 3 == 1 { p.black } else { p.gilt };
        framed(b, &side.frame.moved(middle), picture.size, p.paintings[picture.painting], border);
    }
}
