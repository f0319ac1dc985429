//! The light a surface scatters alike to every side: the part of radiance that a reference image can lend.
//!
//! Next-event estimation: every light that matters there (`light_grid`) and is not behind
//! the surface gets its own stratified shadow rays. Diffuse
//! interreflection is path traced when bounces are asked for.

use super::bvh::{BUNDLE_RAYS, RayBundle};
use super::pixel::{RayCounts, TraceSettings};
use super::{SurfacePoint, Tracer};
use crate::math::Ray;
use crate::math::key::Key;
use crate::math::sampling::{cosine_hemisphere, frame_around, lattice};
use crate::trace::lights::quad::Points;
use crate::trace::lights::sample::{add_samples, is_behind, sample_count};
use glam::Vec3;
use std::f32::consts::{FRAC_1_PI, PI};

/// Dimensions of the random numbers of one surface point. Lights take their index.
const INDIRECT: u32 = 1 << 24;

impl Tracer {
    /// Emitted plus diffusely reflected radiance of a surface point, on the side it is seen from.
    ///
    /// `share` (0..1) is how much of the pixel this point is: shadow rays are spent in proportion, at least one.
    pub fn diffuse_radiance(
        &self,
        point: &SurfacePoint,
        share: f32,
        settings: &TraceSettings,
        key: Key,
        rays: &mut RayCounts,
    ) -> Vec3 {
        self.diffuse_radiance_and_light(point, share, settings, key, rays)[0]
    }

    /// The same, and beside it the arriving light, as the radiance of a white surface: what references store. A
    /// surface that reflects nothing is asked for none, and its light is zero.
    pub(crate) fn diffuse_radiance_and_light(
        &self,
        point: &SurfacePoint,
        share: f32,
        settings: &TraceSettings,
        key: Key,
        rays: &mut RayCounts,
    ) -> [Vec3; 2] {
        let scene = self.scene();
        let emission = scene.materials[point.material.0 as usize].emission;
        let albedo = point.albedo(scene);
        if albedo == Vec3::ZERO {
            return [emission, Vec3::ZERO];
        }
        let samples = settings.samples_for(share);
        let mut irradiance = self.irradiance(point, samples, key, rays);
        if settings.bounces > 0 {
            irradiance += self.indirect_irradiance(point, samples, settings.bounces, key, rays);
        }
        [emission + albedo * FRAC_1_PI * irradiance, irradiance * FRAC_1_PI]
    }

    /// Irradiance that arrives straight from the lights, `samples` shadow rays each.
    pub fn irradiance(&self, point: &SurfacePoint, samples: u32, key: Key, rays: &mut RayCounts) -> Vec3 {
        self.irradiance_through(point, samples, key, |bundle, clamped, passed| {
            rays.shadow += bundle.len() as u64;
            rays.clamped += clamped;
            self.transmittances(bundle, passed);
        })
    }

    /// The shadow rays that [`Self::irradiance`] traces, in its order, appended to `bundles`.
    pub fn shadow_bundles(&self, point: &SurfacePoint, samples: u32, key: Key, bundles: &mut Vec<RayBundle>) {
        self.irradiance_through(point, samples, key, |bundle, _, _| bundles.push(bundle.clone()));
    }

    /// `trace` tells how much light passes along the shadow rays of a bundle; it is told as well how many of them were bounded.
    #[inline(always)]
    fn irradiance_through(
        &self,
        point: &SurfacePoint,
        samples: u32,
        key: Key,
        mut trace: impl FnMut(&RayBundle, u64, &mut [Vec3; BUNDLE_RAYS]),
    ) -> Vec3 {
        let origin = point.origin_in_front();
        let (mut total, mut passed) = (Vec3::ZERO, [Vec3::ZERO; BUNDLE_RAYS]);
        for &index in self.lights_at(point.position) {
            let light = &self.scene().lights[index as usize];
            if is_behind(light, point) {
                continue;
            }
            let count = sample_count(light, samples);
            let shift = key.with(index).pair();
            let mut sum = Vec3::ZERO;
            for first in (0..count).step_by(BUNDLE_RAYS) {
                let mut bundle = RayBundle::new(origin);
                let mut unblocked = [Vec3::ZERO; BUNDLE_RAYS];
                let range = first..count.min(first + BUNDLE_RAYS as u32);
                let points = Points { range, count, shift };
                let clamped = add_samples(self.scene(), light, point, points, &mut bundle, &mut unblocked);
                trace(&bundle, clamped, &mut passed);
                for (unblocked, passed) in unblocked.iter().zip(&passed).take(bundle.len()) {
                    sum += *unblocked * *passed;
                }
            }
            total += sum / count as f32;
        }
        total
    }

    /// Irradiance by way of other diffuse surfaces: `samples` paths of up to `bounces` vertices, one shadow ray per
    /// light at each. Light met directly is left out: [`Self::irradiance`] has it already.
    fn indirect_irradiance(
        &self,
        point: &SurfacePoint,
        samples: u32,
        bounces: u32,
        key: Key,
        rays: &mut RayCounts,
    ) -> Vec3 {
        let key = key.with(INDIRECT);
        let mut sum = Vec3::ZERO;
        for i in 0..samples {
            let u = lattice(i, samples, key.pair());
            sum += self.path_radiance(point, u, bounces, key.with(i), rays);
        }
        sum * (PI / samples as f32)
    }

    fn path_radiance(
        &self,
        start: &SurfacePoint,
        mut u: [f32; 2],
        bounces: u32,
        key: Key,
        rays: &mut RayCounts,
    ) -> Vec3 {
        let (mut point, mut throughput, mut radiance) = (*start, Vec3::ONE, Vec3::ZERO);
        for bounce in 0..bounces {
            let key = key.with(INDIRECT + bounce);
            let direction = frame_around(point.shading_normal) * cosine_hemisphere(u);
            if point.geometric_normal.dot(direction) <= 0.0 {
                break;
            }
            let ray = Ray::new(point.origin_in_front(), direction);
            let (next, was_mirrored) = match self.next_diffuse_point(ray, &mut throughput, key, rays) {
                Next::Surface(next, was_mirrored) => (next, was_mirrored),
                // Seen directly the sky is a light with shadow rays of its own.
                Next::Sky(seen, true) => return radiance + throughput * seen,
                Next::Sky(..) | Next::Lost => break,
            };
            if was_mirrored {
                // No shadow ray finds a light by way of a mirror, so here its emission counts.
                radiance += throughput * self.scene().materials[next.material.0 as usize].emission;
            }
            throughput *= next.albedo(self.scene());
            if throughput.max_element() <= 0.0 {
                break;
            }
            radiance += throughput * FRAC_1_PI * self.irradiance(&next, 1, key, rays);
            point = next;
            u = key.with(INDIRECT).pair();
        }
        radiance
    }

    /// Follows a ray to the next point that scatters, through mirrors and glass on the way. At a surface with several
    /// parts one is chosen at random, by what it carries.
    fn next_diffuse_point(
        &self,
        mut ray: Ray,
        throughput: &mut Vec3,
        key: Key,
        rays: &mut RayCounts,
    ) -> Next {
        const LONGEST_CHAIN: u32 = 64;
        let mut was_mirrored = false;
        for link in 0..LONGEST_CHAIN {
            rays.indirect += 1;
            let Some(hit) = self.closest(&ray) else {
                return Next::Sky(self.sky(ray.direction), was_mirrored);
            };
            let point = self.surface(&ray, &hit);
            if !self.is_specular(&point) {
                return Next::Surface(point, was_mirrored);
            }
            let random = key.with(link).pair();
            let diffuse = point.albedo(self.scene()).max_element();
            let scatters = diffuse / (diffuse + self.specular_weight(&point, ray.direction));
            if random[1] < scatters {
                *throughput /= scatters;
                return Next::Surface(point, was_mirrored);
            }
            let Some((next, weight)) = self.choose_branch(&point, ray.direction, random[0]) else {
                return Next::Lost;
            };
            was_mirrored |= next.direction.dot(point.geometric_normal) > 0.0;
            *throughput *= weight / (1.0 - scatters);
            ray = next;
        }
        Next::Lost
    }
}

/// Where a path arrives; with whether it was mirrored since it last scattered.
enum Next {
    Surface(SurfacePoint, bool),
    Sky(Vec3, bool),
    Lost,
}
