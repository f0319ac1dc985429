//! The camera of the window: flying and walking by keys, drags and the wheel. World metres, no
//! roll.

use super::{EYE_HEIGHT_M, Obstacles, Walker};
use afterimage::Camera;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Default speed in metres per second: walking through a building.
pub const DEFAULT_SPEED: f64 = 2.5;

/// Times in seconds in which a building is crossed along its diagonal. A smaller or larger building
/// is crossed in the nearest of these times, and not at [`DEFAULT_SPEED`].
const CROSSING_SECS: std::ops::RangeInclusive<f64> = 2.0..=40.0;

/// Returns the speed in metres per second that suits a building, given its box in world metres:
/// [`DEFAULT_SPEED`] where its diagonal is 5 to 100 m.
pub fn speed_for([low, high]: [DVec3; 2]) -> f64 {
    let diagonal = (high - low).length();
    let (slowest, fastest) = (diagonal / CROSSING_SECS.end(), diagonal / CROSSING_SECS.start());
    DEFAULT_SPEED.clamp(slowest, fastest).clamp(*SPEED_RANGE.start(), *SPEED_RANGE.end())
}

/// Range of the speed in metres per second: below 5 cm/s nothing seems to move, above 200 m/s
/// steering fails.
pub const SPEED_RANGE: std::ops::RangeInclusive<f64> = 0.05..=200.0;

/// Shift multiplies the speed by this factor, Alt divides by it.
pub const SPEED_FACTOR: f64 = 5.0;

/// Factor of the speed per notch of the wheel.
const SPEED_STEP: f64 = 1.25;

/// Time of flight in seconds that equals one notch of the wheel.
const DOLLY_SECS: f64 = 0.2;

/// Change of the field of view per press of a bracket, in degrees.
const FOV_STEP_DEGREES: f64 = 5.0;

/// Range of the vertical field of view in degrees; pictures beyond it are not legible.
const FOV_DEGREES: std::ops::RangeInclusive<f64> = 10.0..=130.0;

/// Turn per drag over the viewport's height, in fields of view: more than one, so that looking back
/// does not take three strokes.
const TURN_PER_HEIGHT: f64 = 2.5;

/// Duration of an eased change of view in seconds: of a small one, and of a large one.
const EASE_SECS: [f64; 2] = [0.2, 0.7];

/// Distance in metres of a large change of view; half a turn is a large one too.
const LARGE_CHANGE_M: f64 = 6.0;

/// Longest time step in seconds: after a hitch, the camera must not be behind the next wall.
const LONGEST_STEP_SECS: f64 = 0.25;

/// Direction of motion, each axis in -1..1.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Motion to the right; negative values move to the left.
    pub right: f64,
    /// Motion along the world's up axis; negative values move down.
    pub up: f64,
    /// Motion in the viewing direction; negative values move back.
    pub forward: f64,
    /// Factor by which the set speed is multiplied: 1 without a modifier key.
    pub factor: f64,
}

/// Whether the camera flies or walks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MoveMode {
    /// In all directions, through everything.
    #[default]
    Fly,
    /// On the floor, stopped by obstacles.
    Walk,
}

/// How the camera changes to another view.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ViewChange {
    /// In a short flight, which keeps the user's orientation.
    #[default]
    Eased,
    /// At once, for users whom motion makes ill.
    AtOnce,
}

#[derive(Clone, Copy, Debug)]
struct Ease {
    from: Camera,
    to: Camera,
    elapsed_secs: f64,
    secs: f64,
}

/// The camera of the window.
#[derive(Clone, Debug)]
pub struct FlyCamera {
    camera: Camera,
    speed_m_per_s: f64,
    ease: Option<Ease>,
    view_change: ViewChange,
    move_mode: MoveMode,
    walker: Walker,
    is_settling: bool,
    /// A walker looks for the floor below where he is, or where he is going.
    looks_for_floor: bool,
    /// What there is to say about how the camera moves now.
    note: Option<&'static str>,
}

impl Default for FlyCamera {
    /// At the origin, looking along -Z with a field of view of 60 degrees, flying.
    fn default() -> Self {
        Self {
            camera: Camera::look_at(DVec3::ZERO, DVec3::NEG_Z, 60.0),
            speed_m_per_s: DEFAULT_SPEED,
            ease: None,
            view_change: ViewChange::default(),
            move_mode: MoveMode::default(),
            walker: Walker::default(),
            is_settling: false,
            looks_for_floor: false,
            note: None,
        }
    }
}

impl FlyCamera {
    /// Returns whether the camera flies or walks.
    pub fn move_mode(&self) -> MoveMode {
        self.move_mode
    }

    /// Changes how it moves. A walker stands on the floor below; where there is none, the camera
    /// goes on flying.
    pub fn set_move_mode(&mut self, move_mode: MoveMode) {
        (self.move_mode, self.walker) = (move_mode, Walker::default());
        self.looks_for_floor = move_mode == MoveMode::Walk;
        self.note = match move_mode {
            MoveMode::Walk => Some("walking: on the floor below, at eye height"),
            MoveMode::Fly => Some("flying"),
        };
    }

    /// Returns what there is to say about how the camera moves now, once it is known.
    pub fn take_note(&mut self) -> Option<&'static str> {
        if self.looks_for_floor { None } else { self.note.take() }
    }

    /// Stands on the floor below where the camera is going, at eye height; flies where there is
    /// none.
    fn stand(&mut self, obstacles: &Obstacles) {
        self.looks_for_floor = false;
        let to = self.ease.map_or(self.camera, |ease| ease.to);
        let Some(height_m) = obstacles.standing_m(to.eye) else {
            self.move_mode = MoveMode::Fly;
            self.note = Some("no floor below: flying");
            return;
        };
        // Someone who comes down from high above looks ahead, not at his feet.
        let pitch = if to.eye.y - height_m > EYE_HEIGHT_M { 0.0 } else { to.pitch };
        self.ease_to(Camera { eye: DVec3::new(to.eye.x, height_m, to.eye.z), pitch, ..to });
        self.looks_for_floor = false;
    }

    /// Sets how views change from now on.
    pub fn set_view_change(&mut self, view_change: ViewChange) {
        self.view_change = view_change;
    }

    /// Returns the current pose of the camera.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Returns the speed in metres per second, without Shift or Alt.
    pub fn speed_m_per_s(&self) -> f64 {
        self.speed_m_per_s
    }

    /// Changes the speed within [`SPEED_RANGE`].
    pub fn set_speed(&mut self, metres_per_second: f64) {
        self.speed_m_per_s = metres_per_second.clamp(*SPEED_RANGE.start(), *SPEED_RANGE.end());
    }

    /// Changes the speed by notches of the wheel.
    pub fn change_speed(&mut self, notches: f64) {
        self.set_speed(self.speed_m_per_s * SPEED_STEP.powf(notches));
    }

    /// Moves to a pose at once.
    pub fn jump_to(&mut self, camera: Camera) {
        self.camera = camera;
        self.ease = None;
    }

    /// Moves to a pose in a short flight, unless views change at once. A walker goes to the floor
    /// below it.
    pub fn ease_to(&mut self, camera: Camera) {
        self.looks_for_floor = self.move_mode == MoveMode::Walk;
        if self.view_change == ViewChange::AtOnce {
            return self.jump_to(camera);
        }
        let secs = ease_secs(&self.camera, &camera);
        self.ease = Some(Ease { from: self.camera, to: camera, elapsed_secs: 0.0, secs });
    }

    /// True while the camera moves by itself: in a change of view, or falling or climbing.
    pub fn is_easing(&self) -> bool {
        self.ease.is_some() || self.is_settling || self.looks_for_floor
    }

    /// Advances by `secs`. The user's own motion ends a change of view. Without obstacles, walking
    /// is level.
    pub fn advance(&mut self, motion: &Motion, secs: f64, obstacles: Option<&Obstacles>) {
        if let Some(obstacles) = obstacles.filter(|_| self.looks_for_floor) {
            self.stand(obstacles);
        }
        let offset = self.direction(motion);
        if offset != DVec3::ZERO {
            self.ease = None;
        }
        let step_secs = secs.clamp(0.0, LONGEST_STEP_SECS);
        if let Some(mut ease) = self.ease {
            ease.elapsed_secs += secs;
            self.camera = ease.now();
            self.ease = (ease.elapsed_secs < ease.secs).then_some(ease);
        } else {
            self.travel(offset * (self.speed_m_per_s * motion.factor * step_secs), step_secs, obstacles);
        }
    }

    /// Returns the direction of a motion, unit or zero; level for walking.
    fn direction(&self, motion: &Motion) -> DVec3 {
        let m = self.camera.world_from_camera();
        match self.move_mode {
            MoveMode::Fly => m.x_axis * motion.right + DVec3::Y * motion.up - m.z_axis * motion.forward,
            MoveMode::Walk => m.x_axis * motion.right + m.x_axis.cross(DVec3::NEG_Y) * motion.forward,
        }
        .normalize_or_zero()
    }

    fn travel(&mut self, offset: DVec3, secs: f64, obstacles: Option<&Obstacles>) {
        self.is_settling = false;
        match (self.move_mode, obstacles) {
            (MoveMode::Walk, Some(obstacles)) => {
                let before = self.camera.eye;
                self.camera.eye = self.walker.step(obstacles, before, offset, secs);
                self.is_settling = self.camera.eye.y != before.y;
            }
            _ => self.camera.eye += offset,
        }
    }

    /// Turns by a drag: right looks right, down looks down. `drag` is in parts of the viewport's
    /// height.
    pub fn look(&mut self, drag: [f64; 2]) {
        if drag == [0.0, 0.0] {
            return;
        }
        self.ease = None;
        let turn = self.camera.fov_y * TURN_PER_HEIGHT;
        self.camera.yaw = wrap(self.camera.yaw - drag[0] * turn);
        self.camera.pitch = (self.camera.pitch - drag[1] * turn).clamp(-FRAC_PI_2, FRAC_PI_2);
    }

    /// Moves along a direction by notches of the wheel; walking uses the level part of it.
    pub fn dolly(&mut self, direction: DVec3, notches: f64, factor: f64, obstacles: Option<&Obstacles>) {
        let level = DVec3::new(direction.x, 0.0, direction.z);
        let direction = if self.move_mode == MoveMode::Walk { level } else { direction };
        if let Some(direction) = direction.try_normalize() {
            self.ease = None;
            let offset = direction * (notches * factor * self.speed_m_per_s * DOLLY_SECS);
            self.travel(offset, DOLLY_SECS, obstacles);
        }
    }

    /// Returns the world direction through a point of the viewport: `x` and `y` in -1..1 from the
    /// centre, right and up.
    pub fn direction_through(&self, x: f64, y: f64, aspect: f64) -> DVec3 {
        let tan = (self.camera.fov_y / 2.0).tan();
        self.camera.world_from_camera() * DVec3::new(x * tan * aspect, y * tan, -1.0)
    }

    /// Turns the camera to a horizontal viewing direction, upright.
    pub fn level(&mut self) {
        self.ease_to(Camera { pitch: 0.0, roll: 0.0, ..self.camera });
    }

    /// Widens (positive) or narrows the field of view.
    pub fn change_fov(&mut self, steps: f64) {
        self.set_fov_degrees(self.camera.fov_y.to_degrees() + steps * FOV_STEP_DEGREES);
    }

    /// Sets the vertical field of view in degrees.
    pub fn set_fov_degrees(&mut self, degrees: f64) {
        self.camera.fov_y = degrees.clamp(*FOV_DEGREES.start(), *FOV_DEGREES.end()).to_radians();
    }
}

impl Ease {
    fn now(&self) -> Camera {
        let t = (self.elapsed_secs / self.secs).clamp(0.0, 1.0);
        let t = t * t * (3.0 - 2.0 * t);
        let (a, b) = (&self.from, &self.to);
        if t >= 1.0 {
            return *b;
        }
        Camera {
            eye: a.eye.lerp(b.eye, t),
            yaw: a.yaw + wrap(b.yaw - a.yaw) * t,
            pitch: a.pitch + (b.pitch - a.pitch) * t,
            fov_y: a.fov_y + (b.fov_y - a.fov_y) * t,
            roll: a.roll + wrap(b.roll - a.roll) * t,
        }
    }
}

/// Returns the duration of a change of view in seconds, by its size.
fn ease_secs(from: &Camera, to: &Camera) -> f64 {
    let turn = wrap(to.yaw - from.yaw).abs().max((to.pitch - from.pitch).abs()) / PI;
    let distance = from.eye.distance(to.eye) / LARGE_CHANGE_M;
    EASE_SECS[0] + (EASE_SECS[1] - EASE_SECS[0]) * distance.max(turn).clamp(0.0, 1.0)
}

/// Wraps an angle to -pi..pi: the shorter way round.
fn wrap(angle: f64) -> f64 {
    (angle + PI).rem_euclid(TAU) - PI
}

#[cfg(test)]
mod tests;
