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
use super::deadline::Deadline;
use super::frame::{Frame, RefineState};
use super::mixture::mix;
use super::renderer::Renderer;
use super::request::FrameRequest;
use super::settings::RenderSettings;
use super::stages::{PASSES, STAGES, STAGES_OF_RETURN, Stage, number_of_reference};
use crate::camera::Camera;
use crate::lookup::{GrowingReference, LookupSet};
use crate::reference::{ReferenceCache, ReferenceFrame, ReferenceId, settings_of_reference};
use crate::trace::{
    TraceSettings, Tracer,
    parallel::{NEVER, Stop},
};
use glam::Vec3;
use std::{sync::Arc, time::Instant};

/// Passes from which on the full tracer's picture is mixed in. With fewer, the variance of light
/// that few paths find is underestimated: after 8 passes the mixture of a daylit room had 6 % more
/// squared error than its looked-up picture alone (one run).
const MIXED_PASSES: u32 = 16;

/// Looked-up frames that share the samples of the reference: with fewer samples, what a frame
/// traces itself at edges would have more noise than what it looks up.
const MIXED_FRAMES: u32 = 4;

/// The picture of one pose at rest.
#[derive(Debug)]
pub(super) struct RestPicture {
    camera: Camera,
    size: [u32; 2],
    settings: RenderSettings,
    stages: &'static [Stage],
    /// True for the stages of a return.
    is_return: bool,
    pub(super) full: Accumulation,
    renderer: Renderer,
    /// Version of the cache from which the renderer's frame was begun, where a stop cut it.
    cut: Option<u64>,
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
    /// The reference of this view with the samples that it has had so far.
    growing: Option<GrowingReference>,
    /// The reference of this view that an earlier visit has left, to whose light more is added.
    /// `None` before it was looked for.
    earlier: Option<Option<Arc<ReferenceFrame>>>,
    /// The reference of this view that was finished last, and its samples.
    own: Option<ReferenceId>,
    own_samples: u32,
    /// The end of the time for the picture, where it is known.
    deadline: Option<Deadline>,
    /// Looked-up frames that show the light so far, unless the stage has fewer.
    planned: u32,
}

/// The next step towards the picture at rest.
enum Task {
    Frame(u32),
    Light(&'static Stage),
    Pass(u32),
}

impl RestPicture {
    pub(super) fn new(request: &FrameRequest<'_>) -> Self {
        Self {
            camera: *request.camera,
            size: request.size,
            settings: *request.settings,
            stages: &STAGES,
            is_return: false,
            full: Accumulation::new(request, PASSES),
            renderer: Renderer::default(),
            cut: None,
            sums: Vec::new(),
            frames: 0,
            looked_up: Vec::new(),
            shown_points: 0,
            stage: 0,
            is_lit: false,
            growing: None,
            earlier: None,
            own: None,
            own_samples: 0,
            deadline: None,
            planned: u32::MAX,
        }
    }

    /// True where this is the picture of a request.
    pub(super) fn is_of(&self, request: &FrameRequest<'_>) -> bool {
        self.settings == *request.settings && self.full.is_of(request)
    }

    pub(super) fn state(&self) -> RefineState {
        let light_samples = self.own_samples.max(self.settings.trace.samples);
        RefineState { light_samples, ..self.full.state() }
    }

    /// True once a looked-up frame of the view is shown.
    pub(super) fn is_shown(&self) -> bool {
        !self.looked_up.is_empty()
    }

    /// Looks for what an earlier visit of this view has left, once.
    fn find_earlier(&mut self, cache: &ReferenceCache) {
        if self.earlier.is_some() || self.deadline.is_some() {
            return;
        }
        let entries =
            cache.entries().iter().filter(|entry| entry.is_enabled && self.is_of_view(&entry.frame));
        let best = entries.max_by_key(|entry| entry.frame.settings.samples);
        self.earlier = Some(best.map(|best| Arc::clone(&best.frame)));
        let Some(best) = best else { return };
        (self.own, self.own_samples) = (Some(best.id), best.frame.settings.samples);
        if self.own_samples >= self.most_samples() {
            (self.stages, self.is_return) = (&STAGES_OF_RETURN, true);
        }
    }

    /// True for a reference that lights most of this view, pixel by pixel.
    fn is_of_view(&self, frame: &ReferenceFrame) -> bool {
        let is_whole = 2 * frame.lit() > frame.view.pixel_count();
        frame.camera == self.camera && frame.view.size == self.size && is_whole
    }

    /// Samples of the reference that an earlier visit has left.
    fn earlier_samples(&self) -> u32 {
        self.earlier.iter().flatten().map(|earlier| earlier.settings.samples).sum()
    }

    /// The next step. Where a stage is finished, it is the first of the next stage.
    fn task(&mut self, cache: &ReferenceCache) -> Option<Task> {
        loop {
            let stage = self.stages.get(self.stage)?;
            let is_last = self.stage + 1 == self.stages.len();
            let is_known = !self.is_lit && self.is_known(stage, cache);
            // What is known need not be lit, but is shown by a stage that asks for nothing more.
            self.is_lit |= is_known && (is_last || stage.samples == 0);
            self.is_lit &= !self.can_light_again();
            let frames = self.planned.min(stage.frames);
            if !self.is_lit && !is_known {
                return Some(Task::Light(stage));
            } else if self.is_lit && self.frames < frames {
                return Some(Task::Frame(frames));
            } else if self.is_lit && self.full.passes_done() < stage.passes {
                return Some(Task::Pass(stage.passes));
            }
            (self.stage, self.is_lit) = (self.stage + 1, false);
        }
    }

    /// True where the light so far is shown, and there is time to add to it and to show it again.
    fn can_light_again(&self) -> bool {
        let has_time = self.deadline.is_some_and(|deadline| deadline.has_time_for_more(self.planned));
        let is_open = self.growing.as_ref().is_some_and(|growing| growing.samples() < self.most_samples());
        self.is_lit && self.frames >= self.planned && has_time && is_open
    }

    /// Samples of the last stage.
    fn most_samples(&self) -> u32 {
        self.stages.last().map_or(1, |stage| self.samples_of(stage))
    }

    /// True where a reference of this view has at least the pixels and samples of a stage.
    fn is_known(&self, stage: &Stage, cache: &ReferenceCache) -> bool {
        let before = if self.is_return { self.earlier_samples() } else { 0 };
        let (size, samples) = (self.size_of(stage), self.samples_of(stage).saturating_add(before));
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

    fn samples_of(&self, stage: &Stage) -> u32 {
        self.settings.trace.samples.max(1).saturating_mul(stage.samples)
    }

    /// Works on the picture until it has converged or `stop` is true. What is done then is kept.
    pub(super) fn run(&mut self, tracer: &Tracer, cache: &mut ReferenceCache, stop: Stop<'_>) {
        while !stop() && self.step(tracer, cache, stop) {}
    }

    /// Does the next step, until `stop` is true. Returns false where nothing is left to do.
    pub(super) fn step(&mut self, tracer: &Tracer, cache: &mut ReferenceCache, stop: Stop<'_>) -> bool {
        self.find_earlier(cache);
        match self.task(cache) {
            // A stopped frame cannot be shown, and the first one must be.
            Some(Task::Frame(of)) if self.deadline.is_some() && !self.is_shown() => {
                self.add_frame(of, tracer, cache, NEVER);
            }
            Some(Task::Frame(of)) => self.add_frame(of, tracer, cache, stop),
            Some(Task::Light(stage)) => self.light(stage, tracer, cache, stop),
            Some(Task::Pass(until)) => self.full.run_until(until, tracer, stop),
            None => return false,
        }
        true
    }

    /// Adds a looked-up frame through the next of some points of the pixels.
    fn add_frame(&mut self, of: u32, tracer: &Tracer, cache: &ReferenceCache, stop: Stop<'_>) {
        let start = Instant::now();
        let settings = RenderSettings { trace: self.trace_of_frame(of), ..self.settings };
        let request = FrameRequest::new(tracer, &self.camera, self.size, &settings);
        let offset = offset_of_pass(self.frames, of);
        let request = request.reusing(cache).shifted(offset).with_stop(stop);
        // A frame may take longer than the time between two stops, so it is continued.
        let frame = match self.cut.take() {
            Some(version) if version == cache.version() => self.renderer.resume(&request),
            _ => self.renderer.render(&request),
        };
        if !frame.stats.is_complete {
            self.cut = Some(cache.version());
            return;
        }
        if let Some(own) = self.own(cache).filter(|own| own.view.size == self.size) {
            self.renderer.show_shared_light(tracer, own);
        }
        let frame = self.renderer.frame();
        self.sums.resize(frame.radiance.len(), Vec3::ZERO);
        for (sum, radiance) in self.sums.iter_mut().zip(&frame.radiance) {
            *sum = if self.frames == 0 { *radiance } else { *sum + *radiance };
        }
        self.frames += 1;
        if let Some(deadline) = &mut self.deadline {
            deadline.frame_secs = start.elapsed().as_secs_f64();
        }
        // Frames through few points have jagged edges: they do not take the place of smooth ones.
        if self.frames >= self.shown_points {
            let count = self.frames as f32;
            self.looked_up.clear();
            self.looked_up.extend(self.sums.iter().map(|sum| *sum / count));
            self.shown_points = self.frames;
        }
    }

    /// The reference of this view that was finished last.
    pub(super) fn own<'c>(&self, cache: &'c ReferenceCache) -> Option<&'c Arc<ReferenceFrame>> {
        cache.entries().iter().find(|entry| Some(entry.id) == self.own).map(|entry| &entry.frame)
    }

    /// The same, to be kept, unless it is coarse, or an earlier visit has left it.
    pub(super) fn reference(&self, cache: &ReferenceCache) -> Option<Arc<ReferenceFrame>> {
        let own = self.own(cache).filter(|own| own.view.size == self.size)?;
        let is_new = !self.earlier.iter().flatten().any(|earlier| Arc::ptr_eq(earlier, own));
        is_new.then(|| Arc::clone(own))
    }

    /// Settings of the next of some looked-up frames: together they have the samples of the
    /// reference, but each at least those of the settings. Each has a seed of its own.
    fn trace_of_frame(&self, of: u32) -> TraceSettings {
        let trace = self.settings.trace;
        let samples = self.own_samples.min(self.most_samples());
        let samples = samples.div_ceil(of.clamp(1, MIXED_FRAMES)).max(trace.samples);
        // As passes of the full tracer use them.
        let seed = trace.seed.wrapping_add(u64::from(self.frames) << 48);
        TraceSettings { samples, seed, ..trace }
    }

    /// Lights the reference further, until it has the samples of a stage or the time left is needed
    /// to show it; it takes the place of the last.
    fn light(&mut self, stage: &Stage, tracer: &Tracer, cache: &mut ReferenceCache, stop: Stop<'_>) {
        let known = LookupSet::without_references(cache, tracer.epoch());
        let last = self.growing.take().filter(|growing| growing.size() == self.size_of(stage));
        let growing = last.unwrap_or_else(|| self.begin_light(stage.edge, tracer, &known));
        let (samples, deadline) = (self.samples_of(stage), self.deadline);
        let planned = self.planned;
        let growing = self.growing.insert(growing);
        let goal = deadline.map_or(samples, |_| growing.next_goal().min(samples));
        let is_due = || deadline.is_some_and(|deadline| deadline.is_due(planned));
        let is_complete = growing.light(tracer, &known, goal, &|| stop() || is_due());
        if (is_complete && goal == samples) || is_due() {
            self.show_light(cache);
        }
    }

    fn begin_light(&self, edge: u32, tracer: &Tracer, known: &LookupSet<'_>) -> GrowingReference {
        let number = number_of_reference(edge, self.earlier_samples());
        let settings = settings_of_reference(&self.settings.trace, number);
        let size = self.size.map(|pixels| pixels.div_ceil(edge));
        GrowingReference::begin(tracer, &self.camera, size, &settings, known)
    }

    /// Makes the light so far the reference that frames look up.
    fn show_light(&mut self, cache: &mut ReferenceCache) {
        let start = Instant::now();
        (self.is_lit, self.frames) = (true, 0);
        let Some(growing) = self.growing.as_ref().filter(|growing| growing.samples() > 0) else { return };
        let mut lit = growing.finish();
        let earlier = self.earlier.iter().flatten().find(|earlier| lit.can_merge(earlier));
        if let Some(earlier) = earlier {
            lit = lit.merged(earlier);
        }
        lit.is_refined = true;
        self.own_samples = lit.settings.samples;
        if let Some(last) = self.own.replace(cache.insert(Arc::new(lit))) {
            cache.remove(last);
        }
        self.renderer.forget_points();
        if let Some(deadline) = &mut self.deadline {
            deadline.filter_secs = start.elapsed().as_secs_f64();
            self.planned = deadline.frames().max(self.shown_points);
        }
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

/// Pictures for a time that is known.
#[cfg(feature = "pictures")]
impl RestPicture {
    /// The same picture for a time that is known: it goes to one reference, without stages before
    /// the last.
    #[must_use]
    pub(super) fn until(self, deadline: Deadline) -> Self {
        let (stages, planned) = (&STAGES[STAGES.len() - 1..], deadline.frames());
        Self { stages, deadline: Some(deadline), planned, ..self }
    }

    /// The last looked-up frame.
    pub(super) fn frame(&self) -> &Frame {
        self.renderer.frame()
    }

    /// Shows the light so far, however little: to be called where the work ends before a picture.
    pub(super) fn conclude(&mut self, tracer: &Tracer, cache: &mut ReferenceCache) {
        if !self.is_lit {
            self.show_light(cache);
        }
        self.add_frame(1, tracer, cache, NEVER);
    }

    /// The deadline, and what is known about the time that it takes to show light.
    pub(super) fn deadline(&self) -> Option<Deadline> {
        self.deadline
    }

    /// Measures, by a small reference of the view, how long it will take to show light. Until there
    /// is light of more pixels, that of the small reference is looked up.
    pub(super) fn rehearse(&mut self, tracer: &Tracer, cache: &mut ReferenceCache) {
        /// Pixels of the picture, along an edge, per pixel of the small one.
        const EDGE: u32 = 4;
        let known = LookupSet::without_references(cache, tracer.epoch());
        let mut small = self.begin_light(EDGE, tracer, &known);
        small.light(tracer, &known, 1, NEVER);
        self.own = Some(cache.insert(Arc::new(small.finish())));
        let request = FrameRequest::new(tracer, &self.camera, small.size(), &self.settings);
        self.renderer.render(&request.reusing(cache));
        // The first time also fills caches and allocates memory.
        self.renderer.forget_points();
        let start = Instant::now();
        small.finish();
        let filter_secs = start.elapsed().as_secs_f64();
        let frame_secs = self.renderer.render(&request.reusing(cache)).stats.secs.frame;
        self.renderer.forget_points();
        if let Some(deadline) = &mut self.deadline {
            let more = f64::from(EDGE * EDGE);
            (deadline.filter_secs, deadline.frame_secs) = (filter_secs * more, frame_secs * more);
            self.planned = deadline.frames();
        }
    }
}
