//! Rule `none`: no reference is placed automatically, only at the user's request.

use super::rule::PlacementRule;

/// Rule that never places a reference.
pub const NONE: PlacementRule = PlacementRule {
    name: "none",
    about: "only at your request",
    has_threshold: false,
    prefetch_poses: PlacementRule::no_prefetch,
    decide: |_| None,
    keeps_frame: |_, _| false,
};
