//! Six ways to move, made from a scene's own walk so that every scene has them.

use crate::camera::Camera;
use crate::camera::CameraPath;
use crate::experiment::run::ExperimentContext;
use crate::trace::Tracer;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// What a walk is made from.
pub(super) struct Way<'a> {
    tracer: &'a Tracer,
    walk: &'a CameraPath,
    length_m: f64,
    frames: u32,
}

/// A pose for every frame. `None` where the scene's walk has no key frames.
type Poses = fn(&Way<'_>) -> Option<Vec<Camera>>;

/// Every walk and what it is like.
pub(super) const WALKS: [(&str, Poses); 6] = [
    ("slow", |way| way.stretch(0.25, 0.05)),
    ("fast", |way| way.stretch(0.25, 0.3)),
    ("turning", turning),
    ("narrow", narrow),
    ("reversal", reversal),
    ("teleport", teleport),
];

/// The poses of a walk by its name.
pub(super) fn cameras(context: &ExperimentContext<'_>, name: &str) -> Option<Vec<Camera>> {
    let (_, poses) = WALKS.into_iter().find(|(n, _)| *n == name)?;
    let way = Way {
        tracer: context.tracer,
        walk: context.walk,
        length_m: context.walk.length_m(),
        frames: context.settings.frames,
    };
    poses(&way)
}

/// Steps of the scene's walk, fine enough for a centimetre a frame.
const STEPS: u32 = 100_001;

impl Way<'_> {
    /// The pose after so many metres from the point at a share of the walk.
    fn at(&self, share: f64, metres: f64) -> Option<Camera> {
        let share = if self.length_m > 0.0 { share + metres / self.length_m } else { share };
        self.walk.camera((share.clamp(0.0, 1.0) * f64::from(STEPS - 1)).round() as u32, STEPS)
    }

    /// So many metres a frame from the point at a share of the walk.
    fn stretch(&self, share: f64, metres: f64) -> Option<Vec<Camera>> {
        (0..self.frames).map(|i| self.at(share, f64::from(i) * metres)).collect()
    }
}

/// A full turn in place.
fn turning(way: &Way<'_>) -> Option<Vec<Camera>> {
    let start = way.at(0.4, 0.0)?;
    let turned = |i: u32| Camera { yaw: start.yaw + TAU * f64::from(i) / f64::from(way.frames), ..start };
    Some((0..way.frames).map(turned).collect())
}

/// Six metres through the narrowest place of the walk: a door, where there is one.
fn narrow(way: &Way<'_>) -> Option<Vec<Camera>> {
    /// Places that are looked at, and how far to each side, metres.
    const PLACES: u32 = 400;
    const REACH_M: f64 = 10.0;
    const HALF_M: f64 = 3.0;
    let width = |camera: &Camera| {
        let right = camera.world_from_camera().x_axis;
        let side =
            |way_out: DVec3| way.tracer.probe(camera.eye, way_out, REACH_M).map_or(REACH_M, |p| p.distance_m);
        side(right) + side(-right)
    };
    let mut narrowest = (f64::INFINITY, 0.5);
    // Not at the ends, from where there would be no way to either side.
    for i in PLACES / 10..=PLACES * 9 / 10 {
        let share = f64::from(i) / f64::from(PLACES);
        let found = width(&way.at(share, 0.0)?);
        if found < narrowest.0 {
            narrowest = (found, share);
        }
    }
    let step = 2.0 * HALF_M / f64::from(way.frames.max(1));
    (0..way.frames).map(|i| way.at(narrowest.1, f64::from(i) * step - HALF_M)).collect()
}

/// Half of the time ahead, then about and back the way one came.
fn reversal(way: &Way<'_>) -> Option<Vec<Camera>> {
    const STEP_M: f64 = 0.15;
    let half = way.frames / 2;
    let pose = |i: u32| {
        let back = i.saturating_sub(half);
        let camera = way.at(0.3, f64::from(i.min(half) - back.min(half)) * STEP_M)?;
        Some(if back == 0 { camera } else { Camera { yaw: camera.yaw + PI, ..camera } })
    };
    (0..way.frames).map(pose).collect()
}

/// Four stretches far from each other, without a way between them.
fn teleport(way: &Way<'_>) -> Option<Vec<Camera>> {
    const SHARES: [f64; 4] = [0.1, 0.6, 0.3, 0.85];
    const STEP_M: f64 = 0.1;
    let quarter = way.frames.div_ceil(4).max(1);
    let pose = |i: u32| way.at(SHARES[(i / quarter) as usize % 4], f64::from(i % quarter) * STEP_M);
    (0..way.frames).map(pose).collect()
}
