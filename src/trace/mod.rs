//! The ordinary ray tracer, kept simple because it is the truth that reuse is measured against.
//!
//! [`Tracer::pixel`] is the whole of it: a primary ray ([`primary`]), the light a surface scatters to every side
//! ([`diffuse`]), the light it mirrors or lets through ([`specular`]).

pub mod bvh;
pub mod diffuse;
mod indoors;
pub mod lights;
pub mod parallel;
pub mod pixel;
pub mod primary;
mod primary_tile;
mod probe;
pub mod specular;
mod surface;

pub use bvh::{BUNDLE_RAYS, Bvh, Hit, RayBundle, RayTile, TILE_RAYS, TILE_SIDE, TileHits};
pub use lights::grid::{LightCuts, LightGrid};
pub use pixel::{PixelTrace, RayCounts, TraceSettings};
pub use primary::{SceneEpoch, Tracer};
pub use primary_tile::primary_tile;
pub use probe::Probe;
pub use surface::{ILL_CONDITIONED, SurfacePoint};

/// The triangle of a sky pixel.
pub const NO_TRIANGLE: u32 = u32::MAX;
