//! Never: references are those that the viewer asks for.

use super::PlacementRule;

/// See the module.
pub const NONE: PlacementRule = PlacementRule {
    name: "none",
    about: "only when asked for",
    has_threshold: false,
    poses_ahead: PlacementRule::none_ahead,
    decide: |_| None,
    keeps: |_, _| false,
};
