//! Walking: gravity, steps and walls, found by rays of the tracer. World metres.
//!
//! A walker is an upright cylinder. Its path is free where rays between the old and the new
//! position hit nothing at three heights. It is then pushed away from any surface within its
//! radius, along that surface's normal; this makes it slide along walls and around door posts.

use afterimage::{Camera, Tracer};
use glam::DVec3;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Height of the eyes of a standing person above the floor, in metres.
pub const EYE_HEIGHT_M: f64 = Camera::EYE_HEIGHT_M;

/// Height of the highest step that is climbed, in metres: two risers of a stair and a bit.
pub const HIGHEST_STEP_M: f64 = 0.45;

/// Half the width of a person in metres: passes a door of 0.6 m.
const RADIUS_M: f64 = 0.22;

/// Height of the crown above the eyes, in metres.
const CROWN_M: f64 = 0.12;

/// Heights above the feet at which walls are searched, in metres: just above a step, the hip, the
/// eyes.
const HEIGHTS_M: [f64; 3] = [HIGHEST_STEP_M + 0.01, 1.0, EYE_HEIGHT_M];

/// Number of directions in which walls are searched: the ends of the rays are 9 cm apart on the
/// cylinder, less than any post.
const DIRECTIONS: usize = 16;

/// Number of pushes away from walls: two walls of a corner, and what they push the walker into.
const PUSHES: usize = 4;

/// Sine of 45 degrees: a surface whose normal has a larger horizontal part than this is a wall.
const WALL_SINE: f64 = 0.707;

const GRAVITY_M_PER_S2: f64 = 9.81;

/// Speed at which the eyes rise on steps, in metres per second: a stair feels like a slope, not
/// like a series of jolts.
const CLIMB_M_PER_S: f64 = 3.0;

/// Largest number of parts into which a step is cut.
const MAX_PARTS: f64 = 256.0;

/// Words in the names of materials that do not stop a walker: closed doors would lock every room.
const DOOR_WORDS: [&str; 6] = ["door", "tür", "tuer", "porte", "puerta", "porta"];

/// Everything that can stop a walker.
#[derive(Clone, Debug)]
pub struct Obstacles {
    tracer: Arc<Tracer>,
    /// True per material that does not stop a walker.
    is_passable: Vec<bool>,
}

impl Obstacles {
    /// All surfaces of a scene except the leaves of doors.
    pub fn new(tracer: Arc<Tracer>) -> Self {
        let is_door = |name: &str| {
            let name = name.to_lowercase();
            // The frame of an open door still stands.
            DOOR_WORDS.iter().any(|word| name.contains(word)) && !name.contains("frame")
        };
        let is_passable = tracer.scene().materials.iter().map(|m| is_door(&m.name)).collect();
        Self { tracer, is_passable }
    }

    /// Returns the tracer of the scene.
    pub fn tracer(&self) -> &Arc<Tracer> {
        &self.tracer
    }

    /// Rounding error of a distance in metres: rays are f32 in scene space, whose diagonal is at
    /// most 1024 units.
    fn rounding_m(&self) -> f64 {
        const ULPS: f64 = 4.0;
        ULPS * 1024.0 * f64::from(f32::EPSILON) / self.tracer.scene().frame.units_per_metre
    }

    /// Returns distance in metres and normal of the nearest obstacle.
    fn nearest(&self, from: DVec3, direction: DVec3, reach_m: f64) -> Option<(f64, DVec3)> {
        let scene = self.tracer.scene();
        let stops = |triangle: u32| !self.is_passable[scene.triangle_materials[triangle as usize].0 as usize];
        let probe = self.tracer.probe_where(from, direction, reach_m, stops)?;
        Some((probe.distance_m, probe.normal.as_dvec3()))
    }

    /// Returns the height of the floor under a walker whose feet are at `feet`. It is the highest
    /// point that the sole touches, so that the walker does not fall into a joint.
    fn floor(&self, feet: DVec3) -> Option<f64> {
        let sole = RADIUS_M / 2.0;
        let top = feet + DVec3::Y * HIGHEST_STEP_M;
        [DVec3::ZERO, DVec3::X * sole, DVec3::NEG_X * sole, DVec3::Z * sole, DVec3::NEG_Z * sole]
            .into_iter()
            .filter_map(|offset| self.nearest(top + offset, DVec3::NEG_Y, f64::INFINITY))
            .map(|(distance, _)| top.y - distance)
            .max_by(f64::total_cmp)
    }

    /// Returns the height of the eyes of someone who stands on the floor below a position; `None`
    /// where there is none.
    pub fn standing_m(&self, eye: DVec3) -> Option<f64> {
        let below = self.nearest(eye, DVec3::NEG_Y, f64::INFINITY)?.0;
        Some(eye.y - below + EYE_HEIGHT_M)
    }

    /// Returns the offset out of all walls within the radius of a walker's axis.
    fn push(&self, eye: DVec3) -> DVec3 {
        let feet = eye - DVec3::Y * EYE_HEIGHT_M;
        let mut push = DVec3::ZERO;
        for height in HEIGHTS_M {
            for i in 0..DIRECTIONS {
                let (sin, cos) = (TAU * i as f64 / DIRECTIONS as f64).sin_cos();
                let direction = DVec3::new(cos, 0.0, sin);
                let found = self.nearest(feet + DVec3::Y * height, direction, RADIUS_M);
                let Some((distance, normal)) = found.filter(|(_, n)| is_wall(*n)) else { continue };
                let out = DVec3::new(normal.x, 0.0, normal.z).normalize_or_zero();
                let depth = RADIUS_M - distance * -out.dot(direction);
                // Only the deepest along each direction counts: several rays hit the same wall.
                let already = push.dot(out);
                push += out * (depth - already).max(0.0);
            }
        }
        push
    }

    /// True where no wall stands between two positions.
    fn is_free(&self, from: DVec3, to: DVec3) -> bool {
        let offset = to - from;
        HEIGHTS_M.into_iter().all(|height| {
            let start = from + DVec3::Y * (height - EYE_HEIGHT_M);
            self.nearest(start, offset, offset.length()).is_none_or(|(_, normal)| !is_wall(normal))
        })
    }
}

fn is_wall(normal: DVec3) -> bool {
    normal.x.hypot(normal.z) > WALL_SINE
}

/// State of a walker: the speed of a fall.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Walker {
    fall_m_per_s: f64,
}

impl Walker {
    /// Moves an eye by a horizontal offset within `secs`: as far as walls allow, along walls, up
    /// steps, and down by gravity. Above nothing at all it keeps its height.
    pub fn step(&mut self, obstacles: &Obstacles, eye: DVec3, offset: DVec3, secs: f64) -> DVec3 {
        let parts = (offset.length() / RADIUS_M).ceil().clamp(1.0, MAX_PARTS);
        let mut at = eye;
        for _ in 0..parts as u32 {
            let next = slide(obstacles, at, offset / parts);
            let climb = CLIMB_M_PER_S.max(offset.length() / secs.max(f64::MIN_POSITIVE)) * secs / parts;
            at = self.settle(obstacles, next, climb, secs / parts);
        }
        at
    }

    /// Moves the eye up by at most `climb_m`, or down by gravity.
    fn settle(&mut self, obstacles: &Obstacles, eye: DVec3, climb_m: f64, secs: f64) -> DVec3 {
        let feet = eye - DVec3::Y * EYE_HEIGHT_M;
        let Some(floor) = obstacles.floor(feet) else {
            self.fall_m_per_s = 0.0;
            return eye;
        };
        if (floor - feet.y).abs() <= obstacles.rounding_m() {
            self.fall_m_per_s = 0.0;
            return eye;
        }
        if floor > feet.y {
            self.fall_m_per_s = 0.0;
            let rise = (floor - feet.y).min(climb_m);
            let room = obstacles.nearest(eye, DVec3::Y, rise + CROWN_M);
            let rise = room.map_or(rise, |(above, _)| (above - CROWN_M).clamp(0.0, rise));
            return eye + DVec3::Y * rise;
        }
        self.fall_m_per_s += GRAVITY_M_PER_S2 * secs;
        let fall = (self.fall_m_per_s * secs).min(feet.y - floor);
        if fall == feet.y - floor {
            self.fall_m_per_s = 0.0;
        }
        eye - DVec3::Y * fall
    }
}

/// Returns the position after an offset of at most a radius.
fn slide(obstacles: &Obstacles, eye: DVec3, offset: DVec3) -> DVec3 {
    if offset == DVec3::ZERO {
        return eye;
    }
    // A wall ahead is approached; the pushes turn the rest of the offset along it.
    let mut at =
        if obstacles.is_free(eye, eye + offset) { eye + offset } else { along_wall(obstacles, eye, offset) };
    for _ in 0..PUSHES {
        let push = obstacles.push(at);
        if push == DVec3::ZERO {
            break;
        }
        at += push;
    }
    // Between two walls that push against each other there is no room; a walker that stands too
    // close already may leave.
    let is_clear = || obstacles.push(at).length() <= obstacles.push(eye).length().max(RADIUS_M * 0.02);
    if obstacles.is_free(eye, at) && is_clear() { at } else { eye }
}

/// Returns the position after the part of an offset that does not lead into the wall ahead.
fn along_wall(obstacles: &Obstacles, eye: DVec3, offset: DVec3) -> DVec3 {
    let ahead = HEIGHTS_M.into_iter().filter_map(|height| {
        obstacles.nearest(eye + DVec3::Y * (height - EYE_HEIGHT_M), offset, offset.length())
    });
    let wall = ahead.filter(|(_, n)| is_wall(*n)).min_by(|a, b| a.0.total_cmp(&b.0));
    let Some((_, normal)) = wall else { return eye };
    let out = DVec3::new(normal.x, 0.0, normal.z).normalize_or_zero();
    let rest = offset - out * offset.dot(out).min(0.0);
    if obstacles.is_free(eye, eye + rest) { eye + rest } else { eye }
}

#[cfg(test)]
mod tests {
    use super::*;
    use afterimage::scene::{Material, SceneBuilder};
    use glam::{Vec2, Vec3};

    /// A floor of 40 m, and boxes: lower corner, upper corner, name of the material.
    fn obstacles(boxes: &[([f64; 3], [f64; 3], &str)]) -> Obstacles {
        let mut b = SceneBuilder::new("walk");
        let floor = b.add_material(Material::diffuse("floor", Vec3::splat(0.5)));
        let p = |x, y, z| DVec3::new(x, y, z);
        b.add_quad(
            [p(-20.0, 0.0, 20.0), p(20.0, 0.0, 20.0), p(20.0, 0.0, -20.0), p(-20.0, 0.0, -20.0)],
            Vec2::ONE,
            floor,
        );
        for (low, high, name) in boxes {
            let material = b.add_material(Material::diffuse(name, Vec3::splat(0.5)));
            let ([x0, y0, z0], [x1, y1, z1]) = (*low, *high);
            for corners in [
                [p(x0, y0, z0), p(x0, y0, z1), p(x0, y1, z1), p(x0, y1, z0)],
                [p(x1, y0, z1), p(x1, y0, z0), p(x1, y1, z0), p(x1, y1, z1)],
                [p(x0, y1, z1), p(x1, y1, z1), p(x1, y1, z0), p(x0, y1, z0)],
                [p(x0, y0, z0), p(x1, y0, z0), p(x1, y0, z1), p(x0, y0, z1)],
                [p(x1, y0, z0), p(x0, y0, z0), p(x0, y1, z0), p(x1, y1, z0)],
                [p(x0, y0, z1), p(x1, y0, z1), p(x1, y1, z1), p(x0, y1, z1)],
            ] {
                b.add_quad(corners, Vec2::ONE, material);
            }
        }
        Obstacles::new(Arc::new(Tracer::new(Arc::new(b.finish().unwrap()))))
    }

    const STEP_SECS: f64 = 1.0 / 60.0;

    /// Walks for a while at a velocity, with the feet starting at a position.
    fn walk(obstacles: &Obstacles, feet: [f64; 3], velocity: [f64; 2], secs: f64) -> DVec3 {
        let mut walker = Walker::default();
        let mut eye = DVec3::from_array(feet) + DVec3::Y * EYE_HEIGHT_M;
        let offset = DVec3::new(velocity[0], 0.0, velocity[1]) * STEP_SECS;
        for _ in 0..(secs / STEP_SECS).round() as u32 {
            eye = walker.step(obstacles, eye, offset, STEP_SECS);
        }
        eye - DVec3::Y * EYE_HEIGHT_M
    }

    const WALL: ([f64; 3], [f64; 3], &str) = ([2.0, 0.0, -5.0], [2.2, 3.0, 5.0], "wall");

    #[test]
    fn free_space_is_crossed() {
        let feet = walk(&obstacles(&[]), [0.0, 0.0, 0.0], [2.0, 1.0], 1.0);
        assert!((feet - DVec3::new(2.0, 0.0, 1.0)).length() < 1e-3, "{feet}");
    }

    #[test]
    fn a_wall_stops_a_body_width_before_it_at_any_speed() {
        for speed in [0.5, 2.5, 60.0, 200.0] {
            let feet = walk(&obstacles(&[WALL]), [0.0, 0.0, 0.0], [speed, 0.0], 5.0);
            assert!((2.0 - RADIUS_M - feet.x).abs() < 0.03, "at {speed} m/s: {feet}");
        }
    }

    #[test]
    fn walls_are_slid_along() {
        let feet = walk(&obstacles(&[WALL]), [1.7, 0.0, -3.0], [1.5, 1.5], 2.0);
        assert!(feet.x < 2.0 - RADIUS_M + 0.01, "{feet}");
        assert!((feet.z - 0.0).abs() < 0.15, "three metres along the wall: {feet}");
    }

    #[test]
    fn a_corner_stops() {
        let other = ([-5.0, 0.0, 2.0], [5.0, 3.0, 2.2], "wall");
        let feet = walk(&obstacles(&[WALL, other]), [0.0, 0.0, 0.0], [3.0, 2.0], 4.0);
        assert!(feet.x < 2.0 - RADIUS_M + 0.03 && feet.z < 2.0 - RADIUS_M + 0.03, "{feet}");
    }

    #[test]
    fn a_door_is_passed_and_a_slit_is_not() {
        let gap = |half: f64| {
            obstacles(&[
                ([2.0, 0.0, -5.0], [2.2, 3.0, -half], "wall"),
                ([2.0, 0.0, half], [2.2, 3.0, 5.0], "wall"),
                ([2.0, 2.0, -half], [2.2, 3.0, half], "lintel"),
            ])
        };
        assert!(walk(&gap(0.4), [0.0, 0.0, 0.0], [2.0, 0.0], 3.0).x > 4.0);
        // Off the middle, the walker slides off the post.
        assert!(walk(&gap(0.4), [0.0, 0.0, 0.25], [2.0, 0.0], 3.0).x > 3.0);
        assert!(walk(&gap(0.15), [0.0, 0.0, 0.0], [2.0, 0.0], 3.0).x < 2.0);
    }

    #[test]
    fn the_leaf_of_a_door_does_not_stop_but_its_frame_does() {
        let leaf = |name| obstacles(&[([2.0, 0.0, -5.0], [2.05, 2.1, 5.0], name)]);
        assert!(walk(&leaf("Oak door"), [0.0, 0.0, 0.0], [2.0, 0.0], 3.0).x > 4.0);
        assert!(walk(&leaf("door frame"), [0.0, 0.0, 0.0], [2.0, 0.0], 3.0).x < 2.0);
    }

    #[test]
    fn stairs_are_climbed_and_a_table_is_not() {
        let stairs: Vec<_> = (0..5)
            .map(|i| {
                let x = 1.0 + 0.3 * f64::from(i);
                ([x, 0.0, -1.0], [6.0, 0.18 * f64::from(i + 1), 1.0], "stair")
            })
            .collect();
        let feet = walk(&obstacles(&stairs), [0.0, 0.0, 0.0], [1.4, 0.0], 3.0);
        assert!((feet.y - 0.9).abs() < 1e-3 && feet.x > 3.5, "{feet}");
        let table = ([1.0, 0.0, -1.0], [2.0, 0.75, 1.0], "table");
        let feet = walk(&obstacles(&[table]), [0.0, 0.0, 0.0], [1.4, 0.0], 3.0);
        assert!(feet.y < 1e-3 && feet.x < 1.0, "{feet}");
    }

    #[test]
    fn the_highest_step_is_taken_and_a_higher_one_is_not() {
        let step = |height: f64| obstacles(&[([1.0, 0.0, -1.0], [4.0, height, 1.0], "step")]);
        assert!((walk(&step(0.44), [0.0, 0.0, 0.0], [1.4, 0.0], 2.0).y - 0.44).abs() < 1e-3);
        assert!(walk(&step(0.48), [0.0, 0.0, 0.0], [1.4, 0.0], 2.0).y < 1e-3);
    }

    #[test]
    fn falling_follows_gravity_and_ends_on_the_floor() {
        let space = obstacles(&[]);
        let half = walk(&space, [0.0, 5.0, 0.0], [0.0, 0.0], 0.5);
        assert!((half.y - (5.0 - 0.5 * GRAVITY_M_PER_S2 * 0.25)).abs() < 0.1, "{half}");
        assert!(walk(&space, [0.0, 5.0, 0.0], [0.0, 0.0], 3.0).y.abs() < 1e-3);
    }

    #[test]
    fn one_stands_on_the_floor_below_or_nowhere() {
        let table = ([1.0, 0.0, -1.0], [2.0, 0.75, 1.0], "table");
        let space = obstacles(&[table]);
        for (eye, wanted) in [
            ([0.0, 9.0, 0.0], Some(EYE_HEIGHT_M)),
            ([1.5, 3.0, 0.0], Some(0.75 + EYE_HEIGHT_M)),
            ([30.0, 2.0, 0.0], None),
        ] {
            let stands = space.standing_m(DVec3::from_array(eye));
            assert_eq!(stands.map(|h| (h * 1e3).round()), wanted.map(|h| (h * 1e3).round()), "{eye:?}");
        }
    }

    #[test]
    fn above_nothing_the_height_stays() {
        let feet = walk(&obstacles(&[]), [30.0, 2.0, 0.0], [0.0, 0.0], 1.0);
        assert_eq!(feet.y, 2.0);
    }

    #[test]
    fn a_walker_inside_a_wall_gets_out() {
        let feet = walk(&obstacles(&[WALL]), [1.95, 0.0, 0.0], [-1.0, 0.0], 2.0);
        assert!(feet.x < 1.0, "{feet}");
    }
}
