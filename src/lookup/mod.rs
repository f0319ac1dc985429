//! The default way to reuse references: the surface of every pixel is found by its primary ray, and its light is
//! looked up in the references that have seen the place.

mod gather;
pub mod point;
pub mod point_cache;
pub mod sparse;
mod tile_light;
mod tile_surfaces;
mod view;

pub use point::{FoundLight, LookupSet};
pub use point_cache::{PointCache, SurfaceKey, TracedPoint};
pub use sparse::open_percent;
pub use tile_light::{TileLight, TilePoints};
pub use tile_surfaces::TileSurfaces;
pub use view::ViewLookup;
