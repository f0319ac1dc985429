//! The sides of rectangular rooms, and the gaps in walls: what trim and paintings follow.

use crate::scene::builtin::shapes::{Local, Opening};
use glam::DVec3;

/// Thickness of every wall in metres.
pub(in crate::scene::builtin) const WALL_M: f64 = 0.3;

/// A doorway or a window, given by the middle of its wall's thickness.
#[derive(Clone, Copy, Debug)]
pub(in crate::scene::builtin) struct Gap {
    /// World x and z.
    pub(in crate::scene::builtin) middle: [f64; 2],
    /// True if the wall runs along x.
    pub(in crate::scene::builtin) in_wall_along_x: bool,
    /// Clear width in metres.
    pub(in crate::scene::builtin) width: f64,
    /// Heights of the lower and the upper edge in metres.
    pub(in crate::scene::builtin) height: [f64; 2],
}

/// One side of a room. Seen from inside the room, x runs along it to the right and z into the room.
#[derive(Clone, Debug)]
pub(in crate::scene::builtin) struct Side {
    /// Frame with its origin on the floor.
    pub(in crate::scene::builtin) frame: Local,
    /// Length along x in metres.
    pub(in crate::scene::builtin) length: f64,
    /// Doorways and windows.
    pub(in crate::scene::builtin) openings: Vec<Opening>,
}

/// The direction in which a viewer in the room faces a side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::scene::builtin) enum Facing {
    North,
    East,
    South,
    West,
}

impl Facing {
    pub(in crate::scene::builtin) const ALL: [Self; 4] = [Self::North, Self::East, Self::South, Self::West];
}

impl Side {
    /// Returns a side of a room whose extent is `[x0, x1, z0, z1]`.
    pub(in crate::scene::builtin) fn of([x0, x1, z0, z1]: [f64; 4], facing: Facing, gaps: &[Gap]) -> Self {
        let (corner, x, length) = match facing {
            Facing::North => ([x0, z0], DVec3::X, x1 - x0),
            Facing::East => ([x1, z0], DVec3::Z, z1 - z0),
            Facing::South => ([x1, z1], DVec3::NEG_X, x1 - x0),
            Facing::West => ([x0, z1], DVec3::NEG_Z, z1 - z0),
        };
        let frame = Local { origin: DVec3::new(corner[0], 0.0, corner[1]), x };
        let openings = gaps.iter().filter_map(|gap| along(&frame, length, gap)).collect();
        Self { frame, length, openings }
    }

    /// Returns start and end of the doorways, in ascending order.
    pub(in crate::scene::builtin) fn doors(&self) -> Vec<[f64; 2]> {
        let mut doors: Vec<_> =
            self.openings.iter().filter(|o| o.height[0] == 0.0).map(|o| o.along).collect();
        doors.sort_by(|a, b| a[0].total_cmp(&b[0]));
        doors
    }
}

/// Returns the place of a gap along a side, or `None` if it belongs to another side.
fn along(frame: &Local, length: f64, gap: &Gap) -> Option<Opening> {
    let to_middle = DVec3::new(gap.middle[0], 0.0, gap.middle[1]) - frame.origin;
    let runs_along_x = frame.x.x != 0.0;
    let behind = -frame.direction(DVec3::Z).dot(to_middle);
    let middle = frame.x.dot(to_middle);
    let inside = runs_along_x == gap.in_wall_along_x
        && (behind - WALL_M / 2.0).abs() < 0.01
        && (0.0..length).contains(&middle);
    let along = [middle - gap.width / 2.0, middle + gap.width / 2.0];
    inside.then_some(Opening { along, height: gap.height })
}

/// Returns the gaps of a wall as openings. The wall runs from `from` to `to` along its axis, at
/// position `at` across it.
pub(in crate::scene::builtin) fn openings(
    gaps: &[Gap],
    [from, to]: [f64; 2],
    at: f64,
    wall_along_x: bool,
) -> Vec<Opening> {
    let mut found: Vec<Opening> = gaps
        .iter()
        .filter(|g| g.in_wall_along_x == wall_along_x)
        .map(|g| (g, if wall_along_x { g.middle } else { [g.middle[1], g.middle[0]] }))
        .filter(|&(_, [along, across])| across == at && (from..to).contains(&along))
        .map(|(g, [along, _])| {
            let middle = along - from;
            let half = g.width / 2.0;
            Opening { along: [middle - half, middle + half], height: g.height }
        })
        .collect();
    found.sort_by(|a, b| a.along[0].total_cmp(&b.along[0]));
    found
}
