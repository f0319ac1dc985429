//! Where the viewer is, when too much is open: the paper's rule.

use super::{PlacementRule, Situation};
use crate::camera::Camera;

/// See the module.
pub const THRESHOLD: PlacementRule = PlacementRule {
    name: "threshold",
    about: "where you are",
    has_threshold: true,
    poses_ahead: PlacementRule::none_ahead,
    decide,
    keeps: |lit_percent, percent| lit_percent > percent,
};

fn decide(now: &mut Situation<'_>) -> Option<Camera> {
    // What a frame of a mode with sparse references had to light itself it keeps.
    let is_wanted = !now.seen.is_sparse && now.seen.open_percent > now.percent;
    is_wanted.then_some(now.seen.camera)
}
