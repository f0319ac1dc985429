//! The light sources of a scene.

use super::Sun;
use crate::math::sampling::uniform_triangle;
use glam::Vec3;

/// A light source in scene space. Colours are linear Rec. 709.
#[derive(Clone, Debug, PartialEq)]
pub enum Light {
    /// A parallelogram that emits from both sides.
    Quad {
        /// Position of one corner.
        corner: Vec3,
        /// Edge from the corner to one of its neighbours.
        edge_u: Vec3,
        /// Edge from the corner to its other neighbour.
        edge_v: Vec3,
        /// Emitted radiance.
        radiance: Vec3,
    },
    /// A connected emissive mesh that emits from both sides.
    Triangles {
        /// Corners of each triangle.
        corners: Vec<[Vec3; 3]>,
        /// For each triangle, the share of the area in it and all triangles before it; the last is
        /// 1.
        cumulative_area: Vec<f32>,
        /// Total area in square scene units.
        area: f32,
        /// Emitted radiance.
        radiance: Vec3,
    },
    /// A point light.
    Point {
        /// Position.
        position: Vec3,
        /// Radiant intensity, in radiance times square scene units.
        intensity: Vec3,
    },
    /// The sun, a disk at infinity.
    Sun {
        /// Unit direction towards the centre of the disk.
        direction: Vec3,
        /// Cosine of the angular radius.
        cos_angular_radius: f32,
        /// Irradiance on a surface that faces the sun.
        irradiance: Vec3,
    },
    /// The sky of the scene, without [`Light::SkySuns`].
    Sky,
    /// The brightest parts of a sky picture, sampled by their light.
    SkySuns,
}

impl From<Sun> for Light {
    fn from(sun: Sun) -> Self {
        let Sun { direction, angular_radius, irradiance } = sun;
        Self::Sun { direction, cos_angular_radius: angular_radius.cos(), irradiance }
    }
}

/// Maps a point `u` of the unit square to a point of a mesh, uniformly by area. Returns the point
/// and the index of its triangle. `cumulative_area` is that of [`Light::Triangles`].
pub(crate) fn point_on_mesh(corners: &[[Vec3; 3]], cumulative_area: &[f32], u: [f32; 2]) -> (Vec3, usize) {
    let chosen = cumulative_area.partition_point(|&c| c <= u[0]).min(corners.len() - 1);
    let below = if chosen == 0 { 0.0 } else { cumulative_area[chosen - 1] };
    let within = ((u[0] - below) / (cumulative_area[chosen] - below)).clamp(0.0, 1.0);
    let [a, b, c] = corners[chosen];
    let [b1, b2] = uniform_triangle([within, u[1]]);
    (a + (b - a) * b1 + (c - a) * b2, chosen)
}
