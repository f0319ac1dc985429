//! The ordinary ray tracer, kept simple because it is the truth that reuse is measured against.
//!
//! | module | contents |
//! |---|---|
//! | [`bvh`] | the bounding volume hierarchy: one ray, a tile of primary rays, shadow rays |
//! | `tracer`, `surface` | a scene with its hierarchy, and the surface points that its rays hit |
//! | `lights` | sampling of light sources and what passes on the way to them |
//! | `path` | the radiance of a pixel: diffuse light, bounces, mirrors and glass |
//! | `settings`, `bounce_limit` | how many rays a pixel takes |
//! | `visibility` | the first hits of a whole picture by rasterised candidates |
//! | `primary_tile`, `probe` | the primary rays of a tile, and rays that measure the model |
//! | [`section`] | what the camera sees of a scene that is cut open by planes |
//! | `exposure` | the light in the scene, measured for the automatic exposure |
//! | `start_view` | the start view of a model that has none of its own |
//! | [`parallel`] | tracing many pixels on all threads |
//!
//! [`Tracer::pixel`] traces one pixel in full.

mod bounce_limit;
pub mod bvh;
mod exposure;
mod lights;
pub mod parallel;
mod path;
mod primary_tile;
mod probe;
mod relief;
pub mod section;
mod settings;
mod start_view;
mod surface;
mod tracer;
mod visibility;

pub use bounce_limit::{BounceLimit, NotABounceLimit};
pub use bvh::{BUNDLE_RAYS, Bvh, Hit, NO_TRIANGLE, RayBundle, RayTile, TILE_RAYS, TILE_SIDE, TileHits};
pub(crate) use lights::{GroupLight, LightKinds};
pub use lights::{LightCuts, LightGrid};
pub use path::{
    ArrivingLight, CachedLight, LightSettings, MAX_BOUNCES, MAX_PATH, PathVertex, PixelTrace, Reader,
    truncation_bound,
};
pub(crate) use path::{CachedGroups, GroupSettings, PathStop, SmoothSettings};
pub use primary_tile::primary_tile;
pub use probe::Probe;
pub use settings::{RayCounts, TraceSettings};
pub(crate) use surface::emission_of_hit;
pub use surface::{ILL_CONDITIONED, SurfacePoint};
pub use tracer::{SceneEpoch, Tracer};
pub use visibility::VisibilityBuffer;
