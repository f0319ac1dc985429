//! Builds a binary tree by merging neighbouring boxes from the leaves up, in bounded time.
//!
//! Source: Meister, Bittner, "Parallel Locally-Ordered Clustering for Bounding Volume Hierarchy
//! Construction", TVCG 24(3), 2018, sections 3 and 4. In each round every box searches along the
//! Morton curve for the neighbour with which it forms the smallest box; two boxes that choose each
//! other are merged. We differ: a round that would merge too few boxes merges every box with the
//! next. Where each box lies inside the next, a round of the original merges only one pair: 40,000
//! such boxes took 72 s with the builder of `obvhs` 0.4, which has no such bound.

use obvhs::{aabb::Aabb, bvh2::Bvh2, bvh2::node::Bvh2Node, ploc::morton::morton_encode_u64_unorm};
use rayon::prelude::*;

/// Number of neighbours on each side among which a box chooses.
const REACH: usize = 14;

/// Number of boxes per parallel task.
const CHUNK: usize = 1024;

/// Number of boxes below which a round may merge as little as one pair: all such rounds together
/// take about a millisecond.
const FEW: usize = 256;

/// Largest share of its boxes that a round of merging may leave. Rounds of six real buildings leave
/// at most 0.89.
const MAX_LEFT: f32 = 0.9375;

/// Builds the binary tree over one or more boxes, one per leaf.
///
/// A round that would leave too many boxes merges every box with the next. With `is_flat` every
/// round does, so the tree has the least possible depth.
pub(super) fn cluster(boxes: &[Aabb], is_flat: bool) -> Bvh2 {
    let primitive_indices = along_the_curve(boxes);
    let leaf = |(at, &i): (usize, &u32)| Bvh2Node::new(boxes[i as usize], 1, at as u32);
    let mut current: Vec<Bvh2Node> = primitive_indices.iter().enumerate().map(leaf).collect();
    let mut next = Vec::with_capacity(current.len());
    let mut partners = Vec::with_capacity(current.len());
    let mut nodes = vec![Bvh2Node::default(); 2 * boxes.len() - 1];
    let mut free = nodes.len();
    while current.len() > 1 {
        // Let every box choose a neighbour.
        choose(&current, &mut partners);
        let pairs = (0..current.len()).filter(|&i| is_first_of_pair(&partners, i)).count();
        let is_slow = (current.len() - pairs) as f32 > MAX_LEFT * current.len() as f32;
        // Merge every box with the next where too few chose each other; boxes whose area is NaN
        // choose none.
        if is_flat || pairs == 0 || (is_slow && current.len() > FEW) {
            let last = current.len() - 1;
            for (i, partner) in partners.iter_mut().enumerate() {
                *partner = (i ^ 1).min(last) as u32;
            }
        }
        // Write the merged pairs from the end of the array, so that the root comes first.
        merge(&current, &partners, &mut nodes[..free], &mut next);
        free -= 2 * (current.len() - next.len());
        std::mem::swap(&mut current, &mut next);
        next.clear();
    }
    nodes[0] = current[0];
    Bvh2 { nodes, primitive_indices, ..Bvh2::default() }
}

/// Returns the indices of the boxes in the order of the Morton codes of their centres.
fn along_the_curve(boxes: &[Aabb]) -> Vec<u32> {
    let all = boxes.iter().fold(Aabb::empty(), |all, aabb| all.union(aabb));
    let low = all.min.as_dvec3();
    let scale = (all.max.as_dvec3() - low).recip();
    let code = |aabb: &Aabb| {
        let centre = (aabb.min.as_dvec3() + aabb.max.as_dvec3()) * 0.5;
        morton_encode_u64_unorm((centre - low) * scale)
    };
    let mut order: Vec<(u64, u32)> =
        boxes.par_iter().enumerate().map(|(i, aabb)| (code(aabb), i as u32)).collect();
    order.par_sort_unstable();
    order.into_iter().map(|(_, i)| i).collect()
}

/// True where box `i` and its partner chose each other, and `i` comes first.
fn is_first_of_pair(partners: &[u32], i: usize) -> bool {
    let partner = partners[i] as usize;
    partner > i && partners[partner] as usize == i
}

/// Writes to `partners` the neighbour that each of two or more boxes would merge with.
fn choose(current: &[Bvh2Node], partners: &mut Vec<u32>) {
    partners.clear();
    partners.resize(current.len(), 0);
    let chunks = partners.par_chunks_mut(CHUNK).enumerate();
    chunks.for_each(|(chunk, partners)| choose_in(current, chunk * CHUNK, partners));
}

/// [`choose`] for the boxes from `first` on. Every pair is measured once.
fn choose_in(current: &[Bvh2Node], first: usize, partners: &mut [u32]) {
    let mut best = [Choice::NONE; CHUNK + 2 * REACH];
    let from = first.saturating_sub(REACH);
    let end = first + partners.len();
    for i in from..end {
        let bounds = current[i].aabb();
        let seen = &current[i + 1..current.len().min(i + 1 + REACH)];
        for (other, j) in seen.iter().zip(i + 1..) {
            let area = bounds.union(other.aabb()).half_area();
            best[i - from].or(Choice { area, apart: (i ^ j) as u32, partner: j as u32 });
            best[j - from].or(Choice { area, apart: (i ^ j) as u32, partner: i as u32 });
        }
    }
    for (partner, choice) in partners.iter_mut().zip(&best[first - from..]) {
        *partner = choice.partner;
    }
}

/// A box to merge with.
///
/// Among equal areas the pair whose indices differ in the lowest bits wins: both boxes then choose
/// each other, and a row of equal boxes is merged in pairs.
#[derive(Clone, Copy)]
struct Choice {
    /// Half the surface area of the merged box.
    area: f32,
    /// Exclusive or of the two indices.
    apart: u32,
    /// Index of the box to merge with.
    partner: u32,
}

impl Choice {
    /// Worse than any other choice.
    const NONE: Self = Self { area: f32::INFINITY, apart: u32::MAX, partner: 0 };

    /// Takes the other choice where it is better.
    fn or(&mut self, other: Self) {
        if (other.area, other.apart) < (self.area, self.apart) {
            *self = other;
        }
    }
}

/// Merges the boxes of `current` that chose each other: their nodes go to the end of `nodes`, and
/// the merged and the remaining boxes are appended to `next`.
fn merge(current: &[Bvh2Node], partners: &[u32], nodes: &mut [Bvh2Node], next: &mut Vec<Bvh2Node>) {
    let mut free = nodes.len();
    for (i, node) in current.iter().enumerate() {
        let partner = partners[i] as usize;
        if is_first_of_pair(partners, i) {
            let other = &current[partner];
            free -= 2;
            nodes[free] = *node;
            nodes[free + 1] = *other;
            next.push(Bvh2Node::new(node.aabb().union(other.aabb()), 0, free as u32));
        } else if partner == i || !is_first_of_pair(partners, partner) || partners[partner] as usize != i {
            next.push(*node);
        }
    }
}
