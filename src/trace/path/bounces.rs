//! Irradiance by way of other diffuse surfaces, path traced.

use super::dimension::INDIRECT;
use crate::bsdf::Diffuse;
use crate::math::{Ray, key::Key, sampling::lattice};
use crate::trace::{RayCounts, SurfacePoint, Tracer};
use glam::Vec3;
use std::f32::consts::PI;

/// Number of mirrors and panes in a row after which a path ends.
const MAX_CHAIN: u32 = 64;

/// Number of diffuse bounces after which a path ends, whatever the settings say.
const MAX_BOUNCES: u32 = 64;

/// Where a path arrives. The flag is true where a surface reflected it since it last scattered
/// diffusely.
enum Next {
    Surface(SurfacePoint, bool),
    Sky(Vec3, bool),
    Lost,
}

impl Tracer {
    /// Returns the irradiance from other surfaces: `samples` paths of up to `bounces` vertices,
    /// with one shadow ray per light at each.
    ///
    /// Light that arrives straight from a source is left out: [`Self::irradiance`] includes it.
    pub(super) fn indirect_irradiance(
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

    /// Returns the radiance that one path brings to `start`; `u` chooses its first direction.
    fn path_radiance(
        &self,
        start: &SurfacePoint,
        mut u: [f32; 2],
        bounces: u32,
        key: Key,
        rays: &mut RayCounts,
    ) -> Vec3 {
        let (mut point, mut throughput, mut radiance) = (*start, Vec3::ONE, Vec3::ZERO);
        for bounce in 0..bounces.min(MAX_BOUNCES) {
            let key = key.with(INDIRECT + bounce);
            // Follow a diffusely scattered ray to the next diffuse surface.
            let Some(direction) = Diffuse::sample_direction(&point.facing(self.scene()), u) else { break };
            let ray = Ray::new(point.origin_in_front(), direction);
            let (next, was_reflected) = match self.next_diffuse_point(ray, &mut throughput, key, rays) {
                Next::Surface(next, was_reflected) => (next, was_reflected),
                // A sky seen directly is a light, which has shadow rays of its own.
                Next::Sky(seen, true) => return radiance + throughput * seen,
                Next::Sky(..) | Next::Lost => break,
            };
            // No shadow ray finds a light by way of a mirror, so its emission counts here.
            if was_reflected {
                radiance += throughput * self.material(&next).emission;
            }
            // The weight of a diffuse sample is the albedo.
            throughput *= next.albedo(self.scene());
            if throughput.max_element() <= 0.0 {
                break;
            }
            // Add the light that arrives there straight from the sources.
            let irradiance = self.irradiance(&next, 1, key, rays);
            radiance += Diffuse { albedo: throughput }.radiance(irradiance);
            point = next;
            u = key.with(INDIRECT).pair();
        }
        radiance
    }

    /// Follows a ray to the next point that scatters diffusely, through mirrors and glass on the
    /// way. At a surface with several lobes one is chosen at random, by the share of light that it
    /// carries.
    fn next_diffuse_point(
        &self,
        mut ray: Ray,
        throughput: &mut Vec3,
        key: Key,
        rays: &mut RayCounts,
    ) -> Next {
        let mut was_reflected = false;
        for link in 0..MAX_CHAIN {
            rays.indirect += 1;
            let Some(hit) = self.closest(&ray) else {
                return Next::Sky(self.diffuse_sky(ray.direction), was_reflected);
            };
            let point = self.surface(&ray, &hit);
            if !self.is_view_dependent(&point) {
                return Next::Surface(point, was_reflected);
            }
            // Choose between the diffuse lobe and the other.
            let key = key.with(link);
            let [random_branch, random_lobe] = key.pair();
            let continuations = self.scatter(&point, ray.direction, key);
            let diffuse = point.albedo(self.scene()).max_element();
            let scatters = diffuse / (diffuse + continuations.total_weight());
            if random_lobe < scatters {
                *throughput /= scatters;
                return Next::Surface(point, was_reflected);
            }
            // Choose one of the other lobe's continuations.
            let Some(next) = continuations.choose(random_branch) else { return Next::Lost };
            was_reflected |= next.direction.dot(point.geometric_normal) > 0.0;
            *throughput *= next.weight / (1.0 - scatters);
            ray = point.scattered_ray(&next);
        }
        Next::Lost
    }
}
