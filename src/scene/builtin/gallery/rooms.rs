//! The shell of the building: walls, floors, ceilings with beams, columns, roof, and the platform
//! of the garden room.

use super::lantern::OPENING;
use super::palette::Palette;
use super::plan::{BASE_M, BUILDING, GAPS, RoomName, WALL_TOP_M};
use crate::scene::SceneBuilder;
use crate::scene::builtin::parts::{Platform, Shell, cells_outside, column, railing, stairs_up, walls};
use crate::scene::builtin::shapes::{Faces, Local, block, ceiling, floor};
use glam::{DVec3, Vec2};

/// World x of each row of columns.
const ROWS_X: [f64; 2] = [13.5, 20.5];
/// World z of each column in a row.
const COLUMNS_Z: [f64; 4] = [10.7, 14.5, 18.3, 22.1];
const ARCHITRAVE_HALF_M: f64 = 0.48;
/// How far the architraves hang below the ceiling of the hall.
const ARCHITRAVE_DROP_M: f64 = 0.2;
/// How far ceilings reach into the walls, so that no light passes along a seam.
const INTO_WALL_M: f64 = 0.02;
/// The platform of the garden room.
pub(super) const PLATFORM: Platform = Platform { height_m: 0.6, edge_z: 17.4 };
const STAIRS_X: [f64; 2] = [27.8, 30.2];

pub(super) fn add_to(b: &mut SceneBuilder, p: &Palette) {
    let shell = Shell {
        rooms: p.walls,
        outside: p.outside,
        reveal: p.trim,
        height: [BASE_M, WALL_TOP_M],
        gaps: &GAPS,
    };
    walls(b, &shell);
    for (i, name) in RoomName::ALL.into_iter().enumerate() {
        floor(b, name.room().area, 0.0, p.floors[i]);
        ceiling_of(b, p, name);
    }
    ceiling(b, BUILDING, BASE_M, p.outside);
    roof(b, p);
    columns(b, p);
    beams(b, p);
    platform(b, p);
}

fn ceiling_of(b: &mut SceneBuilder, p: &Palette, name: RoomName) {
    let room = name.room();
    let [x0, x1, z0, z1] = room.area;
    let area = [x0 - INTO_WALL_M, x1 + INTO_WALL_M, z0 - INTO_WALL_M, z1 + INTO_WALL_M];
    let holes: &[[f64; 4]] = if name == RoomName::Hall { &[OPENING] } else { &[] };
    for cell in cells_outside(area, holes) {
        ceiling(b, cell, room.ceiling, p.ceiling);
    }
}

/// Adds the roof around the lantern, and the edge of the roof.
fn roof(b: &mut SceneBuilder, p: &Palette) {
    let top = WALL_TOP_M + 0.15;
    for cell in cells_outside(BUILDING, &[OPENING]) {
        floor(b, cell, top, p.outside);
    }
    let [x0, x1, z0, z1] = BUILDING;
    let corners = [[x0, z1], [x1, z1], [x1, z0], [x0, z0]];
    for (i, [x, z]) in corners.into_iter().enumerate() {
        let [to_x, to_z] = corners[(i + 1) % 4];
        let at = |x, y, z| DVec3::new(x, y, z);
        let quad = [at(x, WALL_TOP_M, z), at(to_x, WALL_TOP_M, to_z), at(to_x, top, to_z), at(x, top, z)];
        b.add_quad(quad, Vec2::ONE, p.outside);
    }
}

/// Adds the columns of the hall, and the architraves that they carry.
fn columns(b: &mut SceneBuilder, p: &Palette) {
    let room = RoomName::Hall.room();
    let top = room.ceiling - ARCHITRAVE_DROP_M;
    let [_, _, z0, z1] = room.area;
    let sides = Faces::ALL.without(Faces::TOP).without(Faces::BACK);
    for x in ROWS_X {
        for z in COLUMNS_Z {
            column(b, &p.parts, &Local::at(DVec3::new(x, 0.0, z)), top);
        }
        let low = DVec3::new(x - ARCHITRAVE_HALF_M, top, z0);
        let high = DVec3::new(x + ARCHITRAVE_HALF_M, room.ceiling, z1);
        block(b, &Local::WORLD, [low, high], sides, p.trim);
    }
}

/// Adds the beams below the ceilings of the long gallery and the salon.
fn beams(b: &mut SceneBuilder, p: &Palette) {
    let sides = Faces::ALL.without(Faces::TOP).without(Faces::LEFT).without(Faces::RIGHT);
    let long = RoomName::LongGallery.room();
    let [x0, x1, z0, z1] = long.area;
    for i in 1..7 {
        let z = z0 + (z1 - z0) * f64::from(i) / 7.0;
        let low = DVec3::new(x0, long.ceiling - 0.24, z - 0.11);
        block(b, &Local::WORLD, [low, DVec3::new(x1, long.ceiling, z + 0.11)], sides, p.beam);
    }
    let salon = RoomName::Salon.room();
    let [x0, x1, z0, z1] = salon.area;
    let sides = Faces::ALL.without(Faces::TOP).without(Faces::BACK);
    for i in 1..4 {
        let x = x0 + (x1 - x0) * f64::from(i) / 4.0;
        let low = DVec3::new(x - 0.14, salon.ceiling - 0.2, z0);
        block(b, &Local::WORLD, [low, DVec3::new(x + 0.14, salon.ceiling, z1)], sides, p.trim);
    }
}

fn platform(b: &mut SceneBuilder, p: &Palette) {
    let [x0, x1, _, z1] = RoomName::GardenRoom.room().area;
    let Platform { height_m, edge_z } = PLATFORM;
    floor(b, [x0, x1, edge_z, z1], height_m, p.floors[0]);
    let front = [[x1, 0.0], [x0, 0.0], [x0, height_m], [x1, height_m]];
    let size = Vec2::new((x1 - x0) as f32, height_m as f32);
    b.add_quad(front.map(|[x, y]| DVec3::new(x, y, edge_z)), size, p.parts.stone);
    stairs_up(b, &p.parts, PLATFORM, STAIRS_X);
    railing(b, &p.parts, PLATFORM, [x0 + 0.1, STAIRS_X[0] - 0.06]);
    railing(b, &p.parts, PLATFORM, [STAIRS_X[1] + 0.06, x1 - 0.1]);
}
