//! The shell of the building: walls, floors, ceilings with splayed coffers, and roof.

use super::lights::{LAMPS, Lamp};
use super::palette::Palette;
use super::plan::{BASE_M, DOORS, RoomName, WALL_TOP_M};
use crate::scene::SceneBuilder;
use crate::scene::builtin::parts::{Shell, cells_outside, walls};
use crate::scene::builtin::shapes::{ceiling, floor};
use glam::{DVec3, Vec2};

pub(super) fn add_to(b: &mut SceneBuilder, p: &Palette) {
    walls(
        b,
        &Shell {
            rooms: [p.white, p.red, p.blue, p.sand, p.white, p.green],
            outside: p.outside,
            reveal: p.reveal,
            height: [BASE_M, WALL_TOP_M],
            gaps: &DOORS,
        },
    );
    floors(b, p);
    for name in RoomName::ALL {
        ceiling_of(b, p, name);
    }
    roof(b, p);
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
