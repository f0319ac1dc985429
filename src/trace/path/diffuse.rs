//! The diffuse radiance of a surface: the part that does not depend on the viewer, so that a
//! reference image can provide it to other views.

use super::bounces::SmoothSettings;
use super::cached_light::CachedLight;
use super::dimension::LATER;
use crate::bsdf::Diffuse;
use crate::math::sequence::PointSeed;
use crate::trace::lights::LightKinds;
use crate::trace::{RayCounts, SurfacePoint, TraceSettings, Tracer};
use glam::Vec3;
use std::ops::Range;

/// Light that arrives at a surface point, linear Rec. 709.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ArrivingLight {
    /// Irradiance straight from the lights: from sun and lamps, and without bounces from the sky
    /// too.
    pub direct_irradiance: Vec3,
    /// Smooth light: from the sky and from other surfaces. Sums of the paths with even and with odd
    /// numbers, as radiance of a white surface; zero without bounces.
    pub smooth_sums: [Vec3; 2],
    /// Number of paths; zero without bounces.
    pub paths: u32,
}

impl ArrivingLight {
    /// The light straight from the lights, as the radiance of a white surface.
    pub fn direct(&self) -> Vec3 {
        Diffuse::WHITE.radiance(self.direct_irradiance)
    }

    /// The smooth light, as the radiance of a white surface: the mean of all paths.
    pub fn smooth(&self) -> Vec3 {
        (self.smooth_sums[0] + self.smooth_sums[1]) / self.paths.max(1) as f32
    }

    /// Estimated variance of the smooth light of one path, its channels added up. The sums of the
    /// two halves are independent, so the square of their difference is on average the variance of
    /// a path times the number of paths.
    pub(crate) fn path_variance(&self) -> f64 {
        let [even, odd] = self.smooth_sums.map(|sum| f64::from(sum.element_sum()));
        let difference = even - odd;
        difference * difference / f64::from(self.paths.max(1))
    }

    /// All light together, as the radiance of a white surface.
    pub fn total(&self) -> Vec3 {
        self.direct() + self.smooth()
    }

    /// The radiance that a surface of this albedo reflects.
    pub fn reflected(&self, albedo: Vec3) -> Vec3 {
        Diffuse { albedo }.radiance(self.direct_irradiance) + albedo * self.smooth()
    }
}

/// How the light of a point is traced.
#[derive(Clone, Copy)]
pub struct LightSettings<'a> {
    /// Samples and bounces.
    pub trace: TraceSettings,
    /// Where the paths of smooth light may end; `None` traces them on, without bias.
    pub cache: Option<&'a dyn CachedLight>,
    /// Size of the pixel on the surface, scene units.
    pub footprint: f32,
    /// Irradiance straight from the lights, where it is known.
    pub direct: Option<Vec3>,
}

impl From<TraceSettings> for LightSettings<'_> {
    fn from(trace: TraceSettings) -> Self {
        Self { trace, cache: None, footprint: 0.0, direct: None }
    }
}

impl LightSettings<'_> {
    /// What the paths of smooth light are traced with, of which there are `samples`.
    pub(crate) fn smooth(&self, samples: u32) -> SmoothSettings<'_> {
        let Self { trace, cache, footprint, .. } = *self;
        SmoothSettings { bounces: trace.bounces, cache, footprint, samples, finds_near: false }
    }
}

impl Tracer {
    /// Returns the emitted plus diffusely reflected radiance of a surface point, on the viewer's
    /// side.
    ///
    /// `share` (0..1) is how much of the pixel the point covers: samples are spent in proportion,
    /// at least one per light and one path.
    pub fn diffuse_radiance(
        &self,
        point: &SurfacePoint,
        share: f32,
        settings: &LightSettings<'_>,
        seed: impl Into<PointSeed>,
        rays: &mut RayCounts,
    ) -> Vec3 {
        let light = self.arriving_light(point, share, settings, seed.into(), rays);
        point.emission(self.scene()) + light.reflected(point.albedo(self.scene()))
    }

    /// Returns the light that arrives at a surface point, which references store. For a black
    /// surface no ray is traced, and its light is zero.
    pub(crate) fn arriving_light(
        &self,
        point: &SurfacePoint,
        share: f32,
        settings: &LightSettings<'_>,
        seed: PointSeed,
        rays: &mut RayCounts,
    ) -> ArrivingLight {
        self.light_of_samples(point, 0..settings.trace.samples_for(share), settings, seed, rays)
    }

    /// Returns the light that some of a point's samples bring. For a black surface no ray is
    /// traced, and its light is zero.
    ///
    /// Paths continue the sequence of the point. The samples of a light are a lattice with a random
    /// shift of its own in each call, the next point of a sequence: each mean is unbiased, so the
    /// mean of several calls, weighted by their samples, is as well.
    pub(crate) fn light_of_samples(
        &self,
        point: &SurfacePoint,
        samples: Range<u32>,
        settings: &LightSettings<'_>,
        seed: PointSeed,
        rays: &mut RayCounts,
    ) -> ArrivingLight {
        if point.is_black(self.scene()) {
            return ArrivingLight::default();
        }
        let (trace, count) = (&settings.trace, samples.end - samples.start);
        let direct_irradiance = match samples.start {
            _ if let Some(known) = settings.direct => known,
            0 => self.direct_irradiance(point, count, trace, seed, rays),
            start => {
                let shift = |light| seed.sequence.pair(start, LATER.wrapping_add(light));
                self.irradiance_of(kinds_of(trace), point, count, shift, rays)
            }
        };
        if trace.bounces == 0 {
            return ArrivingLight { direct_irradiance, ..ArrivingLight::default() };
        }
        let smooth = settings.smooth(samples.end);
        let smooth_sums = self.smooth_light(point, samples, seed.sequence, smooth, rays);
        ArrivingLight { direct_irradiance, smooth_sums, paths: count }
    }

    /// Returns the light that arrives at a small sensor in free space, which faces a unit vector.
    /// `position` is in scene space. Paths end in no cells: the mean over seeds is unbiased.
    pub(crate) fn light_at_sensor(
        &self,
        (position, facing): (Vec3, Vec3),
        trace: &TraceSettings,
        seed: PointSeed,
        rays: &mut RayCounts,
    ) -> ArrivingLight {
        let point = SurfacePoint::sensor(position, facing);
        let direct = |kinds, rays: &mut RayCounts| {
            self.irradiance_of(kinds, &point, trace.samples, |light| seed.key.with(light).pair(), rays)
        };
        if trace.bounces == 0 {
            let direct_irradiance = direct(LightKinds::All, rays);
            return ArrivingLight { direct_irradiance, ..ArrivingLight::default() };
        }
        // No picture shares the light of a sensor, so paths may find the lamps next to it.
        let direct_irradiance = direct(LightKinds::FarButSky, rays);
        let settings = LightSettings::from(*trace);
        let smooth = SmoothSettings { finds_near: true, ..settings.smooth(trace.samples) };
        let smooth_sums = self.smooth_light(&point, 0..trace.samples, seed.sequence, smooth, rays);
        ArrivingLight { direct_irradiance, smooth_sums, paths: trace.samples }
    }

    /// Returns the irradiance straight from the lights, without the sky where paths find it.
    pub(crate) fn direct_irradiance(
        &self,
        point: &SurfacePoint,
        samples: u32,
        trace: &TraceSettings,
        seed: PointSeed,
        rays: &mut RayCounts,
    ) -> Vec3 {
        self.irradiance_of(kinds_of(trace), point, samples, |light| seed.key.with(light).pair(), rays)
    }
}

/// The lights that shadow rays find: all but the sky where paths find it.
pub(super) fn kinds_of(trace: &TraceSettings) -> LightKinds {
    if trace.bounces > 0 { LightKinds::AllButSky } else { LightKinds::All }
}
