//! Rule `predictive`: a reference at the pose that the viewer will have a few frames from now, when
//! too many pixels are open. While the viewer moves, only where the reference saves more than it
//! costs.

use super::extrapolate::pose_after;
use super::rule::{MIN_OPEN_PERCENT_SPARSE, PlacementRule, Situation};
use crate::camera::Camera;

/// Rule that places references at the extrapolated pose.
pub const PREDICTIVE: PlacementRule = PlacementRule {
    name: "predictive",
    about: "at the position predicted from your motion",
    has_threshold: true,
    prefetch_poses: PlacementRule::no_prefetch,
    decide,
    keeps_frame: |lit_percent, percent| lit_percent > percent.min(MIN_OPEN_PERCENT_SPARSE),
};

/// Number of frames that the pose is extrapolated by. On the gallery's walk (a quarter of a metre
/// per frame) 3 to 6 frames need the fewest references for the same Type 3; 8 and 12 need up to
/// half as many again.
const FRAMES_AHEAD: f64 = 4.0;

fn decide(now: &mut Situation<'_>) -> Option<Camera> {
    if now.is_covered() {
        return None;
    }
    let (seen, worthwhile) = (now.seen, now.seen.worthwhile_percent(now.percent));
    if now.needs_reference_here() {
        return Some(seen.camera);
    }
    if !seen.is_still() && (seen.is_sparse || seen.held > 0) {
        let pose = pose_after(seen, now.tracer, FRAMES_AHEAD);
        if (now.predict_open)(&pose, None) > worthwhile {
            return Some(pose);
        }
    }
    (!seen.is_sparse && seen.open_percent > worthwhile).then_some(seen.camera)
}
