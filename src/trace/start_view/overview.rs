//! A view of the whole building from outside.

use super::building::Building;
use super::ranking::first_largest;
use super::sight::{MIN_BUILDING, Sight};
use crate::camera::Camera;
use crate::scene::{USUAL_RISE, overview};
use crate::trace::Tracer;
use std::f64::consts::TAU;

/// Number of directions around the building that are tried.
const TURNS: i32 = 16;

/// Heights from which the building is tried, as the tangent of the elevation. The second suits
/// what is flat.
const RISES: [f64; 2] = [USUAL_RISE, 1.0];

/// A view is good enough where it shows this share of the fronts that the best one shows.
const ENOUGH: f64 = 0.7;

/// Factor of the distance in each step towards a building that fills too little of the picture, and
/// the number of steps: down to half the distance. From nearer, a tower would be a wall.
const NEARER: f64 = 0.9;
const STEPS: i32 = 7;

/// Returns a view of the building from outside: the usual one, from the front and to the right, or
/// one that shows more of the fronts of its surfaces.
pub(super) fn best_overview(tracer: &Tracer) -> Camera {
    let building = Building::of(tracer);
    let candidates = candidates(tracer);
    let fronts: Vec<f64> = candidates.iter().map(|c| Sight::of(&building, c).fronts()).collect();
    let Some(best) = first_largest(&fronts) else { return *tracer.scene().start() };
    let usual = fronts.iter().position(|share| *share >= ENOUGH * fronts[best]).unwrap_or(best);
    if fronts[usual] >= MIN_BUILDING {
        return candidates[usual];
    }
    // Another direction at the same height fills more of the picture.
    let first = usual - usual % TURNS as usize;
    let around = first..first + TURNS as usize;
    let fuller = around.clone().find(|i| fronts[*i] >= MIN_BUILDING);
    let fullest = first + first_largest(&fronts[around]).unwrap_or(0);
    nearer(&building, candidates[fuller.unwrap_or(fullest)])
}

/// Returns the views that are tried, the usual one first, then those next to it.
fn candidates(tracer: &Tracer) -> Vec<Camera> {
    let building = tracer.scene().building_m;
    let turn = |i: i32| f64::from((i + 1) / 2 * if i % 2 == 0 { 1 } else { -1 });
    let view = |rise, i| overview(building, turn(i) * TAU / f64::from(TURNS), rise);
    RISES.into_iter().flat_map(|rise| (0..TURNS).map(move |i| view(rise, i))).collect()
}

/// Moves a camera towards the middle of the building until enough of the picture shows it. Where no
/// distance does, as for a tower or a few scattered things, the camera stays and shows it whole.
fn nearer(building: &Building, camera: Camera) -> Camera {
    let (low, high) = (building.low, building.high);
    let centre = low + (high - low) / 2.0;
    let at = |factor: f64| Camera { eye: centre + (camera.eye - centre) * factor, ..camera };
    let is_inside = |camera: &Camera| camera.eye.cmpge(low).all() && camera.eye.cmple(high).all();
    let shows_enough = |camera: &Camera| Sight::of(building, camera).building() >= MIN_BUILDING;
    let steps = (0..STEPS).map(|step| at(NEARER.powi(step)));
    steps.take_while(|camera| !is_inside(camera)).find(shows_enough).unwrap_or(camera)
}
