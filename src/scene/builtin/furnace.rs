//! The furnace test: a closed room whose radiance has a closed form.
//!
//! Every wall emits `Le = 1` and reflects the share `rho = 0.5` of the light. The room is closed
//! and all walls are equal, so each point receives the same radiance from all directions. With `n`
//! diffuse bounces every pixel is `Le * (1 + rho + rho^2 + ... + rho^n) = 2 - 2^-n`, which tends to
//! `Le / (1 - rho) = 2`. Light of the walls that is reflected once counts as the first bounce.

use super::views::{view, walk};
use crate::scene::{Material, SceneBuilder};
use glam::{DVec2, DVec3, Vec2, Vec3};

const HALF_M: f64 = 2.0;

pub(super) fn add_to(b: &mut SceneBuilder) {
    let wall = Material { emission: Vec3::ONE, ..Material::diffuse("glowing wall", Vec3::splat(0.5)) };
    let wall = b.add_material(wall);
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            // The winding is counter-clockwise seen from the middle, so it depends on the side.
            let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]]
                .map(|[s, t]| on_wall(axis, sign, DVec2::new(-s * sign, t)));
            b.add_quad(corners, Vec2::ONE, wall);
        }
    }
    b.views =
        vec![view("start", [0.0; 3], [0.0, 0.0, -1.0], 60.0), view("corner", [1.0; 3], [-1.0; 3], 60.0)];
    let square = [[0.8, 0.0, 0.8], [0.8, 0.0, -0.8], [-0.8, 0.4, -0.8], [-0.8, 0.0, 0.8], [0.8, 0.0, 0.8]];
    b.walk = Some(walk(&square.map(|eye| (eye, [0.0, 0.1, 0.0])), 60, 60.0));
}

fn on_wall(axis: usize, sign: f64, across: DVec2) -> DVec3 {
    let mut p = DVec3::ZERO;
    p[axis] = sign * HALF_M;
    p[(axis + 1) % 3] = across.x * HALF_M;
    p[(axis + 2) % 3] = across.y * HALF_M;
    p
}
