//! The walls of a building of six rooms in two rows, 34 by 24 metres.

use super::{Gap, WALL_M, openings};
use crate::scene::builtin::shapes::{Local, Opening, Wall};
use crate::scene::{MaterialId, SceneBuilder};
use glam::{DVec3, Vec2};

/// What walls look like and where their doorways and windows are.
#[derive(Clone, Copy, Debug)]
pub(in crate::scene::builtin) struct Shell<'a> {
    /// Material of the walls of each room: the northern row from west to east, then the southern.
    pub(in crate::scene::builtin) rooms: [MaterialId; 6],
    /// Material of the outside.
    pub(in crate::scene::builtin) outside: MaterialId,
    /// Material of the insides of openings.
    pub(in crate::scene::builtin) reveal: MaterialId,
    /// Heights of the lower and the upper edge of the walls in metres.
    pub(in crate::scene::builtin) height: [f64; 2],
    /// Doorways and windows.
    pub(in crate::scene::builtin) gaps: &'a [Gap],
}

/// Adds the walls of both rows of rooms. Those along z are continuous; those along x end at them.
pub(in crate::scene::builtin) fn walls(b: &mut SceneBuilder, s: &Shell<'_>) {
    let [mirrors, red, vitrine, court, hall, terrace] = s.rooms;
    let outside = s.outside;
    let (top, bottom) = ([0.0, 9.0], [9.0, 24.0]);
    along_z(b, s, 0.15, top, [outside, mirrors]);
    along_z(b, s, 0.15, bottom, [outside, court]);
    along_z(b, s, 10.0, [0.3, 9.0], [mirrors, red]);
    along_z(b, s, 10.0, [9.0, 23.7], [court, hall]);
    along_z(b, s, 24.0, [0.3, 9.0], [red, vitrine]);
    along_z(b, s, 24.0, [9.0, 23.7], [hall, terrace]);
    along_z(b, s, 33.85, top, [vitrine, outside]);
    along_z(b, s, 33.85, bottom, [terrace, outside]);
    for (z, from_above, from_below) in [
        (0.15, [mirrors, red, vitrine], [outside; 3]),
        (9.0, [court, hall, terrace], [mirrors, red, vitrine]),
        (23.85, [outside; 3], [court, hall, terrace]),
    ] {
        let outer = z != 9.0;
        // An outer wall passes behind the ends of the inner walls; its colours change at their
        // middles.
        let stretches = if outer {
            [[0.3, 10.0], [10.0, 24.0], [24.0, 33.7]]
        } else {
            [[0.3, 9.85], [10.15, 23.85], [24.15, 33.7]]
        };
        for (i, [x0, x1]) in stretches.into_iter().enumerate() {
            along_x(b, s, z, [x0, x1], [from_above[i], from_below[i]]);
        }
    }
    outer_ends(b, s);
}

fn along_x(b: &mut SceneBuilder, s: &Shell<'_>, z: f64, [x0, x1]: [f64; 2], south_north: [MaterialId; 2]) {
    let frame = Local::at(DVec3::new(x0, 0.0, z));
    wall(s, frame, x1 - x0, openings(s.gaps, [x0, x1], z, true), south_north).add_to(b);
}

fn along_z(b: &mut SceneBuilder, s: &Shell<'_>, x: f64, [z0, z1]: [f64; 2], west_east: [MaterialId; 2]) {
    let frame = Local { origin: DVec3::new(x, 0.0, z0), x: DVec3::Z };
    wall(s, frame, z1 - z0, openings(s.gaps, [z0, z1], x, false), west_east).add_to(b);
}

fn wall(s: &Shell<'_>, frame: Local, length: f64, openings: Vec<Opening>, sides: [MaterialId; 2]) -> Wall {
    Wall { frame, length, height: s.height, thickness: WALL_M, openings, sides, reveal: s.reveal }
}

/// Adds the ends of the outer walls along z, flush with the outer faces of those along x.
fn outer_ends(b: &mut SceneBuilder, s: &Shell<'_>) {
    let [y0, y1] = s.height;
    for (x0, x1) in [(0.0, 0.3), (33.7, 34.0)] {
        let face = |x0, x1, z| [[x0, y0, z], [x1, y0, z], [x1, y1, z], [x0, y1, z]].map(DVec3::from);
        let uv = Vec2::new(0.3, (y1 - y0) as f32);
        b.add_quad(face(x1, x0, 0.0), uv, s.outside);
        b.add_quad(face(x0, x1, 24.0), uv, s.outside);
    }
}

/// Returns an area without its holes as rectangles: the cells between the lines through all edges
/// that lie in no hole.
pub(in crate::scene::builtin) fn cells_outside(area: [f64; 4], holes: &[[f64; 4]]) -> Vec<[f64; 4]> {
    let cuts = |axis: usize| {
        let mut all: Vec<f64> =
            holes.iter().chain([&area]).flat_map(|h| [h[2 * axis], h[2 * axis + 1]]).collect();
        all.sort_by(f64::total_cmp);
        all.dedup();
        all
    };
    let (xs, zs) = (cuts(0), cuts(1));
    let in_hole =
        |x: f64, z: f64| holes.iter().any(|h| (h[0]..h[1]).contains(&x) && (h[2]..h[3]).contains(&z));
    let mut cells = Vec::new();
    for x in xs.windows(2) {
        for z in zs.windows(2) {
            if !in_hole((x[0] + x[1]) / 2.0, (z[0] + z[1]) / 2.0) {
                cells.push([x[0], x[1], z[0], z[1]]);
            }
        }
    }
    cells
}
