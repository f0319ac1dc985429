//! The subject of an audit.

use crate::render::frame::Frame;
use crate::trace::{TraceSettings, Tracer};

/// A frame to be audited, with what it was rendered from.
#[derive(Clone, Copy, Debug)]
pub struct Audited<'a> {
    /// The scene, ready to be traced.
    pub tracer: &'a Tracer,
    /// A complete frame of a mode that looks up.
    pub frame: &'a Frame,
    /// Sample count, bounces and seed of the frame.
    pub trace: &'a TraceSettings,
}

impl Audited<'_> {
    /// Factor from radiance to display values before the display curve: the exposure of the scene,
    /// and 1 while its automatic exposure is not known.
    pub(super) fn exposure(&self) -> f32 {
        self.tracer.stops(self.tracer.scene().exposure).unwrap_or_default().exp2()
    }
}
