//! Two parallel mirrors that face each other, 4 m apart: an endless corridor of reflections.
//!
//! After `n` reflections the throughput of a ray is `0.8^n`.

use super::shapes::{Faces, Local, block, ceiling, floor, icosphere};
use super::views::{view, walk};
use crate::scene::{Material, MaterialId, SceneBuilder};
use glam::{DVec3, Vec2, Vec3};

const HALF_WIDTH_M: f64 = 2.0;
const HALF_LENGTH_M: f64 = 3.0;
const HEIGHT_M: f64 = 3.0;
const REFLECTANCE: f32 = 0.8;

pub(super) fn add_to(b: &mut SceneBuilder) {
    let matte = |b: &mut SceneBuilder, name: &str, r, g, blue| {
        b.add_material(Material::diffuse(name, Vec3::new(r, g, blue)))
    };
    let mirror = b.add_material(Material::mirror("mirror", Vec3::splat(REFLECTANCE)));
    let ground = matte(b, "floor", 0.55, 0.5, 0.45);
    let white = matte(b, "white", 0.75, 0.75, 0.72);
    let end = matte(b, "end wall", 0.3, 0.42, 0.5);
    let (w, l, h) = (HALF_WIDTH_M, HALF_LENGTH_M, HEIGHT_M);
    let side = |x: f64, z: f64| [[x, 0.0, z], [x, 0.0, -z], [x, h, -z], [x, h, z]].map(DVec3::from);
    let across = |x: f64, z: f64| [[-x, 0.0, z], [x, 0.0, z], [x, h, z], [-x, h, z]].map(DVec3::from);
    b.add_quad(side(-w, l), Vec2::ONE, mirror);
    b.add_quad(side(w, -l), Vec2::ONE, mirror);
    b.add_quad(across(w, -l), Vec2::ONE, end);
    b.add_quad(across(-w, l), Vec2::ONE, end);
    floor(b, [-w, w, -l, l], 0.0, ground);
    ceiling(b, [-w, w, -l, l], h, white);
    let lamp = b.add_material(Material::emissive("lamp", Vec3::splat(12.0)));
    ceiling(b, [-0.6, 0.6, -0.6, 0.6], h - 0.05, lamp);
    let colours = [
        matte(b, "red", 0.65, 0.1, 0.08),
        matte(b, "yellow", 0.7, 0.5, 0.1),
        matte(b, "green", 0.12, 0.45, 0.2),
    ];
    objects(b, colours);
    b.views = vec![
        view("start", [0.9, 1.6, 2.3], [-2.0, 1.2, -1.2], 60.0),
        view("endless", [0.0, 1.6, 0.6], [-2.0, 1.5, 0.5], 60.0),
    ];
    let keys = [
        ([0.9, 1.6, 2.3], [-2.0, 1.2, -1.2]),
        ([0.9, 1.6, -0.6], [-2.0, 1.3, -1.2]),
        ([0.9, 1.6, -0.6], [2.0, 1.3, 0.6]),
        ([0.0, 1.6, 1.6], [2.0, 1.3, 0.2]),
    ];
    b.walk = Some(walk(&keys, 120, 60.0));
}

fn objects(b: &mut SceneBuilder, [red, yellow, green]: [MaterialId; 3]) {
    let stand = Faces::ALL.without(Faces::BOTTOM);
    let crate_frame = Local::turned(DVec3::new(-0.7, 0.0, -0.9), 25.0);
    block(b, &crate_frame, [DVec3::new(-0.3, 0.0, -0.3), DVec3::new(0.3, 0.8, 0.3)], stand, red);
    let slab_frame = Local::turned(DVec3::new(0.5, 0.0, -1.9), -15.0);
    block(b, &slab_frame, [DVec3::new(-0.2, 0.0, -0.2), DVec3::new(0.2, 1.4, 0.2)], stand, yellow);
    let ball = Local::at(DVec3::new(-0.9, 0.35, 0.5));
    icosphere(b, &ball, 4, green, |d| d * 0.35);
}
