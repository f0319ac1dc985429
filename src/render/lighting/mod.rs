//! Lighting analysis: illuminance at points, on work planes and in pictures.
//!
//! All numbers are photometric: lux and cd/m2 from irradiance and radiance, before any exposure or
//! tone map. Where a model gives its lights without photometric units
//! ([`Scene::is_photometric`](crate::Scene)), they are relative.

mod daylight_factor;
mod fisheye;
pub mod glare;
mod meter;
mod picture;
mod plane;
mod position_index;
mod statistics;
mod sun_hours;
mod surfaces;

pub use daylight_factor::under_overcast_sky;
pub use fisheye::{Fisheye, SeenSun};
pub use meter::{LightMeter, Reading, Sensor};
pub use picture::SurfaceLight;
pub use plane::{MAX_POINTS, PlaneArea, PlaneError, WorkPlane};
pub use position_index::position_index;
pub use statistics::PlaneStatistics;
pub use sun_hours::sun_hours;
pub use surfaces::SeenSurfaces;
