//! Rays that measure the model, in world metres: for walking, measuring and plans.

use super::Tracer;
use crate::math::Ray;
use crate::scene::MaterialId;
use glam::{DVec3, Vec3};

/// The nearest surface in a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probe {
    /// Distance from the ray's origin, metres.
    pub distance_m: f64,
    /// Point on the surface, world metres.
    pub position_m: DVec3,
    /// Unit normal of the triangle, on the side of the ray's origin.
    pub normal: Vec3,
    /// Index into the scene's triangles.
    pub triangle: u32,
    /// Material of the triangle.
    pub material: MaterialId,
    /// True where the ray meets the side from which the corners run counter-clockwise: the outside
    /// of a closed solid.
    pub is_front: bool,
}

impl Tracer {
    /// Returns the nearest surface from a point (world metres) in a direction (any length), within
    /// `reach_m` metres. Behind a section, it is one of the kept part, and caps are none.
    pub fn probe(&self, origin_m: DVec3, direction: DVec3, reach_m: f64) -> Option<Probe> {
        self.probe_where(origin_m, direction, reach_m, |_| true)
    }

    /// [`Self::probe`] for the triangles for which `stops` holds.
    pub fn probe_where(
        &self,
        origin_m: DVec3,
        direction: DVec3,
        reach_m: f64,
        stops: impl Fn(u32) -> bool,
    ) -> Option<Probe> {
        let frame = &self.scene().frame;
        let direction = direction.try_normalize()?.as_vec3();
        let origin = frame.scene_from_world_f64(origin_m).as_vec3();
        let ray = Ray { origin, direction, t_max: (reach_m * frame.units_per_metre) as f32 };
        let ray = self.clipped(ray)?;
        let hit = self
            .bvh()
            .closest(&ray, |hit| stops(hit.triangle) && self.is_kept(&ray, hit) && self.stands(&ray, hit))?;
        let point = self.surface(&ray, &hit);
        Some(Probe {
            distance_m: f64::from(hit.t) / frame.units_per_metre,
            position_m: frame.world_from_scene(point.position),
            normal: point.geometric_normal,
            triangle: hit.triangle,
            material: point.material,
            is_front: point.is_front,
        })
    }
}
