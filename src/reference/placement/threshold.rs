//! Rule `threshold`, the paper's: a reference at the viewer's pose when too many pixels are open.

use super::rule::{PlacementRule, Situation};
use crate::camera::Camera;

/// Rule that places a reference at the viewer's pose above a percentage of open pixels.
pub const THRESHOLD: PlacementRule = PlacementRule {
    name: "threshold",
    about: "at your position",
    has_threshold: true,
    prefetch_poses: PlacementRule::no_prefetch,
    decide,
    keeps_frame: |lit_percent, percent| lit_percent > percent,
};

fn decide(now: &mut Situation<'_>) -> Option<Camera> {
    // With sparse references the frame itself is kept instead: see `keeps_frame`.
    let is_wanted = !now.seen.is_sparse && now.seen.open_percent > now.percent;
    is_wanted.then_some(now.seen.camera)
}
