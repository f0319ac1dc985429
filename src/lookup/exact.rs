//! Completes the pixels that the look-up left open: mirrors and glass, guesses, and surfaces that
//! no reference saw.

use super::policy::{HYSTERESIS, LookupQuality, MAX_POINTS_PER_PIXEL, OTHER_SIDE, is_bad_guess};
use super::{CachedLight, LookupSet, PointCache, SurfaceKey, TracedPoint};
use crate::bsdf::Diffuse;
use crate::camera::View;
use crate::math::{Ray, key::Key, sequence::PointSeed};
use crate::trace::{Hit, LightSettings, PixelTrace, RayCounts, SurfacePoint, TraceSettings, Tracer};
use glam::Vec3;
use std::f32::consts::PI;
use std::ops::AddAssign;

/// Rays traced and points to cache, summed over pixels.
#[derive(Debug, Default)]
pub(crate) struct Tally {
    /// Rays traced.
    pub(crate) rays: RayCounts,
    /// Points whose light was traced, for the cache of the next frames.
    pub(crate) points: Vec<TracedPoint>,
}

impl AddAssign for Tally {
    fn add_assign(&mut self, mut other: Self) {
        self.rays += other.rays;
        self.points.append(&mut other.points);
    }
}

/// Finishes the pixels that the look-up left open: specular, unseen and uncertain ones.
#[derive(Clone, Copy)]
pub(crate) struct PixelResolver<'a> {
    pub(crate) tracer: &'a Tracer,
    pub(crate) lookup: &'a LookupSet<'a>,
    pub(crate) view: &'a View,
    /// Light traced at single points in earlier frames.
    pub(crate) points: &'a PointCache,
    pub(crate) trace: TraceSettings,
    pub(crate) quality: LookupQuality,
}

/// A pixel's diffuse radiance by the look-up, whose direct light is a guess.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Guess {
    /// All of it.
    pub(crate) radiance: Vec3,
    /// The part that is no guess: emission and reflected smooth light.
    pub(crate) certain: Vec3,
    /// Irradiance straight from the lights, as the pixels around have it, where they have the same.
    pub(crate) between: Option<Vec3>,
}

/// The outcome of checking a guess.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CheckedPixel {
    pub(crate) radiance: Vec3,
    /// Irradiance straight from the lights, traced here or nearby.
    pub(crate) irradiance: Option<Vec3>,
    /// True where traced light replaced the guess.
    pub(crate) is_traced: bool,
}

/// Light traced at a point.
struct Traced {
    /// Light straight from the lights.
    light: Vec3,
    /// Smooth light, where it was traced.
    smooth: Option<Vec3>,
    replaced_guess: bool,
}

/// The end of a path from a pixel to a surface point.
struct PathEnd {
    pixel: u32,
    /// Length of the path, scene units.
    distance: f32,
    /// The share of the pixel's radiance that the point contributes, 0..1.
    share: f32,
    /// Key of the point's random numbers.
    key: Key,
}

/// How the light of a tilted surface is traced where a path from a pixel ends.
pub(super) struct ReliefEnd {
    /// Samples of each light, and paths.
    pub(super) samples: u32,
    /// Size of the pixel on the surface, scene units.
    pub(super) footprint: f32,
    pub(super) seed: PointSeed,
}

impl PixelResolver<'_> {
    /// The radiance that a pixel's mirror or glass shows.
    pub(crate) fn resolve_specular(&self, pixel: u32, triangle: u32, tally: &mut Tally) -> Vec3 {
        let (ray, Some(hit)) = self.hit(pixel, triangle) else { return Vec3::ZERO };
        self.specular(&self.tracer.surface(&ray, &hit), &ray, &hit, pixel, tally)
    }

    /// The light that references know at a point seen in a mirror or through glass, at a distance
    /// along the path to it.
    pub(crate) fn known_light(&self, point: &SurfacePoint, distance: f32) -> Option<Vec3> {
        self.lookup
            .light_at(&self.key_at(point, distance), point.triangle)
            .map(|found| found.light + found.smooth)
    }

    /// Shades a pixel that no reference knows. What its mirror or glass shows is looked up.
    pub(crate) fn shade_unseen(&self, pixel: u32, triangle: u32, tally: &mut Tally) -> PixelTrace {
        let resolver = Self { trace: self.quality.unseen_trace(&self.trace), ..*self };
        let (ray, hit) = self.hit(pixel, triangle);
        let trace = resolver.trace;
        let seed = PointSeed::of_pixel(trace.seed, pixel, self.view.size[0], trace.samples);
        let footprint = hit.map_or(0.0, |hit| self.view.footprint(ray.direction, hit.t));
        let settings = self.lookup.light_settings(&trace, footprint);
        let held = hit.filter(|_| self.lookup.has_preview()).and_then(|hit| {
            self.held_irradiance(&self.tracer.surface(&ray, &hit), length(&ray, &hit), trace.samples)
        });
        let settings = LightSettings { direct: held, ..settings };
        let (mut traced, point) = self.tracer.shade_hit((&ray, true), hit, &settings, seed, &mut tally.rays);
        if let (Some(hit), Some(point)) = (hit, point) {
            if point.is_tilted() {
                let end = ReliefEnd { samples: trace.samples, footprint, seed };
                traced.radiance = resolver.lit_relief(&point, traced.light.smooth(), &end, tally);
            }
            traced.radiance += resolver.specular(&point, &ray, &hit, pixel, tally);
        }
        traced
    }

    /// Compares a guess of a pixel's direct light with light traced there. Smooth light is kept as
    /// it was looked up.
    pub(crate) fn check_guess(
        &self,
        pixel: u32,
        triangle: u32,
        guess: Guess,
        tally: &mut Tally,
    ) -> CheckedPixel {
        let (ray, Some(hit)) = self.hit(pixel, triangle) else {
            return CheckedPixel { radiance: guess.radiance, irradiance: None, is_traced: false };
        };
        let point = self.tracer.surface(&ray, &hit);
        if point.is_tilted() {
            let radiance = self.relief_of_pixel((pixel, &guess), &point, (&ray, &hit), tally);
            return CheckedPixel { radiance, irradiance: None, is_traced: true };
        }
        let key = Key::of_pixel(self.trace.seed, pixel);
        let end = PathEnd { pixel, distance: length(&ray, &hit), share: 1.0, key };
        let held = || self.held_irradiance(&point, end.distance, self.trace.samples_for(end.share));
        let mut diffuse = match guess.between.or_else(held) {
            Some(irradiance) => {
                let lit =
                    guess.certain + Diffuse { albedo: self.tracer.albedo_of(&point) }.radiance(irradiance);
                self.better(guess.radiance, (lit, irradiance), 1.0)
            }
            None => self.check_point(guess, &point, &end, tally),
        };
        if diffuse.is_traced && self.is_elsewhere(guess, diffuse.radiance) {
            diffuse.radiance += self.smooth_instead(guess, &point, &end, tally);
        }
        let specular = self.specular(&point, &ray, &hit, pixel, tally);
        CheckedPixel { radiance: diffuse.radiance + specular, ..diffuse }
    }

    /// True where direct light is so far from the guess that the light was looked up at the other
    /// side of an edge, and the smooth light with it.
    fn is_elsewhere(&self, guess: Guess, traced: Vec3) -> bool {
        let direct = guess.radiance - guess.certain;
        let left = (traced - guess.certain).max_element();
        self.trace.bounces > 0 && left < OTHER_SIDE * direct.max_element()
    }

    /// What traced smooth light adds to a pixel in place of the looked-up.
    fn smooth_instead(&self, guess: Guess, point: &SurfacePoint, end: &PathEnd, tally: &mut Tally) -> Vec3 {
        let settings = self.lookup.light_settings(&self.trace, self.key_at(point, end.distance).footprint);
        let (samples, seed) = (self.trace.samples.max(1), PointSeed::from(end.key));
        let smooth = settings.smooth(samples);
        let sums = self.tracer.smooth_light(point, 0..samples, seed.sequence, smooth, &mut tally.rays);
        let light = (sums[0] + sums[1]) / samples as f32;
        self.reflected(point, light) - guess.certain
    }

    /// The primary ray of a pixel, and its hit with the triangle that the pixel is known to show.
    fn hit(&self, pixel: u32, triangle: u32) -> (Ray, Option<Hit>) {
        let ray = Tracer::primary_ray(self.view, pixel);
        (ray, self.tracer.hit_on_triangle(&ray, triangle))
    }

    /// The specular radiance of a pixel's first surface, with light looked up at every point that
    /// it reflects or lets through.
    pub(super) fn specular(
        &self,
        point: &SurfacePoint,
        ray: &Ray,
        hit: &Hit,
        pixel: u32,
        tally: &mut Tally,
    ) -> Vec3 {
        let tracer = self.tracer;
        if tracer.shows_light() || !tracer.is_view_dependent(point) {
            return Vec3::ZERO;
        }
        let samples = self.quality.unseen_trace(&self.trace).samples;
        let seed = PointSeed::of_pixel(self.trace.seed, pixel, self.view.size[0], samples);
        let distance = length(ray, hit);
        let max_points = tally.points.len() + MAX_POINTS_PER_PIXEL;
        let mut rays = RayCounts::default();
        let (radiance, _) =
            tracer.follow_specular(point, ray.direction, (seed, samples), &mut rays, |next, vertex| {
                let (share, key) = (vertex.share, vertex.key);
                let end = PathEnd { pixel, distance: distance + vertex.length, share, key };
                let radiance = self.diffuse(next, &end, tally);
                tally.points.truncate(max_points);
                radiance
            });
        tally.rays += rays;
        radiance
    }

    /// The diffuse radiance of a point seen in a mirror or through glass.
    fn diffuse(&self, point: &SurfacePoint, end: &PathEnd, tally: &mut Tally) -> Vec3 {
        if self.tracer.albedo_of(point) == Vec3::ZERO {
            return self.emission(point);
        }
        let key = self.key_at(point, end.distance);
        if point.is_tilted() {
            return self.relief_in_mirror(point, (&key, end.share), end.key.into(), tally);
        }
        let found = match self.quality.checks_guesses {
            true => self.lookup.light_at(&key, point.triangle),
            false => self.lookup.unchecked_light_at(self.tracer, &key, point.triangle),
        };
        match found {
            Some(found) if found.is_guess => {
                let certain = self.reflected(point, found.smooth);
                let radiance = self.reflected(point, found.light + found.smooth);
                self.check_point(Guess { radiance, certain, between: None }, point, end, tally).radiance
            }
            Some(found) => self.reflected(point, found.light + found.smooth),
            None => self.cached_or_traced(point, end, tally),
        }
    }

    /// The diffuse radiance of a point that no reference knows, traced once for all frames.
    fn cached_or_traced(&self, point: &SurfacePoint, end: &PathEnd, tally: &mut Tally) -> Vec3 {
        let samples = self.trace.samples_for(end.share);
        let near = self.key_at(point, end.distance);
        let all_light = |cached: CachedLight| Some(cached.light + cached.smooth?);
        match self.points.find(&near, samples) {
            Some(cached) if let Some(light) = all_light(cached) => {
                if !cached.is_at_edge {
                    return self.reflected(point, light);
                }
                let exact = self.points.find(&near.exact(), samples);
                match exact.and_then(all_light) {
                    Some(light) => self.reflected(point, light),
                    None => self.trace_unknown(point, end, tally, near.exact()),
                }
            }
            _ => self.trace_unknown(point, end, tally, near),
        }
    }

    /// Checks the guessed diffuse radiance of a point. Light traced nearby can confirm the guess;
    /// only light traced at the same point replaces it, because guesses are bad at the edges of
    /// shadows. The exact key is looked up last: it is stored in addition to the near one, and each
    /// look-up may be a cache miss.
    fn check_point(
        &self,
        guess: Guess,
        point: &SurfacePoint,
        end: &PathEnd,
        tally: &mut Tally,
    ) -> CheckedPixel {
        let albedo = self.tracer.albedo_of(point);
        let lit = |light: Vec3| (guess.certain + albedo * light, light * PI);
        let samples = self.trace.samples_for(end.share);
        let key = self.key_at(point, end.distance);
        let (near, exact) = (key.around(), key.exact());
        let mut trace = |keys: &[SurfaceKey]| {
            let traced = self.trace_guessed(point, end, tally, keys, guess);
            self.better(guess.radiance, traced, 1.0)
        };
        let Some(cached) = self.points.find(&near, samples) else { return trace(&[near, exact]) };
        let most = if cached.replaced_guess { 1.0 / HYSTERESIS } else { 1.0 };
        let near_light = lit(cached.light);
        if !cached.is_at_edge && !self.is_bad(guess.radiance, near_light.0, most) {
            return CheckedPixel {
                radiance: guess.radiance,
                irradiance: Some(near_light.1),
                is_traced: false,
            };
        }
        match self.points.find(&exact, samples) {
            Some(cached) => {
                let most = if cached.replaced_guess { 1.0 / HYSTERESIS } else { HYSTERESIS };
                self.better(guess.radiance, lit(cached.light), most)
            }
            None => trace(&[exact]),
        }
    }

    /// Traces all light of a point that no reference knows, stores it under `key`, and returns the
    /// point's diffuse radiance.
    fn trace_unknown(&self, point: &SurfacePoint, end: &PathEnd, tally: &mut Tally, key: SurfaceKey) -> Vec3 {
        let footprint = self.key_at(point, end.distance).footprint;
        let direct = self.held_irradiance(point, end.distance, self.trace.samples_for(end.share));
        let settings = LightSettings { direct, ..self.lookup.light_settings(&self.trace, footprint) };
        let rays = &mut tally.rays;
        let light = self.tracer.arriving_light(point, end.share, &settings, end.key.into(), rays);
        let traced = Traced { light: light.direct(), smooth: Some(light.smooth()), replaced_guess: false };
        self.store(point, end, tally, &[key], traced);
        self.emission(point) + light.reflected(self.tracer.albedo_of(point))
    }

    /// Traces the direct light of a point where it was guessed, and stores it under all `keys`,
    /// with a note whether it replaces the guess. Returns the diffuse radiance with that light, and
    /// the irradiance.
    fn trace_guessed(
        &self,
        point: &SurfacePoint,
        end: &PathEnd,
        tally: &mut Tally,
        keys: &[SurfaceKey],
        guess: Guess,
    ) -> (Vec3, Vec3) {
        let (samples, rays) = (self.trace.samples_for(end.share), &mut tally.rays);
        let irradiance = self.tracer.direct_irradiance(point, samples, &self.trace, end.key.into(), rays);
        let albedo = self.tracer.albedo_of(point);
        let radiance = guess.certain + Diffuse { albedo }.radiance(irradiance);
        let replaced_guess = self.is_bad(guess.radiance, radiance, 1.0);
        let light = Diffuse::WHITE.radiance(irradiance);
        let smooth = (self.trace.bounces == 0).then_some(Vec3::ZERO);
        self.store(point, end, tally, keys, Traced { light, smooth, replaced_guess });
        (radiance, irradiance)
    }

    /// Stores the light of a point for the next frames. A black surface needs none.
    fn store(&self, point: &SurfacePoint, end: &PathEnd, tally: &mut Tally, keys: &[SurfaceKey], t: Traced) {
        if point.albedo(self.tracer.scene()) == Vec3::ZERO {
            return;
        }
        let (samples, noise) = (self.trace.samples_for(end.share), self.trace.noise());
        let (pixel, near) = (end.pixel, self.key_at(point, end.distance));
        let Traced { light, smooth, replaced_guess } = t;
        tally.points.extend(keys.iter().map(|&key| {
            let is_exact = key.footprint < near.footprint;
            TracedPoint { key, light, smooth, samples, noise, pixel, is_exact, replaced_guess }
        }));
    }

    pub(super) fn emission(&self, point: &SurfacePoint) -> Vec3 {
        self.tracer.emission_of(point)
    }

    /// A point at a distance along the path to it, as look-ups name it.
    pub(super) fn key_at(&self, point: &SurfacePoint, distance: f32) -> SurfaceKey {
        let footprint = self.view.scene_from_pixel.x_axis.length() * distance;
        SurfaceKey { position: point.position, normal: point.geometric_normal, footprint }
    }

    /// True where a guess differs from traced light by more than `most` times [`BAD_GUESS`].
    fn is_bad(&self, guess: Vec3, traced: Vec3, most: f32) -> bool {
        is_bad_guess(guess, traced, most, self.trace.noise())
    }

    /// The guess, or the radiance in traced light of the given irradiance.
    fn better(&self, guess: Vec3, (traced, irradiance): (Vec3, Vec3), most: f32) -> CheckedPixel {
        let is_traced = self.is_bad(guess, traced, most);
        let radiance = if is_traced { traced } else { guess };
        CheckedPixel { radiance, irradiance: Some(irradiance), is_traced }
    }

    /// The diffuse radiance of a point under arriving light.
    pub(super) fn reflected(&self, point: &SurfacePoint, light: Vec3) -> Vec3 {
        self.emission(point) + self.tracer.albedo_of(point) * light
    }
}

/// Length of a primary ray up to its hit, scene units.
fn length(ray: &Ray, hit: &Hit) -> f32 {
    hit.t * ray.direction.length()
}

#[cfg(test)]
mod tests;
