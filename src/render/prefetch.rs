//! The references that a policy wants before they are needed, and which of them are missing.

use crate::camera::Camera;
use crate::reference::{
    ReferenceCache,
    placement::{PlacementPolicy, PrefetchRequest},
};
use crate::trace::{SceneEpoch, Tracer};

/// The share of the cache that prefetched references may fill, 0..1. The rest is for references
/// that frames turn out to need.
const CACHE_SHARE: f64 = 0.75;

/// Memory of a reference, bytes per pixel, with bounces and without mirrors or glass.
const BYTES_PER_PIXEL: f64 = 17.0;

/// Prefetched references at most, whatever the budget: three quarters of a cache's slots.
const MAX_PREFETCHED: usize = 96;

/// What the list of poses depends on.
#[derive(Clone, Debug, PartialEq)]
struct Basis {
    rule: &'static str,
    epoch: SceneEpoch,
    request: PrefetchRequest,
}

/// The poses of references that are still missing.
#[derive(Clone, Debug, Default)]
pub(super) struct Prefetch {
    basis: Option<Basis>,
    missing: Vec<Camera>,
}

impl Prefetch {
    /// The missing pose nearest to a viewer. A reference that was traced once is not requested
    /// again, even if it was evicted.
    pub(super) fn next(
        &mut self,
        tracer: &Tracer,
        cache: &ReferenceCache,
        policy: &PlacementPolicy,
        (viewer, size): (&Camera, [u32; 2]),
    ) -> Option<Camera> {
        let pixels = f64::from(size[0]) * f64::from(size[1]);
        let room = CACHE_SHARE * cache.budget_bytes() as f64 / (pixels * BYTES_PER_PIXEL);
        let request = PrefetchRequest {
            size,
            fov_y: viewer.fov_y,
            max_references: (room as usize).clamp(1, MAX_PREFETCHED),
        };
        let basis = Basis { rule: policy.rule.name, epoch: tracer.epoch(), request };
        if self.basis.as_ref() != Some(&basis) {
            self.missing = (policy.rule.prefetch_poses)(tracer, &request);
            self.basis = Some(basis);
        }
        self.missing.retain(|pose| !cache.entries().iter().any(|e| e.frame.camera == *pose));
        let distance = |pose: &Camera| pose.eye.distance_squared(viewer.eye);
        self.missing.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).copied()
    }
}
