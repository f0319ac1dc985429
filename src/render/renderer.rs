//! Renders a frame, from the request to the finished picture. In a mode that looks up:
//!
//! 1. `FrameRequest::source` (`request.rs`) finds the references; `look_up` starts a task per band.
//! 2. `BandLookup::fill` (`lookup/band.rs`) traces tiles (`lookup/tile.rs`), looks their light up
//!    (`lookup/view.rs`, `lookup/gather.rs`), and decides each pixel's type in `write_pixel`.
//! 3. Open pixels go to the lists (`worklist.rs`), which `PixelResolver`
//!    (`lookup/exact.rs`) completes.
//! 4. `conclude` fills gaps and counts; `keep_frame` (`walkthrough.rs`) may keep a reference.
//!
//! Mode `paper` warps in step 2 (`warp`, `paper_pixels.rs`).

use super::placeholders::{Placeholders, Unfinished};
use super::request::{FrameRequest, Source};
use super::worklist::{Between, Dispersal, WorkList};
use super::{begin_stage::begin_stage, carried_light::CarriedLight};
use super::{frame::Frame, paper_pixels::WarpedPixels, settings::RenderSettings, shared_light};
use crate::lookup::{
    BandLight, BandLookup, CheckedPixel, Guess, LightBetween, LookupQuality, LookupSet, MAX_POINTS_PER_PIXEL,
    OpenPixels, PointCache, Tally, TracedPoint, TracedPoints, write_surfaces,
};
use crate::raster::pixel_types::{NO_SUPPLIER, PixelType, TypeCounts};
use crate::reference::ReferenceFrame;
use crate::trace::parallel::{NEVER, tile_order};
use crate::trace::{NO_TRIANGLE, PixelTrace, TILE_SIDE, Tracer, VisibilityBuffer};
use crate::warp::WarpBuffer;
use glam::Vec3;
use rayon::prelude::*;
use std::{f32::consts::PI, time::Instant};

/// The parts of the work lists that a progressive frame traces one after the other: the first
/// sixteenth of each list, then the first quarter, then all of it. Otherwise a slow mirror could
/// leave the pixels that no reference knows untouched when the frame is stopped.
const ROUNDS: [usize; 3] = [16, 4, 1];

/// The part of the unseen pixels that is traced even in a frame that is stopped at once, where no
/// light at all is known.
const LEAST: usize = 256;

/// Renders frames. Keeps its buffers from one to the next.
#[derive(Debug, Default)]
pub struct Renderer {
    frame: Frame,
    /// Pixels whose light no reference holds; every pixel where nothing is reused.
    unseen: WorkList<PixelTrace>,
    /// Type 2: what the mirror or glass of a pixel shows.
    secondary: WorkList<Vec3>,
    /// Pixels whose looked-up light is a guess.
    uncertain: WorkList<CheckedPixel>,
    /// Emission and looked-up diffuse radiance of the pixels of `secondary`, to which the light
    /// that their mirror or glass shows is added.
    own: Vec<Vec3>,
    /// Emission and reflected smooth light of the pixels whose direct light is a guess.
    certain: Vec<Vec3>,
    /// The open pixels of each band of rows, before they are collected in the lists.
    open: Vec<OpenPixels>,
    /// Light that earlier frames traced at single points.
    pub(super) points: PointCache,
    /// Points traced in this frame, for the next one.
    fresh_points: Vec<TracedPoint>,
    warped: WarpBuffer,
    /// What every pixel shows, in mode `full` and in modes that look up.
    visible: VisibilityBuffer,
    /// The pixels of a picture of `order_size`, tile by tile.
    order: Vec<u32>,
    order_size: [u32; 2],
    dispersal: Dispersal,
    placeholders: Placeholders,
    carried: CarriedLight,
    /// Irradiance from the lights where this frame traced it or settled a guess, for later guesses.
    between: LightBetween,
    is_progressive: bool,
    /// True in modes that look up, which find the hits of all pixels first.
    looks_up: bool,
    /// True where the surfaces of all pixels are known, though not all of their light.
    shows_surfaces: bool,
}

impl Renderer {
    /// Memory that a frame takes per pixel while it is rendered, work lists included: an upper
    /// bound, so that a size can be refused before memory is allocated.
    pub const BYTES_PER_PIXEL: usize = size_of::<Option<PixelTrace>>() // unseen
        + size_of::<Option<CheckedPixel>>() // secondary or uncertain
        + Placeholders::BYTES_PER_PIXEL + CarriedLight::BYTES_PER_PIXEL + size_of::<Vec3>() // own
        + (MAX_POINTS_PER_PIXEL + 1) * size_of::<TracedPoint>() // fresh points
        + size_of::<u64>() + size_of::<u32>() // warped; visible
        + 7 * size_of::<u32>() // order; secondary, unseen, uncertain, in the lists and in the bands
        + LightBetween::BYTES_PER_PIXEL + size_of::<(u32, Vec3)>() // settled guesses
        + 2 * size_of::<Vec3>() + size_of::<f32>() + size_of::<u32>() + 2; // the frame

    /// The last frame.
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// The last frame, without the renderer.
    pub fn into_frame(self) -> Frame {
        self.frame
    }

    /// The last frame, to be refined or dropped.
    pub(super) fn frame_mut(&mut self) -> &mut Frame {
        &mut self.frame
    }

    /// Forgets the light of earlier frames, so that the next has only its references.
    pub fn forget_points(&mut self) {
        self.points.clear();
        self.fresh_points.clear();
        self.carried.clear();
    }

    /// Sets whether frames may be shown before they are complete. The work is then spread over the
    /// picture, which costs about 5 % because rays are less coherent.
    pub fn set_progressive(&mut self, is_progressive: bool) {
        self.is_progressive = is_progressive;
    }

    /// Renders a frame. Pixels that a stop left undone show an interpolation of what is known
    /// around them, and the frame is not marked complete.
    ///
    /// # Panics
    /// Where a reference to be warped belongs to another epoch.
    pub fn render(&mut self, request: &FrameRequest<'_>) -> &Frame {
        begin_stage!(start, "frame");
        let FrameRequest { tracer, camera, .. } = *request;
        let (source, view) = (request.source(), request.view());
        self.carried.begin(&mut self.frame, tracer.epoch(), self.is_progressive, view.pixel_count());
        self.frame.reset(camera, &view);
        match &source {
            Source::LookUp(lookup, quality) => self.look_up(request, lookup, *quality),
            Source::Warp(references) => self.reproject(tracer, references),
        }
        self.trace_open(request, &source);
        self.conclude(request, &source, start)
    }

    /// Continues the last frame where a stop left it. The request must be the one that it was
    /// rendered from, apart from the stop. A complete frame stays as it is.
    pub fn resume(&mut self, request: &FrameRequest<'_>) -> &Frame {
        begin_stage!(start, "frame, continued");
        self.frame.stats.is_complete = true;
        let source = request.source();
        self.trace_open(request, &source);
        self.conclude(request, &source, start)
    }

    /// Stores traced points now, not in the next frame, which may be due soon.
    pub(super) fn store_points(&mut self, tracer: &Tracer) {
        self.points.insert(tracer.epoch(), &mut self.fresh_points);
    }

    /// Modes `fast` and `exact`: finds the hits of all pixels and looks up their light.
    fn look_up(&mut self, request: &FrameRequest<'_>, lookup: &LookupSet<'_>, quality: LookupQuality) {
        begin_stage!(start, "first hits and look-up");
        let (tracer, trace) = (request.tracer, request.settings.trace);
        (self.looks_up, self.shows_surfaces) = (true, true);
        self.frame.stats.references_used = lookup.len();
        let view = self.frame.view;
        self.points.insert(tracer.epoch(), &mut self.fresh_points);
        self.visible.find(tracer, &view, false);
        let traced = TracedPoints { points: &self.points, trace };
        let band_lookup = BandLookup::new(tracer, &view, &self.visible, lookup, quality, traced);
        self.open.resize_with((view.size[1] as usize).div_ceil(TILE_SIDE), OpenPixels::default);
        self.certain.resize(view.pixel_count(), Vec3::ZERO);
        let in_band = (view.size[0] as usize * TILE_SIDE).max(1);
        let mut known: Vec<&mut [Vec3]> = self.carried.light.chunks_mut(in_band).collect();
        known.resize_with(self.open.len(), Default::default);
        let kept = self.certain.par_chunks_mut(in_band).zip(known);
        let bands = self.frame.par_rows_mut(TILE_SIDE).zip(kept).zip(self.open.par_iter_mut()).enumerate();
        bands.for_each(|(band, ((rows, (certain, known)), open))| {
            band_lookup.fill((band * TILE_SIDE) as u32, rows, BandLight { certain, known }, open);
        });
        self.begin_lists(tracer, Some(lookup));
        self.frame.stats.rays.primary += view.pixel_count() as u64;
        self.frame.stats.secs.visibility_and_lookup = start.elapsed().as_secs_f64();
    }

    /// Mode `paper`: steps 1 to 3 of the paper, with the copying of Type 1. Without references, and
    /// in mode `full`, every pixel is unseen.
    fn reproject(&mut self, tracer: &Tracer, references: &[&ReferenceFrame]) {
        begin_stage!(start, "warp");
        (self.looks_up, self.shows_surfaces) = (false, false);
        self.frame.stats.references_used = references.len();
        self.frame.stats.warped_pixels = references.iter().map(|r| r.view.pixel_count()).sum();
        if references.is_empty() {
            self.visible.find(tracer, &self.frame.view, false);
            self.frame.types.fill(PixelType::Unseen);
            self.frame.supplier.fill(NO_SUPPLIER);
            if self.is_progressive {
                self.show_surfaces(tracer);
            }
        } else {
            self.warped.warp(references, &self.frame.view);
            WarpedPixels { tracer, references, warped: &self.warped }.copy_to(&mut self.frame);
        }
        self.list_open_pixels();
        self.begin_lists(tracer, None);
        if !references.is_empty() {
            self.frame.stats.secs.visibility_and_lookup = start.elapsed().as_secs_f64();
        }
    }

    /// Settles the surfaces of all pixels, so that a frame that is stopped shows them.
    fn show_surfaces(&mut self, tracer: &Tracer) {
        self.shows_surfaces = true;
        let (visible, view) = (&self.visible, self.frame.view);
        let bands = self.frame.par_rows_mut(TILE_SIDE).enumerate();
        bands.for_each(|(band, rows)| {
            write_surfaces(tracer, visible, &view, (band * TILE_SIDE) as u32, rows);
        });
    }

    /// Lists the pixels of Types 2 and 3, tile by tile.
    fn list_open_pixels(&mut self) {
        let size = self.frame.view.size;
        if self.order_size != size {
            (self.order, self.order_size) = (tile_order(size), size);
        }
        self.open.resize_with(1, OpenPixels::default);
        let open = &mut self.open[0];
        open.clear();
        self.order.iter().for_each(|&pixel| open.push(self.frame.types[pixel as usize], pixel));
    }

    /// Collects the open pixels of all bands in the lists. In a progressive frame each sixteenth of
    /// a list is spread over the whole picture, so that a stopped frame is known evenly; not so in
    /// mode `paper`, which completes Type 2 first.
    fn begin_lists(&mut self, tracer: &Tracer, lookup: Option<&LookupSet<'_>>) {
        let Self { unseen, secondary, uncertain, open, dispersal, frame, own, between, carried, .. } = self;
        unseen.begin(open.iter().map(|o| &o.unseen[..]));
        secondary.begin(open.iter().map(|o| &o.secondary[..]));
        uncertain.begin(open.iter().map(|o| &o.uncertain[..]));
        let width = frame.view.size[0];
        if self.is_progressive {
            if self.shows_surfaces {
                carried.find(tracer, frame, unseen.pixels());
                carried.fill((tracer, lookup), frame, unseen.pixels());
            }
            unseen.disperse(dispersal, width, |pixel| carried.is_known(pixel));
        }
        if self.is_progressive && self.looks_up {
            secondary.disperse(dispersal, width, |_| false);
            uncertain.disperse(dispersal, width, |_| false);
        } else {
            uncertain.sort_by_round(dispersal, width);
        }
        if !uncertain.pixels().is_empty() {
            between.begin(frame.view.size);
            for &(pixel, light) in open.iter().flat_map(|o| &o.settled) {
                between.set(pixel, light * PI);
            }
        }
        own.clear();
        own.extend(secondary.pixels().iter().map(|&pixel| frame.radiance[pixel as usize]));
    }

    /// Traces what is open, the pixels with the largest error first, so that a stopped frame is as
    /// good as it can be (`docs/history/LAB_DIARY.md`, "Frames cut at the budget"). Mode `paper`
    /// follows the paper: Type 2, then Type 3.
    fn trace_open(&mut self, request: &FrameRequest<'_>, source: &Source<'_>) {
        if !self.looks_up {
            self.trace_secondary(request, source, 1);
        }
        if self.is_progressive && self.shows_surfaces && self.carried.is_dark() {
            self.trace_unseen(&FrameRequest { stop: NEVER, ..*request }, source, LEAST);
        }
        let rounds: &[usize] = if self.is_progressive { &ROUNDS } else { &[1] };
        for &part in rounds {
            self.trace_unseen(request, source, part);
            if self.looks_up {
                self.trace_secondary(request, source, part);
            }
        }
        self.check_uncertain(request, source);
    }

    /// Type 3: shades the surfaces that no reference knows.
    fn trace_unseen(&mut self, request: &FrameRequest<'_>, source: &Source<'_>, part: usize) {
        begin_stage!(start, "unseen pixels");
        let FrameRequest { tracer, settings, stop, .. } = *request;
        let (frame, visible) = (&self.frame, &self.visible);
        let shows_all = source.warped().is_empty();
        let resolver = source.resolver(request, &frame.view, &self.points);
        let traced = self.unseen.run(part, stop, |pixel, tally: &mut Tally| match &resolver {
            Some(resolver) => resolver.shade_unseen(pixel, frame.triangle[pixel as usize], tally),
            None if shows_all => {
                let hit = visible.hit_of_pixel(tracer, &frame.view, pixel);
                tracer.pixel_of_hit((&frame.view, pixel), hit, &settings.trace, &mut tally.rays)
            }
            None => tracer.pixel(&frame.view, pixel, &settings.trace, &mut tally.rays),
        });
        for (pixel, traced) in self.unseen.done() {
            self.frame.radiance[pixel] = traced.radiance;
            if !self.uncertain.pixels().is_empty() {
                self.between.set(pixel as u32, traced.light.direct_irradiance);
            }
            if !self.shows_surfaces {
                self.frame.disparity[pixel] = traced.disparity();
                self.frame.triangle[pixel] = traced.hit.map_or(NO_TRIANGLE, |hit| hit.triangle);
            }
        }
        self.take(traced);
        self.frame.stats.secs.trace += start.elapsed().as_secs_f64();
    }

    /// Type 2: follows mirrors and glass. What they show is looked up in the modes that do so, and
    /// shaded in mode `paper`.
    fn trace_secondary(&mut self, request: &FrameRequest<'_>, source: &Source<'_>, part: usize) {
        begin_stage!(start, "mirrors and glass");
        let FrameRequest { tracer, settings, stop, .. } = *request;
        let frame = &self.frame;
        let resolver = source.resolver(request, &frame.view, &self.points);
        let warped = WarpedPixels { tracer, references: source.warped(), warped: &self.warped };
        let traced = self.secondary.run(part, stop, |pixel, tally: &mut Tally| match &resolver {
            Some(resolver) => resolver.resolve_specular(pixel, frame.triangle[pixel as usize], tally),
            None => warped.specular(&frame.view, pixel, &settings.trace, &mut tally.rays),
        });
        let results = self.secondary.pixels().iter().zip(self.secondary.results());
        for ((&pixel, specular), own) in results.zip(&self.own) {
            if let Some(specular) = specular {
                self.frame.radiance[pixel as usize] = *own + *specular;
            }
        }
        self.take(traced);
        self.frame.stats.secs.secondary += start.elapsed().as_secs_f64();
    }

    /// Checks guesses. Only the look-up makes any.
    fn check_uncertain(&mut self, request: &FrameRequest<'_>, source: &Source<'_>) {
        begin_stage!(start, "uncertain pixels");
        let (frame, certain) = (&self.frame, &self.certain);
        let Some(resolver) = source.resolver(request, &frame.view, &self.points) else { return };
        let mut between = Between::new(&mut self.between, frame, source, &request.settings.trace);
        let check = |pixel: u32, between, tally: &mut Tally| {
            let at = pixel as usize;
            let guess = Guess { radiance: frame.radiance[at], certain: certain[at], between };
            resolver.check_guess(pixel, frame.triangle[at], guess, tally)
        };
        let light_of = |checked: &CheckedPixel| checked.irradiance;
        let checked = self.uncertain.run_in_rounds(request.stop, &mut between, light_of, check);
        for (pixel, checked) in self.uncertain.done() {
            self.frame.radiance[pixel] = checked.radiance;
            if checked.is_traced {
                self.frame.supplier[pixel] = NO_SUPPLIER;
            }
        }
        self.take(checked);
        self.frame.stats.secs.trace += start.elapsed().as_secs_f64();
    }

    /// Counts rays and keeps traced points. The points are used from the next frame on, so that
    /// this frame has the same bits wherever it is stopped and resumed.
    fn take(&mut self, (mut tally, is_complete): (Tally, bool)) {
        self.frame.stats.rays += tally.rays;
        self.frame.stats.is_complete &= is_complete;
        self.fresh_points.append(&mut tally.points);
    }

    fn conclude(&mut self, request: &FrameRequest<'_>, source: &Source<'_>, start: Instant) -> &Frame {
        let Self { unseen, secondary, own, carried, points, .. } = self;
        let is_complete = self.frame.stats.is_complete;
        if self.is_progressive || !is_complete {
            let traced = unseen.done().map(|(pixel, traced)| (pixel, traced.light.total()));
            carried.take(traced, self.frame.radiance.len());
        }
        if !is_complete {
            let (view, light) = (self.frame.view, self.shows_surfaces.then_some(&*carried));
            let (tracer, seed) = (request.tracer, request.settings.trace.seed);
            let resolver = source.resolver(request, &view, points);
            let unfinished = Unfinished { tracer, unseen, secondary, own, light, resolver, seed };
            self.placeholders.fill(&unfinished, &mut self.frame);
        }
        self.frame.stats.types = TypeCounts::of(&self.frame.types);
        self.frame.stats.secs.frame += start.elapsed().as_secs_f64();
        &self.frame
    }

    /// The pixels that the last frame shaded itself, as a reference for the next frames. The frame
    /// must be complete and of a mode that looks up.
    pub(super) fn shaded_reference(&self, tracer: &Tracer, settings: &RenderSettings) -> ReferenceFrame {
        let frame = &self.frame;
        let depths = frame.disparity.iter().map(|d| 1.0 / d);
        let hits = depths
            .zip(&frame.triangle)
            .map(|(t, &triangle)| (triangle != NO_TRIANGLE).then_some((t, triangle)));
        let lights = self.unseen.done().map(|(_, traced)| traced.light);
        let trace = settings.unseen_trace();
        let (camera, size) = (&frame.camera, frame.view.size);
        ReferenceFrame::from_lit_pixels(tracer, camera, size, &trace, hits, self.unseen.pixels(), lights)
    }

    /// Shows, in the pixels that the last frame shaded itself, the smooth light that a reference of
    /// the same view and size holds near there, instead of their own: it was shared between
    /// neighbours.
    pub(super) fn show_shared_light(&mut self, tracer: &Tracer, reference: &ReferenceFrame) {
        if reference.has_smooth_light() {
            shared_light::show(tracer, reference, &self.unseen, &mut self.frame);
        }
    }
}
