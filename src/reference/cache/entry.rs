//! A reference in the cache.

use crate::reference::ReferenceFrame;
use crate::trace::SceneEpoch;
use std::sync::Arc;

/// Identifies a reference. Unique while the program runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ReferenceId(pub u32);

/// A reference in the cache.
#[derive(Clone, Debug)]
pub struct CachedReference {
    /// Identity of the reference.
    pub id: ReferenceId,
    /// The reference image. A frame in flight keeps it alive after eviction.
    pub frame: Arc<ReferenceFrame>,
    /// Share of recent frames' pixels that the reference supplied, 0..1, as a decaying mean.
    pub contribution: f32,
    /// False if frames and new references ignore this reference.
    pub is_enabled: bool,
    pub(super) last_used: u64,
    /// Bit of the reference in the directory.
    pub(crate) slot: usize,
}

impl CachedReference {
    /// Returns true if the reference shows this state of the scene and is enabled.
    pub(crate) fn is_usable(&self, epoch: SceneEpoch) -> bool {
        self.is_enabled && self.frame.epoch == epoch
    }
}
