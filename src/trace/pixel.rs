//! One pixel of the ordinary ray tracer, and of a reference image.

use super::specular::Link;
use super::{Hit, SurfacePoint, Tracer};
use crate::camera::View;
use crate::math::Ray;
use crate::math::key::Key;
use glam::Vec3;
use std::ops::AddAssign;

/// What decides the noise of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TraceSettings {
    /// Shadow rays per light and pixel.
    pub samples: u32,
    /// Diffuse bounces; 0 is direct light only.
    pub bounces: u32,
    /// Of all random numbers.
    pub seed: u64,
}

/// The noise of light that arrives by diffuse bounces, a path a sample, over that of shadow rays. With 3 half of the pixels of a
/// sunlit room were taken for shadow edges.
const BOUNCE_NOISE: f32 = 8.0;

impl TraceSettings {
    /// Shadow rays per light for a surface that is only a share (0..1) of the pixel.
    pub fn samples_for(&self, share: f32) -> u32 {
        ((self.samples as f32 * share).ceil() as u32).clamp(1, self.samples.max(1))
    }

    /// By how much light varies from point to point through noise, over what it does with sixteen shadow rays and no bounce:
    /// what is told from noise by a share of the light is told by so many times that share.
    pub(crate) fn noise(&self) -> f32 {
        let of_bounces = if self.bounces > 0 { BOUNCE_NOISE } else { 1.0 };
        (of_bounces * (16.0 / self.samples.max(1) as f32).sqrt()).max(1.0)
    }
}

impl Default for TraceSettings {
    fn default() -> Self {
        Self { samples: 16, bounces: 0, seed: 0 }
    }
}

/// Rays traced, by purpose.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct RayCounts {
    /// From the eye.
    pub primary: u64,
    /// Towards lights.
    pub shadow: u64,
    /// Mirrored and refracted.
    pub secondary: u64,
    /// Diffusely scattered.
    pub indirect: u64,
    /// Of those towards lights: so near to one that its irradiance was bounded.
    pub clamped: u64,
}

impl RayCounts {
    /// All of them.
    pub fn total(&self) -> u64 {
        self.primary + self.shadow + self.secondary + self.indirect
    }
}

impl AddAssign for RayCounts {
    fn add_assign(&mut self, other: Self) {
        self.primary += other.primary;
        self.shadow += other.shadow;
        self.secondary += other.secondary;
        self.indirect += other.indirect;
        self.clamped += other.clamped;
    }
}

/// A traced pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelTrace {
    /// The light arriving at the first surface, as the radiance of a white one; zero for the sky.
    pub light: Vec3,
    /// All of it.
    pub radiance: Vec3,
    /// The first surface, `None` for the sky.
    pub hit: Option<Hit>,
    /// Specular bounces of the longest branch; 0 for a surface without a specular part.
    pub reflections: u32,
}

impl Tracer {
    /// Traces a pixel in full.
    pub fn pixel(
        &self,
        view: &View,
        pixel: u32,
        settings: &TraceSettings,
        rays: &mut RayCounts,
    ) -> PixelTrace {
        let key = Key::of_pixel(settings.seed, pixel);
        let (mut traced, point) = self.first_hit(view, pixel, settings, key, rays);
        if let Some(point) = point.filter(|p| self.is_specular(p)) {
            let direction = view.direction_of_pixel(pixel);
            let (specular, reflections) = self.specular_radiance(&point, direction, settings, key, rays);
            traced.radiance += specular;
            traced.reflections = reflections;
        }
        traced
    }

    /// Traces what a reference image stores: the diffuse part, the first hit, and how often light is mirrored or
    /// refracted on its way to the eye. Surfaces met after the first bounce are not shaded.
    pub fn reference_pixel(
        &self,
        view: &View,
        pixel: u32,
        settings: &TraceSettings,
        rays: &mut RayCounts,
    ) -> PixelTrace {
        let key = Key::of_pixel(settings.seed, pixel);
        let (mut traced, point) = self.first_hit(view, pixel, settings, key, rays);
        if let Some(point) = point.filter(|p| self.is_specular(p)) {
            let direction = view.direction_of_pixel(pixel);
            let unshaded = |_: &SurfacePoint, _: Link| Vec3::ZERO;
            traced.reflections = self.follow_specular(&point, direction, &mut rays.secondary, unshaded).1;
        }
        traced
    }

    /// The specular radiance of a surface point seen along `direction`, and the bounces of its longest branch.
    pub fn specular_radiance(
        &self,
        point: &SurfacePoint,
        direction: Vec3,
        settings: &TraceSettings,
        key: Key,
        rays: &mut RayCounts,
    ) -> (Vec3, u32) {
        let mut secondary = 0;
        let (radiance, bounces) = self.follow_specular(point, direction, &mut secondary, |next, link| {
            self.diffuse_radiance(next, link.share, settings, Self::specular_key(key, link.number), rays)
        });
        rays.secondary += secondary;
        (radiance, bounces)
    }

    /// The random numbers of a surface met after a specular bounce.
    pub(crate) fn specular_key(key: Key, number: u32) -> Key {
        key.with(SPECULAR + number)
    }

    /// True where a surface mirrors or lets light through.
    pub fn is_specular(&self, point: &SurfacePoint) -> bool {
        self.scene().materials[point.material.0 as usize].is_specular()
    }

    fn first_hit(
        &self,
        view: &View,
        pixel: u32,
        settings: &TraceSettings,
        key: Key,
        rays: &mut RayCounts,
    ) -> (PixelTrace, Option<SurfacePoint>) {
        rays.primary += 1;
        let ray = Self::primary_ray(view, pixel);
        self.shade_hit(&ray, self.closest(&ray), settings, key, rays)
    }

    /// The diffuse part of what a primary ray met.
    pub(crate) fn shade_hit(
        &self,
        ray: &Ray,
        hit: Option<Hit>,
        settings: &TraceSettings,
        key: Key,
        rays: &mut RayCounts,
    ) -> (PixelTrace, Option<SurfacePoint>) {
        let Some(hit) = hit else {
            let sky = self.sky(ray.direction);
            return (PixelTrace { light: Vec3::ZERO, radiance: sky, hit: None, reflections: 0 }, None);
        };
        let point = self.surface(ray, &hit);
        let [radiance, light] = self.diffuse_radiance_and_light(&point, 1.0, settings, key, rays);
        (PixelTrace { light, radiance, hit: Some(hit), reflections: 0 }, Some(point))
    }
}

/// Dimensions of the random numbers of surfaces met after a specular bounce.
const SPECULAR: u32 = 2 << 24;
