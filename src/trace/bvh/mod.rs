//! The bounding volume hierarchy: nearest hit and any hit, watertight.
//!
//! A binary tree (`cluster`, improved by `obvhs`) is folded into nodes of eight children and leaves of four triangles,
//! each tested by one SIMD step. Which instructions do it is chosen while running (`fearless_simd`); every choice gives
//! the same bits, for none fuses a multiplication with an addition. The library's own traversal was not used because it
//! has neither boxes that are never missed by rounding (Ize) nor a watertight triangle test, and both must be one piece
//! with the traversal: a box that is missed makes the best triangle test useless.

mod build;
mod bundle;
mod cluster;
mod cone;
mod fold;
mod packet;
mod rays8;
mod slab;
mod tile;
mod traverse;
mod vectors;

pub use bundle::{BUNDLE_RAYS, MIN_RAYS, RayBundle};
use fearless_simd::Level;
use packet::TrianglePacket;
pub use tile::{RayTile, TILE_RAYS, TILE_SIDE, TileHits};
pub use traverse::Occluder;

/// A triangle met by a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance in units of the ray's direction.
    pub t: f32,
    /// Index into the scene's triangles.
    pub triangle: u32,
    /// Barycentric weight of the second corner.
    pub b1: f32,
    /// Barycentric weight of the third corner.
    pub b2: f32,
}

/// Children of a node: with eight instead of four a ray of the gallery visits a third fewer nodes, which AVX tests in
/// one step (rays 1.3 to 1.4 times as fast). SSE2 takes two steps, and its rays are slower by a tenth to a sixth.
const WIDTH: usize = 8;

/// Eight children: their boxes side by side, so that one SIMD step tests them all.
#[repr(C, align(32))]
#[derive(Clone, Copy, Debug)]
struct Node {
    /// Lower x, upper x, lower y, upper y, lower z, upper z of each child; an absent child's box is inverted.
    bounds: [[f32; WIDTH]; 6],
    /// See [`Child`].
    children: [Child; WIDTH],
}

const _: () =
    assert!(size_of::<Node>() == 224, "seven rows of 32 bytes, so that none lies across two cache lines");

/// An inner node's index, or with the top bit set a leaf's packet index.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Child(u32);

impl Child {
    const LEAF: u32 = 1 << 31;
    const NONE: Self = Self(u32::MAX);
    /// Stands in an unused lane. Its box is met by no ray, but a ray of NaN may seem to: then a real leaf, which such a
    /// ray cannot hit, is harmless.
    const ABSENT: Self = Self(Self::LEAF);

    fn packet(self) -> Option<usize> {
        (self.0 & Self::LEAF != 0).then_some((self.0 & !Self::LEAF) as usize)
    }
}

/// The hierarchy over the triangles of one scene.
#[derive(Debug)]
pub struct Bvh {
    nodes: Vec<Node>,
    packets: Vec<TrianglePacket>,
    root: Child,
    /// The instructions of this processor.
    level: Level,
}

impl Bvh {
    /// The same hierarchy walked with only those instructions that every processor of the target has. The hits are
    /// the same; the tests see to it.
    #[must_use]
    pub fn with_baseline_simd(self) -> Self {
        Self { level: Level::baseline(), ..self }
    }

    /// Memory held, bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice()) + size_of_val(self.packets.as_slice())
    }
}
