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
    /// Where the viewer will be, when Type 3 exceeds a percentage of the pixels.
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
    /// Type 3 pixels in percent.
    pub type3_percent: f64,
    /// References held.
    pub held: usize,
}

/// How many frames ahead a predicted reference stands. On the gallery's walk (0.2 m a frame) that is 1.6 m: near
/// enough to share most of what is seen now, far enough to serve some sixteen frames around it.
const FRAMES_AHEAD: f64 = 8.0;

/// A predicted turn is cut here, in radians: beyond half the field of view the new picture would share nothing.
const LARGEST_TURN: f64 = 0.5;

/// A predicted eye stays this share of the free way in front of the next surface.
const FREE_SHARE: f64 = 0.6;

impl PlacementPolicy {
    /// The pose at which a new reference is wanted, if any.
    pub fn decide(&self, seen: &Observation, tracer: &Tracer) -> Option<Camera> {
        match *self {
            Self::None => None,
            Self::Threshold { percent } => (seen.type3_percent > percent).then_some(seen.camera),
            Self::Predictive { percent } => (seen.type3_percent > percent)
                .then(|| if seen.held == 0 { seen.camera } else { ahead(seen, tracer) }),
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
