//! Reference images: what they store, how they are traced, kept, chosen and placed.

pub mod cache;
pub mod directory;
pub mod frame;
pub mod light;
pub mod lookup;
mod lookup_tile;
mod pixel_warp;
pub mod placement;
pub mod sparse;
mod tile_surfaces;

pub use directory::Directory;
pub use lookup::LookupSet;
pub use lookup_tile::{TileLight, TilePoints, ViewLookup};
pub use cache::{CachedReference, KnownLight, ReferenceCache, ReferenceId};
pub use frame::ReferenceFrame;
pub use pixel_warp::PixelWarp;
pub use sparse::open_percent;
pub use tile_surfaces::TileSurfaces;
pub use placement::{Observation, PlacementPolicy};
