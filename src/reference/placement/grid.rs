//! On a regular grid of the places where one can stand, looking all around, before the walk begins: what light fields and
//! building scans do. It knows nothing of the way.

use super::{AheadRequest, PlacementRule, walkable};
use crate::camera::Camera;
use crate::trace::Tracer;
use std::f64::consts::TAU;

/// See the module.
pub const GRID: PlacementRule = PlacementRule {
    name: "grid",
    about: "everywhere on a grid, before you get there",
    has_threshold: false,
    poses_ahead,
    decide: |_| None,
    keeps: |_, _| false,
};

/// The finest grid whose references, looking all around from every place, are as many as allowed.
fn poses_ahead(tracer: &Tracer, request: &AheadRequest) -> Vec<Camera> {
    let directions = directions(request);
    let places = walkable(tracer);
    let on_grid = |step: i32| {
        places.iter().filter(move |p| p.column.rem_euclid(step) == 0 && p.row.rem_euclid(step) == 0)
    };
    // The lattice may miss small rooms at any step; with one place at most nothing is left to thin out.
    let fits = |step: &i32| on_grid(*step).count() * directions <= request.most;
    let step = (1..=i32::from(i16::MAX)).find(fits).unwrap_or(i32::MAX);
    let around = |i: usize| TAU * i as f64 / directions as f64;
    on_grid(step)
        .flat_map(|place| {
            (0..directions).map(move |i| Camera {
                eye: place.eye,
                yaw: around(i),
                pitch: 0.0,
                fov_y: request.fov_y,
            })
        })
        .collect()
}

/// How many pictures side by side make a full turn.
fn directions(request: &AheadRequest) -> usize {
    let aspect = f64::from(request.size[0].max(1)) / f64::from(request.size[1].max(1));
    let across = 2.0 * ((request.fov_y / 2.0).tan() * aspect).atan();
    (TAU / across).ceil() as usize
}
