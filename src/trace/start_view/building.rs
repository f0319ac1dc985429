//! Rays that meet the building alone. From inside, it stands on a floor at its lowest point.
//!
//! The floor stands for the ground of a model whose rooms have no floor of their own; so a ground
//! plane can come and go, and one that was added is not met at all. Other things outside the box of
//! the building only hide it.

use crate::scene::MaterialId;
use crate::trace::{Probe, Tracer};
use glam::DVec3;

/// Distance by which surfaces may lie outside the box through rounding, in diagonals of the
/// building.
const ROUNDING: f64 = 1e-4;

/// Cosine of the largest slope of ground: 2.6 degrees.
const LEVEL_COSINE: f64 = 0.999;

/// The building of a scene, for rays.
#[derive(Clone, Copy)]
pub(super) struct Building<'a> {
    tracer: &'a Tracer,
    /// Lower corner of the box, world metres.
    pub(super) low: DVec3,
    /// Upper corner of the box, world metres.
    pub(super) high: DVec3,
}

/// A point of the building that a ray meets.
#[derive(Clone, Copy)]
pub(super) struct BuildingHit {
    /// Distance from the ray's origin, metres.
    pub(super) distance_m: f64,
    /// True where the ray meets the front of a surface, or the floor.
    pub(super) is_front: bool,
    /// Material of the surface; `None` for the floor and for surfaces in its plane.
    pub(super) material: Option<MaterialId>,
}

impl<'a> Building<'a> {
    /// The building of a tracer's scene.
    pub(super) fn of(tracer: &'a Tracer) -> Self {
        let [low, high] = tracer.scene().building_m;
        Self { tracer, low, high }
    }

    /// Length of the diagonal of the box, metres.
    pub(super) fn diagonal(&self) -> f64 {
        (self.high - self.low).length()
    }

    /// Distance from the box within which a point counts as inside, metres.
    fn margin(&self) -> f64 {
        self.diagonal() * ROUNDING
    }

    /// True if a point lies in the box.
    fn contains(&self, point_m: DVec3) -> bool {
        let margin = self.margin();
        point_m.cmpge(self.low - margin).all() && point_m.cmple(self.high + margin).all()
    }

    /// True for a level triangle that sticks out of the box sideways. From outside it would hide
    /// what lies below ground.
    fn is_ground(&self, triangle: u32) -> bool {
        let scene = self.tracer.scene();
        let [a, b, c] = scene.corners(triangle).map(|p| scene.frame.world_from_scene(p));
        let normal = (b - a).cross(c - a);
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let margin = self.margin();
        let sticks_out = low.cmplt(self.low - margin) | high.cmpgt(self.high + margin);
        (sticks_out.test(0) || sticks_out.test(2)) && normal.y.abs() >= LEVEL_COSINE * normal.length()
    }

    /// Returns where a ray in a unit direction meets the building, if it meets nothing else before.
    /// The floor is met from inside the box only.
    pub(super) fn probe(&self, origin_m: DVec3, direction: DVec3) -> Option<BuildingHit> {
        let is_outside = !self.contains(origin_m);
        let is_added = |triangle: u32| self.tracer.scene().is_added_ground(triangle);
        let stops = |triangle: u32| !(is_added(triangle) || is_outside && self.is_ground(triangle));
        let hit = self.tracer.probe_where(origin_m, direction, f64::INFINITY, stops);
        let is_above_floor = |hit: &Probe| is_outside || hit.position_m.y > self.low.y + self.margin();
        match hit.filter(is_above_floor) {
            Some(hit) => self.contains(hit.position_m).then_some(BuildingHit {
                distance_m: hit.distance_m,
                is_front: hit.is_front,
                material: Some(hit.material),
            }),
            None if is_outside => None,
            None => self.floor(origin_m, direction),
        }
    }

    /// Returns where a ray that meets nothing above the floor meets the floor.
    fn floor(&self, origin_m: DVec3, direction: DVec3) -> Option<BuildingHit> {
        let distance_m = (self.low.y - origin_m.y) / direction.y;
        let is_met = direction.y < 0.0 && distance_m >= 0.0;
        (is_met && self.contains(origin_m + direction * distance_m)).then_some(BuildingHit {
            distance_m,
            is_front: true,
            material: None,
        })
    }
}
