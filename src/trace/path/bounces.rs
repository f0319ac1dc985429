//! Smooth light: what arrives from the sky and by way of other diffuse surfaces, path traced.

use super::cached_light::{CachedLight, Reader};
use super::dimension::{DIRECTION, LIGHT, ROULETTE};
use crate::bsdf::Diffuse;
use crate::math::{Ray, sequence::Sequence};
use crate::trace::lights::{LightKinds, LobeRay};
use crate::trace::{RayCounts, SurfacePoint, Tracer};
use glam::Vec3;
use std::ops::{ControlFlow, Range};

/// Number of mirrors and panes in a row after which a path ends.
const MAX_CHAIN: u32 = 64;

/// Number of diffuse surfaces after which a path ends, whatever it carries. Russian roulette lets
/// one path in half a million come so far where surfaces absorb nothing, and none elsewhere.
pub const MAX_PATH: u32 = 256;

/// First bounce that Russian roulette may end. In a daylit room and in a court, one over error
/// times seconds was 400 and 132 with 2, against 355 and 127 with 1, and 224 and 130 with 5.
const FIRST_ROULETTE: u32 = 2;

/// Largest probability, 0..1, with which a path continues, so that it ends where surfaces absorb
/// nothing.
const MAX_SURVIVAL: f32 = 0.95;

/// Where a diffusely scattered ray of a path ends.
enum Next {
    /// A surface that scatters diffusely, the length of the way there in scene units, and how lamps
    /// there count.
    Surface(SurfacePoint, f32, Lamps),
    /// The sky, in this direction.
    Sky(Vec3),
    Lost,
}

/// How the emission of a surface counts that a path meets.
#[derive(Clone, Copy)]
pub(super) enum Lamps {
    /// Not at all: shadow rays from the last diffuse surface find it, also through glass.
    Found,
    /// All of it: a mirror has reflected the path since.
    Reflected,
    /// By the densities of both ways: a rough surface has reflected the path since.
    Lobe(LobeRay),
}

/// What the paths of smooth light are traced with.
#[derive(Clone, Copy)]
pub(crate) struct SmoothSettings<'a> {
    /// Diffuse surfaces on the way from the light to the point, at most.
    pub(crate) bounces: u32,
    /// Where a path may end at its first surface; `None` traces it on.
    pub(crate) cache: Option<&'a dyn CachedLight>,
    /// Size of the pixel on the surface, scene units.
    pub(crate) footprint: f32,
    /// Paths of the point, also those of other calls.
    pub(crate) samples: u32,
    /// True where shadow rays at the point leave near lamps to the paths.
    pub(crate) finds_near: bool,
}

impl Tracer {
    /// Sums the light of some samples of a point's sequence: light from the sky, straight or by way
    /// of up to `bounces` diffuse surfaces, and light of the other sources by way of one surface at
    /// least. Each is the radiance of a white surface.
    ///
    /// Returns the sums of the samples with even and with odd numbers.
    pub(crate) fn smooth_light(
        &self,
        point: &SurfacePoint,
        samples: Range<u32>,
        sequence: Sequence,
        settings: SmoothSettings<'_>,
        rays: &mut RayCounts,
    ) -> [Vec3; 2] {
        let mut sums = [Vec3::ZERO; 2];
        for sample in samples {
            let path = Path { tracer: self, sequence, sample, settings, samples_lamps: true };
            sums[(sample & 1) as usize] += path.radiance(point, None, rays);
        }
        sums
    }

    /// The radiance that smooth light brings to a point from one direction, a unit vector on the
    /// lit side, by one sample of a sequence.
    pub(crate) fn smooth_light_along(
        &self,
        (point, direction): (&SurfacePoint, Vec3),
        (sequence, sample): (Sequence, u32),
        settings: SmoothSettings<'_>,
        rays: &mut RayCounts,
    ) -> Vec3 {
        Path { tracer: self, sequence, sample, settings, samples_lamps: true }.radiance(
            point,
            Some(direction),
            rays,
        )
    }
}

/// A place where a path of [`Tracer::follow_path`] arrives.
pub(crate) enum PathStop {
    /// A surface that scatters diffusely.
    Surface {
        /// The point.
        point: SurfacePoint,
        /// Length of the way from the last such surface, scene units.
        length: f32,
        /// True where a mirror or a pane reflected the path on that way.
        was_reflected: bool,
        /// Share (0..1) of the surface's emission that counts here, because no shadow ray finds it.
        emission_share: f32,
    },
    /// A rough surface on the way to the next stop, which scatters light straight from this light,
    /// an index into those of the scene. The share is all of the radiance.
    Lamp(u32),
    /// The sky, in this direction.
    Sky(Vec3),
}

impl Tracer {
    /// Follows one path of a point over up to `bounces` diffuse surfaces, with the random numbers
    /// of [`Self::smooth_light`]. `visit` is given each stop, and the share of the radiance that
    /// leaves it towards the path that arrives at the point, as radiance of a white surface; it may
    /// end the path. Without `samples_lamps`, rough surfaces find lamps by the path alone, and no
    /// other lights. `finds_near` is [`SmoothSettings::finds_near`].
    pub(crate) fn follow_path(
        &self,
        start: &SurfacePoint,
        (sequence, sample): (Sequence, u32),
        (bounces, samples_lamps, finds_near): (u32, bool, bool),
        rays: &mut RayCounts,
        mut visit: impl FnMut(&PathStop, Vec3, &mut RayCounts) -> ControlFlow<()>,
    ) {
        let settings = SmoothSettings { bounces, cache: None, footprint: 0.0, samples: 1, finds_near };
        let path = Path { tracer: self, sequence, sample, settings, samples_lamps };
        let (mut point, mut throughput) = (*start, Vec3::ONE);
        for bounce in 0..bounces.min(MAX_PATH) + 1 {
            if !path.survives(bounce, &mut throughput) {
                return;
            }
            let u = sequence.pair(sample, DIRECTION + bounce);
            let Some(direction) = Diffuse::sample_direction(&point.facing(self.scene()), u) else { return };
            let ray = Ray::new(point.origin_in_front(), direction);
            let mut lit = Vec::new();
            let next = path.next((&point, ray), &mut throughput, bounce, &mut lit, rays);
            for (light, radiance) in lit {
                let _ = visit(&PathStop::Lamp(light), radiance, rays);
            }
            match next {
                Next::Lost => return,
                Next::Sky(direction) => {
                    let _ = visit(&PathStop::Sky(direction), throughput, rays);
                    return;
                }
                Next::Surface(..) if bounce == bounces => return,
                Next::Surface(next, length, lamps) => {
                    let was_reflected = !matches!(lamps, Lamps::Found);
                    let emission_share = path.emission_share(&point, &next, lamps, bounce);
                    let stop = PathStop::Surface { point: next, length, was_reflected, emission_share };
                    if visit(&stop, throughput, rays).is_break() {
                        return;
                    }
                    throughput *= next.albedo(self.scene());
                    point = next;
                }
            }
            if throughput.max_element() <= 0.0 {
                return;
            }
        }
    }
}

/// The lights that shadow rays bring to the vertex after segment `bounce`: without near lamps where
/// the path's next segment may find those.
pub(super) fn kinds_at_vertex(bounce: u32, bounces: u32) -> LightKinds {
    if bounce + 1 < bounces.min(MAX_PATH) { LightKinds::FarButSky } else { LightKinds::AllButSky }
}

/// One path.
pub(super) struct Path<'a> {
    pub(super) tracer: &'a Tracer,
    sequence: Sequence,
    sample: u32,
    pub(super) settings: SmoothSettings<'a>,
    /// True where rough surfaces on the way are lit by samples of the lights.
    pub(super) samples_lamps: bool,
}

impl Path<'_> {
    /// The radiance that the path brings to a white surface, or from its first direction where one
    /// is given.
    fn radiance(&self, start: &SurfacePoint, first: Option<Vec3>, rays: &mut RayCounts) -> Vec3 {
        let scene = self.tracer.scene();
        let bounces = self.settings.bounces.min(MAX_PATH);
        let (mut point, mut throughput, mut radiance) = (*start, Vec3::ONE, Vec3::ZERO);
        // After the last surface only the sky is left to be found.
        let segments = bounces + u32::from(scene.sky.is_some());
        for bounce in 0..segments {
            if !self.survives(bounce, &mut throughput) {
                return radiance;
            }
            // Follow a diffusely scattered ray to the next diffuse surface.
            let direction = first.filter(|_| bounce == 0).or_else(|| {
                let u = self.sequence.pair(self.sample, DIRECTION + bounce);
                Diffuse::sample_direction(&point.facing(scene), u)
            });
            let Some(direction) = direction else { return radiance };
            let ray = Ray::new(point.origin_in_front(), direction);
            let mut lit = Vec::new();
            let next = self.next((&point, ray), &mut throughput, bounce, &mut lit, rays);
            for (_, light) in lit {
                radiance += light;
            }
            let (next, length, lamps) = match next {
                Next::Surface(next, length, lamps) => (next, length, lamps),
                // Shadow rays bring the suns of a sky picture.
                Next::Sky(direction) => return radiance + throughput * self.tracer.diffuse_sky(direction),
                Next::Lost => return radiance,
            };
            if bounce == bounces {
                return radiance;
            }
            // No shadow ray finds a light by way of a mirror, so its emission counts here.
            let share = self.emission_share(&point, &next, lamps, bounce);
            if share > 0.0 {
                radiance += throughput * (next.emission(scene) * share);
            }
            // The weight of a diffuse sample is the albedo.
            throughput *= next.albedo(scene);
            if throughput.max_element() <= 0.0 {
                return radiance;
            }
            // End in light that is known there, or add what arrives there straight from the lights.
            if bounce == 0
                && let Some(cache) = self.settings.cache
                && let Some(light) = cache.light_at(self.tracer, &next, &self.reader(length))
            {
                return radiance + throughput * light;
            }
            let kinds = kinds_at_vertex(bounce, bounces);
            let irradiance = self.lights(&next, kinds, bounce, rays);
            radiance += Diffuse { albedo: throughput }.radiance(irradiance);
            point = next;
        }
        rays.bounded += u64::from(self.settings.bounces > MAX_PATH);
        radiance
    }

    fn reader(&self, length: f32) -> Reader {
        Reader { length, footprint: self.settings.footprint, samples: self.settings.samples }
    }

    /// Russian roulette: true where the path continues, with its throughput raised accordingly.
    fn survives(&self, bounce: u32, throughput: &mut Vec3) -> bool {
        if bounce < FIRST_ROULETTE {
            return true;
        }
        let survival = throughput.max_element().min(MAX_SURVIVAL);
        *throughput /= survival;
        self.sequence.pair(self.sample, ROULETTE + bounce)[0] < survival
    }

    /// The irradiance at a vertex that arrives straight from some kinds of lights.
    fn lights(&self, point: &SurfacePoint, kinds: LightKinds, bounce: u32, rays: &mut RayCounts) -> Vec3 {
        let first = LIGHT + (bounce << 16);
        let shift = |light| self.sequence.pair(self.sample, first.wrapping_add(light));
        self.tracer.irradiance_of(kinds, point, 1, shift, rays)
    }

    /// Share (0..1) of a surface's emission that counts at the end of a segment from `vertex`.
    fn emission_share(
        &self,
        vertex: &SurfacePoint,
        surface: &SurfacePoint,
        lamps: Lamps,
        bounce: u32,
    ) -> f32 {
        let finds_near = bounce > 0 || self.settings.finds_near;
        match lamps {
            Lamps::Found if finds_near && self.tracer.is_lamp_near(vertex, surface) => 1.0,
            Lamps::Found => 0.0,
            Lamps::Reflected => 1.0,
            Lamps::Lobe(lobe) => self.tracer.lamp_share(&lobe, surface),
        }
    }

    /// Follows a ray from a vertex to the next point that scatters diffusely, through mirrors,
    /// glass and rough surfaces on the way. At a surface with several lobes one is chosen at
    /// random, by the share of light that it carries. Appends to `lit` what rough surfaces scatter
    /// straight from lights, with their indices.
    fn next(
        &self,
        (vertex, mut ray): (&SurfacePoint, Ray),
        throughput: &mut Vec3,
        bounce: u32,
        lit: &mut Vec<(u32, Vec3)>,
        rays: &mut RayCounts,
    ) -> Next {
        let tracer = self.tracer;
        let (mut lamps, mut length) = (Lamps::Found, 0.0);
        for link in 0..MAX_CHAIN {
            rays.indirect += 1;
            let Some(hit) = tracer.closest(&ray) else {
                return Next::Sky(ray.direction);
            };
            let point = tracer.surface(&ray, &hit);
            // Directions are of unit length, so `t` is a distance.
            length += hit.t;
            if !tracer.is_view_dependent(&point) {
                return Next::Surface(point, length, lamps);
            }
            // Choose between the diffuse lobe and the other.
            let key = self.sequence.key(self.sample).with(bounce).with(link);
            let [random_branch, random_lobe] = key.pair();
            let continuations = tracer.scatter_of(&self.material(&point), &point, ray.direction, key);
            let diffuse = point.albedo(tracer.scene()).max_element();
            // A black base with a lobe can emit, and no path ends there.
            if diffuse <= 0.0
                && bounce < self.settings.bounces.min(MAX_PATH)
                && let Some(light) = tracer.scene().lamp_of_triangle(point.triangle)
            {
                let share = self.emission_share(vertex, &point, lamps, bounce);
                lit.push((light, *throughput * point.emission(tracer.scene()) * share));
            }
            let of_both = diffuse + self.weight_of_lobe(&point, &ray, &continuations);
            let scatters = if diffuse > 0.0 { diffuse / of_both } else { 0.0 };
            if random_lobe < scatters {
                *throughput /= scatters;
                return Next::Surface(point, length, lamps);
            }
            // Light the rough lobe, and choose one of the other lobe's continuations.
            let chosen = 1.0 - scatters;
            if self.lights_lobe(&point, bounce) {
                self.light_lobe(&point, ray.direction, (*throughput / chosen, key), lit, rays);
            }
            let Some(next) = continuations.choose(random_branch) else { return Next::Lost };
            lamps = self.lamps_after(&point, &ray, &next, bounce, lamps);
            *throughput *= next.weight / chosen;
            ray = point.scattered_ray(&next);
        }
        Next::Lost
    }
}
