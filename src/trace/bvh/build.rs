//! Builds the hierarchy: a binary tree (`cluster`), improved by `obvhs`, then folded (`fold`).

use super::node::{Child, MAX_DEPTH};
use super::{cluster::cluster, fold::Fold, tree::Bvh};
use fearless_simd::Level;
use glam::Vec3;
use obvhs::{aabb::Aabb, bvh2::Bvh2, bvh2::reinsertion::ReinsertionOptimizer};
use rayon::prelude::*;

/// Share of the nodes that reinsertion moves in a round. Rays of the gallery visit 1 to 4 % fewer
/// nodes than with 0.05.
const REINSERTED: f32 = 0.2;

/// Nodes that a random ray meets on average, above which reinsertion is skipped. The search for a
/// better place meets about as many nodes, so its time would grow with the square of the number of
/// triangles. Five real buildings have 42 to 100.
const MAX_MET: f32 = 1000.0;

impl Bvh {
    /// Builds the hierarchy over triangles given by their corners, scene space.
    pub fn build(corners: &[[Vec3; 3]]) -> Self {
        Self::build_without(corners, &[])
    }

    /// Builds the hierarchy without the triangles `hidden`, which are given in ascending order. It
    /// is empty where all are hidden.
    pub fn build_without(corners: &[[Vec3; 3]], hidden: &[u32]) -> Self {
        let mut bvh = Self { nodes: Vec::new(), packets: Vec::new(), root: Child::NONE, level: Level::new() };
        if corners.len() == hidden.len() {
            return bvh;
        }
        let is_seen = |i: &u32| hidden.binary_search(i).is_err();
        let triangles: Vec<u32> = (0..corners.len() as u32).filter(is_seen).collect();
        let tree = binary(corners, &triangles);
        bvh.root = Fold::new(&tree, corners, &mut bvh).child(0);
        bvh
    }
}

/// Builds the binary tree over some of the triangles.
fn binary(corners: &[[Vec3; 3]], triangles: &[u32]) -> Bvh2 {
    let boxes: Vec<Aabb> = triangles.par_iter().map(|&i| bounds_of(&corners[i as usize])).collect();
    let mut tree = cluster(&boxes, false);
    // Move nodes to better places where that takes linear time.
    if nodes_met(&tree) <= MAX_MET {
        ReinsertionOptimizer::default().run(&mut tree, REINSERTED, None);
    }
    // Build a flat tree where a traversal could not hold this one.
    if depth_of(&tree) > MAX_DEPTH {
        tree = cluster(&boxes, true);
    }
    for index in &mut tree.primitive_indices {
        *index = triangles[*index as usize];
    }
    tree
}

fn bounds_of([a, b, c]: &[Vec3; 3]) -> Aabb {
    Aabb { min: a.min(*b).min(*c).into(), max: a.max(*b).max(*c).into() }
}

/// Returns the number of nodes that a random ray through the root meets on average, from their
/// surface areas.
fn nodes_met(tree: &Bvh2) -> f32 {
    let area: f64 = tree.nodes.iter().map(|node| f64::from(node.aabb().half_area())).sum();
    (area / f64::from(tree.nodes[0].aabb().half_area())) as f32
}

/// Returns the largest number of inner nodes on any path from the root to a leaf.
fn depth_of(tree: &Bvh2) -> usize {
    let mut deepest = 0;
    let mut stack = vec![(0u32, 0usize)];
    while let Some((index, depth)) = stack.pop() {
        let node = &tree.nodes[index as usize];
        deepest = deepest.max(depth);
        if !node.is_leaf() {
            stack.extend([(node.first_index, depth + 1), (node.first_index + 1, depth + 1)]);
        }
    }
    deepest
}
