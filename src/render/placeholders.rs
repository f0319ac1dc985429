//! What a frame that was stopped shows where it is not done.
//!
//! Where the surface is known, only its light is filled from around it (`light_around.rs`), so that
//! textures and edges stay sharp; so is the light of what mirrors and glass show. Where the surface
//! is not known, in mode `paper`, the colour is.

use super::carried_light::{CarriedLight, normal_of};
use super::light_around::{KnownLight, Lie, LightPyramid};
use super::{frame::Frame, worklist::WorkList};
use crate::lookup::PixelResolver;
use crate::math::{Ray, key::Key};
use crate::raster::fill::{Levels, fill_unknown};
use crate::raster::pixel_types::PixelType;
use crate::trace::{Hit, NO_TRIANGLE, PathVertex, PixelTrace, RayCounts, SurfacePoint, Tracer};
use glam::Vec3;
use rayon::prelude::*;

/// Trust in light that was looked up, relative to a traced sample: it is a mean of many.
const TRUST_IN_REFERENCES: f32 = 4.0;

/// Scratch memory, reused between frames.
#[derive(Debug, Default)]
pub(super) struct Placeholders {
    is_known: Vec<bool>,
    found: Vec<Vec3>,
    levels: Levels,
    pyramid: LightPyramid,
}

/// A stopped frame's lists of work.
#[derive(Clone, Copy)]
pub(super) struct Unfinished<'a> {
    pub(super) tracer: &'a Tracer,
    pub(super) unseen: &'a WorkList<PixelTrace>,
    pub(super) secondary: &'a WorkList<Vec3>,
    /// Radiance of the pixels of `secondary` without what their mirror or glass shows.
    pub(super) own: &'a [Vec3],
    /// The light that is known so far; `None` where the hits of the pixels are not.
    pub(super) light: Option<&'a CarriedLight>,
    /// Looks up what mirrors and glass show; `None` in modes that do not.
    pub(super) resolver: Option<PixelResolver<'a>>,
    /// Seed of the frame's random numbers.
    pub(super) seed: u64,
}

impl Placeholders {
    /// Memory per pixel: an upper bound.
    pub(super) const BYTES_PER_PIXEL: usize = 2 * size_of::<Vec3>() + LightPyramid::BYTES_PER_PIXEL + 1;

    /// Gives the pixels that a stop left undone something to show.
    pub(super) fn fill(&mut self, unfinished: &Unfinished<'_>, frame: &mut Frame) {
        if let Some(light) = unfinished.light {
            let size = frame.view.size.map(|s| s as usize);
            let level = level_of(&light.light);
            self.pyramid.gather(size, || known_lights(unfinished.tracer, frame, light, level));
            self.fill_specular(unfinished, frame);
            self.fill_light(unfinished, frame);
        } else {
            for pixel in unfinished.unseen.missing() {
                (frame.disparity[pixel], frame.triangle[pixel]) = (0.0, NO_TRIANGLE);
            }
            self.fill_colour(unfinished, frame);
        }
    }

    fn fill_colour(&mut self, unfinished: &Unfinished<'_>, frame: &mut Frame) {
        let Self { is_known, levels, .. } = self;
        is_known.clear();
        is_known.resize(frame.radiance.len(), true);
        unfinished.unseen.missing().for_each(|pixel| is_known[pixel] = false);
        unfinished.secondary.missing().for_each(|pixel| is_known[pixel] = false);
        fill_unknown(&mut frame.radiance, is_known, frame.view.size[0] as usize, levels);
    }

    /// Mirrors and glass show the surfaces behind, in light that is known there or filled.
    fn fill_specular(&mut self, unfinished: &Unfinished<'_>, frame: &mut Frame) {
        let Unfinished { secondary, own, .. } = *unfinished;
        let filler = Filler { unfinished, frame, pyramid: &self.pyramid };
        let works = secondary.pixels().par_iter().zip(secondary.results()).zip(own);
        let shown = |((&pixel, done), own): ((&u32, &Option<Vec3>), &Vec3)| match done {
            Some(specular) => *own + *specular,
            None => *own + filler.specular(pixel),
        };
        works.map(shown).collect_into_vec(&mut self.found);
        show(secondary.pixels(), &self.found, frame);
    }

    /// Surfaces show their own texture in the light around them: also those that are traced, since
    /// few samples among smooth light would be seen as noise.
    fn fill_light(&mut self, unfinished: &Unfinished<'_>, frame: &mut Frame) {
        let unseen = unfinished.unseen;
        let filler = Filler { unfinished, frame, pyramid: &self.pyramid };
        let works = unseen.pixels().par_iter().zip(unseen.results());
        let shown = |(&pixel, traced): (&u32, &Option<PixelTrace>)| match traced {
            Some(traced) => filler.smoothed(pixel, traced),
            None => filler.lit(pixel),
        };
        works.map(shown).collect_into_vec(&mut self.found);
        show(unseen.pixels(), &self.found, frame);
    }
}

fn show(pixels: &[u32], found: &[Vec3], frame: &mut Frame) {
    for (&pixel, &found) in pixels.iter().zip(found).filter(|(_, found)| found.is_finite()) {
        frame.radiance[pixel as usize] = found;
    }
}

/// Finds what single pixels show.
struct Filler<'a> {
    unfinished: &'a Unfinished<'a>,
    frame: &'a Frame,
    pyramid: &'a LightPyramid,
}

impl Filler<'_> {
    /// The primary ray of a pixel, and its hit.
    fn hit(&self, pixel: u32) -> (Ray, Option<Hit>) {
        let ray = Tracer::primary_ray(&self.frame.view, pixel);
        (ray, self.unfinished.tracer.hit_on_triangle(&ray, self.frame.triangle[pixel as usize]))
    }

    /// The light around a pixel whose surface lies like this.
    fn light_around(&self, pixel: u32, lie: &Lie) -> Option<Vec3> {
        let width = self.frame.view.size[0];
        self.pyramid.around([pixel % width, pixel / width].map(|at| at as usize), lie)
    }

    fn light_of(&self, pixel: u32, ray: &Ray, hit: &Hit) -> Option<Vec3> {
        let normal = facing_normal(self.unfinished.tracer, ray.direction, hit.triangle);
        self.light_around(pixel, &Lie::new(normal, self.frame.disparity[pixel as usize]))
    }

    /// The radiance of a traced pixel, in the light around it instead of its own.
    fn smoothed(&self, pixel: u32, traced: &PixelTrace) -> Vec3 {
        let (ray, Some(hit)) = self.hit(pixel) else { return traced.radiance };
        let own = traced.light.total();
        let light = self.light_of(pixel, &ray, &hit).unwrap_or(own);
        (traced.radiance + self.unfinished.tracer.albedo(&hit, ray.direction) * (light - own)).max(Vec3::ZERO)
    }

    /// The radiance of a pixel that was not traced.
    fn lit(&self, pixel: u32) -> Vec3 {
        let tracer = self.unfinished.tracer;
        let (ray, Some(hit)) = self.hit(pixel) else {
            return tracer.sky(self.frame.view.direction_of_pixel(pixel));
        };
        let light = self.light_of(pixel, &ray, &hit).unwrap_or_default();
        let material = tracer.scene().material_of(hit.triangle);
        let specular = if material.is_view_dependent() { self.specular(pixel) } else { Vec3::ZERO };
        tracer.emission(&hit, ray.direction) + tracer.albedo(&hit, ray.direction) * light + specular
    }

    /// What the mirror or glass of a pixel shows.
    fn specular(&self, pixel: u32) -> Vec3 {
        let Unfinished { tracer, resolver, seed, .. } = self.unfinished;
        let (ray, Some(hit)) = self.hit(pixel) else { return Vec3::ZERO };
        let point = tracer.surface(&ray, &hit);
        let (key, distance) = (Key::of_pixel(*seed, pixel), hit.t * ray.direction.length());
        let shade = |next: &SurfacePoint, vertex: PathVertex| {
            let albedo = next.albedo(tracer.scene());
            let emission = next.emission(tracer.scene());
            if albedo == Vec3::ZERO {
                return emission;
            }
            let length = distance + vertex.length;
            let known = resolver.as_ref().and_then(|resolver| resolver.known_light(next, length));
            let around = || self.light_around(pixel, &Lie::new(next.geometric_normal, length.recip()));
            emission + albedo * known.or_else(around).unwrap_or_default()
        };
        tracer.follow_specular(&point, ray.direction, (key.into(), 1), &mut RayCounts::default(), shade).0
    }
}

/// The level of the known light of a picture: a mean in which a few places close to a lamp do not
/// matter. Zero where none is known.
fn level_of(light: &[Vec3]) -> f32 {
    let known = light.iter().map(|light| light.max_element()).filter(|most| *most >= 0.0 && most.is_finite());
    let (sum, count) =
        known.fold((0.0, 0u32), |(sum, count), most| (sum + f64::from(most).sqrt(), count + 1));
    (sum / f64::from(count.max(1))).powi(2) as f32
}

/// The known light of a picture's pixels, asked from left to right: every other of those that were
/// looked up, and all that were traced. Light far above the level counts less, otherwise a place
/// close to a lamp would dominate its surroundings.
fn known_lights<'a>(
    tracer: &'a Tracer,
    frame: &'a Frame,
    light: &'a CarriedLight,
    level: f32,
) -> impl FnMut(usize) -> Option<(KnownLight, Lie)> + 'a {
    let width = frame.view.size[0] as usize;
    let (mut last, mut normal) = (NO_TRIANGLE, Vec3::Y);
    move |pixel| {
        let (known, triangle) = (light.light[pixel], frame.triangle[pixel]);
        let is_traced = frame.types[pixel] == PixelType::Unseen;
        let is_skipped = !is_traced && (pixel % width + pixel / width) % 2 == 1;
        if is_skipped || triangle == NO_TRIANGLE || !known.is_finite() {
            return None;
        }
        if triangle != last {
            (last, normal) =
                (triangle, facing_normal(tracer, frame.view.direction_of_pixel(pixel as u32), triangle));
        }
        let trust = if is_traced { 1.0 } else { TRUST_IN_REFERENCES };
        let weight = trust * 2.0 / (1.0 + known.max_element() / level.max(f32::MIN_POSITIVE));
        Some((KnownLight { light: known, weight }, Lie::new(normal, frame.disparity[pixel])))
    }
}

/// The normal of a triangle, of any length, on the side that a ray meets.
fn facing_normal(tracer: &Tracer, direction: Vec3, triangle: u32) -> Vec3 {
    let normal = normal_of(tracer.scene(), triangle);
    if normal.dot(direction) > 0.0 { -normal } else { normal }
}
