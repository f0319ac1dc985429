//! Where the paths of smooth light may end.

use crate::trace::{SurfacePoint, Tracer};
use glam::Vec3;

/// The ray that reads cached light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reader {
    /// Its length, scene units.
    pub length: f32,
    /// Size of the pixel that it serves on the surface that it starts from, scene units.
    pub footprint: f32,
    /// Paths of that pixel.
    pub samples: u32,
}

/// Light that is known at the surfaces which bounce rays meet. It is read there only, never where a
/// camera looks.
pub trait CachedLight: Sync {
    /// Returns all light that arrives at a point, as the radiance of a white surface; `None` where
    /// it is not known well enough for this reader, so that the path must be traced on.
    fn light_at(&self, tracer: &Tracer, point: &SurfacePoint, reader: &Reader) -> Option<Vec3>;
}
