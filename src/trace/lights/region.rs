//! A cell of the grid of lights with its surroundings, the lines drawn from it, and bounds on the
//! light that it can receive.

use super::sample::point_on;
use crate::math::{Ray, key::Key};
use crate::scene::{Light, Scene};
use crate::trace::Bvh;
use glam::Vec3;

/// A cell, enlarged by half a cell on each side.
pub(super) struct Region {
    pub(super) low: Vec3,
    pub(super) size: f32,
    /// Key of the random numbers of its lines.
    pub(super) key: Key,
}

impl Region {
    pub(super) fn centre(&self) -> Vec3 {
        self.low + self.size / 2.0
    }

    /// Radius of a sphere around the region.
    pub(super) fn radius(&self) -> f32 {
        self.size / 2.0 * 3f32.sqrt()
    }

    /// True where a line from the region to a light, with the random numbers of `key`, meets
    /// nothing opaque.
    pub(super) fn reaches(&self, scene: &Scene, bvh: &Bvh, light: u32, key: Key) -> bool {
        let [x, y] = key.pair();
        let [z, _] = key.with(1).pair();
        let from = self.low + Vec3::new(x, y, z) * self.size;
        let Some(to) = point_on(&scene.lights[light as usize], key.with(2).pair()) else { return true };
        // Glass and cut-out texels let light through, so they hide no lamp for certain.
        !bvh.any(&Ray::segment(from, to), |hit| scene.material_of(hit.triangle).is_opaque())
    }
}

/// Returns a bound on the unshadowed irradiance (largest channel) that a light brings to a point
/// within `slack` of `at`.
pub(super) fn unshadowed(light: &Light, at: Vec3, slack: f32) -> f32 {
    let falloff = |centre: Vec3, radius: f32| {
        let nearest = (centre.distance(at) - radius - slack).max(0.0);
        1.0 / (nearest * nearest).max(f32::MIN_POSITIVE)
    };
    match light {
        Light::Quad { corner, edge_u, edge_v, radiance, .. } => {
            let (centre, radius) = (*corner + (*edge_u + *edge_v) / 2.0, (*edge_u + *edge_v).length() / 2.0);
            let solid_angle = edge_u.cross(*edge_v).length() * falloff(centre, radius);
            radiance.max_element() * solid_angle.min(std::f32::consts::PI)
        }
        Light::Triangles { corners, area, radiance, picture, .. } => {
            let points = || Light::outline(corners, picture).iter().flatten().copied();
            let (low, high) =
                points().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(l, h), p| (l.min(p), h.max(p)));
            let solid_angle = area * falloff((low + high) / 2.0, (high - low).length() / 2.0);
            // Near a bright part of a picture, its mean over the hemisphere is no bound.
            let most = if picture.is_some() { f32::MAX } else { std::f32::consts::PI };
            radiance.max_element() * solid_angle.min(most)
        }
        Light::Point { position, intensity, .. } => intensity.max_element() * falloff(*position, 0.0),
        Light::Sun { irradiance, .. } => irradiance.max_element(),
        Light::Sky | Light::SkySuns => 0.0,
    }
}
