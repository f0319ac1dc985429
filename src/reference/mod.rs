//! Reference images: what they store, how they are kept within a memory budget, and where they are
//! placed.

pub mod cache;
pub mod directory;
pub mod disparity_tiles;
pub mod frame;
mod layers;
pub mod light;
pub mod placement;
mod sample_sums;
mod smooth_filter;
mod smooth_samples;
pub mod stale;

pub use cache::{CachedReference, ReferenceCache, ReferenceId, ReferenceSnapshot};
pub use directory::Directory;
pub use disparity_tiles::DisparityTiles;
pub(crate) use frame::ReferenceParts;
pub use frame::{ReferenceFrame, settings_of_reference};
pub(crate) use layers::{GroupTracer, LightLayers};
pub use placement::{Observation, PlacementPolicy, PlacementRule};
pub(crate) use sample_sums::SampleSums;
pub(crate) use smooth_filter::SmoothFilter;
pub(crate) use smooth_samples::SmoothSamples;
