//! Where one can stand and look: the poses from which a building is seen, and from which
//! references are chosen.

use crate::camera::{Camera, CameraPath};
use crate::reference::placement::{GRID, PrefetchRequest, directions, walkable};
use crate::trace::Tracer;
use glam::DVec3;
use std::f64::consts::TAU;

/// Distances between places, metres: the first that gives at most [`MAX_PLACES`].
const SPACINGS_M: [f64; 9] = [1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0, 16.0];

/// Largest number of places, unless rooms alone are more.
const MAX_PLACES: usize = 400;

/// Two places belong to one storey where their heights differ by less, metres.
const STOREY_M: f64 = 2.0;

/// Directions of a place, for each that is needed to see all around: poses that are chosen from
/// overlap by half.
const OVERLAP: usize = 2;

/// Poses along a camera path, at most.
const MAX_STEPS: u32 = 512;

/// Poses of a grid, at most.
const MAX_GRID: usize = 1024;

/// Places in the walkable space, world metres: every walkable position is near one of them and sees
/// it. Empty where one can walk nowhere.
pub(super) fn places(tracer: &Tracer) -> Vec<DVec3> {
    let walkable: Vec<DVec3> = walkable(tracer).iter().map(|standing| standing.eye).collect();
    let mut places = Vec::new();
    for spacing in SPACINGS_M {
        places = spread(tracer, &walkable, spacing);
        if places.len() <= MAX_PLACES {
            break;
        }
    }
    places
}

/// Keeps of some positions those that are far from others, or hidden from them.
fn spread(tracer: &Tracer, positions: &[DVec3], spacing_m: f64) -> Vec<DVec3> {
    let mut kept: Vec<DVec3> = Vec::new();
    for &eye in positions {
        let stands_for = |other: &DVec3| {
            let way = *other - eye;
            let is_near = way.x.hypot(way.z) < spacing_m && way.y.abs() < STOREY_M;
            is_near && tracer.probe(eye, way, way.length()).is_none()
        };
        if !kept.iter().any(stands_for) {
            kept.push(eye);
        }
    }
    kept
}

/// Poses that look all around from each of some places.
pub(super) fn looking_around(places: &[DVec3], size: [u32; 2], fov_y: f64) -> Vec<Camera> {
    let count = OVERLAP * directions(size, fov_y);
    let yaw = |i: usize| TAU * i as f64 / count as f64;
    let at =
        |&eye: &DVec3| (0..count).map(move |i| Camera { eye, yaw: yaw(i), pitch: 0.0, fov_y, roll: 0.0 });
    places.iter().flat_map(at).collect()
}

/// Poses of a regular grid over the floor.
pub(super) fn on_grid(tracer: &Tracer, size: [u32; 2], fov_y: f64) -> Vec<Camera> {
    let request = PrefetchRequest { size, fov_y, max_references: MAX_GRID };
    (GRID.prefetch_poses)(tracer, &request)
}

/// Poses along a camera path. Empty where it has no key frames.
pub(super) fn along(path: &CameraPath) -> Vec<Camera> {
    let count = path.frames.clamp(1, MAX_STEPS);
    (0..count).filter_map(|step| path.camera(step, count)).filter(Camera::is_valid).collect()
}
