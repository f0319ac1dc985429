//! The section through which the camera sees the scene, as the renderer needs it.

use afterimage::Tracer;
use afterimage::trace::section::CutPlane;
use std::sync::Arc;

/// A plane that cuts the scene open for the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenSection {
    /// The plane, world metres.
    pub plane: CutPlane,
    /// Radiance of the ground and the lines of cut surfaces.
    pub tones: [f32; 2],
}

impl SeenSection {
    /// The tracer of the cut scene; the same one where there is no section.
    pub fn of(section: Option<Self>, tracer: &Arc<Tracer>) -> Arc<Tracer> {
        section.map_or_else(|| tracer.clone(), |s| Arc::new(tracer.with_section(&[s.plane], s.tones)))
    }
}
