//! Six walks derived from a scene's own walk, so that every scene has them.

use crate::camera::{Camera, CameraPath};
use crate::experiment::run::ExperimentContext;
use crate::trace::Tracer;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// The walk of the scene, from which the others are derived.
pub(super) struct BaseWalk<'a> {
    tracer: &'a Tracer,
    walk: &'a CameraPath,
    length_m: f64,
    frames: u32,
}

/// Returns a camera for every frame. `None` if the walk of the scene has no key frames.
type Poses = fn(&BaseWalk<'_>) -> Option<Vec<Camera>>;

/// Name and cameras of every walk.
pub(super) const WALKS: [(&str, Poses); 6] = [
    ("slow", |base| base.stretch(0.25, 0.05)),
    ("fast", |base| base.stretch(0.25, 0.3)),
    ("turning", turning),
    ("narrow", narrow),
    ("reversal", reversal),
    ("teleport", teleport),
];

/// Returns the cameras of a walk by its name.
pub(super) fn cameras(context: &ExperimentContext<'_>, name: &str) -> Option<Vec<Camera>> {
    let (_, poses) = WALKS.into_iter().find(|(n, _)| *n == name)?;
    let base = BaseWalk {
        tracer: context.tracer,
        walk: context.walk,
        length_m: context.walk.length_m(),
        frames: context.settings.frames,
    };
    poses(&base)
}

/// Number of steps of the scene's walk, fine enough for a centimetre per frame.
const STEPS: u32 = 100_001;

impl BaseWalk<'_> {
    /// Returns the camera a distance in metres after the point at a share of the walk.
    fn at(&self, share: f64, metres: f64) -> Option<Camera> {
        let share = if self.length_m > 0.0 { share + metres / self.length_m } else { share };
        self.walk.camera((share.clamp(0.0, 1.0) * f64::from(STEPS - 1)).round() as u32, STEPS)
    }

    /// Moves a distance in metres per frame from the point at a share of the walk.
    fn stretch(&self, share: f64, metres: f64) -> Option<Vec<Camera>> {
        (0..self.frames).map(|i| self.at(share, f64::from(i) * metres)).collect()
    }
}

/// A full turn in place.
fn turning(base: &BaseWalk<'_>) -> Option<Vec<Camera>> {
    let start = base.at(0.4, 0.0)?;
    let turned = |i: u32| Camera { yaw: start.yaw + TAU * f64::from(i) / f64::from(base.frames), ..start };
    Some((0..base.frames).map(turned).collect())
}

/// Moves six metres through the narrowest place of the walk: a door, if there is one.
fn narrow(base: &BaseWalk<'_>) -> Option<Vec<Camera>> {
    /// Number of places that are probed, the distance probed to each side, and half the length of
    /// the walk, in metres.
    const PLACES: u32 = 400;
    const REACH_M: f64 = 10.0;
    const HALF_M: f64 = 3.0;
    let width = |camera: &Camera| {
        let right = camera.world_from_camera().x_axis;
        let side = |direction: DVec3| {
            base.tracer.probe(camera.eye, direction, REACH_M).map_or(REACH_M, |p| p.distance_m)
        };
        side(right) + side(-right)
    };
    let mut narrowest = (f64::INFINITY, 0.5);
    // The ends are left out: the walk must continue on both sides.
    for i in PLACES / 10..=PLACES * 9 / 10 {
        let share = f64::from(i) / f64::from(PLACES);
        let found = width(&base.at(share, 0.0)?);
        if found < narrowest.0 {
            narrowest = (found, share);
        }
    }
    let step = 2.0 * HALF_M / f64::from(base.frames.max(1));
    (0..base.frames).map(|i| base.at(narrowest.1, f64::from(i) * step - HALF_M)).collect()
}

/// Moves forward for half of the frames, then turns around and returns.
fn reversal(base: &BaseWalk<'_>) -> Option<Vec<Camera>> {
    const STEP_M: f64 = 0.15;
    let half = base.frames / 2;
    let pose = |i: u32| {
        let back = i.saturating_sub(half);
        let camera = base.at(0.3, f64::from(i.min(half) - back.min(half)) * STEP_M)?;
        Some(if back == 0 { camera } else { Camera { yaw: camera.yaw + PI, ..camera } })
    };
    (0..base.frames).map(pose).collect()
}

/// Moves along four stretches and jumps between them.
fn teleport(base: &BaseWalk<'_>) -> Option<Vec<Camera>> {
    const SHARES: [f64; 4] = [0.1, 0.6, 0.3, 0.85];
    const STEP_M: f64 = 0.1;
    let quarter = base.frames.div_ceil(4).max(1);
    let pose = |i: u32| base.at(SHARES[(i / quarter) as usize % 4], f64::from(i % quarter) * STEP_M);
    (0..base.frames).map(pose).collect()
}
