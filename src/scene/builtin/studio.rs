//! A studio of rough surfaces: a varnished floor, metal from polished to matte, and frosted panes
//! with lamps behind them.

use super::shapes::{Faces, Local, block, ceiling, floor, icosphere};
use super::views::{view, walk};
use crate::scene::{Material, MaterialId, MaterialKind, SceneBuilder};
use glam::{DVec3, Vec2, Vec3};

const HALF_WIDTH_M: f64 = 4.0;
const HALF_LENGTH_M: f64 = 4.0;
const HEIGHT_M: f64 = 3.0;

/// Roughness of the balls, of the panes, and of the floor: satin varnish.
const BALLS: [f32; 6] = [0.0, 0.1, 0.2, 0.35, 0.5, 0.8];
const PANES: [f32; 3] = [0.0, 0.2, 0.45];
const VARNISH: f32 = 0.2;

pub(super) fn add_to(b: &mut SceneBuilder) {
    room(b);
    balls(b);
    behind_panes(b);
    b.views = vec![
        view("start", [-0.6, 1.5, 3.4], [0.2, 0.7, -2.0], 58.0),
        view("panes", [2.6, 1.3, 2.2], [2.7, 0.9, -1.6], 50.0),
        view("floor", [-3.0, 0.5, 3.2], [0.5, 0.1, -2.0], 50.0),
    ];
    let keys = [
        ([-2.4, 1.5, 3.2], [-1.2, 0.5, -1.5]),
        ([-0.6, 1.5, 2.4], [0.2, 0.6, -1.5]),
        ([1.2, 1.4, 1.6], [1.8, 0.8, -1.6]),
        ([2.6, 1.4, 2.0], [2.7, 0.9, -1.6]),
    ];
    b.walk = Some(walk(&keys, 120, 58.0));
}

fn glossy(name: &str, base: Vec3, reflectance: Vec3, roughness: f32) -> Material {
    let kind = MaterialKind::Glossy { reflectance, roughness };
    Material { kind, ..Material::diffuse(name, base) }
}

fn room(b: &mut SceneBuilder) {
    let (w, l, h) = (HALF_WIDTH_M, HALF_LENGTH_M, HEIGHT_M);
    let varnished = glossy("varnished floor", Vec3::new(0.32, 0.19, 0.1), Vec3::splat(0.04), VARNISH);
    let ground = b.add_material(varnished);
    let white = b.add_material(Material::diffuse("white", Vec3::splat(0.72)));
    let red = b.add_material(Material::diffuse("red wall", Vec3::new(0.6, 0.12, 0.08)));
    let lamp = b.add_material(Material::emissive("lamp", Vec3::splat(14.0)));
    floor(b, [-w, w, -l, l], 0.0, ground);
    ceiling(b, [-w, w, -l, l], h, white);
    ceiling(b, [-1.2, 1.2, -1.0, 0.4], h - 0.05, lamp);
    let side = |x: f64, z: f64| [[x, 0.0, z], [x, 0.0, -z], [x, h, -z], [x, h, z]].map(DVec3::from);
    let across = |x: f64, z: f64| [[-x, 0.0, z], [x, 0.0, z], [x, h, z], [-x, h, z]].map(DVec3::from);
    b.add_quad(side(-w, l), Vec2::ONE, red);
    b.add_quad(side(w, -l), Vec2::ONE, white);
    b.add_quad(across(w, -l), Vec2::ONE, white);
    b.add_quad(across(-w, l), Vec2::ONE, white);
}

/// A row of brushed metal, and a plate behind it.
fn balls(b: &mut SceneBuilder) {
    let gold = Vec3::new(0.95, 0.75, 0.42);
    for (i, roughness) in (0u8..).zip(BALLS) {
        let metal = b.add_material(glossy(&format!("metal {roughness}"), Vec3::ZERO, gold, roughness));
        let at = Local::at(DVec3::new(-3.1 + 0.82 * f64::from(i), 0.36, -1.4));
        icosphere(b, &at, 5, metal, |d| d * 0.36);
    }
    let plate = b.add_material(glossy("brushed steel", Vec3::ZERO, Vec3::splat(0.6), 0.3));
    let stand = Faces::ALL.without(Faces::BOTTOM);
    let corners = [DVec3::new(-1.6, 0.0, -0.05), DVec3::new(1.6, 1.6, 0.05)];
    block(b, &Local::at(DVec3::new(-1.2, 0.0, -2.9)), corners, stand, plate);
}

fn behind_panes(b: &mut SceneBuilder) {
    let blue = b.add_material(Material::diffuse("blue", Vec3::new(0.1, 0.2, 0.55)));
    let yellow = b.add_material(Material::diffuse("yellow", Vec3::new(0.7, 0.5, 0.1)));
    let bulb = b.add_material(Material::emissive("bulb", Vec3::new(12.0, 9.0, 5.0)));
    for (i, roughness) in (0u8..).zip(PANES) {
        let kind = MaterialKind::Frosted { eta: 1.5, transmittance: Vec3::splat(0.95), roughness };
        let pane = Material { kind, ..Material::diffuse(&format!("pane {roughness}"), Vec3::ZERO) };
        let (pane, x) = (b.add_material(pane), 1.75 + 0.7 * f64::from(i));
        let corners = [[x, 0.0, -1.2], [x + 0.66, 0.0, -1.2], [x + 0.66, 2.0, -1.2], [x, 2.0, -1.2]];
        b.add_quad(corners.map(DVec3::from), Vec2::ONE, pane);
        let color = if i % 2 == 0 { blue } else { yellow };
        pillar(b, x + 0.2, color);
        icosphere(b, &Local::at(DVec3::new(x + 0.33, 1.5, -1.7)), 3, bulb, |d| d * 0.12);
    }
}

fn pillar(b: &mut SceneBuilder, x: f64, material: MaterialId) {
    let corners = [DVec3::new(0.0, 0.0, -0.15), DVec3::new(0.3, 1.1, 0.15)];
    block(b, &Local::at(DVec3::new(x, 0.0, -1.7)), corners, Faces::ALL.without(Faces::BOTTOM), material);
}
