//! The floor plan: rooms and doorways.

use crate::scene::builtin::parts::{Facing, Gap, Side};

/// Height of the upper edge of the walls, which carries the roof.
pub(super) const WALL_TOP_M: f64 = 5.3;
/// Height of the lower edge of the walls and of the underside of the floors.
pub(super) const BASE_M: f64 = -0.3;
/// Clear width and height of every doorway in metres.
pub(super) const DOOR_M: [f64; 2] = [2.4, 2.8];

/// The inside of a room, in world metres.
#[derive(Clone, Copy, Debug)]
pub(super) struct Room {
    /// Extent as x0, x1, z0, z1.
    pub(super) area: [f64; 4],
    /// Height of the flat part of the ceiling.
    pub(super) ceiling: f64,
    /// Height of the lids of the coffers above the flat part of the ceiling.
    pub(super) coffer_rise: f64,
}

/// The rooms, in the order of [`RoomName`]. The coffers of the hall are shallow, because deeper
/// ones would hide the lamps from the aisles.
pub(super) const ROOMS: [Room; 6] = [
    Room { area: [0.3, 9.85, 0.3, 8.85], ceiling: 4.5, coffer_rise: 0.5 },
    Room { area: [10.15, 23.85, 0.3, 8.85], ceiling: 4.5, coffer_rise: 0.5 },
    Room { area: [24.15, 33.7, 0.3, 8.85], ceiling: 4.5, coffer_rise: 0.5 },
    Room { area: [0.3, 9.85, 9.15, 23.7], ceiling: 4.5, coffer_rise: 0.5 },
    Room { area: [10.15, 23.85, 9.15, 23.7], ceiling: 4.65, coffer_rise: 0.25 },
    Room { area: [24.15, 33.7, 9.15, 23.7], ceiling: 4.5, coffer_rise: 0.5 },
];

/// Index into [`ROOMS`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RoomName {
    Mirrors,
    Red,
    Vitrine,
    Court,
    Hall,
    Terrace,
}

impl RoomName {
    pub(super) const ALL: [Self; 6] =
        [Self::Mirrors, Self::Red, Self::Vitrine, Self::Court, Self::Hall, Self::Terrace];

    pub(super) fn room(self) -> &'static Room {
        &ROOMS[self as usize]
    }
}

const fn door(x: f64, z: f64, in_wall_along_x: bool) -> Gap {
    Gap { middle: [x, z], in_wall_along_x, width: DOOR_M[0], height: [0.0, DOOR_M[1]] }
}

/// All doorways. Those of a row of rooms are aligned, so that all three rooms are visible at once.
pub(super) const DOORS: [Gap; 7] = [
    door(10.0, 4.5, false),
    door(24.0, 4.5, false),
    door(5.0, 9.0, true),
    door(17.0, 9.0, true),
    door(29.0, 9.0, true),
    door(10.0, 12.6, false),
    door(24.0, 12.6, false),
];

impl Room {
    /// Returns the height of the lids of the coffers.
    pub(super) fn lid(&self) -> f64 {
        self.ceiling + self.coffer_rise
    }

    pub(super) fn side(&self, facing: Facing) -> Side {
        Side::of(self.area, facing, &DOORS)
    }
}
