//! What a view shows of the building, by a coarse grid of rays.

use super::building::{Building, BuildingHit};
use crate::camera::Camera;
use glam::DVec3;
use rayon::prelude::*;

/// Number of rays across and down the picture: the common shape of screens, 16:9.
const RAYS: [i32; 2] = [32, 18];

/// Distance below which a surface fills the view without being recognised, metres: an arm and a
/// bit.
const NEAR_M: f64 = 1.0;

/// Smallest share of the picture that shows building in a start view, as counted by 576 rays. That
/// leaves a hundredth of the picture for what lies between them: it is at least 0.3.
pub(super) const MIN_BUILDING: f64 = 0.31;

/// The surfaces that a view shows.
pub(super) struct Sight {
    /// The surfaces of the building, one for each ray that meets the building first.
    seen: Vec<BuildingHit>,
    /// Mean distance to the building in the middle of the picture, in a square of its height.
    depth_m: f64,
}

impl Sight {
    /// What a camera shows.
    pub(super) fn of(building: &Building, camera: &Camera) -> Self {
        let axes = camera.world_from_camera();
        let tan = (camera.fov_y / 2.0).tan();
        let unit = |i: i32, count: i32| (f64::from(i) + 0.5) / f64::from(count) * 2.0 - 1.0;
        let aspect = f64::from(RAYS[0]) / f64::from(RAYS[1]);
        let met = |i: i32| {
            let [x, y] = [unit(i % RAYS[0], RAYS[0]) * aspect, unit(i / RAYS[0], RAYS[1])];
            let direction = (axes * DVec3::new(x * tan, y * tan, -1.0)).normalize_or(DVec3::NEG_Z);
            Some((x.abs() <= 1.0, building.probe(camera.eye, direction)?))
        };
        let met: Vec<_> = (0..RAYS[0] * RAYS[1]).into_par_iter().filter_map(met).collect();
        let middle = met.iter().filter(|(is_middle, _)| *is_middle);
        let (sum, count) = middle.fold((0.0, 0), |(sum, count), (_, hit)| (sum + hit.distance_m, count + 1));
        let depth_m = sum / f64::from(count.max(1));
        Self { seen: met.into_iter().map(|(_, hit)| hit).collect(), depth_m }
    }

    /// Share of the picture that shows building.
    pub(super) fn building(&self) -> f64 {
        self.share(|_| true)
    }

    /// Share of the picture that shows the front of building surfaces.
    pub(super) fn fronts(&self) -> f64 {
        self.share(|hit| hit.is_front)
    }

    /// Share of the picture that shows building closer than a metre.
    pub(super) fn near(&self) -> f64 {
        self.share(|hit| hit.distance_m < NEAR_M)
    }

    /// Share of back faces among the surfaces of the building; zero where there are none.
    pub(super) fn backs(&self) -> f64 {
        let building = self.building();
        if building > 0.0 { 1.0 - self.fronts() / building } else { 0.0 }
    }

    /// Mean distance to the building in the middle of the picture, metres. Rays that leave through
    /// windows do not count. Zero where none meets the building.
    pub(super) fn depth_m(&self) -> f64 {
        self.depth_m
    }

    /// Share of the surfaces of the building that hide the view: closer than a third of the depth.
    pub(super) fn clutter(&self) -> f64 {
        let is_close = |hit: &&BuildingHit| hit.distance_m < self.depth_m / 3.0;
        self.seen.iter().filter(is_close).count() as f64 / self.seen.len().max(1) as f64
    }

    /// Effective number of materials of the surfaces of the building: 2 to the power of the entropy
    /// of their shares. One where there are none. The floor of the box does not count.
    pub(super) fn materials(&self) -> f64 {
        let mut materials: Vec<u32> = self.seen.iter().filter_map(|hit| Some(hit.material?.0)).collect();
        materials.sort_unstable();
        let shares = materials.chunk_by(|a, b| a == b).map(|m| m.len() as f64 / materials.len() as f64);
        let entropy: f64 = shares.map(|share| -share * share.log2()).sum();
        entropy.exp2()
    }

    fn share(&self, counts: impl Fn(&BuildingHit) -> bool) -> f64 {
        self.seen.iter().filter(|hit| counts(hit)).count() as f64 / f64::from(RAYS[0] * RAYS[1])
    }
}
