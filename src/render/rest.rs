//! The picture of a camera at rest, in the modes that look smooth light up.
//!
//! Two pictures are made, one after the other. The first is the mean of looked-up frames through
//! different points of the pixels; its reference gets more pixels and samples from stage to stage,
//! so its noise is low and its bias shrinks. The second is the mean of passes of the full tracer,
//! which has no bias. Each block of pixels shows the mixture that has the least estimated error,
//! which in the limit is the full tracer's picture.
//!
//! Source: James and Stein, "Estimation with Quadratic Loss", 1961, for mixing by estimated error;
//! Gu et al., "Neural James-Stein Combiner for Unbiased and Biased Renderings", ACM TOG 2022, for
//! doing so with renderings. We differ: the shares are computed per block from the passes'
//! variance.

use super::accumulate::{Accumulation, offset_of_pass};
use super::frame::{Frame, RefineState};
use super::renderer::Renderer;
use super::request::FrameRequest;
use super::settings::RenderSettings;
use crate::camera::Camera;
use crate::lookup::{LookupSet, UnfinishedReference};
use crate::reference::{ReferenceCache, ReferenceId, settings_of_reference};
use crate::trace::{TraceSettings, Tracer, parallel::Stop};
use glam::Vec3;
use std::sync::Arc;

/// Passes of the full tracer until the picture counts as converged.
const PASSES: u32 = 64;

/// Passes from which on the full tracer's picture is mixed in. With fewer, the variance of light
/// that few paths find is underestimated: after 8 passes the mixture of a daylit room had 6 % more
/// squared error than its looked-up picture alone (one run).
const MIXED_PASSES: u32 = 16;

/// A stage of the picture: a reference of the view, and what follows it.
struct Stage {
    /// Pixels of the picture, along an edge, per pixel of the reference.
    edge: u32,
    /// Samples of the reference's pixels, as a multiple of those of a frame.
    samples: u32,
    /// Points of each pixel through which looked-up frames are rendered.
    frames: u32,
    /// Passes of the full tracer when the stage ends.
    passes: u32,
}

/// The stages: light first, then edges, then what has no bias.
const STAGES: [Stage; 4] = [
    Stage { edge: 2, samples: 1, frames: 1, passes: 0 },
    Stage { edge: 1, samples: 1, frames: 4, passes: 0 },
    Stage { edge: 1, samples: 4, frames: 16, passes: 0 },
    Stage { edge: 1, samples: 16, frames: 16, passes: PASSES },
];

/// Number of the first reference that is traced for a view at rest: others count from 1.
const FIRST_NUMBER: u64 = 1 << 15;

/// Side of the square of pixels whose errors are estimated together.
const BLOCK: usize = 16;

/// The picture of one pose at rest.
#[derive(Debug)]
pub(super) struct RestPicture {
    camera: Camera,
    size: [u32; 2],
    settings: RenderSettings,
    full: Accumulation,
    renderer: Renderer,
    /// Sums of the looked-up frames since the references were improved, and their number.
    sums: Vec<Vec3>,
    frames: u32,
    /// The mean of looked-up frames that is shown, and the number of these frames.
    looked_up: Vec<Vec3>,
    shown_points: u32,
    /// The stage that is being worked on.
    stage: usize,
    /// True once the stage's reference is lit.
    is_lit: bool,
    /// The reference that is being lit.
    lighting: Option<UnfinishedReference>,
    /// The reference of this view that was finished last.
    own: Option<ReferenceId>,
}

/// The next step towards the picture at rest.
enum Task {
    Frame(&'static Stage),
    Light(&'static Stage),
    Pass(u32),
}

impl RestPicture {
    pub(super) fn new(request: &FrameRequest<'_>) -> Self {
        Self {
            camera: *request.camera,
            size: request.size,
            settings: *request.settings,
            full: Accumulation::new(request, PASSES),
            renderer: Renderer::default(),
            sums: Vec::new(),
            frames: 0,
            looked_up: Vec::new(),
            shown_points: 0,
            stage: 0,
            is_lit: false,
            lighting: None,
            own: None,
        }
    }

    /// True where this is the picture of a request.
    pub(super) fn is_of(&self, request: &FrameRequest<'_>) -> bool {
        self.settings == *request.settings && self.full.is_of(request)
    }

    pub(super) fn state(&self) -> RefineState {
        let light_samples = self.trace().samples;
        RefineState { light_samples, ..self.full.state() }
    }

    /// Settings of the looked-up frames: those of the last reference, but for its seed.
    fn trace(&self) -> TraceSettings {
        let last = if self.is_lit { Some(self.stage) } else { self.stage.checked_sub(1) };
        let more = last.and_then(|last| STAGES.get(last)).map_or(1, |stage| stage.samples);
        self.trace_of(more)
    }

    fn trace_of(&self, more_samples: u32) -> TraceSettings {
        let trace = self.settings.trace;
        TraceSettings { samples: trace.samples.saturating_mul(more_samples), ..trace }
    }

    /// The next step. Where a stage is finished, it is the first of the next stage.
    fn task(&mut self, cache: &ReferenceCache) -> Option<Task> {
        loop {
            let stage = STAGES.get(self.stage)?;
            if !self.is_lit && !self.is_known(stage, cache) {
                return Some(Task::Light(stage));
            } else if self.is_lit && self.frames < stage.frames {
                return Some(Task::Frame(stage));
            } else if self.is_lit && self.full.passes_done() < stage.passes {
                return Some(Task::Pass(stage.passes));
            }
            (self.stage, self.is_lit) = (self.stage + 1, false);
        }
    }

    /// True where a reference of this view has at least the pixels and samples of a stage.
    fn is_known(&self, stage: &Stage, cache: &ReferenceCache) -> bool {
        let (size, samples) = (self.size_of(stage), self.trace_of(stage.samples).samples);
        cache.entries().iter().any(|entry| {
            let frame = &entry.frame;
            let is_fine = frame.view.size[0] >= size[0] && frame.settings.samples >= samples;
            let is_whole = 2 * frame.lit() > frame.view.pixel_count();
            entry.is_enabled && frame.camera == self.camera && is_fine && is_whole
        })
    }

    fn size_of(&self, stage: &Stage) -> [u32; 2] {
        self.size.map(|edge| edge.div_ceil(stage.edge))
    }

    /// Works on the picture until it has converged or `stop` is true. What is done then is kept.
    pub(super) fn run(&mut self, tracer: &Tracer, cache: &mut ReferenceCache, stop: Stop<'_>) {
        while !stop()
            && let Some(task) = self.task(cache)
        {
            match task {
                Task::Frame(stage) => self.add_frame(stage, tracer, cache, stop),
                Task::Light(stage) => self.light(stage, tracer, cache, stop),
                Task::Pass(until) => self.full.run_until(until, tracer, stop),
            }
        }
    }

    /// Adds a looked-up frame through the next point of the pixels.
    fn add_frame(&mut self, stage: &Stage, tracer: &Tracer, cache: &ReferenceCache, stop: Stop<'_>) {
        let settings = RenderSettings { trace: self.trace(), ..self.settings };
        let request = FrameRequest::new(tracer, &self.camera, self.size, &settings);
        let offset = offset_of_pass(self.frames, stage.frames);
        let frame = self.renderer.render(&request.reusing(cache).shifted(offset).with_stop(stop));
        if !frame.stats.is_complete {
            return;
        }
        let own = cache.entries().iter().find(|entry| Some(entry.id) == self.own);
        if let Some(own) = own.filter(|own| own.frame.view.size == self.size) {
            self.renderer.show_shared_light(tracer, &own.frame);
        }
        let frame = self.renderer.frame();
        self.sums.resize(frame.radiance.len(), Vec3::ZERO);
        for (sum, radiance) in self.sums.iter_mut().zip(&frame.radiance) {
            *sum = if self.frames == 0 { *radiance } else { *sum + *radiance };
        }
        self.frames += 1;
        // Frames through few points have jagged edges: they do not take the place of smooth ones.
        if self.frames >= self.shown_points {
            let count = self.frames as f32;
            self.looked_up.clear();
            self.looked_up.extend(self.sums.iter().map(|sum| *sum / count));
            self.shown_points = self.frames;
        }
    }

    /// Lights the reference of a stage; it takes the place of the last.
    fn light(&mut self, stage: &Stage, tracer: &Tracer, cache: &mut ReferenceCache, stop: Stop<'_>) {
        let (camera, size) = (self.camera, self.size_of(stage));
        let number = FIRST_NUMBER + self.stage as u64;
        let settings = settings_of_reference(&self.trace_of(stage.samples), number);
        let known = LookupSet::without_references(cache, tracer.epoch());
        let lighting = self
            .lighting
            .get_or_insert_with(|| UnfinishedReference::begin(tracer, &camera, size, &settings, &known));
        if !lighting.light(tracer, &known, stop) {
            return;
        }
        let Some(finished) = self.lighting.take().map(|lighting| lighting.finish(tracer)) else { return };
        if let Some(last) = self.own.replace(cache.insert(Arc::new(finished))) {
            cache.remove(last);
        }
        self.renderer.forget_points();
        (self.is_lit, self.frames) = (true, 0);
    }

    /// Shows in a frame of the same size what is done.
    pub(super) fn write_to(&self, frame: &mut Frame) {
        if self.looked_up.is_empty() {
            frame.stats.refined = self.state();
            return;
        }
        frame.radiance.clone_from(&self.looked_up);
        if self.full.passes_done() >= MIXED_PASSES {
            mix(&mut frame.radiance, &self.full.means(), self.size[0] as usize);
        }
        frame.stats.refined = self.state();
    }
}

/// Replaces each looked-up pixel by a mixture with the mean of the full tracer's passes.
///
/// Over a block, the squared distance of the two pictures is the error of the first plus the
/// variance of the second. So the first's error is known, and the shares that minimize the error of
/// the mixture are those of the inverse errors.
fn mix(shown: &mut [Vec3], full: &[Option<(Vec3, f32)>], width: usize) {
    let (columns, rows) = (width.div_ceil(BLOCK), (shown.len() / width.max(1)).div_ceil(BLOCK));
    let block_of = |pixel: usize| pixel / width / BLOCK * columns + pixel % width / BLOCK;
    let mut errors = vec![[0.0f64; 2]; columns * rows];
    let energy = full.iter().flatten().map(|(mean, _)| f64::from(mean.length_squared())).sum::<f64>();
    let usual = energy / full.len().max(1) as f64;
    for (pixel, (shown, full)) in shown.iter().zip(full).enumerate() {
        if let Some((mean, variance)) = full {
            // Errors count as they are seen: less in pixels brighter than the picture.
            let weight = 1.0 / (usual + f64::from(mean.length_squared())).max(f64::MIN_POSITIVE);
            let error = &mut errors[block_of(pixel)];
            error[0] += weight * f64::from((*shown - *mean).length_squared());
            error[1] += weight * f64::from(*variance);
        }
    }
    for (pixel, (shown, full)) in shown.iter_mut().zip(full).enumerate() {
        if let Some((mean, _)) = full {
            let [distance, variance] = errors[block_of(pixel)];
            let bias = (distance - variance).max(0.0);
            let share = if bias + variance > 0.0 { bias / (bias + variance) } else { 1.0 };
            *shown = shown.lerp(*mean, share as f32);
        }
    }
}
