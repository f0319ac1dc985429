//! Pixels whose shading normal a normal map tilts.
//!
//! References hold the light for the normal without the map, which changes slowly over a surface.
//! What differs for the tilted normal is traced in each frame: all direct light, and of the smooth
//! light the difference between the two normals. That difference is small where the tilt is, so few
//! paths, which end in cells, have less noise than all light traced at the point. Mode `fast`
//! leaves the difference out.

use super::SurfaceKey;
use super::exact::{Guess, PixelResolver, ReliefEnd, Tally};
use crate::bsdf::Diffuse;
use crate::math::{Ray, sequence::PointSeed};
use crate::trace::{Hit, SurfacePoint};
use glam::Vec3;

impl PixelResolver<'_> {
    /// The radiance of a pixel whose first surface is tilted, and whose light for the other normal
    /// was looked up.
    pub(super) fn relief_of_pixel(
        &self,
        (pixel, guess): (u32, &Guess),
        point: &SurfacePoint,
        (ray, hit): (&Ray, &Hit),
        tally: &mut Tally,
    ) -> Vec3 {
        let trace = self.quality.unseen_trace(&self.trace);
        let resolver = Self { trace, ..*self };
        let seed = PointSeed::of_pixel(trace.seed, pixel, self.view.size[0], trace.samples);
        let footprint = self.view.footprint(ray.direction, hit.t);
        let end = ReliefEnd { samples: trace.samples_for(1.0), footprint, seed };
        let radiance = guess.certain + resolver.relief(point, &end, tally);
        let specular = self.specular(point, ray, hit, pixel, tally);
        radiance.max(Vec3::ZERO) + specular
    }

    /// The diffuse radiance of a tilted point whose smooth light for the other normal is known.
    pub(super) fn lit_relief(
        &self,
        point: &SurfacePoint,
        smooth: Vec3,
        end: &ReliefEnd,
        tally: &mut Tally,
    ) -> Vec3 {
        (self.reflected(point, smooth) + self.relief(point, end, tally)).max(Vec3::ZERO)
    }

    /// The diffuse radiance of a tilted point seen in a mirror or through glass, which contributes
    /// a share of the pixel.
    pub(super) fn relief_in_mirror(
        &self,
        point: &SurfacePoint,
        (key, share): (&SurfaceKey, f32),
        seed: PointSeed,
        tally: &mut Tally,
    ) -> Vec3 {
        let found = match self.quality.checks_guesses {
            true => self.lookup.light_at(key, point.triangle),
            false => self.lookup.unchecked_light_at(self.tracer, key, point.triangle),
        };
        if let Some(found) = found {
            let end = ReliefEnd { samples: self.trace.samples_for(share), footprint: key.footprint, seed };
            return self.lit_relief(point, found.smooth, &end, tally);
        }
        let settings = self.lookup.light_settings(&self.trace, key.footprint);
        let light = self.tracer.arriving_light(point, share, &settings, seed, &mut tally.rays);
        self.emission(point) + light.reflected(self.tracer.albedo_of(point))
    }

    /// What is reflected of direct light at a tilted point, and of the difference of its smooth
    /// light.
    fn relief(&self, point: &SurfacePoint, end: &ReliefEnd, tally: &mut Tally) -> Vec3 {
        let (tracer, rays) = (self.tracer, &mut tally.rays);
        let irradiance = tracer.direct_irradiance(point, end.samples, &self.trace, end.seed, rays);
        let mut light = Diffuse::WHITE.radiance(irradiance);
        // With the few paths of mode `fast`, the difference would have more noise than it mends.
        if self.trace.bounces > 0 && self.quality.checks_guesses {
            let settings = self.lookup.light_settings(&self.trace, end.footprint);
            let smooth = settings.smooth(end.samples);
            light += tracer.smooth_light_of_tilt(point, end.samples, end.seed.sequence, smooth, rays);
        }
        tracer.albedo_of(point) * light
    }
}
