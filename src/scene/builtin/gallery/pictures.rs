//! Framed paintings on the walls, each with a label beside it.

use super::palette::Palette;
use super::plan::RoomName;
use super::rooms::PLATFORM;
use crate::scene::SceneBuilder;
use crate::scene::builtin::parts::{Facing, framed};
use crate::scene::builtin::shapes::{Faces, Local, block};
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

const PICTURES: [Picture; 28] = [
    hung(RoomName::Mirrors, Facing::North, 2.4, [1.5, 1.5], 5),
    hung(RoomName::Mirrors, Facing::North, 7.1, [1.5, 1.5], 3),
    hung(RoomName::Salon, Facing::North, 1.75, [1.4, 1.7], 3),
    hung(RoomName::Salon, Facing::North, 5.1, [2.4, 1.6], 2),
    hung(RoomName::Salon, Facing::North, 8.6, [2.4, 1.6], 0),
    hung(RoomName::Salon, Facing::North, 11.95, [1.4, 1.7], 8),
    hung(RoomName::Salon, Facing::South, 2.6, [2.2, 1.5], 6),
    hung(RoomName::Salon, Facing::South, 11.1, [2.2, 1.5], 1),
    hung(RoomName::Salon, Facing::East, 1.45, [1.1, 1.4], 5),
    hung(RoomName::Salon, Facing::East, 7.0, [1.1, 1.4], 7),
    hung(RoomName::Salon, Facing::West, 1.45, [1.1, 1.4], 4),
    hung(RoomName::Salon, Facing::West, 7.0, [1.1, 1.4], 3),
    hung(RoomName::Treasury, Facing::North, 2.45, [1.4, 1.4], 4),
    hung(RoomName::Treasury, Facing::North, 4.775, [1.4, 1.4], 0),
    hung(RoomName::Treasury, Facing::North, 7.1, [1.4, 1.4], 5),
    hung(RoomName::Treasury, Facing::East, 4.25, [2.6, 1.6], 3),
    hung(RoomName::Hall, Facing::North, 2.4, [1.6, 1.9], 2),
    hung(RoomName::Hall, Facing::North, 11.3, [1.6, 1.9], 5),
    hung(RoomName::Hall, Facing::West, 3.4, [2.4, 1.7], 0),
    hung(RoomName::Hall, Facing::West, 7.2, [2.4, 1.7], 1),
    hung(RoomName::Hall, Facing::East, 7.3, [2.4, 1.7], 4),
    hung(RoomName::Hall, Facing::East, 11.1, [2.4, 1.7], 3),
    hung(RoomName::LongGallery, Facing::West, 3.4, [1.8, 1.5], 7),
    hung(RoomName::LongGallery, Facing::West, 7.3, [2.2, 1.5], 2),
    hung(RoomName::LongGallery, Facing::West, 11.2, [1.8, 1.5], 5),
    hung(RoomName::LongGallery, Facing::East, 9.1, [2.8, 1.8], 0),
    hung(RoomName::GardenRoom, Facing::West, 3.0, [2.4, 1.6], 8),
    hung(RoomName::GardenRoom, Facing::West, 7.9, [2.4, 1.6], 3),
];
const EYE_LEVEL_M: f64 = 1.7;
/// Lowest edge of a painting above the floor in metres, clear of the panelling.
const LOWEST_M: f64 = 1.12;
/// Width, height and depth of a label in metres.
const LABEL_M: [f64; 3] = [0.16, 0.1, 0.004];

pub(super) fn add_to(b: &mut SceneBuilder, p: &Palette) {
    for (i, picture) in PICTURES.iter().enumerate() {
        let side = picture.room.room().side(picture.facing);
        let is_raised = side.frame.point(DVec3::X * picture.middle).z > PLATFORM.edge_z;
        let lift = if is_raised && picture.room == RoomName::GardenRoom { PLATFORM.height_m } else { 0.0 };
        let [width, height] = picture.size;
        let middle = side.frame.moved(DVec3::new(
            picture.middle,
            EYE_LEVEL_M.max(height / 2.0 + LOWEST_M) + lift,
            0.0,
        ));
        let border = if i % 3 == 1 { p.parts.black } else { p.parts.gilt };
        framed(b, &middle, [width, height], p.paintings[picture.painting], border);
        label(b, p, &middle.moved(DVec3::new(width / 2.0 + 0.17, 0.15 - height / 2.0, 0.0)));
    }
}

fn label(b: &mut SceneBuilder, p: &Palette, corner: &Local) {
    let corners = [DVec3::ZERO, DVec3::from(LABEL_M)];
    block(b, corner, corners, Faces::ALL.without(Faces::BACK), p.paper);
}
