//! Reference images: what they store, how they are traced, kept, chosen and placed.

pub mod cache;
pub mod disparity_tiles;
pub mod frame;
mod pixel_warp;
pub mod placement;

pub use cache::{ReferenceCache, ReferenceId};
pub use disparity_tiles::DisparityTiles;
pub use frame::ReferenceFrame;
pub use pixel_warp::{PixelWarp, RowWarp};
pub use placement::{Observation, PlacementPolicy};
