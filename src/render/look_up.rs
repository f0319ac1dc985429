//! Modes `fast` and `exact`: every pixel shows the surface its primary ray meets, in light looked up in the references.
//!
//! The hits are found for tiles of pixels together, which costs a fifth of a ray each, so nothing has to be guessed about
//! visibility; what the references save is the shading. Where the look-up itself is a guess, `exact` traces a few rays
//! to see whether it is a bad one; `fast` takes it as it is.

use super::finish::{Finish, Spent};
use super::frame::NO_SUPPLIER;
use super::renderer::Renderer;
use super::{Mode, RenderSettings};
use crate::camera::View;
use crate::lookup::{LookupSet, TileLight, TileSurfaces, ViewLookup};
use crate::raster::pixel_types::PixelType;
use crate::reference::ReferenceFrame;
use crate::trace::parallel::{Stop, trace_missing};
use crate::trace::{Hit, TILE_RAYS, TILE_SIDE, TraceSettings, Tracer};
use glam::Vec3;
use rayon::prelude::*;
use std::time::Instant;

/// References that a pixel is averaged over at most: noise falls with their number, time grows.
const REFERENCES_EXACT: usize = 2;
const REFERENCES_FAST: usize = 1;

/// `fast` shades what no reference knows with so many times fewer rays; the next reference has it right.
const UNSEEN_SHARE_FAST: u32 = 4;

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
    /// What the look-up left open, the worst first, so that a frame stopped before its end is as good as it can be: see
    /// `docs/EXPERIMENTS.md`, "Frames cut at the budget".
    pub(super) fn finish_looked_up(
        &mut self,
        tracer: &Tracer,
        settings: &RenderSettings,
        lookup: &LookupSet<'_>,
        stop: Stop<'_>,
    ) {
        for &part in self.rounds() {
            self.shade_unseen(tracer, settings, lookup, part, stop);
            self.look_up_secondary(tracer, settings, lookup, part, stop);
        }
        self.check_uncertain(tracer, settings, lookup, stop);
    }

    /// Hits and look-ups of all pixels; lists what is left. What the frames before traced is entered.
    pub(super) fn resolve(&mut self, tracer: &Tracer, lookup: &LookupSet<'_>, mode: Mode) {
        let start = Instant::now();
        self.knows_hits = true;
        self.frame.stats.references_used = lookup.len();
        let view = self.frame.view;
        let most = if mode == Mode::Fast { REFERENCES_FAST } else { REFERENCES_EXACT };
        let lookup = ViewLookup::new(lookup, &view, most);
        let [width, height] = view.size.map(|s| s as usize);
        let band = (width * TILE_SIDE).max(1);
        self.bands.resize_with(height.div_ceil(TILE_SIDE), Band::default);
        let (points, fresh, frame) = (&mut self.points, &mut self.fresh_points, &mut self.frame);
        let bands = (
            frame.radiance.par_chunks_mut(band),
            frame.disparity.par_chunks_mut(band),
            frame.triangle.par_chunks_mut(band),
            frame.types.par_chunks_mut(band),
            frame.supplier.par_chunks_mut(band),
            self.bands.par_iter_mut(),
        );
        let resolve = || {
            bands.into_par_iter().enumerate().for_each(
                |(row, (radiance, disparity, triangle, types, supplier, band))| {
                    let rows = BandRows { radiance, disparity, triangle, types, supplier };
                    band.resolve(tracer, &view, &lookup, mode, row as u32 * TILE_SIDE as u32, rows);
                },
            );
        };
        // Nothing here asks for points: they are entered meanwhile, by one thread, for their order decides.
        rayon::join(|| points.enter(tracer.epoch(), fresh), resolve);
        self.gather_lists();
        self.frame.stats.rays.primary += view.pixel_count() as u64;
        self.frame.stats.secs.visibility_and_lookup = start.elapsed().as_secs_f64();
    }

    fn gather_lists(&mut self) {
        self.secondary.clear();
        self.unseen.clear();
        self.uncertain.clear();
        for band in &self.bands {
            self.secondary.extend_from_slice(&band.secondary);
            self.unseen.extend_from_slice(&band.unseen);
            self.uncertain.extend_from_slice(&band.uncertain);
        }
        if self.progressive {
            self.spread(|r| &mut r.unseen);
            self.spread(|r| &mut r.secondary);
            self.spread(|r| &mut r.uncertain);
        }
    }

    /// Type 2: one ray a bounce; what it meets is looked up, and shaded only where no reference saw it.
    fn look_up_secondary(
        &mut self,
        tracer: &Tracer,
        settings: &RenderSettings,
        lookup: &LookupSet<'_>,
        part: usize,
        stop: Stop<'_>,
    ) {
        let start = Instant::now();
        let frame = &self.frame;
        let finish = Finish::new(tracer, lookup, &frame.view, &self.points, settings);
        let due = self.secondary.len().div_ceil(part);
        let (list, specular) = (&self.secondary[..due], &mut self.specular[..due]);
        let (spent, complete) = trace_missing(list, specular, stop, |pixel, spent| {
            finish.specular_of(pixel, frame.triangle[pixel as usize], spent)
        });
        self.add_specular();
        self.note(spent, complete);
        self.frame.stats.secs.secondary += start.elapsed().as_secs_f64();
    }

    /// Pixels that no reference knows are shaded.
    fn shade_unseen(
        &mut self,
        tracer: &Tracer,
        settings: &RenderSettings,
        lookup: &LookupSet<'_>,
        part: usize,
        stop: Stop<'_>,
    ) {
        let start = Instant::now();
        let settings = &RenderSettings { trace: shading_of_unseen(settings), ..*settings };
        let frame = &self.frame;
        let finish = Finish::new(tracer, lookup, &frame.view, &self.points, settings);
        let due = self.unseen.len().div_ceil(part);
        let (list, traced) = (&self.unseen[..due], &mut self.traced[..due]);
        let (spent, complete) = trace_missing(list, traced, stop, |pixel, spent| {
            finish.shade(pixel, frame.triangle[pixel as usize], spent)
        });
        for (&pixel, traced) in self.unseen.iter().zip(&self.traced) {
            if let Some(traced) = traced {
                self.frame.radiance[pixel as usize] = traced.radiance;
            }
        }
        self.note(spent, complete);
        self.frame.stats.secs.trace += start.elapsed().as_secs_f64();
    }

    /// Guesses are checked.
    fn check_uncertain(
        &mut self,
        tracer: &Tracer,
        settings: &RenderSettings,
        lookup: &LookupSet<'_>,
        stop: Stop<'_>,
    ) {
        let start = Instant::now();
        let frame = &self.frame;
        let finish = Finish::new(tracer, lookup, &frame.view, &self.points, settings);
        let (spent, complete) = trace_missing(&self.uncertain, &mut self.checked, stop, |pixel, spent| {
            let at = pixel as usize;
            finish.check(pixel, frame.triangle[at], frame.radiance[at], spent)
        });
        for (&pixel, checked) in self.uncertain.iter().zip(&self.checked) {
            if let Some(checked) = checked {
                self.frame.radiance[pixel as usize] = checked.radiance;
                if checked.is_traced {
                    self.frame.supplier[pixel as usize] = NO_SUPPLIER;
                }
            }
        }
        self.note(spent, complete);
        self.frame.stats.secs.trace += start.elapsed().as_secs_f64();
    }

    /// What is traced now serves from the next frame on, so that this one is the same wherever it is stopped.
    fn note(&mut self, mut spent: Spent, complete: bool) {
        self.frame.stats.rays += spent.rays;
        self.frame.stats.is_complete &= complete;
        self.fresh_points.append(&mut spent.points);
    }

    /// What the last looked-up frame lit itself, as a reference, so that no frame after it has to. Only of a frame that is
    /// complete.
    pub(super) fn lit_reference(&self, tracer: &Tracer, settings: &RenderSettings) -> ReferenceFrame {
        let frame = &self.frame;
        let depths = frame.disparity.iter().map(|d| 1.0 / d);
        let hits =
            depths.zip(&frame.triangle).map(|(t, &triangle)| (triangle != u32::MAX).then_some((t, triangle)));
        let lights = self.traced.iter().flatten().map(|t| t.light);
        let (camera, size) = (&frame.camera, frame.view.size);
        let trace = shading_of_unseen(settings);
        ReferenceFrame::from_lit_pixels(tracer, camera, size, &trace, hits, &self.unseen, lights)
    }
}

fn shading_of_unseen(settings: &RenderSettings) -> TraceSettings {
    let fewer = if settings.mode == Mode::Fast { UNSEEN_SHARE_FAST } else { 1 };
    TraceSettings { samples: (settings.trace.samples / fewer).max(1), ..settings.trace }
}

impl Band {
    fn resolve(
        &mut self,
        tracer: &Tracer,
        view: &View,
        lookup: &ViewLookup<'_>,
        mode: Mode,
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
                    let kind = write_pixel(tracer, &seen, &light, ray, at, mode, &mut rows);
                    self.list(kind, y0 * view.size[0] + at as u32);
                }
            }
        }
    }

    fn list(&mut self, kind: PixelType, pixel: u32) {
        match kind {
            PixelType::Secondary => self.secondary.push(pixel),
            PixelType::Unseen => self.unseen.push(pixel),
            PixelType::Uncertain => self.uncertain.push(pixel),
            _ => {}
        }
    }
}

/// Writes what is known of a pixel and returns what is left to do about it.
#[inline(always)]
fn write_pixel(
    tracer: &Tracer,
    seen: &TileSurfaces,
    light: &TileLight,
    ray: usize,
    at: usize,
    mode: Mode,
    rows: &mut BandRows<'_>,
) -> PixelType {
    let triangle = seen.hits.triangle[ray];
    (rows.triangle[at], rows.disparity[at], rows.supplier[at]) =
        (triangle, seen.points.disparity[ray], NO_SUPPLIER);
    let kind = if triangle == u32::MAX {
        rows.radiance[at] = tracer.sky(seen.direction(ray));
        PixelType::Reused
    } else {
        let material = &tracer.scene().materials[seen.material[ray].0 as usize];
        rows.radiance[at] = material.emission;
        let (is_wanted, is_known) = (seen.points.wanted >> ray & 1 == 1, light.known >> ray & 1 == 1);
        if is_known {
            let hit = Hit { t: 0.0, triangle, b1: seen.hits.b1[ray], b2: seen.hits.b2[ray] };
            rows.radiance[at] += tracer.albedo(&hit) * light.at(ray);
            rows.supplier[at] = light.slot[ray];
        }
        if is_wanted && !is_known {
            PixelType::Unseen
        } else if is_known && mode == Mode::Exact && light.is_guess(ray) {
            PixelType::Uncertain
        } else if material.is_view_dependent() {
            PixelType::Secondary
        } else {
            PixelType::Reused
        }
    };
    rows.types[at] = kind;
    kind
}
