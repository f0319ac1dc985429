//! Where the next reference should stand.

use crate::camera::Camera;
use crate::math::Ray;
use crate::trace::Tracer;
use serde::{Deserialize, Serialize};

/// A rule for adding references. A policy is data: what it decides depends on the observation alone.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PlacementPolicy {
    /// Never.
    None,
    /// Where the viewer is, when Type 3 exceeds a percentage of the pixels.
    Threshold {
        /// Of the pixels.
        percent: f64,
    },
    /// Where the viewer will be, when Type 3 exceeds a percentage of the pixels; while the viewer moves, only where the
    /// reference is worth the frame it costs.
    Predictive {
        /// Of the pixels.
        percent: f64,
    },
}

impl Default for PlacementPolicy {
    fn default() -> Self {
        Self::Predictive { percent: 5.0 }
    }
}

/// What a policy sees of the last frame.
#[derive(Clone, Copy, Debug)]
pub struct Observation {
    /// The frame's camera.
    pub camera: Camera,
    /// The camera one frame before; the same where there was none.
    pub previous: Camera,
    /// Pixels in percent that a reference here would have to light: Type 3 for the paper's references, for sparse ones
    /// only what no reference knows.
    pub open_percent: f64,
    /// Whether references light only what older ones do not know.
    pub is_sparse: bool,
    /// The frame was stopped before its end, so that what it lit is not kept.
    pub was_cut: bool,
    /// References held.
    pub held: usize,
}

/// Foretells the Type 3 percentage of a pose from the references held.
pub type Foresight<'a> = &'a mut dyn FnMut(&Camera) -> f64;

/// How many frames ahead a predicted reference stands. On the gallery's walk (a quarter of a metre a frame) 3 to 6
/// frames need the fewest references for the same Type 3, 8 and 12 up to half as many again.
const FRAMES_AHEAD: f64 = 4.0;

/// A reference costs what tracing a whole frame does. While the viewer moves, one is worth it only where at least this
/// percentage of the picture would be open, whatever the threshold: on the gallery's walk 71 references with 5.7 % Type 3
/// in the median, against 102 with 4.0 % where 5 % open ahead suffice.
const WORTH_PERCENT: f64 = 20.0;

/// A sparse reference costs little more than the pixels it lights, and those would be shaded in frame after frame. So
/// one is worth it where this percentage of the picture ahead is not known.
const SPARSE_WORTH_PERCENT: f64 = 1.0;

/// A predicted turn is cut here, in radians: beyond half the field of view the new picture would share nothing.
const LARGEST_TURN: f64 = 0.5;

/// A predicted eye stays this share of the free way in front of the next surface.
const FREE_SHARE: f64 = 0.6;

impl PlacementPolicy {
    /// The pose at which a new reference is wanted, if any.
    pub fn decide(&self, seen: &Observation, tracer: &Tracer, foresee: Foresight<'_>) -> Option<Camera> {
        match *self {
            Self::None => None,
            // What a frame had to light itself it keeps; see `keeps`.
            Self::Threshold { .. } if seen.is_sparse => None,
            Self::Threshold { percent } => (seen.open_percent > percent).then_some(seen.camera),
            // The next frames would be cut there as well.
            Self::Predictive { percent }
                if seen.is_sparse
                    && seen.was_cut
                    && seen.open_percent > SPARSE_WORTH_PERCENT.min(percent) =>
            {
                Some(seen.camera)
            }
            Self::Predictive { percent } if seen.is_sparse => {
                let ahead = ahead(seen, tracer);
                (seen.camera != seen.previous && foresee(&ahead) > SPARSE_WORTH_PERCENT.min(percent))
                    .then_some(ahead)
            }
            Self::Predictive { percent } => {
                if seen.open_percent <= percent {
                    return None;
                }
                let ahead = ahead(seen, tracer);
                let is_still = seen.camera == seen.previous;
                let worth = if is_still || seen.held == 0 { percent } else { percent.max(WORTH_PERCENT) };
                if !is_still && seen.held > 0 && foresee(&ahead) > worth {
                    return Some(ahead);
                }
                (seen.open_percent > worth).then_some(seen.camera)
            }
        }
    }

    /// Whether a frame that lit this percentage of its pixels itself is kept as a sparse reference.
    pub fn keeps(&self, lit_percent: f64) -> bool {
        match *self {
            Self::None => false,
            Self::Threshold { percent } => lit_percent > percent,
            Self::Predictive { percent } => lit_percent > percent.min(SPARSE_WORTH_PERCENT),
        }
    }

    /// The name used on the command line.
    pub fn name(&self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Threshold { .. } => "threshold",
            Self::Predictive { .. } => "predictive",
        }
    }
}

/// The camera [`FRAMES_AHEAD`] frames on if the motion of the last frame goes on, never through a wall.
fn ahead(seen: &Observation, tracer: &Tracer) -> Camera {
    use std::f64::consts::{PI, TAU};
    let turn = |now: f64, before: f64| {
        let step = (now - before + PI).rem_euclid(TAU) - PI;
        (step * FRAMES_AHEAD).clamp(-LARGEST_TURN, LARGEST_TURN)
    };
    let way = (seen.camera.eye - seen.previous.eye) * FRAMES_AHEAD;
    let frame = &tracer.scene().frame;
    let from = frame.scene_from_world_f64(seen.camera.eye).as_vec3();
    let direction = (way * frame.units_per_metre).as_vec3();
    let free = match tracer.closest(&Ray::new(from, direction)) {
        Some(hit) => (f64::from(hit.t) * FREE_SHARE).min(1.0),
        None => 1.0,
    };
    Camera {
        eye: seen.camera.eye + way * free,
        yaw: seen.camera.yaw + turn(seen.camera.yaw, seen.previous.yaw),
        pitch: (seen.camera.pitch + turn(seen.camera.pitch, seen.previous.pitch)).clamp(-PI / 2.0, PI / 2.0),
        fov_y: seen.camera.fov_y,
    }
}
