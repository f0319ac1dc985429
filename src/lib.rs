//! Afterimage: ray tracing that reuses reference images.

pub mod camera;
pub mod camera_path;
pub mod math;
pub mod raster;
pub mod scene;
