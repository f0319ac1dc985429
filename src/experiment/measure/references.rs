//! References traced for a trial.

use crate::camera::Camera;
use crate::experiment::run::ExperimentContext;
use crate::reference::{ReferenceCache, ReferenceFrame, settings_of_reference};
use crate::trace::TraceSettings;
use std::sync::Arc;

/// References at given poses, for the warp and for the look-up.
#[derive(Debug)]
pub struct References {
    /// References in the order of their poses.
    pub frames: Vec<Arc<ReferenceFrame>>,
    cache: ReferenceCache,
}

impl References {
    /// Traces every pixel of a reference at each pose, each with a seed of its own. `None` after a
    /// stop.
    pub fn trace(context: &ExperimentContext<'_>, poses: &[Camera], trace: &TraceSettings) -> Option<Self> {
        let reference = |(number, pose): (u64, &Camera)| {
            let settings = settings_of_reference(trace, number);
            ReferenceFrame::trace(context.tracer, pose, context.settings.size, &settings, context.stop)
                .map(Arc::new)
        };
        let frames = (1..).zip(poses).map(reference).collect::<Option<Vec<_>>>()?;
        let mut cache = ReferenceCache::new(context.tracer.scene(), usize::MAX);
        for frame in &frames {
            cache.insert(Arc::clone(frame));
        }
        Some(Self { frames, cache })
    }

    /// No references.
    pub fn none(context: &ExperimentContext<'_>) -> Self {
        Self { frames: Vec::new(), cache: ReferenceCache::new(context.tracer.scene(), usize::MAX) }
    }

    /// Cache that holds all references, for the look-up.
    pub(super) fn cache(&self) -> &ReferenceCache {
        &self.cache
    }

    /// Wall time of tracing all references in seconds.
    pub fn secs(&self) -> f64 {
        // Not `sum`, which returns -0 for an empty list.
        self.frames.iter().fold(0.0, |sum, f| sum + f.secs)
    }
}
