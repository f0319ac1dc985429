//! Extrapolation of the viewer's motion.

use super::rule::Observation;
use crate::camera::Camera;
use crate::math::Ray;
use crate::trace::Tracer;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Maximum extrapolated turn in radians. Beyond half the field of view the new picture would share
/// nothing with the present one.
const MAX_TURN: f64 = 0.5;

/// Share of the distance to an obstacle that an extrapolated eye may move, 0..1.
const FREE_SHARE: f64 = 0.6;

/// Returns the camera a number of frames from now, if the motion of the last frame continues. It
/// never passes through a wall.
pub(super) fn pose_after(seen: &Observation, tracer: &Tracer, frames: f64) -> Camera {
    let turn = |now: f64, before: f64| {
        let step = (now - before + PI).rem_euclid(TAU) - PI;
        (step * frames).clamp(-MAX_TURN, MAX_TURN)
    };
    let (now, before) = (&seen.camera, &seen.previous);
    Camera {
        eye: moved_freely(tracer, now.eye, (now.eye - before.eye) * frames),
        yaw: now.yaw + turn(now.yaw, before.yaw),
        pitch: (now.pitch + turn(now.pitch, before.pitch)).clamp(-FRAC_PI_2, FRAC_PI_2),
        fov_y: now.fov_y,
        roll: now.roll,
    }
}

/// Returns the eye moved by `way` in world metres, or to a point in front of the first obstacle.
pub(super) fn moved_freely(tracer: &Tracer, eye: DVec3, way: DVec3) -> DVec3 {
    let frame = &tracer.scene().frame;
    let from = frame.scene_from_world_f64(eye).as_vec3();
    let direction = (way * frame.units_per_metre).as_vec3();
    let free = match tracer.closest(&Ray::new(from, direction)) {
        Some(hit) => (f64::from(hit.t) * FREE_SHARE).min(1.0),
        None => 1.0,
    };
    eye + way * free
}
