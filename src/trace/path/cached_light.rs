//! Where the paths of smooth light may end.

use crate::trace::{SurfacePoint, Tracer};
use glam::Vec3;

/// Light that is known at the surfaces which bounce rays meet. It is read there only, never where a
/// camera looks.
pub trait CachedLight: Sync {
    /// Returns all light that arrives at a point, as the radiance of a white surface, for a ray of
    /// this `length` in scene units; `None` where it is not known well enough, so that the path must
    /// be traced on.
    fn light_at(&self, tracer: &Tracer, point: &SurfacePoint, length: f32) -> Option<Vec3>;
}
