//! Hours of direct sun.

use super::meter::{Reading, Sensor};
use crate::math::Ray;
use crate::trace::Tracer;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Returns how long the middle of the sun is seen from sensors: the hours of the steps in which it
/// is above the horizon, before the sensor, and not hidden. `suns` are unit vectors to the sun in
/// the middle of equal steps of `step_hours`. Glass does not hide it.
///
/// The readings are hours in place of lux. Their standard error is that of a beginning and an end of
/// the sun somewhere in their steps.
pub fn sun_hours(tracer: &Tracer, sensors: &[Sensor], suns: &[DVec3], step_hours: f64) -> Vec<Reading> {
    let frame = &tracer.scene().frame;
    let up: Vec<Vec3> = suns.iter().filter(|sun| sun.y > 0.0).map(|sun| sun.as_vec3()).collect();
    // An end that lies evenly anywhere in its step: step / sqrt(12), twice.
    let standard_error_lux = step_hours / 6f64.sqrt();
    let read = |sensor: &Sensor| {
        let position = frame.scene_from_world_f64(sensor.position_m).as_vec3();
        let is_seen = |sun: &&Vec3| {
            sensor.facing.dot(**sun) > 0.0
                && tracer.transmittance_along(&Ray::new(position, **sun)) != Vec3::ZERO
        };
        let steps = up.iter().filter(is_seen).count() as f64;
        Reading { lux: steps * step_hours, standard_error_lux }
    };
    sensors.par_iter().map(read).collect()
}
