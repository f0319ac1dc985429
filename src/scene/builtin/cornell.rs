//! The Cornell box as measured at Cornell in 1985, and a variant with two spheres.
//!
//! Source: <https://www.graphics.cornell.edu/online/box/data.html>. We differ: one unit of the data
//! is a centimetre, so that the box is large enough to walk in; the lamp hangs 1 cm below a ceiling
//! without a hole; and the box is turned so that the camera looks into it along -Z.

use super::shapes::{Local, icosphere};
use super::views::{view, walk};
use crate::scene::{Material, MaterialId, SceneBuilder};
use glam::{DVec3, Vec2, Vec3};

/// The objects in the box.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Contents {
    /// Two diffuse boxes.
    Boxes,
    /// A mirror sphere and a glass sphere.
    Spheres,
}

/// Converts a position of the data to world metres: half a turn about the vertical axis, with the
/// middle of the front edge of the floor at the origin.
fn world(p: [f64; 3]) -> DVec3 {
    DVec3::new(278.0 - p[0], p[1], -p[2]) / 100.0
}

pub(super) fn add_to(b: &mut SceneBuilder, contents: Contents) {
    let white = b.add_material(Material::diffuse("white", Vec3::new(0.73, 0.73, 0.73)));
    let red = b.add_material(Material::diffuse("red", Vec3::new(0.63, 0.065, 0.05)));
    let green = b.add_material(Material::diffuse("green", Vec3::new(0.14, 0.45, 0.091)));
    let lamp = b.add_material(Material::emissive("lamp", Vec3::new(17.0, 12.0, 4.0)));
    let mut quad = |corners: [[f64; 3]; 4], material| b.add_quad(corners.map(world), Vec2::ONE, material);
    quad([[552.8, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 559.2], [549.6, 0.0, 559.2]], white);
    quad([[556.0, 548.8, 0.0], [556.0, 548.8, 559.2], [0.0, 548.8, 559.2], [0.0, 548.8, 0.0]], white);
    quad([[549.6, 0.0, 559.2], [0.0, 0.0, 559.2], [0.0, 548.8, 559.2], [556.0, 548.8, 559.2]], white);
    quad([[0.0, 0.0, 559.2], [0.0, 0.0, 0.0], [0.0, 548.8, 0.0], [0.0, 548.8, 559.2]], green);
    quad([[552.8, 0.0, 0.0], [549.6, 0.0, 559.2], [556.0, 548.8, 559.2], [556.0, 548.8, 0.0]], red);
    quad([[343.0, 547.8, 227.0], [343.0, 547.8, 332.0], [213.0, 547.8, 332.0], [213.0, 547.8, 227.0]], lamp);
    match contents {
        Contents::Boxes => boxes(b, white),
        Contents::Spheres => spheres(b),
    }
    b.views = vec![
        view("start", [0.0, 2.73, 8.0], [0.0, 2.73, 0.0], 39.0),
        view("inside", [0.9, 2.4, 0.3], [-0.5, 1.3, -4.5], 60.0),
    ];
    let keys = [
        ([-1.6, 2.6, 3.2], [0.2, 2.2, -3.0]),
        ([-0.6, 2.3, 1.2], [0.2, 1.8, -3.0]),
        ([0.7, 2.1, 0.2], [0.0, 1.6, -3.0]),
        ([1.7, 2.0, -0.6], [-0.4, 1.4, -3.0]),
    ];
    b.walk = Some(walk(&keys, 120, 55.0));
}

/// Adds the short and the tall box, given by the four corners of the top and the height.
fn boxes(b: &mut SceneBuilder, white: MaterialId) {
    b.begin_object("short box");
    standing(b, [[130.0, 65.0], [82.0, 225.0], [240.0, 272.0], [290.0, 114.0]], 165.0, white);
    b.begin_object("tall box");
    standing(b, [[423.0, 247.0], [265.0, 296.0], [314.0, 456.0], [472.0, 406.0]], 330.0, white);
    b.end_object();
}

fn standing(b: &mut SceneBuilder, top: [[f64; 2]; 4], height: f64, material: MaterialId) {
    let at = |[x, z]: [f64; 2], y: f64| world([x, y, z]);
    b.add_quad(top.map(|p| at(p, height)), Vec2::ONE, material);
    for i in 0..4 {
        let (p, q) = (top[i], top[(i + 1) % 4]);
        b.add_quad([at(q, height), at(p, height), at(p, 0.0), at(q, 0.0)], Vec2::ONE, material);
    }
}

fn spheres(b: &mut SceneBuilder) {
    let mirror = b.add_material(Material::mirror("mirror", Vec3::splat(0.9)));
    let glass = b.add_material(Material::glass("glass", 1.5, Vec3::ONE));
    // 1 mm above the floor: a solid of glass must not share a plane with another surface.
    let at = |x, y, z| Local::at(world([x, y, z]));
    b.begin_object("mirror sphere");
    icosphere(b, &at(390.0, 100.1, 370.0), 4, mirror, |d| d);
    b.begin_object("glass sphere");
    icosphere(b, &at(170.0, 100.1, 190.0), 4, glass, |d| d);
    b.end_object();
}
