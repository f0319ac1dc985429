//! The lamps: rings, drums and long boxes that hang from the ceilings.
//!
//! The surface that emits light is flat, since every sample of it then reaches the room, and hangs
//! in a housing.

use super::palette::Palette;
use super::plan::RoomName;
use crate::scene::builtin::shapes::{Closing, Faces, Grid, Local, bar, block, lathe, on_circle};
use crate::scene::{Material, MaterialId, SceneBuilder};
use glam::{DVec3, Vec2, Vec3};
use std::f64::consts::TAU;

/// Colour of the lamps: a warm white.
const TINT: Vec3 = Vec3::new(1.0, 0.91, 0.78);
/// Odd, because the samples of a light are a power of two, and would else all lie at the same place
/// in their triangles.
const SEGMENTS: u32 = 63;
const CABLE_M: f64 = 0.006;
/// How far the emitting surface lies above the lower edge of its housing.
const RECESS_M: f64 = 0.012;

/// The shape of a lamp; lengths in metres.
#[derive(Clone, Copy, Debug)]
enum Shape {
    /// A ring that shines down, given by its inner and outer radius.
    Ring([f64; 2]),
    /// A disk in a shade that shines down, given by its radius.
    Drum(f64),
    /// A rectangle that shines down, given by its sides along x and z.
    Box([f64; 2]),
    /// A luminous part of the ceiling behind a grid of bars, given by the side of its square.
    Panel(f64),
}

/// One lamp.
struct Lamp {
    room: RoomName,
    shape: Shape,
    /// World x and z of the middle.
    middle: [f64; 2],
    /// Height of the lower edge of the housing in metres.
    height: f64,
    radiance: f32,
}

const fn lamp(room: RoomName, shape: Shape, middle: [f64; 2], height: f64, radiance: f32) -> Lamp {
    Lamp { room, shape, middle, height, radiance }
}

const LAMPS: [Lamp; 9] = [
    lamp(RoomName::Mirrors, Shape::Panel(4.2), [5.075, 4.575], 4.32, 4.6),
    lamp(RoomName::Salon, Shape::Ring([0.6, 1.0]), [13.575, 4.575], 3.3, 27.0),
    lamp(RoomName::Salon, Shape::Ring([0.6, 1.0]), [20.425, 4.575], 3.3, 27.0),
    lamp(RoomName::Treasury, Shape::Drum(0.95), [26.55, 4.575], 3.25, 16.0),
    lamp(RoomName::Treasury, Shape::Drum(0.95), [31.3, 4.575], 3.25, 16.0),
    lamp(RoomName::LongGallery, Shape::Box([3.0, 0.4]), [5.075, 12.25], 3.35, 28.0),
    lamp(RoomName::LongGallery, Shape::Box([3.0, 0.4]), [5.075, 16.4], 3.35, 28.0),
    lamp(RoomName::LongGallery, Shape::Box([3.0, 0.4]), [5.075, 20.55], 3.35, 28.0),
    lamp(RoomName::GardenRoom, Shape::Ring([0.6, 1.0]), [28.925, 13.3], 3.3, 20.0),
];

pub(super) fn add_to(b: &mut SceneBuilder, p: &Palette) {
    for lamp in &LAMPS {
        let frame = Local::at(DVec3::new(lamp.middle[0], lamp.height, lamp.middle[1]));
        let to_ceiling = lamp.room.room().ceiling - lamp.height;
        match lamp.shape {
            Shape::Ring(radii) => ring(b, p, &frame, radii, lamp.radiance, to_ceiling),
            Shape::Drum(radius) => drum(b, p, &frame, radius, lamp.radiance, to_ceiling),
            Shape::Box(sides) => long_box(b, p, &frame, sides, lamp.radiance, to_ceiling),
            Shape::Panel(side) => panel(b, p, &frame, side, lamp.radiance, to_ceiling),
        }
    }
}

fn emitter(b: &mut SceneBuilder, radiance: f32) -> MaterialId {
    b.add_material(Material::emissive("lamp", TINT * radiance))
}

fn ring(
    b: &mut SceneBuilder,
    p: &Palette,
    frame: &Local,
    [inner, outer]: [f64; 2],
    radiance: f32,
    to_ceiling: f64,
) {
    const HEIGHT_M: f64 = 0.09;
    let light = emitter(b, radiance);
    annulus(b, frame, [inner, outer], RECESS_M, light);
    annulus(b, frame, [inner, outer], HEIGHT_M, p.brass);
    lathe(b, frame, &[[outer, 0.0], [outer, HEIGHT_M]], SEGMENTS, p.brass);
    lathe(b, frame, &[[inner, HEIGHT_M], [inner, 0.0]], SEGMENTS, p.brass);
    let middle = f64::midpoint(inner, outer);
    for i in 0..3 {
        let foot = frame.point(on_circle(f64::from(i) / 3.0, middle, HEIGHT_M));
        let top = frame.point(on_circle(f64::from(i) / 3.0, 0.05, to_ceiling - 0.03));
        bar(b, [foot, top], CABLE_M, 6, p.parts.iron);
    }
    canopy(b, p, frame, to_ceiling);
}

fn drum(b: &mut SceneBuilder, p: &Palette, frame: &Local, radius: f64, radiance: f32, to_ceiling: f64) {
    const HEIGHT_M: f64 = 0.42;
    let light = emitter(b, radiance);
    disk(b, &frame.moved(DVec3::Y * RECESS_M), radius, light);
    lathe(b, frame, &[[radius, 0.0], [radius, HEIGHT_M]], SEGMENTS, p.shade);
    for y in [0.0, HEIGHT_M] {
        hoop(b, p, frame, radius, y);
    }
    disk(b, &frame.moved(DVec3::Y * (HEIGHT_M - 0.02)), radius, p.shade);
    let cable = [HEIGHT_M - 0.02, to_ceiling - 0.03].map(|y| frame.point(DVec3::Y * y));
    bar(b, cable, CABLE_M, 6, p.parts.iron);
    canopy(b, p, frame, to_ceiling);
}

/// Adds a thin rim of brass to a shade.
fn hoop(b: &mut SceneBuilder, p: &Palette, frame: &Local, radius: f64, y: f64) {
    let grid = Grid { nu: SEGMENTS, nv: 6, u: Closing::Around, v: Closing::Around };
    grid.add_to(b, frame, p.brass, |u, v| {
        let (sin, cos) = (v * TAU).sin_cos();
        on_circle(u, radius + 0.008 * cos, y + 0.008 * sin)
    });
}

fn long_box(
    b: &mut SceneBuilder,
    p: &Palette,
    frame: &Local,
    [x, z]: [f64; 2],
    radiance: f32,
    to_ceiling: f64,
) {
    const HEIGHT_M: f64 = 0.07;
    const RIM_M: f64 = 0.01;
    let light = emitter(b, radiance);
    let (x, z) = (x / 2.0, z / 2.0);
    let corners = [[-x, -z], [x, -z], [x, z], [-x, z]].map(|[x, z]| frame.point(DVec3::new(x, RECESS_M, z)));
    b.add_quad(corners, Vec2::ONE, light);
    let mut housing = |low: [f64; 3], high: [f64; 3]| {
        block(b, frame, [DVec3::from(low), DVec3::from(high)], Faces::ALL, p.parts.black);
    };
    let (wide, deep) = (x + RIM_M, z + RIM_M);
    housing([-wide, RECESS_M + 0.008, -deep], [wide, HEIGHT_M, deep]);
    housing([-wide, 0.0, -deep], [-x, RECESS_M + 0.008, deep]);
    housing([x, 0.0, -deep], [wide, RECESS_M + 0.008, deep]);
    housing([-x, 0.0, -deep], [x, RECESS_M + 0.008, -z]);
    housing([-x, 0.0, z], [x, RECESS_M + 0.008, deep]);
    for at in [-0.8 * x, 0.8 * x] {
        let ends = [HEIGHT_M, to_ceiling].map(|y| frame.point(DVec3::new(at, y, 0.0)));
        bar(b, ends, CABLE_M, 6, p.parts.iron);
    }
}

fn panel(b: &mut SceneBuilder, p: &Palette, frame: &Local, side: f64, radiance: f32, to_ceiling: f64) {
    const FIELDS: u32 = 3;
    const FRAME_M: f64 = 0.09;
    const BAR_M: f64 = 0.02;
    let light = emitter(b, radiance);
    let half = side / 2.0;
    let corners = [[-half, -half], [half, -half], [half, half], [-half, half]];
    let glow = corners.map(|[x, z]| frame.point(DVec3::new(x, to_ceiling - 0.02, z)));
    b.add_quad(glow, Vec2::ONE, light);
    // All bars reach above the luminous surface; those across end at those along.
    let mut bar = |low: [f64; 2], high: [f64; 2], y: f64| {
        let corners = [DVec3::new(low[0], y, low[1]), DVec3::new(high[0], to_ceiling, high[1])];
        block(b, frame, corners, Faces::ALL.without(Faces::TOP), p.brass);
    };
    let outer = half + FRAME_M;
    for sign in [-1.0, 1.0] {
        let [near, far] = if sign < 0.0 { [-outer, -half] } else { [half, outer] };
        bar([near, -outer], [far, outer], 0.0);
        bar([-half, near], [half, far], 0.0);
    }
    for i in 1..FIELDS {
        let at = side * (f64::from(i) / f64::from(FIELDS) - 0.5);
        bar([at - BAR_M, -half], [at + BAR_M, half], 0.02);
        bar([-half, at - BAR_M], [half, at + BAR_M], 0.025);
    }
}

/// Adds the cover of the hook in the ceiling.
fn canopy(b: &mut SceneBuilder, p: &Palette, frame: &Local, to_ceiling: f64) {
    let profile =
        [[0.001, -0.045], [0.05, -0.04], [0.075, -0.02], [0.08, 0.0]].map(|[r, y]| [r, to_ceiling + y]);
    lathe(b, frame, &profile, 24, p.brass);
}

/// Adds a flat ring at height `y` of a frame.
fn annulus(b: &mut SceneBuilder, frame: &Local, [inner, outer]: [f64; 2], y: f64, material: MaterialId) {
    Grid { nu: SEGMENTS, nv: 1, u: Closing::Around, v: Closing::Open }
        .add_to(b, frame, material, |u, v| on_circle(u, outer + (inner - outer) * v, y));
}

/// Adds a horizontal disk that faces down.
fn disk(b: &mut SceneBuilder, frame: &Local, radius: f64, material: MaterialId) {
    let down = Vec3::NEG_Y;
    let middle = b.add_vertex(frame.origin, down, Vec2::ZERO);
    let share = |i: u32| f64::from(i) / f64::from(SEGMENTS);
    let rim: Vec<u32> = (0..SEGMENTS)
        .map(|i| b.add_vertex(frame.point(on_circle(share(i), radius, 0.0)), down, Vec2::ZERO))
        .collect();
    for i in 0..rim.len() {
        b.add_triangle([middle, rim[(i + 1) % rim.len()], rim[i]], material);
    }
}
