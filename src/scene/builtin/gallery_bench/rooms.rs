//! The shell of the building: walls, floors, ceilings with splayed coffers, and roof.

use super::lights::{LAMPS, Lamp};
use super::palette::Palette;
use super::plan::{BASE_M, RoomName, WALL_M, WALL_TOP_M, openings};
use crate::scene::builtin::shapes::{Local, Opening, Wall, ceiling, floor};
use crate::scene::{MaterialId, SceneBuilder};
use glam::{DVec3, Vec2};

pub(super) fn add_to(b: &mut SceneBuilder, p: &Palette) {
    walls(b, p);
    floors(b, p);
    for name in RoomName::ALL {
        ceiling_of(b, p, name);
    }
    roof(b, p);
}

/// Adds the walls. Those along z are continuous; those along x end at them.
fn walls(b: &mut SceneBuilder, p: &Palette) {
    let (top, bottom) = ([0.0, 9.0], [9.0, 24.0]);
    along_z(b, p, 0.15, top, [p.outside, p.white]);
    along_z(b, p, 0.15, bottom, [p.outside, p.sand]);
    along_z(b, p, 10.0, [0.3, 9.0], [p.white, p.red]);
    along_z(b, p, 10.0, [9.0, 23.7], [p.sand, p.white]);
    along_z(b, p, 24.0, [0.3, 9.0], [p.red, p.blue]);
    along_z(b, p, 24.0, [9.0, 23.7], [p.white, p.green]);
    along_z(b, p, 33.85, top, [p.blue, p.outside]);
    along_z(b, p, 33.85, bottom, [p.green, p.outside]);
    for (z, from_above, from_below) in [
        (0.15, [p.white, p.red, p.blue], [p.outside; 3]),
        (9.0, [p.sand, p.white, p.green], [p.white, p.red, p.blue]),
        (23.85, [p.outside; 3], [p.sand, p.white, p.green]),
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
            along_x(b, p, z, [x0, x1], [from_above[i], from_below[i]]);
        }
    }
    outer_ends(b, p);
}

fn along_x(b: &mut SceneBuilder, p: &Palette, z: f64, [x0, x1]: [f64; 2], south_north: [MaterialId; 2]) {
    let frame = Local::at(DVec3::new(x0, 0.0, z));
    wall(p, frame, x1 - x0, openings(x0, x1, z, true), south_north).add_to(b);
}

fn along_z(b: &mut SceneBuilder, p: &Palette, x: f64, [z0, z1]: [f64; 2], west_east: [MaterialId; 2]) {
    let frame = Local { origin: DVec3::new(x, 0.0, z0), x: DVec3::Z };
    wall(p, frame, z1 - z0, openings(z0, z1, x, false), west_east).add_to(b);
}

fn wall(p: &Palette, frame: Local, length: f64, openings: Vec<Opening>, sides: [MaterialId; 2]) -> Wall {
    Wall { frame, length, height: [BASE_M, WALL_TOP_M], thickness: WALL_M, openings, sides, reveal: p.reveal }
}

/// Adds the ends of the outer walls along z, flush with the outer faces of those along x.
fn outer_ends(b: &mut SceneBuilder, p: &Palette) {
    let (y0, y1) = (BASE_M, WALL_TOP_M);
    for (x0, x1) in [(0.0, 0.3), (33.7, 34.0)] {
        let face = |x0, x1, z| [[x0, y0, z], [x1, y0, z], [x1, y1, z], [x0, y1, z]].map(DVec3::from);
        let uv = Vec2::new(0.3, (y1 - y0) as f32);
        b.add_quad(face(x1, x0, 0.0), uv, p.outside);
        b.add_quad(face(x0, x1, 24.0), uv, p.outside);
    }
}

fn floors(b: &mut SceneBuilder, p: &Palette) {
    let materials =
        [p.marble_floor, p.wood_floor, p.dark_wood_floor, p.wood_floor, p.tile_floor, p.tile_floor];
    for (name, material) in RoomName::ALL.into_iter().zip(materials) {
        floor(b, name.room().area, 0.0, material);
    }
    ceiling(b, [0.0, 34.0, 0.0, 24.0], BASE_M, p.outside);
}

/// Adds the flat part of a ceiling, and its coffers.
fn ceiling_of(b: &mut SceneBuilder, p: &Palette, name: RoomName) {
    let room = name.room();
    let lamps: Vec<&Lamp> = LAMPS.iter().filter(|l| l.room == name).collect();
    let holes: Vec<[f64; 4]> = lamps.iter().map(|l| l.coffer()).collect();
    for cell in cells_outside(room.area, &holes) {
        ceiling(b, cell, room.ceiling, p.ceiling);
    }
    for lamp in lamps {
        coffer(b, p, lamp, [room.ceiling, room.lid()]);
    }
}

/// Returns an area without its holes as rectangles: the cells between the lines through all edges
/// that lie in no hole.
fn cells_outside(area: [f64; 4], holes: &[[f64; 4]]) -> Vec<[f64; 4]> {
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

/// Adds four splayed sides, which reflect the light of the lamp, and a lid.
fn coffer(b: &mut SceneBuilder, p: &Palette, lamp: &Lamp, [low_y, high_y]: [f64; 2]) {
    let (low, high) = (corners(lamp.coffer(), low_y), corners(lamp.lid(), high_y));
    for i in 0..4 {
        let j = (i + 1) % 4;
        b.add_quad([low[j], low[i], high[i], high[j]], Vec2::ONE, p.coffer);
    }
    ceiling(b, lamp.lid(), high_y, p.ceiling);
}

/// Returns the corners of a horizontal rectangle, counter-clockwise seen from above.
fn corners([x0, x1, z0, z1]: [f64; 4], y: f64) -> [DVec3; 4] {
    [[x0, z1], [x1, z1], [x1, z0], [x0, z0]].map(|[x, z]| DVec3::new(x, y, z))
}

fn roof(b: &mut SceneBuilder, p: &Palette) {
    let (area, top) = ([0.0, 34.0, 0.0, 24.0], WALL_TOP_M + 0.15);
    floor(b, area, top, p.outside);
    let (low, high) = (corners(area, WALL_TOP_M), corners(area, top));
    for i in 0..4 {
        let j = (i + 1) % 4;
        b.add_quad([low[i], low[j], high[j], high[i]], Vec2::ONE, p.outside);
    }
}
