//! One pixel of a picture, and of a reference image.

use super::diffuse::{ArrivingLight, LightSettings};
use super::specular::PathVertex;
use crate::camera::View;
use crate::math::{Ray, sequence::PointSeed};
use crate::trace::{Hit, RayCounts, SurfacePoint, TraceSettings, Tracer};
use glam::Vec3;

/// A traced pixel. Light and radiance are linear Rec. 709.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PixelTrace {
    /// Light arriving at the first surface; zero for the sky.
    pub light: ArrivingLight,
    /// Radiance of the pixel.
    pub radiance: Vec3,
    /// First surface; `None` for the sky and for the cap of a section.
    pub hit: Option<Hit>,
    /// Specular bounces of the longest branch; 0 where the first surface has no viewer-dependent
    /// part.
    pub reflections: u32,
    /// 1 / distance of the cap of a section that the pixel shows; 0 where it shows none.
    pub cap_disparity: f32,
}

impl PixelTrace {
    /// 1 / depth of what the pixel shows, along its ray; 0 for the sky.
    pub fn disparity(&self) -> f32 {
        self.hit.map_or(self.cap_disparity, |hit| 1.0 / hit.t)
    }
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
        let hit = self.closest_seen(&Self::primary_ray(view, pixel));
        self.pixel_of_hit((view, pixel), hit, settings, rays)
    }

    /// [`Self::pixel`] of a view and a pixel whose first hit is known.
    pub fn pixel_of_hit(
        &self,
        of: (&View, u32),
        hit: Option<Hit>,
        settings: &TraceSettings,
        rays: &mut RayCounts,
    ) -> PixelTrace {
        self.pixel_with((of, false), hit, settings, rays, |point, direction, seed, rays| {
            self.specular_radiance(point, direction, settings, seed, rays)
        })
    }

    /// Traces what a reference image stores: the diffuse part, the first hit, and how often light
    /// is reflected or refracted on its way to the eye. Surfaces after the first are not shaded.
    pub fn reference_pixel(
        &self,
        view: &View,
        pixel: u32,
        settings: &TraceSettings,
        rays: &mut RayCounts,
    ) -> PixelTrace {
        let hit = self.closest_seen(&Self::primary_ray(view, pixel));
        self.reference_pixel_of_hit(((view, pixel), false), hit, settings, rays)
    }

    /// [`Self::reference_pixel`] of a view and a pixel whose first hit is known, with the light
    /// that look-ups want ([`SurfacePoint::as_stored`]) where `for_look_ups`.
    pub(crate) fn reference_pixel_of_hit(
        &self,
        of: ((&View, u32), bool),
        hit: Option<Hit>,
        settings: &TraceSettings,
        rays: &mut RayCounts,
    ) -> PixelTrace {
        self.pixel_with(of, hit, settings, rays, |point, direction, seed, rays| {
            let unshaded = |_: &SurfacePoint, _| Vec3::ZERO;
            (Vec3::ZERO, self.follow_specular(point, direction, (seed, 0), rays, unshaded).1)
        })
    }

    /// Traces a pixel whose viewer-dependent radiance and number of bounces `specular` returns.
    fn pixel_with(
        &self,
        ((view, pixel), for_look_ups): ((&View, u32), bool),
        hit: Option<Hit>,
        settings: &TraceSettings,
        rays: &mut RayCounts,
        specular: impl FnOnce(&SurfacePoint, Vec3, PointSeed, &mut RayCounts) -> (Vec3, u32),
    ) -> PixelTrace {
        let seed = PointSeed::of_pixel(settings.seed, pixel, view.size[0], settings.samples);
        rays.primary += 1;
        let ray = Self::primary_ray(view, pixel);
        let settings = LightSettings::from(*settings);
        let (mut traced, point) = self.shade_hit((&ray, for_look_ups), hit, &settings, seed, rays);
        if let Some(point) = point.filter(|point| self.is_view_dependent(point)) {
            let (radiance, reflections) = specular(&point, ray.direction, seed, rays);
            traced.radiance += radiance;
            traced.reflections = reflections;
        }
        traced
    }

    /// Returns the radiance that arrives at the origin of a ray, traced in full.
    pub fn radiance_along(
        &self,
        ray: &Ray,
        settings: &TraceSettings,
        seed: PointSeed,
        rays: &mut RayCounts,
    ) -> Vec3 {
        rays.primary += 1;
        let lit = LightSettings::from(*settings);
        let (mut traced, point) = self.shade_hit((ray, false), self.closest(ray), &lit, seed, rays);
        if let Some(point) = point.filter(|point| self.is_view_dependent(point)) {
            traced.radiance += self.specular_radiance(&point, ray.direction, settings, seed, rays).0;
        }
        traced.radiance
    }

    /// Returns the viewer-dependent radiance of a surface point seen along `direction`, and the
    /// bounces of its longest branch.
    pub fn specular_radiance(
        &self,
        point: &SurfacePoint,
        direction: Vec3,
        settings: &TraceSettings,
        seed: PointSeed,
        rays: &mut RayCounts,
    ) -> (Vec3, u32) {
        if self.shows_light() {
            return (Vec3::ZERO, 0);
        }
        let mut own = RayCounts::default();
        let shade = |next: &SurfacePoint, vertex: PathVertex| {
            self.diffuse_radiance(next, vertex.share, &(*settings).into(), vertex.key, rays)
        };
        let (radiance, bounces) =
            self.follow_specular(point, direction, (seed, settings.samples), &mut own, shade);
        *rays += own;
        (radiance, bounces)
    }

    /// Returns the diffuse part of what a primary ray hit, and the surface point; no point for the
    /// sky. With `for_look_ups`, it is lit as references store light ([`SurfacePoint::as_stored`]).
    pub(crate) fn shade_hit(
        &self,
        (ray, for_look_ups): (&Ray, bool),
        hit: Option<Hit>,
        settings: &LightSettings<'_>,
        seed: PointSeed,
        rays: &mut RayCounts,
    ) -> (PixelTrace, Option<SurfacePoint>) {
        let Some(hit) = hit else {
            let (radiance, cap_disparity) = self.beyond_surfaces(ray);
            let light = ArrivingLight::default();
            return (PixelTrace { light, radiance, hit: None, reflections: 0, cap_disparity }, None);
        };
        let point = self.surface(ray, &hit);
        let lit = if for_look_ups { point.as_stored() } else { point };
        let light = self.arriving_light(&lit, 1.0, settings, seed, rays);
        let radiance = self.emission_of(&point) + light.reflected(self.albedo_of(&point));
        (PixelTrace { light, radiance, hit: Some(hit), reflections: 0, cap_disparity: 0.0 }, Some(point))
    }
}
