//! The places where a person can stand, found by walking there: a flood fill over a lattice from where the scene's views
//! and its walk stand.

use crate::camera::Camera;
use crate::scene::Scene;
use crate::trace::Tracer;
use glam::DVec3;
use std::collections::{BTreeMap, VecDeque};

/// A place on the lattice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Standing {
    /// Lattice steps along world x.
    pub column: i32,
    /// Lattice steps along world z.
    pub row: i32,
    /// Eyes of who stands there, world metres.
    pub eye: DVec3,
}

/// Between two places of the lattice, metres: passes any door.
const STEP_M: f64 = 0.5;

const EYE_HEIGHT_M: f64 = Camera::EYE_HEIGHT_M;

/// The most that the floor may rise or fall from one place to the next, metres: a stair of 45 degrees.
const MAX_RISE_M: f64 = STEP_M;

/// Heights above the floor at which nothing may stand between two places, metres.
const CLEAR_HEIGHTS_M: [f64; 2] = [0.6, EYE_HEIGHT_M];

/// Half the width of a person, metres: nobody stands nearer than this to what is ahead, nor on its very surface.
const RADIUS_M: f64 = 0.2;

/// Storeys are told apart by eyes so far above each other, metres.
const STOREY_M: f64 = 2.0;

/// More places are not looked for: 25,000 square metres of floor.
const MAX_PLACES: usize = 100_000;

/// Every place that can be reached on foot from the scene's views and walk, by storey, column and row.
pub fn walkable(tracer: &Tracer) -> Vec<Standing> {
    let mut found = BTreeMap::new();
    let mut queue: VecDeque<Standing> =
        seeds(tracer.scene()).into_iter().filter_map(|eye| place_near(tracer, eye)).collect();
    while let Some(place) = queue.pop_front() {
        if found.len() >= MAX_PLACES {
            break;
        }
        if found.contains_key(&key(&place)) {
            continue;
        }
        found.insert(key(&place), place);
        for (column, row) in [(-1, 0), (1, 0), (0, -1), (0, 1)] {
            queue.extend(step(tracer, &place, place.column + column, place.row + row));
        }
    }
    found.into_values().collect()
}

fn key(place: &Standing) -> (i64, i32, i32) {
    ((place.eye.y / STOREY_M).floor() as i64, place.column, place.row)
}

/// Eyes that stand where people do.
fn seeds(scene: &Scene) -> Vec<DVec3> {
    let walk = scene.walk.keyframes.iter().map(|key| key.eye);
    scene.views.iter().map(|view| view.camera.eye).chain(walk).collect()
}

/// The lattice place next to an eye, where one can stand and be seen from the eye.
fn place_near(tracer: &Tracer, eye: DVec3) -> Option<Standing> {
    let [column, row] = [eye.x, eye.z].map(|c| (c / STEP_M).round() as i32);
    let above = lattice_point(column, row, eye.y);
    let is_free = tracer.probe(eye, above - eye, eye.distance(above)).is_none();
    let floor = is_free.then(|| floor_below(tracer, above))??;
    Some(standing(column, row, floor))
}

/// Whoever stands there.
fn standing(column: i32, row: i32, floor_y: f64) -> Standing {
    Standing { column, row, eye: lattice_point(column, row, floor_y + EYE_HEIGHT_M) }
}

fn lattice_point(column: i32, row: i32, y: f64) -> DVec3 {
    DVec3::new(f64::from(column) * STEP_M, y, f64::from(row) * STEP_M)
}

/// Height of the floor within a storey below an eye, metres.
fn floor_below(tracer: &Tracer, eye: DVec3) -> Option<f64> {
    tracer.probe(eye, DVec3::NEG_Y, EYE_HEIGHT_M + STOREY_M).map(|p| p.position_m.y)
}

/// A neighbouring place, where one can walk there.
fn step(tracer: &Tracer, from: &Standing, column: i32, row: i32) -> Option<Standing> {
    let above = lattice_point(column, row, from.eye.y);
    let way = above - from.eye;
    let floor_y = from.eye.y - EYE_HEIGHT_M;
    let is_clear = CLEAR_HEIGHTS_M.iter().all(|height| {
        let start = DVec3::new(from.eye.x, floor_y + height, from.eye.z);
        tracer.probe(start, way, way.length() + RADIUS_M).is_none()
    });
    let floor = is_clear.then(|| floor_below(tracer, above))??;
    let is_step = (floor - floor_y).abs() <= MAX_RISE_M;
    is_step.then(|| standing(column, row, floor))
}
