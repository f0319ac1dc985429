//! The default way to reuse references: a primary ray finds the surface of every pixel, and the
//! light there is looked up in the references that saw it.
//!
//! In the order of the calls for a frame:
//!
//! | File | Contents |
//! |---|---|
//! | `point` | [`LookupSet`] holds the references of a frame and finds light at single points |
//! | `held` | direct light that an edit of the scene left as it was |
//! | `found` | what a look-up finds: light, and how sure it is |
//! | `band` | `BandLookup` fills eight rows of a frame and lists the pixels that it leaves open |
//! | `tile` | the surfaces of 8 x 8 pixels, and the light found for them |
//! | `view` | [`ViewLookup`] chooses the best references for a tile |
//! | `rows` | a tile's light row by row: means, and rows interpolated between others |
//! | `gather` | gathers the light of one reference for a row of a tile |
//! | `taps` | reads the samples around the points of a row |
//! | `sums` | sums over these samples |
//! | `sides` | mode `fast`: leaves out light from the other side of a wall |
//! | `exact` | `PixelResolver` completes the open pixels |
//! | `point_cache` | light that earlier frames traced at single points |
//! | `between` | which pixels are traced first, and the light of those between them |
//! | `sparse` | sparse references, which light only what older references do not know well |
//! | `planned` | which pixels of a planned reference others of the plan light |
//! | `policy` | every threshold |

mod band;
mod between;
mod exact;
mod found;
mod gather;
mod growing;
mod held;
mod open_pixels;
mod planned;
mod point;
mod point_cache;
mod policy;
mod relief;
mod rows;
mod sides;
mod sparse;
mod sums;
mod taps;
mod tile;
mod view;

pub(crate) use band::{BandLight, BandLookup, FrameRows, OpenPixels, TracedPoints, write_surfaces};
pub(crate) use between::{LightBetween, PictureSurfaces, round_of, rounds_of};
pub(crate) use exact::{CheckedPixel, Guess, PixelResolver, Tally};
pub use found::FoundLight;
pub(crate) use growing::GrowingReference;
pub(crate) use planned::PlannedPictures;
pub use point::LookupSet;
pub use point_cache::{CachedLight, PointCache, SurfaceKey, TracedPoint};
pub use policy::LookupQuality;
pub(crate) use policy::MAX_POINTS_PER_PIXEL;
pub use sparse::open_percent;
pub(crate) use tile::pixels_of_tile;
pub use tile::{TileLight, TilePoints, TileSurfaces};
pub use view::ViewLookup;
