//! Simple shapes for small scenes made in code, such as those of tests and stability cases.

use super::{MaterialId, SceneBuilder};
use glam::{DVec3, Vec2, Vec3};
use std::f64::consts::{PI, TAU};

/// Adds a parallelogram given by a corner and the two edges from it. `u`, `v` and the front form a
/// right-handed system.
pub fn quad(b: &mut SceneBuilder, corner: DVec3, u: DVec3, v: DVec3, material: MaterialId) {
    b.add_quad([corner, corner + u, corner + u + v, corner + v], Vec2::ONE, material);
}

/// Adds a closed box from its lower to its upper corner. Its faces point outwards, or inwards if
/// `inside_out` is true.
pub fn cuboid(b: &mut SceneBuilder, [low, high]: [DVec3; 2], material: MaterialId, inside_out: bool) {
    let d = high - low;
    let (x, y, z) = (DVec3::X * d.x, DVec3::Y * d.y, DVec3::Z * d.z);
    let faces = [(low, y, x), (low, z, y), (low, x, z), (high, -x, -y), (high, -y, -z), (high, -z, -x)];
    for (corner, u, v) in faces {
        if inside_out { quad(b, corner, v, u, material) } else { quad(b, corner, u, v, material) }
    }
}

/// Adds a closed sphere of `rings` rings of `rings` quadrilaterals each, with smooth or flat
/// normals.
pub fn sphere(
    b: &mut SceneBuilder,
    centre: DVec3,
    radius: f64,
    rings: u32,
    is_smooth: bool,
    material: MaterialId,
) {
    let direction = |i: u32, j: u32| {
        let (theta, phi) =
            (PI * f64::from(i) / f64::from(rings), TAU * f64::from(j % rings) / f64::from(rings));
        // Each pole must be a single point, or the sphere would not be closed.
        let sin = if i == 0 || i == rings { 0.0 } else { theta.sin() };
        DVec3::new(sin * phi.cos(), theta.cos(), sin * phi.sin())
    };
    let vertex = |b: &mut SceneBuilder, i, j| {
        let d = direction(i, j);
        b.add_vertex(centre + d * radius, if is_smooth { d.as_vec3() } else { Vec3::ZERO }, Vec2::ZERO)
    };
    for i in 0..rings {
        for j in 0..rings {
            let [a, right, down, far] =
                [[i, j], [i, j + 1], [i + 1, j], [i + 1, j + 1]].map(|[i, j]| vertex(b, i, j));
            if i > 0 {
                b.add_triangle([a, right, down], material);
            }
            if i + 1 < rings {
                b.add_triangle([down, right, far], material);
            }
        }
    }
}
