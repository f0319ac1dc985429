//! The hierarchy as it lies in memory.

use super::node::{Child, Node};
use super::packet::TrianglePacket;
use fearless_simd::Level;

/// The hierarchy over the triangles of one scene.
#[derive(Debug)]
pub struct Bvh {
    pub(super) nodes: Vec<Node>,
    pub(super) packets: Vec<TrianglePacket>,
    pub(super) root: Child,
    /// The SIMD instructions of this processor.
    pub(super) level: Level,
}

impl Bvh {
    /// The same hierarchy, traversed with only those instructions that every processor of the
    /// target has. Hits have the same bits.
    #[must_use]
    pub fn with_baseline_simd(self) -> Self {
        Self { level: Level::baseline(), ..self }
    }

    /// Memory held, bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice()) + size_of_val(self.packets.as_slice())
    }
}
