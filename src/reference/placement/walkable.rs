//! Positions where a person can stand: a flood fill over a lattice, seeded at the scene's views and
//! along its walk.

use crate::camera::Camera;
use crate::scene::Scene;
use crate::trace::Tracer;
use glam::DVec3;
use std::collections::{BTreeMap, VecDeque};

/// A position of the lattice where a person can stand.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Standing {
    /// Lattice coordinate along world x, in steps.
    pub column: i32,
    /// Lattice coordinate along world z, in steps.
    pub row: i32,
    /// Eye of a person standing there, world metres.
    pub eye: DVec3,
}

/// Distance between neighbouring positions, metres. Small enough to pass any door.
const STEP_M: f64 = 0.5;

/// Height of the eye above the floor, metres.
const EYE_HEIGHT_M: f64 = Camera::EYE_HEIGHT_M;

/// Maximum difference in floor height between neighbours, metres: a stair of 45 degrees.
const MAX_RISE_M: f64 = STEP_M;

/// Heights above the floor at which the way between two neighbours must be free, metres.
const CLEAR_HEIGHTS_M: [f64; 2] = [0.6, EYE_HEIGHT_M];

/// Half the width of a person, metres. A position keeps this distance from an obstacle in the
/// direction of the step.
const RADIUS_M: f64 = 0.2;

/// Vertical distance, metres, from which two positions above each other count as different storeys.
const STOREY_M: f64 = 2.0;

/// Maximum number of positions: 25,000 square metres of floor.
const MAX_PLACES: usize = 100_000;

/// Returns all positions that can be reached on foot from the scene's views and walk, ordered by
/// storey, column and row.
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

/// Returns the eyes of the scene's views and of its walk, world metres.
fn seeds(scene: &Scene) -> Vec<DVec3> {
    let walk = scene.walk.keyframes.iter().map(|key| key.eye);
    scene.views.iter().map(|view| view.camera.eye).chain(walk).collect()
}

/// Returns the lattice position nearest to an eye, if it has a floor and is visible from the eye.
fn place_near(tracer: &Tracer, eye: DVec3) -> Option<Standing> {
    let [column, row] = [eye.x, eye.z].map(|c| (c / STEP_M).round() as i32);
    let above = lattice_point(column, row, eye.y);
    let is_free = tracer.probe(eye, above - eye, eye.distance(above)).is_none();
    if !is_free {
        return None;
    }
    floor_below(tracer, above).map(|floor_y| standing(column, row, floor_y))
}

fn standing(column: i32, row: i32, floor_y: f64) -> Standing {
    Standing { column, row, eye: lattice_point(column, row, floor_y + EYE_HEIGHT_M) }
}

fn lattice_point(column: i32, row: i32, y: f64) -> DVec3 {
    DVec3::new(f64::from(column) * STEP_M, y, f64::from(row) * STEP_M)
}

/// Returns the height of the floor within a storey below an eye, world metres. A ground that was
/// added is none: it has no end.
fn floor_below(tracer: &Tracer, eye: DVec3) -> Option<f64> {
    let floor = tracer.probe(eye, DVec3::NEG_Y, EYE_HEIGHT_M + STOREY_M);
    floor.filter(|p| !tracer.scene().is_added_ground(p.triangle)).map(|p| p.position_m.y)
}

/// Returns the neighbouring position, if a person can walk there.
fn step(tracer: &Tracer, from: &Standing, column: i32, row: i32) -> Option<Standing> {
    let above = lattice_point(column, row, from.eye.y);
    let way = above - from.eye;
    let floor_y = from.eye.y - EYE_HEIGHT_M;
    let is_clear = CLEAR_HEIGHTS_M.iter().all(|height| {
        let start = DVec3::new(from.eye.x, floor_y + height, from.eye.z);
        tracer.probe(start, way, way.length() + RADIUS_M).is_none()
    });
    if !is_clear {
        return None;
    }
    let next_y = floor_below(tracer, above).filter(|next_y| (next_y - floor_y).abs() <= MAX_RISE_M)?;
    Some(standing(column, row, next_y))
}
