//! References that a policy wants before they are needed: which of them are still to be made.

use crate::camera::Camera;
use crate::reference::ReferenceCache;
use crate::reference::placement::{PlacementPolicy, PrefetchRequest};
use crate::trace::{SceneEpoch, Tracer};

/// The share of the cache that such references may fill; the rest is for those that frames show to be missing.
const CACHE_SHARE: f64 = 0.75;

/// Memory of a reference at most.
const BYTES_PER_PIXEL: f64 = 16.0;

/// At most, whatever the cache holds: three quarters of the references that it can tell apart.
const MAX_AHEAD: usize = 96;

/// What decides the list.
#[derive(Clone, Debug, PartialEq)]
struct Basis {
    rule: &'static str,
    epoch: SceneEpoch,
    request: PrefetchRequest,
}

/// The poses that are still missing.
#[derive(Clone, Debug, Default)]
pub(crate) struct Ahead {
    basis: Option<Basis>,
    missing: Vec<Camera>,
}

impl Ahead {
    /// The missing pose next to a viewer. A reference that was made once is not made again, evicted or not.
    pub(crate) fn next(
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
            max_references: (room as usize).clamp(1, MAX_AHEAD),
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
