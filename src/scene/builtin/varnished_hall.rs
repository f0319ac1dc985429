//! A daylit hall with a varnished floor, lacquered furniture and columns of brushed brass, on which
//! reuse in rough scenes is measured. It never changes, so that builds can be compared.

use super::shapes::{Faces, Local, Opening, Wall, block, ceiling, floor, icosphere};
use super::views::{view, walk};
use crate::scene::{Gradient, Material, MaterialId, MaterialKind, SceneBuilder, Sky, Sun};
use glam::{DVec3, Vec2, Vec3};

const HALF_LENGTH_M: f64 = 10.0;
const HALF_WIDTH_M: f64 = 4.0;
const HEIGHT_M: f64 = 4.5;
const WALL_M: f64 = 0.3;

/// Left edges of the windows, along the wall, and their width.
const WINDOWS_M: [f64; 5] = [1.5, 5.1, 8.7, 12.3, 15.9];
const WINDOW_WIDTH_M: f64 = 2.4;

const SKY: Gradient = Gradient {
    zenith: Vec3::new(1.6, 2.1, 3.0),
    horizon: Vec3::new(2.8, 3.0, 3.2),
    ground: Vec3::new(0.5, 0.5, 0.42),
};

struct Materials {
    plaster: MaterialId,
    varnish: MaterialId,
    lacquer: MaterialId,
    brass: MaterialId,
    stone: MaterialId,
}

pub(super) fn add_to(b: &mut SceneBuilder) {
    let m = materials(b);
    room(b, &m);
    furniture(b, &m);
    b.sky = Some(Sky::Gradient(SKY));
    b.sun = Some(Sun {
        direction: DVec3::new(-0.35, 0.62, 0.7).normalize_or(DVec3::Y).as_vec3(),
        irradiance: Vec3::new(9.0, 8.0, 6.4),
        ..Sun::clear_day()
    });
    b.views = vec![
        view("start", [-9.0, 1.6, 1.6], [2.0, 1.2, -1.0], 60.0),
        view("windows", [7.5, 1.5, -2.8], [-1.0, 1.2, 2.5], 60.0),
    ];
    let keys = [
        ([-9.0, 1.6, 1.6], [2.0, 1.2, -1.0]),
        ([-3.5, 1.6, 2.4], [5.0, 1.0, -1.5]),
        ([2.5, 1.6, 2.2], [8.0, 1.0, -2.0]),
        ([7.5, 1.5, -2.8], [-1.0, 1.2, 2.5]),
    ];
    b.walk = Some(walk(&keys, 120, 60.0));
}

fn materials(b: &mut SceneBuilder) -> Materials {
    let coat = Vec3::splat(0.04);
    let mut glossy = |name: &str, base: Vec3, reflectance: Vec3, roughness: f32| {
        let kind = MaterialKind::Glossy { reflectance, roughness };
        b.add_material(Material { kind, ..Material::diffuse(name, base) })
    };
    Materials {
        varnish: glossy("varnished oak", Vec3::new(0.36, 0.22, 0.12), coat, 0.15),
        lacquer: glossy("black lacquer", Vec3::splat(0.03), coat, 0.1),
        brass: glossy("brushed brass", Vec3::ZERO, Vec3::new(0.89, 0.74, 0.42), 0.3),
        plaster: b.add_material(Material::diffuse("plaster", Vec3::new(0.76, 0.74, 0.7))),
        stone: b.add_material(Material::diffuse("stone", Vec3::new(0.5, 0.47, 0.42))),
    }
}

fn room(b: &mut SceneBuilder, m: &Materials) {
    let (l, w, h) = (HALF_LENGTH_M, HALF_WIDTH_M, HEIGHT_M);
    floor(b, [-l, l, -w, w], 0.0, m.varnish);
    ceiling(b, [-l, l, -w, w], h, m.plaster);
    let across = |x: f64, z: f64| [[x, 0.0, z], [x, 0.0, -z], [x, h, -z], [x, h, z]].map(DVec3::from);
    b.add_quad(across(-l, w), Vec2::ONE, m.plaster);
    b.add_quad(across(l, -w), Vec2::ONE, m.plaster);
    b.add_quad([[-l, 0.0, -w], [l, 0.0, -w], [l, h, -w], [-l, h, -w]].map(DVec3::from), Vec2::ONE, m.plaster);
    let opening = |x: f64| Opening { along: [x, x + WINDOW_WIDTH_M], height: [0.5, 3.8] };
    let windows = Wall {
        frame: Local::turned(DVec3::new(l, 0.0, w + WALL_M / 2.0), 180.0),
        length: 2.0 * l,
        height: [0.0, h],
        thickness: WALL_M,
        openings: WINDOWS_M.map(opening).into(),
        sides: [m.plaster, m.stone],
        reveal: m.plaster,
    };
    windows.add_to(b);
}

/// A long table with benches, columns, and stone balls on plinths.
fn furniture(b: &mut SceneBuilder, m: &Materials) {
    let stand = Faces::ALL.without(Faces::BOTTOM);
    let mut add = |[x, y, z]: [f64; 3], size: [f64; 3], material| {
        let half = DVec3::new(size[0] / 2.0, 0.0, size[2] / 2.0);
        let corners = [-half, half + DVec3::Y * size[1]];
        let faces = if y > 0.0 { Faces::ALL } else { stand };
        block(b, &Local::at(DVec3::new(x, y, z)), corners, faces, material);
    };
    add([1.0, 0.72, -0.6], [5.0, 0.06, 1.1], m.lacquer);
    for x in [-1.2, 3.2] {
        add([x, 0.0, -0.6], [0.12, 0.72, 0.9], m.brass);
    }
    for z in [-1.6, 0.4] {
        add([1.0, 0.0, z], [4.2, 0.44, 0.4], m.lacquer);
    }
    for x in [-6.0, -2.0, 2.0, 6.0] {
        add([x, 0.0, -3.4], [0.35, HEIGHT_M, 0.35], m.brass);
    }
    for x in [-4.0, 0.0, 4.0, 8.0] {
        add([x, 0.0, -3.2], [0.5, 0.9, 0.5], m.stone);
    }
    for x in [-4.0, 0.0, 4.0, 8.0] {
        icosphere(b, &Local::at(DVec3::new(x, 1.2, -3.2)), 4, m.stone, |d| d * 0.3);
    }
}
