//! The daylight factor: the illuminance in a building in percent of the illuminance of open level
//! ground, under the standard overcast sky of the CIE.
//!
//! The sky of the model, its sun and its lamps do not matter. The ground below the horizon reflects
//! as that of all skies here does, and lights ceilings.

use crate::scene::{CieSky, GROUND_ALBEDO, Scene, Sky};
use crate::trace::Tracer;
use glam::Vec3;
use std::f32::consts::PI;
use std::sync::Arc;

/// Illuminance of open level ground in lux: readings in lux are daylight factors in percent.
const OUTDOORS_LUX: f32 = 100.0;

/// Returns a tracer of the same geometry under the overcast sky alone, in which illuminances in lux
/// are daylight factors in percent.
#[must_use]
pub fn under_overcast_sky(tracer: &Tracer) -> Tracer {
    let scene = tracer.scene();
    tracer.with_same_geometry(Arc::new(scene.lit_by_sky_alone(overcast_sky(scene))))
}

fn overcast_sky(scene: &Scene) -> Sky {
    let irradiance = Vec3::splat(OUTDOORS_LUX / scene.nits_per_unit());
    Sky::Cie(CieSky::overcast(irradiance, irradiance * (GROUND_ALBEDO / PI)))
}
