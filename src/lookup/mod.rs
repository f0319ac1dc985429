//! The default way to reuse references: a primary ray finds the surface of every pixel, and the
//! light there is looked up in the references that saw it.
//!
//! [`LookupSet`] holds the references of a frame, [`ViewLookup`] looks up tiles of pixels, and
//! [`LookupSet::light_at`] single points. [`BandLookup`] fills the rows of a frame with what is
//! known, and [`PixelResolver`] completes the pixels that this leaves open. `policy.rs` holds every
//! threshold.

mod band;
mod exact;
mod gather;
mod point;
mod point_cache;
mod policy;
mod sparse;
mod tile;
mod view;

pub(crate) use band::{BandLookup, FrameRows, OpenPixels};
pub(crate) use exact::{CheckedPixel, PixelResolver, Tally};
pub use point::{FoundLight, LookupSet};
pub use point_cache::{CachedLight, PointCache, SurfaceKey, TracedPoint};
pub use policy::LookupQuality;
pub(crate) use policy::MAX_POINTS_PER_PIXEL;
pub use sparse::open_percent;
pub(crate) use tile::pixels_of_tile;
pub use tile::{TileLight, TilePoints, TileSurfaces};
pub use view::ViewLookup;
