//! Mode `exact`: every pixel shows the surface its primary ray meets, in light looked up in the references.
//!
//! The hits are found for tiles of pixels together, which costs a fraction of a ray each, so nothing has to be guessed
//! about visibility; what the references save is the shading.

use super::RenderSettings;
use super::frame::NO_SUPPLIER;
use super::renderer::Renderer;
use crate::camera::View;
use crate::math::hash::Key;
use crate::reference::{LookupSet, TileLight, TileSurfaces, ViewLookup};
use crate::reproject::PixelType;
use crate::trace::parallel::{Stop, trace_pixels};
use crate::trace::{Hit, PixelTrace, RayCounts, SurfacePoint, TILE_RAYS, TILE_SIDE, TraceSettings, Tracer};
use glam::Vec3;
use rayon::prelude::*;
use std::time::Instant;

/// Pixels of which the look-up is a guess are lit with so many times fewer rays. Eight times the variance on a twentieth
/// of the pixels adds less error than the averaging over references and samples takes from the others.
const FEWER_SAMPLES: u32 = 8;

/// What eight rows of pixels leave to do.
#[derive(Debug, Default)]
pub(super) struct Band {
    secondary: Vec<u32>,
    unseen: Vec<u32>,
    uncertain: Vec<u32>,
}

/// The rows of a frame that one band writes.
struct BandRows<'a> {
    radiance: &'a mut [Vec3],
    disparity: &'a mut [f32],
    triangle: &'a mut [u32],
    types: &'a mut [PixelType],
    supplier: &'a mut [u8],
}

impl Renderer {
    pub(super) fn render_exact(
        &mut self,
        tracer: &Tracer,
        settings: &RenderSettings,
        lookup: &LookupSet<'_>,
        stop: Stop<'_>,
    ) {
        let start = Instant::now();
        self.frame.stats.references_used = lookup.len();
        self.resolve(tracer, lookup);
        self.frame.stats.secs.warp = start.elapsed().as_secs_f64();
        self.look_up_secondary(tracer, settings, lookup, stop);
        self.shade_open(tracer, settings, lookup, stop);
    }

    /// Hits and look-ups of all pixels; lists what is left.
    fn resolve(&mut self, tracer: &Tracer, lookup: &LookupSet<'_>) {
        let view = self.frame.view;
        let lookup = ViewLookup::new(lookup, &view);
        let [width, height] = view.size.map(|s| s as usize);
        let band = (width * TILE_SIDE).max(1);
        self.bands.resize_with(height.div_ceil(TILE_SIDE), Band::default);
        let frame = &mut self.frame;
        (
            frame.radiance.par_chunks_mut(band),
            frame.disparity.par_chunks_mut(band),
            frame.triangle.par_chunks_mut(band),
            frame.types.par_chunks_mut(band),
            frame.supplier.par_chunks_mut(band),
            self.bands.par_iter_mut(),
        )
            .into_par_iter()
            .enumerate()
            .for_each(|(row, (radiance, disparity, triangle, types, supplier, band))| {
                let rows = BandRows { radiance, disparity, triangle, types, supplier };
                band.resolve(tracer, &view, &lookup, row as u32 * TILE_SIDE as u32, rows);
            });
        self.secondary.clear();
        self.unseen.clear();
        self.uncertain.clear();
        for band in &self.bands {
            self.secondary.extend_from_slice(&band.secondary);
            self.unseen.extend_from_slice(&band.unseen);
            self.uncertain.extend_from_slice(&band.uncertain);
        }
        self.frame.stats.rays.primary += view.pixel_count() as u64;
    }

    /// Type 2: one ray a bounce; what it meets is looked up, and shaded only where no reference saw it.
    fn look_up_secondary(
        &mut self,
        tracer: &Tracer,
        settings: &RenderSettings,
        lookup: &LookupSet<'_>,
        stop: Stop<'_>,
    ) {
        let start = Instant::now();
        let frame = &self.frame;
        let trace = &settings.trace;
        let (rays, complete) = trace_pixels(&self.secondary, &mut self.specular, stop, |pixel, rays| {
            let Some(point) = known_point(tracer, &frame.view, pixel, frame.triangle[pixel as usize]) else {
                return Vec3::ZERO;
            };
            let direction = frame.view.direction_of_pixel(pixel);
            specular_with_lookup(tracer, lookup, &point, direction, trace, pixel, rays)
        });
        for (&pixel, specular) in self.secondary.iter().zip(&self.specular) {
            self.frame.radiance[pixel as usize] += specular.unwrap_or(Vec3::ZERO);
        }
        self.frame.stats.rays += rays;
        self.frame.stats.is_complete &= complete;
        self.frame.stats.secs.secondary = start.elapsed().as_secs_f64();
    }

    /// Pixels that no reference knows are shaded, those of which the look-up is a guess with few rays.
    fn shade_open(
        &mut self,
        tracer: &Tracer,
        settings: &RenderSettings,
        lookup: &LookupSet<'_>,
        stop: Stop<'_>,
    ) {
        let start = Instant::now();
        for (list, is_guess) in [(&self.unseen, false), (&self.uncertain, true)] {
            let frame = &self.frame;
            let (rays, complete) = trace_pixels(list, &mut self.traced, stop, |pixel, rays| {
                let guess = is_guess.then(|| frame.radiance[pixel as usize]);
                shade_open_pixel(tracer, &frame.view, pixel, frame.triangle[pixel as usize], guess, lookup, &settings.trace, rays)
            });
            for (&pixel, traced) in list.iter().zip(&self.traced) {
                if let Some(traced) = traced {
                    self.frame.radiance[pixel as usize] = traced.radiance;
                }
            }
            self.frame.stats.rays += rays;
            self.frame.stats.is_complete &= complete;
        }
        self.frame.stats.secs.trace = start.elapsed().as_secs_f64();
    }
}

#[allow(clippy::too_many_arguments)]
fn shade_open_pixel(
    tracer: &Tracer,
    view: &View,
    pixel: u32,
    triangle: u32,
    guess: Option<Vec3>,
    lookup: &LookupSet<'_>,
    trace: &TraceSettings,
    rays: &mut RayCounts,
) -> PixelTrace {
    let ray = Tracer::primary_ray(view, pixel);
    let hit = known_hit(tracer, view, pixel, triangle);
    let key = Key::of_pixel(trace.seed, pixel);
    let first = guess.map_or(trace.samples, |_| (trace.samples / 8).max(1));
    let settings = TraceSettings { samples: first, ..*trace };
    let (mut traced, point) = tracer.shade_hit(&ray, hit, &settings, key, rays);
    if let Some(guess) = guess {
        let (a, b) = (traced.radiance, guess);
        let off = (a - b).abs().max_element() / a.max(b).max_element().max(1e-20);
        if off > 0.15 {
            let more = TraceSettings { samples: (trace.samples / 2).max(1), ..*trace };
            let (second, _) = tracer.shade_hit(&ray, hit, &more, key.with(77), rays);
            let w = first as f32 / (first + more.samples) as f32;
            traced.radiance = a * w + second.radiance * (1.0 - w);
        } else {
            traced.radiance = guess;
        }
    }
    if let Some(point) = point.filter(|p| tracer.is_specular(p)) {
        traced.radiance += specular_with_lookup(tracer, lookup, &point, ray.direction, trace, pixel, rays);
    }
    traced
}

/// Where a pixel's ray meets the triangle it is known to see.
fn known_hit(tracer: &Tracer, view: &View, pixel: u32, triangle: u32) -> Option<Hit> {
    tracer.hit_on_triangle(&Tracer::primary_ray(view, pixel), triangle)
}

fn known_point(tracer: &Tracer, view: &View, pixel: u32, triangle: u32) -> Option<SurfacePoint> {
    let ray = Tracer::primary_ray(view, pixel);
    known_hit(tracer, view, pixel, triangle).map(|hit| tracer.surface(&ray, &hit))
}

/// The specular radiance of a point, with the light of all that it mirrors or lets through looked up.
fn specular_with_lookup(
    tracer: &Tracer,
    lookup: &LookupSet<'_>,
    point: &SurfacePoint,
    direction: Vec3,
    settings: &TraceSettings,
    pixel: u32,
    rays: &mut RayCounts,
) -> Vec3 {
    let key = Key::of_pixel(settings.seed, pixel);
    tracer.specular_radiance_by(point, direction, rays, |next, share, number, rays| {
        let scene = tracer.scene();
        let albedo = next.albedo(scene);
        if albedo != Vec3::ZERO
            && let Some(light) = lookup.light_at(next.position, next.geometric_normal, next.triangle)
        {
            return scene.materials[next.material.0 as usize].emission + albedo * light;
        }
        tracer.diffuse_radiance(next, share, settings, Tracer::specular_key(key, number), rays)
    })
}

impl Band {
    fn resolve(
        &mut self,
        tracer: &Tracer,
        view: &View,
        lookup: &ViewLookup<'_>,
        y0: u32,
        mut rows: BandRows<'_>,
    ) {
        self.secondary.clear();
        self.unseen.clear();
        self.uncertain.clear();
        let (mut seen, mut light) = (TileSurfaces::new(view), TileLight::NONE);
        for x0 in (0..view.size[0]).step_by(TILE_SIDE) {
            seen.see(tracer, view, [x0, y0]);
            lookup.gather(&seen.points, &mut light);
            for ray in 0..TILE_RAYS {
                let (x, y) = (x0 + (ray % TILE_SIDE) as u32, (ray / TILE_SIDE) as u32);
                if x < view.size[0] && y0 + y < view.size[1] {
                    let at = (y * view.size[0] + x) as usize;
                    self.write_pixel(tracer, &seen, &light, ray, at, y0 * view.size[0], &mut rows);
                }
            }
        }
    }

    #[inline(always)]
    #[allow(clippy::too_many_arguments)]
    fn write_pixel(
        &mut self,
        tracer: &Tracer,
        seen: &TileSurfaces,
        light: &TileLight,
        ray: usize,
        at: usize,
        first: u32,
        rows: &mut BandRows<'_>,
    ) {
        let triangle = seen.hits.triangle[ray];
        rows.triangle[at] = triangle;
        rows.disparity[at] = seen.points.disparity[ray];
        rows.supplier[at] = NO_SUPPLIER;
        if triangle == u32::MAX {
            rows.radiance[at] = tracer.sky(seen.direction(ray));
            rows.types[at] = PixelType::Reused;
            return;
        }
        let material = &tracer.scene().materials[seen.material[ray].0 as usize];
        let (is_wanted, is_known) = (seen.points.wanted >> ray & 1 == 1, light.known >> ray & 1 == 1);
        if is_wanted && !is_known {
            rows.types[at] = PixelType::Unseen;
            self.unseen.push(first + at as u32);
            return;
        }
        let mut radiance = material.emission;
        if is_known {
            let hit = Hit { t: 0.0, triangle, b1: seen.hits.b1[ray], b2: seen.hits.b2[ray] };
            radiance += tracer.albedo(&hit) * light.at(ray);
            rows.supplier[at] = light.slot[ray];
        }
        rows.radiance[at] = radiance;
        rows.types[at] = PixelType::Reused;
        rows.radiance[at] = radiance;
        if is_known && light.is_guess(ray) {
            rows.types[at] = PixelType::Uncertain;
            self.uncertain.push(first + at as u32);
            return;
        }
        if material.is_specular() {
            rows.types[at] = PixelType::Secondary;
            self.secondary.push(first + at as u32);
        }
    }
}
