//! Where the viewer will be, when too much is open; while the viewer moves, only where the reference is worth the frame
//! it costs.

use super::{PlacementRule, SPARSE_WORTH_PERCENT, Situation};
use crate::camera::Camera;
use crate::reference::placement::extrapolate::ahead;

/// See the module.
pub const PREDICTIVE: PlacementRule = PlacementRule {
    name: "predictive",
    about: "ahead on your way",
    has_threshold: true,
    poses_ahead: PlacementRule::none_ahead,
    decide,
    keeps: |lit_percent, percent| lit_percent > percent.min(SPARSE_WORTH_PERCENT),
};

/// How many frames ahead a predicted reference stands. On the gallery's walk (a quarter of a metre a frame) 3 to 6
/// frames need the fewest references for the same Type 3, 8 and 12 up to half as many again.
const FRAMES_AHEAD: f64 = 4.0;

fn decide(now: &mut Situation<'_>) -> Option<Camera> {
    let (seen, worth) = (now.seen, now.seen.worth_percent(now.percent));
    if !seen.is_sparse && seen.open_percent <= now.percent {
        return None;
    }
    // The next frames would be cut there as well.
    if seen.is_sparse && seen.was_cut && seen.open_percent > worth {
        return Some(seen.camera);
    }
    if !seen.is_still() && (seen.is_sparse || seen.held > 0) {
        let ahead = ahead(seen, now.tracer, FRAMES_AHEAD);
        if (now.foresee)(&ahead, None) > worth {
            return Some(ahead);
        }
    }
    (!seen.is_sparse && seen.open_percent > worth).then_some(seen.camera)
}
