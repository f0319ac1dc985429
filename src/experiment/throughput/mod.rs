//! The speed of the stages: rays by kind, the warp against the memory bound, shading.
//!
//! Rays are gathered first and timed alone, so that the figures are those of the hierarchy and can
//! be compared with another library's on the same rays ([`RayDump`]). Every figure is the median of
//! five rounds after one round that is not counted.

mod feature_speed;
mod lookup_speed;
mod measure;
mod ray_speed;
mod rays;
mod report;
mod settings;
mod stage_speed;
mod timing;
mod visibility_speed;
mod warp_speed;

pub use feature_speed::FeatureSpeed;
pub(super) use measure::run_cell;
pub use measure::{Throughput, measure_throughput};
pub use rays::{RayDump, gather_rays};
pub(super) use report::report;
pub use settings::ThroughputSettings;
pub(super) use settings::{cells, settings};
pub use stage_speed::StageSpeed;
pub use visibility_speed::VisibilitySpeed;
pub use warp_speed::WarpSpeed;
