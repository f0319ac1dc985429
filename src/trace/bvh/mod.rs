//! The bounding volume hierarchy: nearest hit and any hit, watertight.
//!
//! A binary tree (`cluster`, improved by `obvhs`) is folded into nodes of eight children and leaves
//! of four triangles, each tested by one SIMD step. The instructions are chosen at run time
//! (`fearless_simd`); every choice gives the same bits, because none fuses a multiplication with an
//! addition. The traversal of `obvhs` is not used because it has neither boxes that rounding never
//! misses (Ize) nor a watertight triangle test, and both must be one piece with the traversal: once
//! a box is missed, the best triangle test is of no use.
//!
//! | files | contents |
//! |---|---|
//! | `tree`, `node`, `hit` | the data |
//! | `build`, `cluster`, `fold` | building, in this order |
//! | `slab`, `packet` | a ray against eight boxes; a ray against four triangles |
//! | `rays` | several rays against a triangle |
//! | `traverse` | one ray |
//! | `tile` | 64 primary rays |
//! | `ray_bundle`, `cone`, `bundle` | up to 16 shadow rays: the data, their bounds, the traversal |

mod bits;
mod build;
mod bundle;
mod cluster;
mod cone;
mod fold;
mod hit;
mod node;
mod packet;
mod ray_bundle;
mod rays;
mod slab;
mod tile;
mod traverse;
mod tree;
mod vectors;

pub(super) use bits::Bits;
pub use bundle::Judge;
pub use hit::{Hit, NO_TRIANGLE};
pub(super) use node::{Child, Node};
pub(super) use packet::{TrianglePacket, intersect_triangle};
pub use ray_bundle::{BUNDLE_RAYS, MIN_RAYS, RayBundle};
pub(super) use rays::{LANES, RayShear, SeenTriangle};
pub(super) use slab::safe_component;
pub use tile::{RayTile, TILE_RAYS, TILE_SIDE, TileHits};
pub use traverse::Occluder;
pub(super) use traverse::{FARTHER, STACK, nearest_first};
pub use tree::Bvh;
pub(super) use vectors::{cross, dot, sub};
