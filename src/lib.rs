//! Afterimage: ray tracing that reuses reference images.

pub mod camera;
pub mod camera_path;
pub mod experiment;
pub mod math;
pub mod raster;
pub mod reference;
pub mod render;
pub mod reproject;
pub mod scene;
pub mod trace;

pub use camera::{Camera, View};
pub use render::{Frame, Mode, RenderSettings, Renderer, Walkthrough, WalkthroughSettings};
pub use scene::Scene;
pub use trace::Tracer;
