//! Questions about the model in metres: what stands in a direction, and how far. For walking, measuring and plans.

use super::{Hit, Tracer};
use crate::math::Ray;
use crate::scene::MaterialId;
use glam::{DVec3, Vec3};

/// A surface found in a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probe {
    /// From where it was asked, metres.
    pub distance_m: f64,
    /// On the surface, world metres.
    pub position_m: DVec3,
    /// Unit normal of the triangle, on the side of who asks.
    pub normal: Vec3,
    /// Index into the scene's triangles.
    pub triangle: u32,
    /// Of the triangle.
    pub material: MaterialId,
    /// True where the side is seen from which the corners run counter-clockwise: the outside of a closed body.
    pub is_front: bool,
}

impl Tracer {
    /// The nearest surface from a place in a direction (any length), not further than `reach_m` metres.
    pub fn probe(&self, origin_m: DVec3, direction: DVec3, reach_m: f64) -> Option<Probe> {
        self.probe_where(origin_m, direction, reach_m, |_| true)
    }

    /// The same past all triangles that `stops` says no to.
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
        let hit = self.bvh().closest(&ray, |hit| stops(hit.triangle) && self.stands(&ray, hit))?;
        Some(self.probe_of(&ray, &hit))
    }

    fn probe_of(&self, ray: &Ray, hit: &Hit) -> Probe {
        let point = self.surface(ray, hit);
        let frame = &self.scene().frame;
        Probe {
            distance_m: f64::from(hit.t) / frame.units_per_metre,
            position_m: frame.world_from_scene(point.position),
            normal: point.geometric_normal,
            triangle: hit.triangle,
            material: point.material,
            is_front: point.is_front,
        }
    }
}
