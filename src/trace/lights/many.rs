//! Irradiance from many lamps, by a number of shadow rays that does not depend on theirs.
//!
//! Samples are in the order of the tree of lamps, so rays are spread over the lamps, and those of
//! one bundle go the same way.

use super::quad::Points;
use super::sample::{LightSample, add_samples, is_behind, sample, sample_count};
use super::share::{CellLights, LightTurn, SHARING};
use crate::math::{Ray, sampling::lattice};
use crate::trace::{BUNDLE_RAYS, RayBundle, SurfacePoint, Tracer};
use glam::Vec3;

/// Number of shadow rays for each sample that is asked for: a full bundle.
const SHADOW_RAYS: u32 = BUNDLE_RAYS as u32;

/// Number of shadow rays for a single sample, as at a vertex of a path, whose noise is that of the
/// path.
const RAYS_OF_ONE_SAMPLE: u32 = 8;

/// Shadow rays to several lamps, which are traced together.
struct Shared {
    bundle: RayBundle,
    /// Light of each ray, and irradiance that it brings where nothing hides the light.
    of_ray: [(u32, Vec3); BUNDLE_RAYS],
    /// Number of rays whose irradiance was bounded.
    clamped: u64,
}

impl Tracer {
    /// Finds the irradiance of the lamps that are chosen in a cell. `shift`, `trace` and `add` are
    /// those of the lights that get all their samples, and `most` bounds those of a lamp as in
    /// [`add_samples`].
    pub(super) fn irradiance_of_many(
        &self,
        cell: &CellLights,
        point: &SurfacePoint,
        (samples, most): (u32, f32),
        shift: &impl Fn(u32) -> [f32; 2],
        trace: &mut impl FnMut(&RayBundle, u64, &mut [Vec3; BUNDLE_RAYS]),
        add: &mut impl FnMut(u32, Vec3),
    ) {
        let count = if samples == 1 { RAYS_OF_ONE_SAMPLE } else { SHADOW_RAYS.saturating_mul(samples) };
        let turns = cell.chosen_turns(self.light_grid().tree(), point, count, shift(SHARING)[0]);
        let origin = point.origin_in_front();
        let mut shared = Shared::new(RayBundle::new(origin));
        for LightTurn { index, samples, weight, .. } in turns {
            let light = &self.scene().lights[index as usize];
            let (count, shift) = (sample_count(light, samples), shift(index));
            if count == 1 {
                let found = sample(self.scene(), light, point, origin, lattice(0, 1, shift));
                if let Some(LightSample { shadow_ray, irradiance, factor, is_clamped }) = found
                    && factor <= most
                {
                    shared.make_room(trace, add);
                    shared.push(index, &shadow_ray, irradiance * weight);
                    shared.clamped += u64::from(is_clamped);
                }
                continue;
            }
            if is_behind(light, point) {
                continue;
            }
            for first in (0..count).step_by(BUNDLE_RAYS) {
                let (mut bundle, mut unblocked) = (RayBundle::new(origin), [Vec3::ZERO; BUNDLE_RAYS]);
                let range = first..count.min(first + BUNDLE_RAYS as u32);
                let points = Points { range, count, shift };
                shared.clamped +=
                    add_samples(self.scene(), light, point, points, most, &mut bundle, &mut unblocked);
                for (ray, unblocked) in bundle.rays().zip(unblocked) {
                    shared.make_room(trace, add);
                    shared.push(index, &ray, unblocked * (weight / count as f32));
                }
            }
        }
        shared.finish(trace, add);
    }
}

impl Shared {
    fn new(bundle: RayBundle) -> Self {
        Self { bundle, of_ray: [(0, Vec3::ZERO); BUNDLE_RAYS], clamped: 0 }
    }

    fn push(&mut self, light: u32, ray: &Ray, irradiance: Vec3) {
        self.of_ray[self.bundle.len()] = (light, irradiance);
        self.bundle.push(ray.direction, ray.t_max);
    }

    /// Traces the rays where there is no room for another.
    fn make_room(
        &mut self,
        trace: &mut impl FnMut(&RayBundle, u64, &mut [Vec3; BUNDLE_RAYS]),
        add: &mut impl FnMut(u32, Vec3),
    ) {
        if self.bundle.len() == BUNDLE_RAYS {
            self.finish(trace, add);
        }
    }

    /// Traces the rays, and starts again without any.
    fn finish(
        &mut self,
        trace: &mut impl FnMut(&RayBundle, u64, &mut [Vec3; BUNDLE_RAYS]),
        add: &mut impl FnMut(u32, Vec3),
    ) {
        let mut passed = [Vec3::ZERO; BUNDLE_RAYS];
        trace(&self.bundle, self.clamped, &mut passed);
        for ((light, irradiance), passed) in self.of_ray.iter().zip(&passed).take(self.bundle.len()) {
            add(*light, *irradiance * *passed);
        }
        *self = Self::new(RayBundle::new(self.bundle.origin()));
    }
}
