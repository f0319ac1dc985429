//! A reference to be traced, on this thread or another.

use crate::camera::Camera;
use crate::lookup::LookupSet;
use crate::reference::{ReferenceFrame, ReferenceSnapshot};
use crate::trace::{TraceSettings, Tracer, parallel::Stop};
use std::sync::Arc;

/// A reference to be traced.
#[derive(Clone, Debug)]
pub struct ReferenceJob {
    /// The scene, ready to be traced.
    pub tracer: Arc<Tracer>,
    /// The pose.
    pub camera: Camera,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Sample count, bounces and seed.
    pub settings: TraceSettings,
    /// References whose light is known and need not be traced again; `None` lights every pixel, as
    /// mode `paper` needs it.
    pub known: Option<ReferenceSnapshot>,
}

impl ReferenceJob {
    /// Traces the reference on the current thread pool. Returns `None` after a stop.
    pub fn trace(&self, stop: Stop<'_>) -> Option<ReferenceFrame> {
        profiling::scope!("reference");
        let (tracer, camera, size, settings) = (&self.tracer, &self.camera, self.size, &self.settings);
        let made = match &self.known {
            None => ReferenceFrame::trace(tracer, camera, size, settings, stop),
            Some(known) => {
                let lookup = LookupSet::of_snapshot(known, tracer.epoch());
                ReferenceFrame::trace_sparse(tracer, camera, size, settings, &lookup, stop)
            }
        };
        if let Some(reference) = &made {
            log::debug!(
                "a reference of {}x{} pixels is traced, in {:.3} s",
                size[0],
                size[1],
                reference.secs
            );
        }
        made
    }
}
