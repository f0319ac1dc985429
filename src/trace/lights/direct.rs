//! Irradiance that arrives straight from the lights (next-event estimation).
//!
//! Every light that matters at the point (`grid`) and is not behind the surface gets stratified
//! shadow rays of its own; where many lamps matter, some are chosen (`many`).

use super::near::MOST;
use super::quad::Points;
use super::sample::{add_samples, is_behind, sample_count};
use super::share::LightTurn;
use crate::math::key::Key;
use crate::scene::{Light, MAX_LIGHT_GROUPS};
use crate::trace::{BUNDLE_RAYS, RayBundle, RayCounts, SurfacePoint, Tracer};
use glam::Vec3;

/// Light of each group of a scene's lights.
pub(crate) type GroupLight = [Vec3; MAX_LIGHT_GROUPS];

/// Which lights are sampled by shadow rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LightKinds {
    /// All of them.
    All,
    /// Those that cast sharp shadows. Paths find the sky.
    AllButSky,
    /// The same without the parts of lamps that are so near that the path from there finds them.
    FarButSky,
}

impl Tracer {
    /// Returns the irradiance that arrives straight from the lights, by `samples` shadow rays each.
    /// Where more than 64 lights matter, 16 shadow rays for each sample are shared by all lamps.
    pub fn irradiance(&self, point: &SurfacePoint, samples: u32, key: Key, rays: &mut RayCounts) -> Vec3 {
        self.irradiance_of(LightKinds::All, point, samples, |light| key.with(light).pair(), rays)
    }

    /// Returns the irradiance that arrives straight from some kinds of lights. `shift` returns the
    /// random shift of the samples of a light, by its index in the scene.
    pub(crate) fn irradiance_of(
        &self,
        kinds: LightKinds,
        point: &SurfacePoint,
        samples: u32,
        shift: impl Fn(u32) -> [f32; 2],
        rays: &mut RayCounts,
    ) -> Vec3 {
        let mut total = Vec3::ZERO;
        let add = |_, irradiance| total += irradiance;
        self.irradiance_through(kinds, point, samples, shift, self.traced(rays), add);
        total
    }

    /// Adds the irradiance that arrives straight from some kinds of lights to those of their
    /// groups. Takes the rays of [`Self::irradiance_of`].
    pub(crate) fn add_irradiance_by_group(
        &self,
        kinds: LightKinds,
        point: &SurfacePoint,
        samples: u32,
        shift: impl Fn(u32) -> [f32; 2],
        (rays, groups): (&mut RayCounts, &mut GroupLight),
    ) {
        let of_light = &self.scene().light_groups.of_light;
        let add = |light: u32, irradiance| {
            let group = of_light.get(light as usize).map(|&group| usize::from(group));
            if let Some(sum) = group.and_then(|group| groups.get_mut(group)) {
                *sum += irradiance;
            }
        };
        self.irradiance_through(kinds, point, samples, shift, self.traced(rays), add);
    }

    /// Traces bundles of shadow rays and counts their rays.
    fn traced<'r>(
        &'r self,
        rays: &'r mut RayCounts,
    ) -> impl FnMut(&RayBundle, u64, &mut [Vec3; BUNDLE_RAYS]) + 'r {
        |bundle, clamped, passed| {
            rays.shadow += bundle.len() as u64;
            rays.clamped += clamped;
            self.transmittances(bundle, passed);
        }
    }

    /// Returns the irradiance that arrives straight from one light, which need not be one of the
    /// scene, by `count` samples.
    pub(crate) fn irradiance_of_light(
        &self,
        light: &Light,
        point: &SurfacePoint,
        count: u32,
        shift: [f32; 2],
        rays: &mut RayCounts,
    ) -> Vec3 {
        if is_behind(light, point) {
            return Vec3::ZERO;
        }
        let (mut sum, mut passed) = (Vec3::ZERO, [Vec3::ZERO; BUNDLE_RAYS]);
        let count = sample_count(light, count);
        for first in (0..count).step_by(BUNDLE_RAYS) {
            let mut bundle = RayBundle::new(point.origin_in_front());
            let mut unblocked = [Vec3::ZERO; BUNDLE_RAYS];
            let range = first..count.min(first + BUNDLE_RAYS as u32);
            let points = Points { range, count, shift };
            rays.clamped +=
                add_samples(self.scene(), light, point, points, f32::INFINITY, &mut bundle, &mut unblocked);
            rays.shadow += bundle.len() as u64;
            self.transmittances(&bundle, &mut passed);
            sum += unblocked.iter().zip(&passed).take(bundle.len()).map(|(u, p)| *u * *p).sum::<Vec3>();
        }
        sum / count as f32
    }

    /// Appends to `bundles` the shadow rays that [`Self::irradiance`] traces, in its order.
    pub fn shadow_bundles(&self, point: &SurfacePoint, samples: u32, key: Key, bundles: &mut Vec<RayBundle>) {
        let shift = |light| key.with(light).pair();
        let push = |bundle: &RayBundle, _, _: &mut _| bundles.push(bundle.clone());
        self.irradiance_through(LightKinds::All, point, samples, shift, push, |_, _| ());
    }

    /// Finds the irradiance of each light, and passes it to `add` with the light's index. `trace`
    /// receives each bundle of shadow rays with the number of its rays whose irradiance was
    /// bounded, and writes the share of light that passes along each.
    #[inline(always)]
    fn irradiance_through(
        &self,
        kinds: LightKinds,
        point: &SurfacePoint,
        samples: u32,
        shift: impl Fn(u32) -> [f32; 2],
        mut trace: impl FnMut(&RayBundle, u64, &mut [Vec3; BUNDLE_RAYS]),
        mut add: impl FnMut(u32, Vec3),
    ) {
        let (origin, mut passed) = (point.origin_in_front(), [Vec3::ZERO; BUNDLE_RAYS]);
        let most = if kinds == LightKinds::FarButSky { MOST } else { f32::INFINITY };
        let cell = self.lights_at(point.position);
        for LightTurn { index, samples, weight, .. } in cell.own_turns(samples) {
            // Skip a light that lies wholly behind the surface.
            let light = &self.scene().lights[index as usize];
            let is_left_out = kinds != LightKinds::All && matches!(light, Light::Sky);
            if is_left_out || is_behind(light, point) {
                continue;
            }
            let count = sample_count(light, samples);
            let shift = shift(index);
            let mut sum = Vec3::ZERO;
            for first in (0..count).step_by(BUNDLE_RAYS) {
                // Sample points on the light.
                let mut bundle = RayBundle::new(origin);
                let mut unblocked = [Vec3::ZERO; BUNDLE_RAYS];
                let range = first..count.min(first + BUNDLE_RAYS as u32);
                let points = Points { range, count, shift };
                let clamped =
                    add_samples(self.scene(), light, point, points, most, &mut bundle, &mut unblocked);
                // Trace the shadow rays and add what arrives.
                trace(&bundle, clamped, &mut passed);
                for (unblocked, passed) in unblocked.iter().zip(&passed).take(bundle.len()) {
                    sum += *unblocked * *passed;
                }
            }
            add(index, sum / count as f32 * weight);
        }
        if cell.is_shared() {
            self.irradiance_of_many(cell, point, (samples, most), &shift, &mut trace, &mut add);
        }
    }
}
