//! References traced for a trial.

use crate::camera::Camera;
use crate::experiment::run::ExperimentContext;
use crate::reference::{ReferenceCache, ReferenceFrame, settings_of_reference};
use crate::trace::TraceSettings;
use std::sync::Arc;

/// References at given poses, for the warp and for the look-up.
#[derive(Debug)]
pub struct References {
    cache: ReferenceCache,
    secs: f64,
}

impl References {
    /// Traces every pixel of a reference at each pose, each with a seed of its own. `None` after a
    /// stop.
    pub fn trace(context: &ExperimentContext<'_>, poses: &[Camera], trace: &TraceSettings) -> Option<Self> {
        let mut references = Self::none(context);
        for (number, pose) in (1..).zip(poses) {
            let settings = settings_of_reference(trace, number);
            let size = context.settings.size;
            let frame = ReferenceFrame::trace(context.tracer, pose, size, &settings, context.stop)?;
            references.secs += frame.secs;
            references.cache.insert(Arc::new(frame));
        }
        Some(references)
    }

    /// No references.
    pub fn none(context: &ExperimentContext<'_>) -> Self {
        Self { cache: ReferenceCache::new(context.tracer.scene(), usize::MAX), secs: 0.0 }
    }

    /// Cache that holds all references.
    pub(super) fn cache(&self) -> &ReferenceCache {
        &self.cache
    }

    /// Wall time of tracing all references in seconds.
    pub fn secs(&self) -> f64 {
        self.secs
    }
}
