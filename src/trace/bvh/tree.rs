//! The hierarchy as it lies in memory.

use super::node::{Child, Node};
use super::packet::TrianglePacket;
use fearless_simd::Level;

/// The hierarchy over the triangles of one scene.
#[derive(Debug)]
pub struct Bvh {
    pub(in crate::trace) nodes: Vec<Node>,
    pub(in crate::trace) packets: Vec<TrianglePacket>,
    pub(in crate::trace) root: Child,
    /// The SIMD instructions of this processor.
    pub(in crate::trace) level: Level,
}

impl Bvh {
    /// The same hierarchy, traversed with only those instructions that every processor of the
    /// target has. Hits have the same bits.
    #[must_use]
    pub fn with_baseline_simd(self) -> Self {
        Self { level: Level::baseline(), ..self }
    }

    /// The triangle in a slot: four times the index of its packet, plus its lane.
    #[inline(always)]
    pub(in crate::trace) fn triangle_in_slot(&self, slot: u32) -> (&TrianglePacket, usize) {
        (&self.packets[slot as usize / 4], slot as usize % 4)
    }

    /// Memory held, bytes.
    pub fn bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice()) + size_of_val(self.packets.as_slice())
    }
}
