//! The floor plan: rooms, doorways and windows.

use crate::scene::builtin::parts::{Facing, Gap, Side};

/// Height of the upper edge of the walls, which carries the roof.
pub(super) const WALL_TOP_M: f64 = 5.3;
/// Height of the lower edge of the walls and of the underside of the floors.
pub(super) const BASE_M: f64 = -0.3;
/// Extent of the building as x0, x1, z0, z1.
pub(super) const BUILDING: [f64; 4] = [0.0, 34.0, 0.0, 24.0];
/// Height of window sills in metres.
pub(super) const SILL_M: f64 = 0.95;

/// The inside of a room, in world metres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Room {
    /// Extent as x0, x1, z0, z1.
    pub(super) area: [f64; 4],
    /// Height of the ceiling.
    pub(super) ceiling: f64,
}

/// The rooms: the northern row from west to east, then the southern.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RoomName {
    Mirrors,
    Salon,
    Treasury,
    LongGallery,
    Hall,
    GardenRoom,
}

impl RoomName {
    pub(super) const ALL: [Self; 6] =
        [Self::Mirrors, Self::Salon, Self::Treasury, Self::LongGallery, Self::Hall, Self::GardenRoom];

    pub(super) fn room(self) -> Room {
        let (area, ceiling) = match self {
            Self::Mirrors => ([0.3, 9.85, 0.3, 8.85], 4.4),
            Self::Salon => ([10.15, 23.85, 0.3, 8.85], 4.5),
            Self::Treasury => ([24.15, 33.7, 0.3, 8.85], 4.4),
            Self::LongGallery => ([0.3, 9.85, 9.15, 23.7], 4.4),
            Self::Hall => ([10.15, 23.85, 9.15, 23.7], 4.7),
            Self::GardenRoom => ([24.15, 33.7, 9.15, 23.7], 4.4),
        };
        Room { area, ceiling }
    }
}

impl Room {
    pub(super) fn side(&self, facing: Facing) -> Side {
        Side::of(self.area, facing, &GAPS)
    }
}

const fn door(x: f64, z: f64, in_wall_along_x: bool) -> Gap {
    Gap { middle: [x, z], in_wall_along_x, width: 2.4, height: [0.0, 2.8] }
}

const fn window(middle: [f64; 2], in_wall_along_x: bool, width: f64) -> Gap {
    Gap { middle, in_wall_along_x, width, height: [SILL_M, 3.75] }
}

/// All doorways and windows. The doorways of a row of rooms are aligned, so that all three rooms
/// are visible at once.
pub(super) const GAPS: [Gap; 14] = [
    door(10.0, 4.5, false),
    door(24.0, 4.5, false),
    door(5.0, 9.0, true),
    door(17.0, 9.0, true),
    door(29.0, 9.0, true),
    door(10.0, 12.6, false),
    door(24.0, 12.6, false),
    Gap { middle: [17.0, 23.85], in_wall_along_x: true, width: 3.2, height: [0.0, 3.4] },
    window([33.85, 10.95], false, 2.2),
    window([33.85, 13.4], false, 2.2),
    window([33.85, 15.85], false, 2.2),
    window([33.85, 20.6], false, 3.4),
    window([28.95, 23.85], true, 4.2),
    window([5.0, 23.85], true, 3.0),
];
