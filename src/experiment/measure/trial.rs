//! One view in one mode from given references: rendered again and again for its time, once for its error.

use super::errors::Errors;
use super::measurement::{TRUTH_SEED, see_through_percent};
use super::references::References;
use super::truth::{TruthRequest, truth};
use crate::camera::Camera;
use crate::experiment::run::{CellOutcome, ExperimentContext, RunRecord};
use crate::lookup::LookupSet;
use crate::reference::ReferenceFrame;
use crate::render::{Frame, Mode, RenderSettings, Renderer};
use crate::trace::TraceSettings;
use glam::Vec3;

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
            let lookup = LookupSet::new(self.references.cache(), context.tracer.epoch());
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
    /// [`crate::experiment::run::ExperimentError::Compare`] for a frame without pixels.
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
