//! One frame: warp, classify, finish each list.

use super::finish::{Checked, MAX_POINTS};
use super::frame::{Frame, NO_SUPPLIER};
use super::look_up::Band;
use super::request::{FrameRequest, Source};
use super::{Mode, RenderSettings};
use crate::camera::{Camera, View};
use crate::lookup::{PointCache, TracedPoint};
use crate::math::key::Key;
use crate::raster::pixel_types::{PixelType, TypeCounts};
use crate::reference::ReferenceFrame;
use crate::render::placeholders::Placeholders;
use crate::trace::NO_TRIANGLE;
use crate::trace::parallel::{Stop, tile_order, trace_missing};
use crate::trace::{PixelTrace, SurfacePoint, Tracer};
use crate::warp::WarpBuffer;
use crate::warp::classify;
use glam::Vec3;
use rayon::prelude::*;
use std::time::Instant;

/// The pass of each pixel of a square of four by four: Bayer's dispersed order.
pub(super) const DISPERSED: [usize; 16] = [0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5];

/// Where frames may be cut, what is open is done for one pixel in so many first, whatever its type, so that a mirror that
/// takes long does not leave what no reference knows untouched, nor one thread's half of the picture the other's.
const ROUNDS: [usize; 3] = [16, 4, 1];

/// Renders frames; keeps its buffers from one to the next.
#[derive(Debug)]
pub struct Renderer {
    pub(super) frame: Frame,
    warped: WarpBuffer,
    order: Vec<u32>,
    order_size: [u32; 2],
    pub(super) secondary: Vec<u32>,
    pub(super) unseen: Vec<u32>,
    pub(super) uncertain: Vec<u32>,
    pub(super) progressive: bool,
    /// True where the hits of pixels that are not shaded are right all the same.
    pub(super) knows_hits: bool,
    passes: [Vec<u32>; 16],
    /// Results of `unseen`, `secondary` and `uncertain`, in their order; `None` is still to be done.
    pub(super) traced: Vec<Option<PixelTrace>>,
    pub(super) specular: Vec<Option<Vec3>>,
    pub(super) checked: Vec<Option<Checked>>,
    /// What the pixels of `secondary` show beside their mirror or glass.
    pub(super) own: Vec<Vec3>,
    pub(super) bands: Vec<Band>,
    /// Light traced where no reference has it, of frames before.
    pub(super) points: PointCache,
    /// The same of the last frame.
    pub(super) fresh_points: Vec<TracedPoint>,
    /// Scratch of frames that are shown before they are complete.
    pub(super) placeholders: Placeholders,
}

impl Default for Renderer {
    fn default() -> Self {
        Self {
            frame: Frame::empty(),
            warped: WarpBuffer::default(),
            order: Vec::new(),
            order_size: [0, 0],
            secondary: Vec::new(),
            unseen: Vec::new(),
            uncertain: Vec::new(),
            progressive: false,
            knows_hits: false,
            passes: Default::default(),
            traced: Vec::new(),
            specular: Vec::new(),
            checked: Vec::new(),
            own: Vec::new(),
            bands: Vec::new(),
            points: PointCache::default(),
            fresh_points: Vec::new(),
            placeholders: Placeholders::default(),
        }
    }
}

impl Renderer {
    /// Memory a frame takes while it is made, lists of work included: an upper bound, so that a size can be refused
    /// before anything is reserved.
    pub const BYTES_PER_PIXEL: usize = size_of::<Option<PixelTrace>>() // traced
        + size_of::<Option<Checked>>() // specular or checked
        + Placeholders::BYTES_PER_PIXEL + size_of::<Vec3>() // own
        + (MAX_POINTS + 1) * size_of::<TracedPoint>() // fresh points
        + size_of::<u64>() // warped
        + 7 * size_of::<u32>() // order; secondary, unseen, uncertain, of the frame and of its bands
        + size_of::<Vec3>() + size_of::<f32>() + size_of::<u32>() + 2; // the frame

    /// The last frame.
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// The last frame, without the rest.
    pub fn into_frame(self) -> Frame {
        self.frame
    }

    /// Drops the last frame: its scene is gone.
    pub(super) fn forget(&mut self) {
        self.frame = Frame::empty();
    }

    /// Forgets the light that earlier frames left by place: the next one has only its references, as a first one has.
    pub fn forget_points(&mut self) {
        self.points.clear();
        self.fresh_points.clear();
    }

    /// The last frame, to be refined.
    pub(super) fn frame_mut(&mut self) -> &mut Frame {
        &mut self.frame
    }

    /// Whether frames may be shown before they are complete: the work is then spread over the picture, which costs some
    /// 5 % for rays that are less coherent.
    pub fn set_progressive(&mut self, progressive: bool) {
        self.progressive = progressive;
    }

    /// Adds the time that choosing the references took to the last frame's.
    pub(super) fn add_select_secs(&mut self, secs: f64) {
        self.frame.stats.secs.select = secs;
        self.frame.stats.secs.frame += secs;
    }

    /// Renders a frame. Pixels that a stop left undone show what was known of them, and the frame
    /// says that it is not complete.
    ///
    /// # Panics
    /// Where a reference to be warped belongs to another epoch.
    pub fn render(&mut self, request: &FrameRequest<'_>) -> &Frame {
        let FrameRequest { tracer, camera, size, settings, .. } = *request;
        let source = request.source();
        let start = self.begin(tracer, camera, size);
        match &source {
            Source::LookUp(lookup) => self.resolve(tracer, lookup, settings.mode),
            Source::Warp(references) => self.reproject(tracer, references),
        }
        self.begin_lists();
        self.finish_open(request, &source);
        self.finish(tracer, start)
    }

    /// Continues the last frame where a stop left it. The request must be the one that it was
    /// rendered from, apart from the stop. A complete frame stays as it is.
    pub fn resume(&mut self, request: &FrameRequest<'_>) -> &Frame {
        let start = Instant::now();
        self.frame.stats.is_complete = true;
        self.finish_open(request, &request.source());
        self.finish(request.tracer, start)
    }

    fn finish_open(&mut self, request: &FrameRequest<'_>, source: &Source<'_>) {
        let FrameRequest { tracer, settings, stop, .. } = *request;
        match source {
            Source::LookUp(lookup) => self.finish_looked_up(tracer, settings, lookup, stop),
            Source::Warp(references) => self.finish_lists(tracer, settings, references, stop),
        }
    }

    /// Type 2 and 3 where the light of references is copied, and where there are none.
    fn finish_lists(
        &mut self,
        tracer: &Tracer,
        settings: &RenderSettings,
        references: &[&ReferenceFrame],
        stop: Stop<'_>,
    ) {
        if settings.mode == Mode::Paper {
            self.finish_secondary(tracer, settings, references, stop);
        }
        for &part in self.rounds() {
            self.finish_unseen(tracer, settings, part, stop);
        }
    }

    /// The parts of its lists that are done one after the other.
    pub(super) fn rounds(&self) -> &'static [usize] {
        if self.progressive { &ROUNDS } else { &[1] }
    }

    fn begin(&mut self, tracer: &Tracer, camera: &Camera, size: [u32; 2]) -> Instant {
        let start = Instant::now();
        self.frame.reset(camera, &View::new(camera, &tracer.scene().frame, size));
        self.frame.stats.is_complete = true;
        self.knows_hits = false;
        if self.order_size != size {
            self.order = tile_order(size);
            self.order_size = size;
        }
        start
    }

    /// Nothing of the lists is done.
    fn begin_lists(&mut self) {
        let Self { secondary, unseen, uncertain, specular, traced, checked, own, frame, .. } = self;
        own.clear();
        own.extend(secondary.iter().map(|&pixel| frame.radiance[pixel as usize]));
        specular.clear();
        specular.resize(secondary.len(), None);
        traced.clear();
        traced.resize(unseen.len(), None);
        checked.clear();
        checked.resize(uncertain.len(), None);
    }

    fn finish(&mut self, tracer: &Tracer, start: Instant) -> &Frame {
        if !self.frame.stats.is_complete {
            self.placeholder(tracer);
        }
        self.frame.stats.types = TypeCounts::of(&self.frame.types);
        self.frame.stats.secs.frame += start.elapsed().as_secs_f64();
        &self.frame
    }

    /// Steps 1 to 3 of the paper, with the copying of Type 1, and the lists of what is left to do.
    fn reproject(&mut self, tracer: &Tracer, references: &[&ReferenceFrame]) {
        let start = Instant::now();
        self.frame.stats.references_used = references.len();
        self.frame.stats.warped_pixels = references.iter().map(|r| r.view.pixel_count()).sum();
        self.secondary.clear();
        self.unseen.clear();
        self.uncertain.clear();
        if references.is_empty() {
            self.frame.types.fill(PixelType::Unseen);
            self.frame.supplier.fill(NO_SUPPLIER);
            self.list_work();
            return;
        }
        self.warped.warp(references, &self.frame.view);
        self.copy_samples(tracer, references);
        self.list_work();
        self.frame.stats.secs.visibility_and_lookup = start.elapsed().as_secs_f64();
    }

    /// The pixels of Types 2 and 3, tile by tile. Where unfinished frames are shown, those of Type 3 come in sixteen
    /// passes instead, each spread over the whole picture, so that a frame stopped before its end is known evenly.
    fn list_work(&mut self) {
        for &pixel in &self.order {
            match self.frame.types[pixel as usize] {
                PixelType::Secondary => self.secondary.push(pixel),
                PixelType::Unseen => self.unseen.push(pixel),
                _ => {}
            }
        }
        if self.progressive {
            self.spread(|r| &mut r.unseen);
        }
    }

    /// Brings the pixels of a list into sixteen passes, each spread over the whole picture.
    pub(super) fn spread(&mut self, list: impl Fn(&mut Self) -> &mut Vec<u32>) {
        let width = self.frame.view.size[0];
        let mut pixels = std::mem::take(list(self));
        self.passes.iter_mut().for_each(Vec::clear);
        for &pixel in &pixels {
            let (x, y) = (pixel % width % 4, pixel / width % 4);
            self.passes[DISPERSED[(4 * y + x) as usize]].push(pixel);
        }
        pixels.clear();
        self.passes.iter().for_each(|pass| pixels.extend_from_slice(pass));
        *list(self) = pixels;
    }

    /// Takes over what the winning samples know.
    fn copy_samples(&mut self, tracer: &Tracer, references: &[&ReferenceFrame]) {
        let width = self.frame.view.size[0].max(1) as usize;
        let warped = &self.warped;
        let frame = &mut self.frame;
        (
            frame.radiance.par_chunks_mut(width),
            frame.disparity.par_chunks_mut(width),
            frame.triangle.par_chunks_mut(width),
            frame.types.par_chunks_mut(width),
            frame.supplier.par_chunks_mut(width),
        )
            .into_par_iter()
            .enumerate()
            .with_min_len(8)
            .for_each(|(y, (radiance, disparity, triangle, types, supplier))| {
                for x in 0..width {
                    let pixel = y * width + x;
                    types[x] = classify(warped, references, pixel);
                    supplier[x] = NO_SUPPLIER;
                    if let Some((sample, sample_disparity)) = warped.sample(pixel) {
                        let (reference, at) = (references[sample.slot()], sample.pixel() as usize);
                        if !reference.is_sound(tracer, sample.pixel()) {
                            types[x] = PixelType::Unseen;
                            continue;
                        }
                        radiance[x] = reference.diffuse_radiance(tracer, sample.pixel());
                        disparity[x] = sample_disparity;
                        triangle[x] = reference.triangle()[at];
                        supplier[x] = sample.slot() as u8;
                    }
                }
            });
    }

    /// Type 2: secondary rays from the stored intersection point, as seen from the new eye.
    fn finish_secondary(
        &mut self,
        tracer: &Tracer,
        settings: &RenderSettings,
        references: &[&ReferenceFrame],
        stop: Stop<'_>,
    ) {
        let start = Instant::now();
        let (view, warped) = (&self.frame.view, &self.warped);
        let (rays, complete) = trace_missing(&self.secondary, &mut self.specular, stop, |pixel, rays| {
            let Some((sample, _)) = warped.sample(pixel as usize) else { return Vec3::ZERO };
            let reference = references[sample.slot()];
            let offset = reference.offset_from_eye(sample.pixel());
            let direction = offset + reference.view.eye_relative_to(view);
            let triangle = reference.triangle()[sample.pixel() as usize];
            let position = reference.view.eye + offset;
            let point = SurfacePoint::from_position(tracer.scene(), triangle, position, direction);
            let key = Key::of_pixel(settings.trace.seed, pixel);
            tracer.specular_radiance(&point, direction, &settings.trace, key, rays).0
        });
        self.add_specular();
        self.frame.stats.rays += rays;
        self.frame.stats.is_complete &= complete;
        self.frame.stats.secs.secondary += start.elapsed().as_secs_f64();
    }

    /// Adds what mirrors and glass show to their pixels.
    pub(super) fn add_specular(&mut self) {
        for ((&pixel, specular), own) in self.secondary.iter().zip(&self.specular).zip(&self.own) {
            if let Some(specular) = specular {
                self.frame.radiance[pixel as usize] = *own + *specular;
            }
        }
    }

    /// Type 3: traced in full.
    fn finish_unseen(&mut self, tracer: &Tracer, settings: &RenderSettings, part: usize, stop: Stop<'_>) {
        let start = Instant::now();
        let view = &self.frame.view;
        let due = self.unseen.len().div_ceil(part);
        let (list, traced) = (&self.unseen[..due], &mut self.traced[..due]);
        let (rays, complete) =
            trace_missing(list, traced, stop, |pixel, rays| tracer.pixel(view, pixel, &settings.trace, rays));
        for (&pixel, traced) in self.unseen.iter().zip(&self.traced) {
            let Some(traced) = traced else { continue };
            let pixel = pixel as usize;
            self.frame.radiance[pixel] = traced.radiance;
            self.frame.disparity[pixel] = traced.hit.map_or(0.0, |hit| 1.0 / hit.t);
            self.frame.triangle[pixel] = traced.hit.map_or(NO_TRIANGLE, |hit| hit.triangle);
        }
        self.frame.stats.rays += rays;
        self.frame.stats.is_complete &= complete;
        self.frame.stats.secs.trace += start.elapsed().as_secs_f64();
    }
}
