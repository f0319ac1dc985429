//! References traced for a trial.

use crate::camera::Camera;
use crate::experiment::run::ExperimentContext;
use crate::reference::{ReferenceCache, ReferenceFrame, settings_of_reference};
use crate::render::Mode;
use crate::trace::TraceSettings;
use std::sync::Arc;

/// References at given poses: traced once, and stored for the warp and for look-ups, which differ
/// in their smooth light.
#[derive(Debug)]
pub struct References {
    warped: ReferenceCache,
    /// `None` without bounces, where both are the same.
    looked_up: Option<ReferenceCache>,
}

impl References {
    /// Traces every pixel of a reference at each pose, each with a seed of its own. `None` after a
    /// stop.
    pub fn trace(context: &ExperimentContext<'_>, poses: &[Camera], trace: &TraceSettings) -> Option<Self> {
        let tracer = context.tracer;
        let mut references = Self::none(context);
        references.looked_up = (trace.bounces > 0).then(|| empty(context));
        for (number, pose) in (1..).zip(poses) {
            let settings = settings_of_reference(trace, number);
            let size = context.settings.size;
            let (frame, samples) =
                ReferenceFrame::trace_samples(tracer, pose, size, (&settings, false), context.stop)?;
            if let Some(looked_up) = &mut references.looked_up {
                // Where normals are tilted, look-ups want the light of others.
                let filtered = match tracer.scene().features.normal_maps {
                    true => ReferenceFrame::trace_filtered(tracer, pose, size, &settings, context.stop)?,
                    false => frame.clone().filtered(tracer, &samples),
                };
                looked_up.insert(Arc::new(filtered));
            }
            references.warped.insert(Arc::new(frame));
        }
        Some(references)
    }

    /// No references.
    pub fn none(context: &ExperimentContext<'_>) -> Self {
        Self { warped: empty(context), looked_up: None }
    }

    /// Cache that holds all references as a mode reuses them.
    pub(super) fn cache(&self, mode: Mode) -> &ReferenceCache {
        self.looked_up.as_ref().filter(|_| mode.looks_up()).unwrap_or(&self.warped)
    }

    /// Wall time in seconds of making all references for a mode.
    pub fn secs(&self, mode: Mode) -> f64 {
        self.cache(mode).entries().iter().map(|entry| entry.frame.secs).sum()
    }
}

fn empty(context: &ExperimentContext<'_>) -> ReferenceCache {
    ReferenceCache::new(context.tracer.scene(), usize::MAX)
}
