//! Reference images: what they store, how they are traced, kept, chosen and placed.

pub mod cache;
pub mod directory;
pub mod disparity_tiles;
pub mod frame;
pub mod light;
pub mod placement;

pub use cache::{CachedReference, KnownLight, ReferenceCache, ReferenceId};
pub use directory::Directory;
pub use disparity_tiles::DisparityTiles;
pub use frame::ReferenceFrame;
pub use placement::{Observation, PlacementPolicy, PlacementRule};
