//! Reference images: what they store, how they are traced, kept, chosen and placed.

pub mod cache;
pub mod directory;
pub mod disparity_tiles;
pub mod frame;
mod gather;
pub mod light;
pub mod lookup;
mod pixel_warp;
pub mod placement;
pub mod point_cache;
pub mod sparse;
mod tile_light;
mod tile_surfaces;
mod view_lookup;

pub use cache::{CachedReference, KnownLight, ReferenceCache, ReferenceId};
pub use directory::Directory;
pub use disparity_tiles::DisparityTiles;
pub use frame::ReferenceFrame;
pub use lookup::{FoundLight, LookupSet};
pub use pixel_warp::{PixelWarp, RowWarp};
pub use placement::{Observation, PlacementPolicy, PlacementRule};
pub use point_cache::{Place, PointCache, TracedPoint};
pub use sparse::open_percent;
pub use tile_light::{TileLight, TilePoints};
pub use tile_surfaces::TileSurfaces;
pub use view_lookup::ViewLookup;
