//! The picture of a camera at rest, in the modes that look smooth light up.
//!
//! Two pictures are made in turns. One is the mean of looked-up frames through different points of
//! the pixels; its references get four times as many samples each time, so its noise is low and its
//! bias shrinks. The other is the mean of passes of the full tracer, which has no bias. Each tile
//! shows the mixture that has the least estimated error, which in the limit is the full tracer's
//! picture.
//!
//! Source: James and Stein, "Estimation with Quadratic Loss", 1961, for mixing by estimated error;
//! Gu et al., "Neural James-Stein Combiner for Unbiased and Biased Renderings", ACM TOG 2022, for
//! doing so with renderings. We differ: the shares are computed per tile from the passes' variance.

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

/// Points of each pixel through which looked-up frames are rendered.
const FRAMES: u32 = 16;

/// Each time that the references of the view are improved, they get this many times the samples.
const MORE_SAMPLES: u32 = 4;

/// Times that the references of the view are improved, and the passes of the full tracer after
/// each.
const PASSES_AFTER: [u32; 3] = [0, 8, PASSES];

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
    /// The mean of the looked-up frames that is shown: the last one through all points of the
    /// pixels, or, before there is any, that of the frames so far.
    looked_up: Vec<Vec3>,
    /// Times that the references of the view were improved.
    improved: usize,
    /// The reference that is being lit.
    lighting: Option<UnfinishedReference>,
    /// The reference of this view that was finished last.
    own: Option<ReferenceId>,
}

/// The next step towards the picture at rest.
enum Task {
    Frame,
    Light,
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
            improved: 0,
            lighting: None,
            own: None,
        }
    }

    /// True where this is the picture of a request.
    pub(super) fn is_of(&self, request: &FrameRequest<'_>) -> bool {
        self.settings == *request.settings && self.full.is_of(request)
    }

    pub(super) fn state(&self) -> RefineState {
        let light_samples = self.samples_after(self.improved);
        RefineState { light_samples, ..self.full.state() }
    }

    /// Paths per pixel of the references after some improvements.
    fn samples_after(&self, improvements: usize) -> u32 {
        self.settings.trace.samples.saturating_mul(MORE_SAMPLES.pow(improvements as u32))
    }

    fn task(&self) -> Option<Task> {
        let passes = self.full.passes_done();
        let due = PASSES_AFTER[self.improved.min(PASSES_AFTER.len() - 1)];
        if self.frames < FRAMES {
            Some(Task::Frame)
        } else if passes < due {
            Some(Task::Pass(due))
        } else {
            (self.improved + 1 < PASSES_AFTER.len()).then_some(Task::Light)
        }
    }

    /// Works on the picture until it has converged or `stop` is true. What is done then is kept.
    pub(super) fn run(&mut self, tracer: &Tracer, cache: &mut ReferenceCache, stop: Stop<'_>) {
        while !stop()
            && let Some(task) = self.task()
        {
            match task {
                Task::Frame => self.add_frame(tracer, cache, stop),
                Task::Light => self.improve(tracer, cache, stop),
                Task::Pass(until) => self.full.run_until(until, tracer, stop),
            }
        }
    }

    /// Adds a looked-up frame through the next point of the pixels.
    fn add_frame(&mut self, tracer: &Tracer, cache: &ReferenceCache, stop: Stop<'_>) {
        let request = FrameRequest::new(tracer, &self.camera, self.size, &self.settings);
        let offset = offset_of_pass(self.frames, FRAMES);
        let frame = self.renderer.render(&request.reusing(cache).shifted(offset).with_stop(stop));
        if !frame.stats.is_complete {
            return;
        }
        self.sums.resize(frame.radiance.len(), Vec3::ZERO);
        for (sum, radiance) in self.sums.iter_mut().zip(&frame.radiance) {
            *sum = if self.frames == 0 { *radiance } else { *sum + *radiance };
        }
        self.frames += 1;
        // Frames through few points have jagged edges: they do not take the place of smooth ones.
        if self.frames == FRAMES || self.improved == 0 {
            let count = self.frames as f32;
            self.looked_up.clear();
            self.looked_up.extend(self.sums.iter().map(|sum| *sum / count));
        }
    }

    /// Lights a reference of this view with more samples than before; it takes the place of the
    /// last.
    fn improve(&mut self, tracer: &Tracer, cache: &mut ReferenceCache, stop: Stop<'_>) {
        let (camera, size, trace) = (self.camera, self.size, self.trace());
        let known = LookupSet::without_references(cache, tracer.epoch());
        let lighting = self
            .lighting
            .get_or_insert_with(|| UnfinishedReference::begin(tracer, &camera, size, &trace, &known));
        if !lighting.light(tracer, &known, stop) {
            return;
        }
        let Some(finished) = self.lighting.take().map(|lighting| lighting.finish(tracer)) else { return };
        if let Some(last) = self.own.replace(cache.insert(Arc::new(finished))) {
            cache.remove(last);
        }
        self.renderer.forget_points();
        (self.improved, self.frames) = (self.improved + 1, 0);
    }

    /// Settings of the next reference of this view.
    fn trace(&self) -> TraceSettings {
        let trace = self.settings.trace;
        let samples = self.samples_after(self.improved + 1);
        settings_of_reference(&TraceSettings { samples, ..trace }, FIRST_NUMBER + self.improved as u64)
    }

    /// Shows in a frame of the same size what is done.
    pub(super) fn write_to(&self, frame: &mut Frame) {
        if self.looked_up.is_empty() {
            frame.stats.refined = self.state();
            return;
        }
        frame.radiance.clone_from(&self.looked_up);
        if self.full.passes_done() >= 2 {
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
