//! Rule `grid`: references on a regular grid over the walkable floor, looking all around, traced
//! before the walk begins. Light fields and building scans are captured in this way. The rule does
//! not use the viewer's path.

use super::rule::{PlacementRule, PrefetchRequest};
use super::walkable::walkable;
use crate::camera::Camera;
use crate::trace::Tracer;
use std::f64::consts::TAU;

/// Rule that traces references on a grid in advance.
pub const GRID: PlacementRule = PlacementRule {
    name: "grid",
    about: "on a grid over the whole floor, in advance",
    has_threshold: false,
    prefetch_poses,
    decide: |_| None,
    keeps_frame: |_, _| false,
};

/// Returns the poses of the finest grid that keeps within the maximum number of references.
fn prefetch_poses(tracer: &Tracer, request: &PrefetchRequest) -> Vec<Camera> {
    let directions = directions(request.size, request.fov_y);
    let places = walkable(tracer);
    let on_grid = |step: i32| {
        places.iter().filter(move |p| p.column.rem_euclid(step) == 0 && p.row.rem_euclid(step) == 0)
    };
    // A coarser grid may miss small rooms. At the largest step at most one position is left.
    let fits = |step: &i32| on_grid(*step).count() * directions <= request.max_references;
    let step = (1..=i32::from(i16::MAX)).find(fits).unwrap_or(i32::MAX);
    let around = |i: usize| TAU * i as f64 / directions as f64;
    on_grid(step)
        .flat_map(|place| {
            (0..directions).map(move |i| Camera {
                eye: place.eye,
                yaw: around(i),
                pitch: 0.0,
                fov_y: request.fov_y,
                roll: 0.0,
            })
        })
        .collect()
}

/// Returns the number of pictures of this size, and vertical field of view in radians, that cover a
/// full turn.
pub fn directions(size: [u32; 2], fov_y: f64) -> usize {
    let aspect = f64::from(size[0].max(1)) / f64::from(size[1].max(1));
    let across = 2.0 * ((fov_y / 2.0).tan() * aspect).atan();
    (TAU / across).ceil() as usize
}
