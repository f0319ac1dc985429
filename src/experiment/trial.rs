//! One view in one mode from given references: rendered again and again for its time, once for its error.

use super::errors::Errors;
use super::measure::{TRUTH_SEED, see_through_percent};
use super::run::{CellOutcome, ExperimentContext, ExperimentError, RunRecord};
use super::truth::{TruthRequest, truth};
use crate::camera::Camera;
use crate::lookup::LookupSet;
use crate::reference::{ReferenceCache, ReferenceFrame};
use crate::render::{Frame, Mode, RenderSettings, Renderer};
use crate::trace::TraceSettings;
use glam::Vec3;
use std::sync::Arc;

/// References at hand, for the warp and for the look-up.
#[derive(Debug)]
pub struct References {
    /// One by one.
    pub frames: Vec<Arc<ReferenceFrame>>,
    cache: ReferenceCache,
}

impl References {
    /// Traces every pixel of references at poses, each with a seed of its own. `None` after a stop.
    pub fn trace(context: &ExperimentContext<'_>, poses: &[Camera], trace: &TraceSettings) -> Option<Self> {
        let reference = |(number, pose): (u64, &Camera)| {
            let settings = TraceSettings { seed: trace.seed.wrapping_add(number << 32), ..*trace };
            ReferenceFrame::trace(context.tracer, pose, context.settings.size, &settings, context.stop)
                .map(Arc::new)
        };
        let frames = (1..).zip(poses).map(reference).collect::<Option<Vec<_>>>()?;
        let mut cache = ReferenceCache::new(context.tracer.scene(), usize::MAX);
        frames.iter().for_each(|f| {
            cache.insert(Arc::clone(f));
        });
        Some(Self { frames, cache })
    }

    /// None at all.
    pub fn none(context: &ExperimentContext<'_>) -> Self {
        Self { frames: Vec::new(), cache: ReferenceCache::new(context.tracer.scene(), usize::MAX) }
    }

    /// Seconds that tracing them took, together.
    pub fn secs(&self) -> f64 {
        // Not `sum`, which makes -0 of nothing.
        self.frames.iter().fold(0.0, |sum, f| sum + f.secs)
    }
}

/// What is rendered.
#[derive(Clone, Copy, Debug)]
pub struct Trial<'a> {
    /// How.
    pub mode: Mode,
    /// With which samples and seed.
    pub trace: TraceSettings,
    /// From where.
    pub camera: Camera,
    /// And from what.
    pub references: &'a References,
}

impl Trial<'_> {
    /// One frame. `None` after a stop.
    pub fn render<'r>(
        &self,
        context: &ExperimentContext<'_>,
        renderer: &'r mut Renderer,
    ) -> Option<&'r Frame> {
        let settings = RenderSettings { mode: self.mode, trace: self.trace };
        let size = context.settings.size;
        if self.mode.looks_up() {
            let lookup = LookupSet::new(&self.references.cache, context.tracer.epoch());
            renderer.render_by_lookup(context.tracer, &self.camera, size, &settings, &lookup, context.stop);
        } else {
            let references: Vec<&ReferenceFrame> = self.references.frames.iter().map(|r| &**r).collect();
            renderer.render(context.tracer, &self.camera, size, &settings, &references, context.stop);
        }
        let frame = renderer.frame();
        frame.stats.is_complete.then_some(frame)
    }

    /// A record for every repetition, the first of them marked as a warm-up, all with the errors of the frame, which are
    /// the same in each. The frame stays in `renderer`. `None` after a stop.
    ///
    /// # Errors
    /// [`ExperimentError::Compare`] for a frame without pixels.
    pub fn measure(
        &self,
        context: &ExperimentContext<'_>,
        truth: &[Vec3],
        renderer: &mut Renderer,
    ) -> CellOutcome {
        let mut records = Vec::new();
        for repetition in 0..=context.settings.repetitions {
            // The same view a second time would find all that was traced for the first.
            renderer.forget_points();
            let Some(frame) = self.render(context, renderer) else { return Ok(None) };
            let stats = &frame.stats;
            records.push(
                RunRecord::default()
                    .with("repetition", repetition)
                    .with("is_warm_up", repetition == 0)
                    .with("frame_secs", stats.secs.frame)
                    .with("type1_secs", stats.secs.warp)
                    .with("type2_secs", stats.secs.secondary)
                    .with("type3_secs", stats.secs.trace)
                    .with("reference_secs", self.references.secs())
                    .with("pixels", stats.types.total())
                    .with_fields(&stats.types.percentages())
                    .with_fields(&serde_json::json!({ "rays": stats.rays })),
            );
        }
        let frame = renderer.frame();
        let Some(see_through) = self.see_through_percent(context, frame) else { return Ok(None) };
        let errors = Errors::of(frame, truth, context.exposure_ev(truth))?;
        let with_errors = |r: RunRecord| r.with_fields(&errors).with("see_through_percent", see_through);
        Ok(Some(records.into_iter().map(with_errors).collect()))
    }

    /// Reused pixels that show another surface than the primary ray's: none where that is where surfaces come from.
    /// `None` after a stop.
    fn see_through_percent(&self, context: &ExperimentContext<'_>, frame: &Frame) -> Option<f64> {
        if self.mode != Mode::Paper {
            return Some(0.0);
        }
        let settings = RenderSettings { mode: Mode::Full, trace: TraceSettings { samples: 1, ..self.trace } };
        let mut full = Renderer::default();
        full.render(context.tracer, &self.camera, context.settings.size, &settings, &[], context.stop);
        full.frame().stats.is_complete.then(|| see_through_percent(frame, full.frame()))
    }
}

/// The converged picture of a view. `None` after a stop.
pub fn truth_of(context: &ExperimentContext<'_>, camera: &Camera) -> Option<Vec<Vec3>> {
    let settings = TraceSettings {
        samples: context.settings.truth_samples,
        seed: context.settings.seed ^ TRUTH_SEED,
        bounces: context.settings.bounces,
    };
    let request = TruthRequest { tracer: context.tracer, camera, size: context.settings.size, settings };
    // Where it cannot be kept it is only slower the next time.
    truth(&request, context.truth_folder, context.stop).map(|(radiance, _)| radiance)
}

/// The camera at a share of the walk, 0 its start, 1 its end; beyond them those.
///
/// # Errors
/// [`ExperimentError::Unsuitable`] for a walk without key frames.
pub fn camera_on_walk(context: &ExperimentContext<'_>, share: f64) -> Result<Camera, ExperimentError> {
    /// The walk is divided into so many frames, fine enough for any share.
    const FRAMES: u32 = 10_001;
    let frame = (f64::from(FRAMES - 1) * share.clamp(0.0, 1.0)).round() as u32;
    let none = || ExperimentError::Unsuitable("the walk has no key frames; it needs at least one".to_owned());
    context.walk.camera(frame, FRAMES).ok_or_else(none)
}
