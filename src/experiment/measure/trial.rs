//! One view in one mode from given references: rendered several times for its time, compared once
//! for its error.

use super::measurement::{TRUTH_SEED, see_through_percent};
use super::truth::{TruthRequest, truth};
use super::{errors::Errors, references::References};
use crate::camera::Camera;
use crate::experiment::run::{CellOutcome, ExperimentContext, RunRecord};
use crate::render::{CONVERGED_PASSES, Frame, FrameRequest, Mode, RenderSettings, Renderer};
use crate::trace::TraceSettings;
use glam::Vec3;

/// One view in one mode from given references.
#[derive(Clone, Copy, Debug)]
pub struct Trial<'a> {
    /// Rendering mode.
    pub mode: Mode,
    /// Samples, bounces and seed.
    pub trace: TraceSettings,
    /// Camera of the view.
    pub camera: Camera,
    /// References that the frame may reuse.
    pub references: &'a References,
}

impl Trial<'_> {
    /// Renders one frame. `None` after a stop.
    pub fn render<'r>(
        &self,
        context: &ExperimentContext<'_>,
        renderer: &'r mut Renderer,
    ) -> Option<&'r Frame> {
        let settings = RenderSettings { mode: self.mode, trace: self.trace };
        let size = context.settings.size;
        let request = FrameRequest::new(context.tracer, &self.camera, size, &settings);
        renderer.render(&request.reusing(self.references.cache(self.mode)).with_stop(context.stop));
        let frame = renderer.frame();
        frame.stats.is_complete.then_some(frame)
    }

    /// Renders the view `repetitions + 1` times and returns a record of each; the first is marked
    /// as a warm-up. Every record has the errors of the frame, which are equal in all repetitions.
    /// The frame stays in `renderer`. `None` after a stop.
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
            // Otherwise the second repetition would reuse all points that the first one traced.
            renderer.forget_points();
            let Some(frame) = self.render(context, renderer) else { return Ok(None) };
            let stats = &frame.stats;
            records.push(
                RunRecord::default()
                    .with("repetition", repetition)
                    .with("is_warm_up", repetition == 0)
                    .with("frame_secs", stats.secs.frame)
                    .with("type1_secs", stats.secs.visibility_and_lookup)
                    .with("type2_secs", stats.secs.secondary)
                    .with("type3_secs", stats.secs.trace)
                    .with("reference_secs", self.references.secs(self.mode))
                    .with("pixels", stats.types.total())
                    .with_fields(&stats.types.percentages())
                    .with_fields(&serde_json::json!({ "rays": stats.rays })),
            );
        }
        let frame = renderer.frame();
        let Some(see_through) = self.see_through_percent(context, frame) else { return Ok(None) };
        let errors = Errors::of(frame, truth, context.settings.exposure_ev)?;
        let with_errors = |r: RunRecord| r.with_fields(&errors).with("see_through_percent", see_through);
        Ok(Some(records.into_iter().map(with_errors).collect()))
    }

    /// Returns the share of reused pixels, in percent, that show another surface than the primary
    /// ray hits. It is 0 in modes that trace primary rays. `None` after a stop.
    fn see_through_percent(&self, context: &ExperimentContext<'_>, frame: &Frame) -> Option<f64> {
        if self.mode != Mode::Paper {
            return Some(0.0);
        }
        let settings = RenderSettings { mode: Mode::Full, trace: TraceSettings { samples: 1, ..self.trace } };
        let mut full = Renderer::default();
        full.render(
            &FrameRequest::new(context.tracer, &self.camera, context.settings.size, &settings)
                .with_stop(context.stop),
        );
        full.frame().stats.is_complete.then(|| see_through_percent(frame, full.frame()))
    }
}

/// Returns the converged picture of a view. `None` after a stop.
pub fn truth_of(context: &ExperimentContext<'_>, camera: &Camera) -> Option<Vec<Vec3>> {
    let samples = context.settings.truth_samples;
    kept_truth(context, camera, 1, TraceSettings { samples, ..context.settings.trace() })
}

/// Returns the converged picture of a view with smooth edges, as a stationary picture is refined.
/// `None` after a stop.
pub fn antialiased_truth_of(context: &ExperimentContext<'_>, camera: &Camera) -> Option<Vec<Vec3>> {
    let (passes, settings) = spread_over_passes(context.settings.truth_samples, context.settings.trace());
    kept_truth(context, camera, passes, settings)
}

/// Returns the number of passes over a picture and the settings of each, for `samples` per pixel in
/// total: as many passes as a refined picture has, through different points of each pixel.
pub fn spread_over_passes(samples: u32, trace: TraceSettings) -> (u32, TraceSettings) {
    let passes = CONVERGED_PASSES.min(samples).max(1);
    (passes, TraceSettings { samples: (samples / passes).max(1), ..trace })
}

fn kept_truth(
    context: &ExperimentContext<'_>,
    camera: &Camera,
    passes: u32,
    settings: TraceSettings,
) -> Option<Vec<Vec3>> {
    let settings = TraceSettings { seed: settings.seed ^ TRUTH_SEED, ..settings };
    let (tracer, size) = (context.tracer, context.settings.size);
    let request = TruthRequest { tracer, camera, size, settings, passes };
    // A picture that cannot be kept only costs time in the next run.
    truth(&request, context.truth_folder, context.stop).map(|(radiance, _)| radiance)
}
