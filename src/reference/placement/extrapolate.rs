//! Where the viewer will be if the motion of the last frame goes on.

use crate::camera::Camera;
use crate::math::Ray;
use crate::reference::placement::Observation;
use crate::trace::Tracer;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// A predicted turn is cut here, in radians: beyond half the field of view the new picture would share nothing.
const LARGEST_TURN: f64 = 0.5;

/// A predicted eye stays this share of the free way in front of the next surface.
const FREE_SHARE: f64 = 0.6;

/// The camera so many frames on, never through a wall.
pub(crate) fn ahead(seen: &Observation, tracer: &Tracer, frames: f64) -> Camera {
    let turn = |now: f64, before: f64| {
        let step = (now - before + PI).rem_euclid(TAU) - PI;
        (step * frames).clamp(-LARGEST_TURN, LARGEST_TURN)
    };
    let (now, before) = (&seen.camera, &seen.previous);
    Camera {
        eye: moved(tracer, now.eye, (now.eye - before.eye) * frames),
        yaw: now.yaw + turn(now.yaw, before.yaw),
        pitch: (now.pitch + turn(now.pitch, before.pitch)).clamp(-FRAC_PI_2, FRAC_PI_2),
        fov_y: now.fov_y,
    }
}

/// An eye after a way in metres, or before whatever stands in it.
pub(crate) fn moved(tracer: &Tracer, eye: DVec3, way: DVec3) -> DVec3 {
    let frame = &tracer.scene().frame;
    let from = frame.scene_from_world_f64(eye).as_vec3();
    let direction = (way * frame.units_per_metre).as_vec3();
    let free = match tracer.closest(&Ray::new(from, direction)) {
        Some(hit) => (f64::from(hit.t) * FREE_SHARE).min(1.0),
        None => 1.0,
    };
    eye + way * free
}
