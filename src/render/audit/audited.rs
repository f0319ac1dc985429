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
