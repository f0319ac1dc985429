//! The start view of a model of rooms that brings none: inside a room. From outside one would see
//! the backs of its walls, or nothing where all light is inside.

use super::Tracer;
use crate::camera::{Camera, CameraPath};
use crate::scene::{Light, NamedView};
use glam::{DQuat, DVec3};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// Number of rays along each axis of the picture that shows the whole model.
const OUTSIDE_RAYS: i32 = 24;

// The shares below were chosen by where six models should begin: living room, staircase and office
// inside, FZK house and Sponza outside, the open Cornell box in front of its opening.

/// Smallest share of back faces among the hits from outside at which the model shows its inside.
const MIN_BACKS: f64 = 0.4;

/// Number of places tried along each side of the plan.
const PLACES: i32 = 12;

/// Largest number of floors tried at a place.
const MAX_FLOORS: usize = 8;

/// Distance below a hit at which the search for the next floor continues, as a share of the model's
/// diagonal: less than the height of a storey.
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

/// Angles from a viewing direction, horizontally and vertically, in which the depth of the room is
/// measured.
const FAN: [f64; 5] = [-PI / 6.0, -PI / 12.0, 0.0, PI / 12.0, PI / 6.0];

impl Tracer {
    /// Adds a start view inside where the model brings no view and, from outside, shows back faces
    /// or is dark.
    ///
    /// The view from outside becomes the second. Where the model brings no camera path, the path
    /// turns around at the start.
    #[must_use]
    pub fn beginning_indoors(mut self) -> Self {
        if self.scene().brings_view || !(self.is_dark_outside() || self.shows_backs()) {
            return self;
        }
        let Some(camera) = self.widest_place().map(|eye| self.widest_view(eye)) else { return self };
        let scene = Arc::make_mut(self.scene_mut());
        "outside".clone_into(&mut scene.views[0].name);
        scene.views.insert(0, NamedView { name: "start".to_owned(), camera });
        if !scene.brings_walk {
            scene.walk = CameraPath::turning(&camera);
        }
        self
    }

    /// True where neither sun nor sky lights the model.
    fn is_dark_outside(&self) -> bool {
        !self.scene().lights.iter().any(|light| matches!(light, Light::Sun { .. } | Light::Sky))
    }

    /// True where the view of the whole model shows back faces.
    fn shows_backs(&self) -> bool {
        let start = self.scene().start();
        let unit = |i: i32| (f64::from(i) + 0.5) / f64::from(OUTSIDE_RAYS) * 2.0 - 1.0;
        let tan = (start.fov_y / 2.0).tan();
        let axes = start.world_from_camera();
        let directions = (0..OUTSIDE_RAYS * OUTSIDE_RAYS)
            .map(|i| [unit(i % OUTSIDE_RAYS) * tan, unit(i / OUTSIDE_RAYS) * tan]);
        let seen = directions
            .filter_map(|[x, y]| self.probe(start.eye, axes * DVec3::new(x, y, -1.0), f64::INFINITY));
        let (backs, all) = seen.fold((0, 0), |(backs, all), p| (backs + i32::from(!p.is_front), all + 1));
        f64::from(backs) >= MIN_BACKS * f64::from(all.max(1))
    }

    /// Returns the eye of a person who stands in the room with the most space around; `None` where
    /// there is no room. World metres.
    fn widest_place(&self) -> Option<DVec3> {
        let [low, high] = self.scene().bounds_m;
        let along = |i: i32, axis: usize| {
            low[axis] + (high[axis] - low[axis]) * (f64::from(i) + 0.5) / f64::from(PLACES)
        };
        let tops =
            (0..PLACES * PLACES).map(|i| DVec3::new(along(i % PLACES, 0), high.y, along(i / PLACES, 2)));
        let eyes: Vec<DVec3> = tops.flat_map(|top| self.standing_below(top)).collect();
        let rooms: Vec<(f64, DVec3)> =
            eyes.into_iter().filter_map(|eye| Some((self.space_around(eye)?, eye))).collect();
        let is_on_furniture = |eye: DVec3| {
            rooms.iter().any(|(_, other)| (eye.y - HEADROOM_M..eye.y - STEP_M).contains(&other.y))
        };
        let floors = rooms.iter().filter(|(_, eye)| !is_on_furniture(*eye));
        floors.max_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, eye)| *eye)
    }

    /// Returns the eyes of persons who stand on the floors below a point at the top of the model.
    fn standing_below(&self, top: DVec3) -> Vec<DVec3> {
        let [low, high] = self.scene().bounds_m;
        let past = (high - low).length() * PAST;
        let (mut at, mut eyes) = (top + DVec3::Y * past, Vec::new());
        for _ in 0..MAX_FLOORS {
            let Some(floor) = self.probe(at, DVec3::NEG_Y, f64::INFINITY) else { break };
            if floor.distance_m >= HEADROOM_M {
                eyes.push(floor.position_m + DVec3::Y * Camera::EYE_HEIGHT_M);
            }
            at = floor.position_m - DVec3::Y * past;
        }
        eyes
    }

    /// Returns the median distance to the surroundings of a place, metres; `None` outside rooms and
    /// inside solids.
    fn space_around(&self, eye: DVec3) -> Option<f64> {
        let directions = (0..DIRECTIONS).map(|i| direction_on_sphere(i, DIRECTIONS));
        let hits: Vec<_> = directions.filter_map(|d| self.probe(eye, d, f64::INFINITY)).collect();
        let fronts = hits.iter().filter(|p| p.is_front).count() as f64;
        let is_room = hits.len() as f64 >= MIN_ENCLOSED * f64::from(DIRECTIONS)
            && fronts >= MIN_FRONTS * hits.len() as f64;
        let mut distances: Vec<f64> = hits.iter().map(|p| p.distance_m).collect();
        distances.sort_by(f64::total_cmp);
        is_room.then(|| distances[distances.len() / 2])
    }

    /// Returns the view from an eye towards the deepest part of the room. Rays that leave through
    /// windows do not count.
    fn widest_view(&self, eye: DVec3) -> Camera {
        let direction =
            |yaw: f64, pitch: f64| DQuat::from_rotation_y(yaw) * DQuat::from_rotation_x(pitch) * DVec3::NEG_Z;
        let distance = |d: DVec3| self.probe(eye, d, f64::INFINITY).map(|p| p.distance_m);
        let around = |yaw: f64| FAN.iter().flat_map(move |dx| FAN.map(move |dy| direction(yaw + dx, dy)));
        let space = |yaw: f64| {
            let hits = || around(yaw).filter_map(distance);
            hits().sum::<f64>() / hits().count().max(1) as f64
        };
        let headings = (0..HEADINGS).map(|i| f64::from(i) / f64::from(HEADINGS) * TAU);
        let scored = headings.map(|yaw| (space(yaw), yaw));
        let (_, widest) = scored.max_by(|(a, _), (b, _)| a.total_cmp(b)).unwrap_or_default();
        Camera::look_at(eye, eye + direction(widest, 0.0), Camera::DEFAULT_FOV_Y_DEG)
    }
}

/// Returns direction `i` of `count` evenly spread over the sphere: a spiral in steps of the golden
/// angle.
fn direction_on_sphere(i: i32, count: i32) -> DVec3 {
    let y = 1.0 - 2.0 * (f64::from(i) + 0.5) / f64::from(count);
    let (sine, angle) = ((1.0 - y * y).sqrt(), f64::from(i) * PI * (3.0 - 5f64.sqrt()));
    DVec3::new(sine * angle.cos(), y, sine * angle.sin())
}
