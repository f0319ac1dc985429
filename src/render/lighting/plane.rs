//! Work planes: the points at which the illuminance of a room is measured.

use super::meter::Sensor;
use crate::trace::Tracer;
use glam::{DVec2, DVec3, Vec3};
use std::collections::{BTreeSet, VecDeque};

/// Maximum number of points of a plane: a hall of 100 x 100 m in steps of 0.32 m.
pub const MAX_POINTS: usize = 100_000;

/// Difference in height of two neighbouring floors, metres, up to which they are one room: a step.
const MAX_STEP_M: f64 = 0.25;

/// Smallest cosine of the slope of a floor: 60 degrees, so that stairs and ramps count.
const MIN_FLOOR_COS: f32 = 0.5;

/// A way is open where no surface is nearer than this times its length: the point at its end lies
/// on no wall.
const CLEARANCE: f64 = 1.01;

/// Part of a floor that a plane covers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlaneArea {
    /// The room around a point in world metres, under its roof: as far as one can go from it in
    /// steps of the grid without passing a wall, a door leaf, a window or more than a step in the
    /// floor.
    Room(DVec3),
    /// All of a rectangle, metres: smallest and largest x, smallest and largest z. The floor is
    /// that below its middle, seen from this height.
    Rectangle {
        /// Smallest and largest x.
        x_m: [f64; 2],
        /// Smallest and largest z.
        z_m: [f64; 2],
        /// Height above the floor from which it is searched, world metres.
        above_m: f64,
    },
}

/// A horizontal plane of sensors that face up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorkPlane {
    /// Height above the floor in metres: 0.85 for desks, 0 for the floor itself.
    pub height_m: f64,
    /// Distance between neighbouring points in metres.
    pub grid_m: f64,
    /// What is left out along walls, metres.
    pub margin_m: f64,
    /// The part of the floor.
    pub area: PlaneArea,
}

/// Why a plane has no points. The messages say what to do.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum PlaneError {
    /// There is no floor.
    #[error("there is no floor below {0:.2?}; choose a point inside the building, with --view or --eye")]
    NoFloor(DVec3),
    /// No point is free.
    #[error("no point of the plane is free: it lies outside the model, or inside walls and furniture")]
    NoPoints,
    /// There are too many points.
    #[error("the plane has more than {MAX_POINTS} points; choose a wider grid, or a smaller rectangle")]
    TooMany,
    /// A number cannot be used.
    #[error("the grid must be wider than 1 mm and at most 100 m, and heights and margins from 0 to 100 m")]
    BadNumbers,
}

impl WorkPlane {
    /// Returns the sensors of the plane, row by row: from the smallest z and, in a row, the
    /// smallest x.
    ///
    /// # Errors
    /// See [`PlaneError`].
    pub fn sensors(&self, tracer: &Tracer) -> Result<Vec<Sensor>, PlaneError> {
        let is_usable = (0.001..=100.0).contains(&self.grid_m)
            && (0.0..=100.0).contains(&self.height_m)
            && (0.0..=100.0).contains(&self.margin_m);
        if !is_usable {
            return Err(PlaneError::BadNumbers);
        }
        let points = match self.area {
            PlaneArea::Room(at) => self.room(tracer, at)?,
            PlaneArea::Rectangle { x_m, z_m, above_m } => self.rectangle(tracer, [x_m, z_m], above_m)?,
        };
        let is_free = |p: &DVec3| !self.is_near_wall(tracer, *p);
        let sensors: Vec<Sensor> = points
            .into_iter()
            .filter(is_free)
            .map(|position_m| Sensor { position_m, facing: Vec3::Y })
            .collect();
        if sensors.is_empty() { Err(PlaneError::NoPoints) } else { Ok(sensors) }
    }

    /// The points that can be reached from a point without leaving its room.
    fn room(&self, tracer: &Tracer, at: DVec3) -> Result<Vec<DVec3>, PlaneError> {
        let floor = floor_below(tracer, at).ok_or(PlaneError::NoFloor(at))?;
        let start = DVec3::new(at.x, floor + self.height_m, at.z);
        if is_blocked(tracer, at, start) {
            return Err(PlaneError::NoPoints);
        }
        let place = |[i, j]: [i32; 2], y: f64| {
            DVec3::new(at.x + f64::from(i) * self.grid_m, y, at.z + f64::from(j) * self.grid_m)
        };
        let mut found = BTreeSet::from([[0, 0]]);
        let mut heights = vec![([0, 0], floor)];
        let mut open = VecDeque::from([([0, 0], floor)]);
        while let Some(([i, j], floor)) = open.pop_front() {
            for next in [[i + 1, j], [i - 1, j], [i, j + 1], [i, j - 1]] {
                if found.contains(&next) {
                    continue;
                }
                let eye = floor + self.height_m.max(MAX_STEP_M);
                let (from, to) = (place([i, j], eye), place(next, eye));
                let Some(below) = floor_below(tracer, to) else { continue };
                let is_step = (below - floor).abs() > MAX_STEP_M;
                if is_step || is_blocked(tracer, from, to) || !is_under_roof(tracer, to) {
                    continue;
                }
                found.insert(next);
                heights.push((next, below));
                open.push_back((next, below));
                if found.len() > MAX_POINTS {
                    return Err(PlaneError::TooMany);
                }
            }
        }
        heights.sort_by_key(|([i, j], _)| [*j, *i]);
        // A plane is level: a threshold or a rug below it does not bend it.
        Ok(heights.into_iter().map(|(cell, _)| place(cell, floor + self.height_m)).collect())
    }

    /// The points of a rectangle, the middles of its squares, that do not lie inside something.
    fn rectangle(
        &self,
        tracer: &Tracer,
        [x_m, z_m]: [[f64; 2]; 2],
        above_m: f64,
    ) -> Result<Vec<DVec3>, PlaneError> {
        let middle = DVec2::new(x_m[0] + x_m[1], z_m[0] + z_m[1]) / 2.0;
        let above = DVec3::new(middle.x, above_m, middle.y);
        let floor = floor_below(tracer, above).ok_or(PlaneError::NoFloor(above))?;
        let count = |[from, to]: [f64; 2]| ((to - from) / self.grid_m).round().max(1.0);
        let counts = [count(x_m), count(z_m)];
        if counts[0] * counts[1] > MAX_POINTS as f64 {
            return Err(PlaneError::TooMany);
        }
        let at = |[from, to]: [f64; 2], count: f64, i: u32| from + (to - from) * (f64::from(i) + 0.5) / count;
        let rows = (0..counts[1] as u32).map(|j| at(z_m, counts[1], j));
        let points = rows.flat_map(|z| {
            (0..counts[0] as u32).map(move |i| DVec3::new(at(x_m, counts[0], i), floor + self.height_m, z))
        });
        let (inside, free): (Vec<DVec3>, Vec<DVec3>) = points.partition(|p| is_inside(tracer, *p));
        // The walls of some models show their backs to the room: then all of it looks like a body.
        Ok(if free.is_empty() { inside } else { free })
    }

    /// True where a wall is nearer than the margin, in one of eight directions.
    fn is_near_wall(&self, tracer: &Tracer, point: DVec3) -> bool {
        self.margin_m > 0.0
            && (0..8).any(|i| {
                let (sin, cos) = (f64::from(i) * std::f64::consts::FRAC_PI_4).sin_cos();
                tracer.probe(point, DVec3::new(cos, 0.0, sin), self.margin_m).is_some()
            })
    }
}

/// Height of the floor below a point, world metres.
fn floor_below(tracer: &Tracer, point: DVec3) -> Option<f64> {
    let probe = tracer.probe(point, DVec3::NEG_Y, f64::INFINITY)?;
    (probe.normal.y > MIN_FLOOR_COS).then_some(probe.position_m.y)
}

/// True where a surface cuts the way, or lies at its end.
fn is_blocked(tracer: &Tracer, from: DVec3, to: DVec3) -> bool {
    tracer.probe(from, to - from, CLEARANCE * from.distance(to)).is_some()
}

fn is_under_roof(tracer: &Tracer, point: DVec3) -> bool {
    tracer.probe(point, DVec3::Y, f64::INFINITY).is_some()
}

/// True for a point inside a closed body: above and around it are the backs of surfaces. Below is
/// not asked, where furniture shares a plane with the floor it stands on.
fn is_inside(tracer: &Tracer, point: DVec3) -> bool {
    let sides = [DVec3::Y, DVec3::X, DVec3::NEG_X, DVec3::Z, DVec3::NEG_Z];
    sides.iter().all(|side| tracer.probe(point, *side, f64::INFINITY).is_some_and(|probe| !probe.is_front))
}
