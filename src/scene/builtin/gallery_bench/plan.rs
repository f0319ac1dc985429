//! The floor plan: rooms, doorways, and the sides of rooms that trim and paintings follow.

use crate::scene::builtin::shapes::{Local, Opening};
use glam::DVec3;

/// Thickness of every wall in metres.
pub(super) const WALL_M: f64 = 0.3;
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

/// A doorway, given by the middle of its threshold.
#[derive(Clone, Copy, Debug)]
pub(super) struct Door {
    /// World x and z.
    pub(super) middle: [f64; 2],
    /// True if the wall of the doorway runs along x.
    pub(super) in_wall_along_x: bool,
}

const fn door(x: f64, z: f64, in_wall_along_x: bool) -> Door {
    Door { middle: [x, z], in_wall_along_x }
}

/// All doorways. Those of a row of rooms are aligned, so that all three rooms are visible at once.
pub(super) const DOORS: [Door; 7] = [
    door(10.0, 4.5, false),
    door(24.0, 4.5, false),
    door(5.0, 9.0, true),
    door(17.0, 9.0, true),
    door(29.0, 9.0, true),
    door(10.0, 12.6, false),
    door(24.0, 12.6, false),
];

/// One side of a room. Seen from inside the room, x runs along it to the right and z into the room.
#[derive(Clone, Debug)]
pub(super) struct Side {
    /// Frame with its origin on the floor.
    pub(super) frame: Local,
    /// Length along x in metres.
    pub(super) length: f64,
    /// Start and end of each doorway along x.
    pub(super) doors: Vec<[f64; 2]>,
}

/// The direction in which a viewer in the room faces a side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Facing {
    North,
    East,
    South,
    West,
}

impl Facing {
    pub(super) const ALL: [Self; 4] = [Self::North, Self::East, Self::South, Self::West];
}

impl Room {
    /// Returns the height of the lids of the coffers.
    pub(super) fn lid(&self) -> f64 {
        self.ceiling + self.coffer_rise
    }

    pub(super) fn side(&self, facing: Facing) -> Side {
        let [x0, x1, z0, z1] = self.area;
        let (corner, x, length) = match facing {
            Facing::North => ([x0, z0], DVec3::X, x1 - x0),
            Facing::East => ([x1, z0], DVec3::Z, z1 - z0),
            Facing::South => ([x1, z1], DVec3::NEG_X, x1 - x0),
            Facing::West => ([x0, z1], DVec3::NEG_Z, z1 - z0),
        };
        let frame = Local { origin: DVec3::new(corner[0], 0.0, corner[1]), x };
        let doors = DOORS.iter().filter_map(|d| along(&frame, length, d)).collect();
        Side { frame, length, doors }
    }
}

/// Returns the start and end of a doorway along a side, or `None` if it belongs to another side.
fn along(frame: &Local, length: f64, door: &Door) -> Option<[f64; 2]> {
    let to_middle = DVec3::new(door.middle[0], 0.0, door.middle[1]) - frame.origin;
    let runs_along_x = frame.x.x != 0.0;
    let behind = -frame.direction(DVec3::Z).dot(to_middle);
    let middle = frame.x.dot(to_middle);
    let inside = runs_along_x == door.in_wall_along_x
        && (behind - WALL_M / 2.0).abs() < 0.01
        && (0.0..length).contains(&middle);
    inside.then_some([middle - DOOR_M[0] / 2.0, middle + DOOR_M[0] / 2.0])
}

/// Returns the doorways of a wall as openings. The wall runs from `from` to `to` along its axis, at
/// position `at` across it.
pub(super) fn openings(from: f64, to: f64, at: f64, wall_along_x: bool) -> Vec<Opening> {
    let mut found: Vec<Opening> = DOORS
        .iter()
        .filter(|d| d.in_wall_along_x == wall_along_x)
        .map(|d| if wall_along_x { (d.middle[0], d.middle[1]) } else { (d.middle[1], d.middle[0]) })
        .filter(|&(along, across)| across == at && (from..to).contains(&along))
        .map(|(along, _)| {
            let middle = along - from;
            let half = DOOR_M[0] / 2.0;
            Opening { along: [middle - half, middle + half], height: [0.0, DOOR_M[1]] }
        })
        .collect();
    found.sort_by(|a, b| a.along[0].total_cmp(&b.along[0]));
    found
}
