//! Builds the binary tree (`cluster`), improves it with `obvhs`, and folds it (`fold`).

use super::cluster::cluster;
use super::fold::Fold;
use super::node::{Child, MAX_DEPTH};
use super::tree::Bvh;
use fearless_simd::Level;
use glam::Vec3;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use rayon::prelude::*;

/// The share of nodes put elsewhere in a round: rays of the gallery visit 1 to 4 % fewer nodes than after a twentieth.
const REINSERTED: f32 = 0.2;

/// Nodes that a ray may meet on average, above which none is put elsewhere: the search for a better place meets about as
/// many, so that its time would grow with the square of the triangles. Of five real buildings 42 to 100 are met.
const MAX_MET: f32 = 1000.0;

impl Bvh {
    /// Builds the tree over triangles given by their corners.
    pub fn build(corners: &[[Vec3; 3]]) -> Self {
        Self::build_without(corners, &[])
    }

    /// The same without some of them, given ascending; not without all.
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

fn binary(corners: &[[Vec3; 3]], triangles: &[u32]) -> Bvh2 {
    let boxes: Vec<Aabb> = triangles.par_iter().map(|&i| bounds_of(&corners[i as usize])).collect();
    let mut tree = cluster(&boxes, false);
    if nodes_met(&tree) <= MAX_MET {
        ReinsertionOptimizer::default().run(&mut tree, REINSERTED, None);
    }
    if depth_of(&tree) > MAX_DEPTH {
        tree = cluster(&boxes, true);
    }
    tree.primitive_indices.iter_mut().for_each(|i| *i = triangles[*i as usize]);
    tree
}

fn bounds_of([a, b, c]: &[Vec3; 3]) -> Aabb {
    Aabb { min: a.min(*b).min(*c).into(), max: a.max(*b).max(*c).into() }
}

/// The nodes that a random ray through the root meets on average, by their areas.
fn nodes_met(tree: &Bvh2) -> f32 {
    let area: f64 = tree.nodes.iter().map(|node| f64::from(node.aabb().half_area())).sum();
    (area / f64::from(tree.nodes[0].aabb().half_area())) as f32
}

/// The largest number of inner nodes on any way from the root to a leaf.
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
