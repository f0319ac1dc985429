//! Where things are: rooms, doors, and the sides of rooms that trim and pictures follow.

use crate::scene::builtin::shapes::{Local, Opening};
use glam::DVec3;

/// Of every wall, metres.
pub(super) const WALL_M: f64 = 0.3;
/// Upper edge of the walls; the roof lies on it.
pub(super) const WALL_TOP_M: f64 = 5.3;
/// Lower edge of the walls and underside of the floors.
pub(super) const BASE_M: f64 = -0.3;
/// Clear width and height of every doorway.
pub(super) const DOOR_M: [f64; 2] = [2.4, 2.8];

/// One room between the faces of its walls.
#[derive(Clone, Copy, Debug)]
pub(super) struct Room {
    /// x0, x1, z0, z1.
    pub(super) area: [f64; 4],
    /// Height of the flat of the ceiling.
    pub(super) ceiling: f64,
}

/// The rooms, in the order of [`RoomName`].
pub(super) const ROOMS: [Room; 6] = [
    Room { area: [0.3, 9.85, 0.3, 8.85], ceiling: 4.5 },
    Room { area: [10.15, 23.85, 0.3, 8.85], ceiling: 4.5 },
    Room { area: [24.15, 33.7, 0.3, 8.85], ceiling: 4.5 },
    Room { area: [0.3, 9.85, 9.15, 23.7], ceiling: 4.5 },
    Room { area: [10.15, 23.85, 9.15, 23.7], ceiling: 4.65 },
    Room { area: [24.15, 33.7, 9.15, 23.7], ceiling: 4.5 },
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

/// A doorway by the middle of its threshold.
#[derive(Clone, Copy, Debug)]
pub(super) struct Door {
    /// x and z.
    pub(super) middle: [f64; 2],
    /// Whether the wall it is in runs along x.
    pub(super) in_wall_along_x: bool,
}

const fn door(x: f64, z: f64, in_wall_along_x: bool) -> Door {
    Door { middle: [x, z], in_wall_along_x }
}

/// All doorways. Those of a row of rooms are in line, so that one looks through all three.
pub(super) const DOORS: [Door; 7] = [
    door(10.0, 4.5, false),
    door(24.0, 4.5, false),
    door(5.0, 9.0, true),
    door(17.0, 9.0, true),
    door(29.0, 9.0, true),
    door(10.0, 12.6, false),
    door(24.0, 12.6, false),
];

/// One side of a room, seen from within: x along it to the right, z into the room.
#[derive(Clone, Debug)]
pub(super) struct Side {
    /// Its frame, standing on the floor.
    pub(super) frame: Local,
    /// Metres along x.
    pub(super) length: f64,
    /// Its doorways along x.
    pub(super) doors: Vec<[f64; 2]>,
}

/// Which way one looks to see a side.
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

/// The stretch of a side that a doorway takes, where it is in that side.
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

/// Doorways as openings of a wall that begins at `from` along its own axis.
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
