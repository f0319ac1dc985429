//! A reference to be traced, by this thread or another.

use crate::camera::Camera;
use crate::lookup::LookupSet;
use crate::reference::{ReferenceFrame, ReferenceSnapshot};
use crate::trace::parallel::Stop;
use crate::trace::{TraceSettings, Tracer};
use std::sync::Arc;

/// A reference to be traced.
#[derive(Clone, Debug)]
pub struct ReferenceJob {
    /// Of this scene.
    pub tracer: Arc<Tracer>,
    /// Here.
    pub camera: Camera,
    /// In pixels.
    pub size: [u32; 2],
    /// Samples, bounces, seed.
    pub settings: TraceSettings,
    /// What is known already and need not be lit; `None` lights every pixel, as the paper does.
    pub known: Option<ReferenceSnapshot>,
}

impl ReferenceJob {
    /// Traces it on the current thread pool. `None` after a stop.
    pub fn trace(&self, stop: Stop<'_>) -> Option<ReferenceFrame> {
        let (tracer, camera, size, settings) = (&self.tracer, &self.camera, self.size, &self.settings);
        match &self.known {
            None => ReferenceFrame::trace(tracer, camera, size, settings, stop),
            Some(known) => {
                let lookup = LookupSet::of_snapshot(known, tracer.epoch());
                ReferenceFrame::trace_sparse(tracer, camera, size, settings, &lookup, stop)
            }
        }
    }
}
