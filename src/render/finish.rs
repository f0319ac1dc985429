//! Finishes the pixels that the look-up left open: mirrors and glass, guesses, and what no reference saw.

use crate::camera::View;
use crate::math::Ray;
use crate::math::hash::Key;
use crate::reference::{LookupSet, Place, PointCache, TracedPoint};
use crate::trace::{Hit, PixelTrace, RayCounts, SurfacePoint, TraceSettings, Tracer};
use glam::Vec3;
use std::ops::AddAssign;

/// A guess that is off by more than this share of the brighter of the two gives way to what was traced. Below it the
/// look-up, a mean over references, has less noise than sixteen rays.
const BAD_GUESS: f32 = 0.15;

/// Points that one pixel's mirrors and glass leave at most, so that memory is bounded; a frame after it finds these and
/// leaves the next.
pub(super) const MOST_POINTS: usize = 2;

/// What finishing pixels takes and leaves.
#[derive(Debug, Default)]
pub(super) struct Spent {
    pub(super) rays: RayCounts,
    /// Traced where no reference knows the light.
    pub(super) points: Vec<TracedPoint>,
}

impl AddAssign for Spent {
    fn add_assign(&mut self, mut other: Self) {
        self.rays += other.rays;
        self.points.append(&mut other.points);
    }
}

/// What pixels are finished with.
#[derive(Clone, Copy)]
pub(super) struct Finish<'a> {
    pub(super) tracer: &'a Tracer,
    pub(super) view: &'a View,
    pub(super) lookup: &'a LookupSet<'a>,
    pub(super) points: &'a PointCache,
    pub(super) settings: &'a TraceSettings,
}

/// How a pixel sees a point.
struct Seen {
    pixel: u32,
    /// Length of the way to it, scene units.
    distance: f32,
    /// The share of the pixel that it is, 0..1.
    share: f32,
    /// Of the random numbers.
    key: Key,
}

impl Finish<'_> {
    /// The light that a pixel's mirror or glass shows.
    pub(super) fn specular_of(&self, pixel: u32, triangle: u32, spent: &mut Spent) -> Vec3 {
        let (ray, Some(hit)) = self.hit(pixel, triangle) else { return Vec3::ZERO };
        self.specular(&self.tracer.surface(&ray, &hit), &ray, &hit, pixel, spent)
    }

    /// Shades a pixel; what its mirror or glass shows is looked up.
    pub(super) fn shade(&self, pixel: u32, triangle: u32, spent: &mut Spent) -> PixelTrace {
        let (ray, hit) = self.hit(pixel, triangle);
        let key = Key::of_pixel(self.settings.seed, pixel);
        let (mut traced, point) = self.tracer.shade_hit(&ray, hit, self.settings, key, &mut spent.rays);
        if let (Some(hit), Some(point)) = (hit, point) {
            traced.radiance += self.specular(&point, &ray, &hit, pixel, spent);
        }
        traced
    }

    /// A pixel whose light the look-up guessed: the guess of its diffuse radiance is held against what is traced there,
    /// in this frame or one before.
    pub(super) fn check(&self, pixel: u32, triangle: u32, guess: Vec3, spent: &mut Spent) -> Vec3 {
        let (ray, Some(hit)) = self.hit(pixel, triangle) else { return guess };
        let point = self.tracer.surface(&ray, &hit);
        let key = Key::of_pixel(self.settings.seed, pixel);
        let seen = Seen { pixel, distance: distance(&ray, &hit), share: 1.0, key };
        let traced = self.diffuse(&point, &seen, spent);
        let brighter = traced.max(guess).max_element();
        let is_bad = (traced - guess).abs().max_element() > BAD_GUESS * brighter;
        let diffuse = if is_bad { traced } else { guess };
        diffuse + self.specular(&point, &ray, &hit, pixel, spent)
    }

    /// The ray of a pixel, and where it meets the triangle it is known to see.
    fn hit(&self, pixel: u32, triangle: u32) -> (Ray, Option<Hit>) {
        let ray = Tracer::primary_ray(self.view, pixel);
        (ray, self.tracer.hit_on_triangle(&ray, triangle))
    }

    /// The specular radiance of a pixel's first surface, with the light of all that it mirrors or lets through looked up.
    fn specular(&self, point: &SurfacePoint, ray: &Ray, hit: &Hit, pixel: u32, spent: &mut Spent) -> Vec3 {
        let (tracer, scene) = (self.tracer, self.tracer.scene());
        if !tracer.is_specular(point) {
            return Vec3::ZERO;
        }
        let (key, distance) = (Key::of_pixel(self.settings.seed, pixel), distance(ray, hit));
        let most_points = spent.points.len() + MOST_POINTS;
        let mut secondary = 0;
        let (radiance, _) = tracer.follow_specular(point, ray.direction, &mut secondary, |next, link| {
            let albedo = next.albedo(scene);
            if albedo != Vec3::ZERO
                && let Some(light) = self.lookup.light_at(next.position, next.geometric_normal, next.triangle)
            {
                return scene.materials[next.material.0 as usize].emission + albedo * light;
            }
            let key = Tracer::specular_key(key, link.number);
            let seen = Seen { pixel, distance: distance + link.length, share: link.share, key };
            let radiance = self.diffuse(next, &seen, spent);
            spent.points.truncate(most_points);
            radiance
        });
        spent.rays.secondary += secondary;
        radiance
    }

    /// The diffuse radiance of a point that no reference knows; traced once for all frames.
    fn diffuse(&self, point: &SurfacePoint, seen: &Seen, spent: &mut Spent) -> Vec3 {
        let scene = self.tracer.scene();
        let footprint = self.view.scene_from_pixel.x_axis.length() * seen.distance;
        let place = Place { position: point.position, normal: point.geometric_normal, footprint };
        let samples = self.settings.samples_for(seen.share);
        if let Some(light) = self.points.find(&place, samples) {
            return scene.materials[point.material.0 as usize].emission + point.albedo(scene) * light;
        }
        let rays = &mut spent.rays;
        let [radiance, light] =
            self.tracer.diffuse_radiance_and_light(point, seen.share, self.settings, seen.key, rays);
        if point.albedo(scene) != Vec3::ZERO {
            spent.points.push(TracedPoint { place, light, samples, pixel: seen.pixel });
        }
        radiance
    }
}

/// Length of a primary ray up to its hit.
fn distance(ray: &Ray, hit: &Hit) -> f32 {
    hit.t * ray.direction.length()
}
