//! The view from inside the room with the most space. From outside one would see the backs of its
//! walls, or nothing where all light is inside.

use super::building::Building;
use super::ranking::{first_largest, largest};
use super::sight::{MIN_BUILDING, Sight};
use crate::camera::Camera;
use crate::trace::Tracer;
use glam::{DQuat, DVec3};
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

// The shares below were chosen by where six models should begin; `start_view` names them.

/// Number of places tried along each side of the plan.
const PLACES: i32 = 12;

/// Largest number of floors tried at a place.
const MAX_FLOORS: usize = 8;

/// Distance below a hit at which the search for the next floor continues, in diagonals of the
/// building: less than the height of a storey.
const PAST: f64 = 1e-3;

/// Smallest height above a floor at which one can stand, metres. A floor that lies less than this
/// above another is the top of furniture.
const HEADROOM_M: f64 = 2.0;

/// Number of directions in which the surroundings of a place are measured.
const DIRECTIONS: i32 = 96;

/// Largest height difference within one floor, metres.
const STEP_M: f64 = 0.3;

/// Smallest share of directions in which a room has a wall, floor or ceiling; the others are
/// windows.
const MIN_ENCLOSED: f64 = 0.85;

/// Smallest share of those surfaces that a room shows from the front.
const MIN_FRONTS: f64 = 0.7;

/// Number of viewing directions tried.
const HEADINGS: i32 = 24;

/// Number of places from which views are tried if those from the first are not good.
const PLACES_TRIED: usize = 4;

/// Distance that a viewer keeps from the wall behind, metres: an arm's length.
const BEHIND_M: f64 = 0.7;

/// Largest share of the picture that may show surfaces at arm's length.
const MAX_NEAR: f64 = 0.25;

/// Returns the view of a person who stands in the room with the most space around, or further back
/// in it, and looks to where the room is deep and shows much; `None` where there is no room.
///
/// Where no view from there is good, because it shows too little of the building or mostly what is
/// at arm's length, the next places are tried.
pub(super) fn best_view(tracer: &Tracer) -> Option<Camera> {
    let building = Building::of(tracer);
    let eyes = widest_places(&building);
    let mut views = eyes.iter().filter_map(|eye| best_view_from(&building, *eye));
    let first = views.next()?;
    let good = std::iter::once(first).chain(views).find(|(_, is_good)| *is_good);
    Some(good.unwrap_or(first).0)
}

/// Returns the best view from a place, and whether it is good.
fn best_view_from(building: &Building, eye: DVec3) -> Option<(Camera, bool)> {
    let turned = (0..HEADINGS).map(|i| DQuat::from_rotation_y(f64::from(i) / f64::from(HEADINGS) * TAU));
    let directions = turned.map(|turn| turn * DVec3::NEG_Z);
    let views = directions.flat_map(|d| [eye, stepped_back(building, eye, d)].map(|eye| (eye, eye + d)));
    let views: Vec<Camera> =
        views.map(|(eye, at)| Camera::look_at(eye, at, Camera::DEFAULT_FOV_Y_DEG)).collect();
    let sights: Vec<Sight> = views.iter().map(|camera| Sight::of(building, camera)).collect();
    let is_good = |i: &usize| sights[*i].building() >= MIN_BUILDING && sights[*i].near() <= MAX_NEAR;
    let good: Vec<usize> = (0..views.len()).filter(is_good).collect();
    let tried = if good.is_empty() { (0..views.len()).collect() } else { good };
    let worth: Vec<f64> = tried.iter().map(|&i| worth(&sights[i])).collect();
    let best = tried[first_largest(&worth)?];
    Some((views[best], is_good(&best)))
}

/// Returns how much a view is worth: deep space that nothing near hides, and many materials.
///
/// Measured by pictures of living room, staircase, Sponza and office: depth alone shows two windows
/// of the living room and no furniture; without the square, and with the geometric or harmonic mean
/// of the depth, the staircase is seen past a post.
fn worth(sight: &Sight) -> f64 {
    sight.depth_m() * (1.0 - sight.clutter()).powi(2) * sight.materials()
}

/// Returns the eye of a person who has stepped back from a place against a level direction, up to
/// the wall, where the floor has the same height.
fn stepped_back(building: &Building, eye: DVec3, direction: DVec3) -> DVec3 {
    let Some(wall) = building.probe(eye, -direction) else { return eye };
    let stands = |at: &DVec3| {
        let floor = building.probe(*at, DVec3::NEG_Y);
        floor.is_some_and(|floor| (floor.distance_m - Camera::EYE_HEIGHT_M).abs() <= STEP_M)
    };
    let room = (wall.distance_m - BEHIND_M).max(0.0);
    let steps = [1.0, 0.75, 0.5, 0.25].map(|share| eye - direction * (room * share));
    steps.into_iter().find(stands).unwrap_or(eye)
}

/// Returns the eyes of persons who stand where the space around is largest, the best first. World
/// metres.
fn widest_places(building: &Building) -> Vec<DVec3> {
    let along = |i: i32, axis: usize| {
        building.low[axis]
            + (building.high[axis] - building.low[axis]) * (f64::from(i) + 0.5) / f64::from(PLACES)
    };
    let top = |i: i32| DVec3::new(along(i % PLACES, 0), building.high.y, along(i / PLACES, 2));
    let rooms: Vec<(f64, DVec3)> = (0..PLACES * PLACES)
        .into_par_iter()
        .flat_map_iter(|i| standing_below(building, top(i)))
        .filter_map(|eye| Some((space_around(building, eye)?, eye)))
        .collect();
    let is_on_furniture =
        |eye: DVec3| rooms.iter().any(|(_, other)| (eye.y - HEADROOM_M..eye.y - STEP_M).contains(&other.y));
    let floors: Vec<_> = rooms.iter().filter(|(_, eye)| !is_on_furniture(*eye)).collect();
    let spaces: Vec<f64> = floors.iter().map(|(space, _)| *space).collect();
    largest(&spaces, PLACES_TRIED).into_iter().map(|i| floors[i].1).collect()
}

/// Returns the eyes of persons who stand on the floors below a point at the top of the building.
fn standing_below(building: &Building, top: DVec3) -> Vec<DVec3> {
    let past = building.diagonal() * PAST;
    let (mut at, mut eyes) = (top, Vec::new());
    for _ in 0..MAX_FLOORS {
        let Some(floor) = building.probe(at, DVec3::NEG_Y) else { break };
        let place = at - DVec3::Y * floor.distance_m;
        if floor.distance_m >= HEADROOM_M {
            eyes.push(place + DVec3::Y * Camera::EYE_HEIGHT_M);
        }
        at = place - DVec3::Y * past;
        if at.y < building.low.y {
            break;
        }
    }
    eyes
}

/// Returns the median distance to the surroundings of a place, metres; `None` outside rooms and
/// inside solids.
fn space_around(building: &Building, eye: DVec3) -> Option<f64> {
    let directions = (0..DIRECTIONS).map(|i| direction_on_sphere(i, DIRECTIONS));
    let hits: Vec<_> = directions.filter_map(|d| building.probe(eye, d)).collect();
    let fronts = hits.iter().filter(|hit| hit.is_front).count() as f64;
    let is_room =
        hits.len() as f64 >= MIN_ENCLOSED * f64::from(DIRECTIONS) && fronts >= MIN_FRONTS * hits.len() as f64;
    let mut distances: Vec<f64> = hits.iter().map(|hit| hit.distance_m).collect();
    distances.sort_by(f64::total_cmp);
    is_room.then(|| distances[distances.len() / 2])
}

/// Returns direction `i` of `count` evenly spread over the sphere: a spiral in steps of the golden
/// angle.
fn direction_on_sphere(i: i32, count: i32) -> DVec3 {
    let y = 1.0 - 2.0 * (f64::from(i) + 0.5) / f64::from(count);
    let (sine, angle) = ((1.0 - y * y).sqrt(), f64::from(i) * PI * (3.0 - 5f64.sqrt()));
    DVec3::new(sine * angle.cos(), y, sine * angle.sin())
}
