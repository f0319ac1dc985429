//! Builds the binary tree with `obvhs`, to be folded (`fold`).

use super::fold::Fold;
use super::{Bvh, Child};
use fearless_simd::Level;
use glam::Vec3;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::{Boundable, BvhBuildParams};
use rayon::prelude::*;

/// Inner levels a traversal can hold.
pub(super) const MAX_DEPTH: usize = 80;

/// One triangle a leaf: what becomes a leaf is decided when folding. Reinsertion of a fifth of the nodes: rays of the
/// gallery visit 1 to 4 % fewer than after that of a twentieth, and building takes about 1.4 times as long.
const BUILD: BvhBuildParams = BvhBuildParams {
    max_prims_per_leaf: 1,
    pre_split: false,
    reinsertion_batch_ratio: 0.2,
    post_collapse_reinsertion_batch_ratio_multiplier: 0.0,
    ..BvhBuildParams::medium_build()
};

struct Bounded(Aabb);

impl Boundable for Bounded {
    fn aabb(&self) -> Aabb {
        self.0
    }
}

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
        let groups = Groups::of_equal_boxes(corners, hidden);
        let binary = build_bvh2(&groups.boxes, BUILD, &mut std::time::Duration::default());
        let tree = if depth_of(&binary) <= MAX_DEPTH { binary } else { balanced(&groups.boxes) };
        bvh.root = Fold::new(&tree, &groups, corners, &mut bvh).child(0);
        bvh
    }
}

/// Triangles grouped by equal bounding boxes, which the builder sees as one.
///
/// Of many equal boxes the builder merges one pair a round: 20,000 of them took 14 s and gave a tree 20,000 deep.
pub(super) struct Groups {
    boxes: Vec<Bounded>,
    /// Where each group's triangles begin in `triangles`; one entry more than groups.
    first: Vec<u32>,
    triangles: Vec<u32>,
}

impl Groups {
    fn of_equal_boxes(corners: &[[Vec3; 3]], hidden: &[u32]) -> Self {
        let all: Vec<Aabb> = corners.par_iter().map(bounds_of).collect();
        let key = |i: u32| {
            let aabb = &all[i as usize];
            [aabb.min.to_array(), aabb.max.to_array()].map(|p| p.map(f32::to_bits))
        };
        let is_seen = |i: &u32| hidden.binary_search(i).is_err();
        let mut triangles: Vec<u32> = (0..corners.len() as u32).filter(is_seen).collect();
        triangles.par_sort_unstable_by_key(|&i| (key(i), i));
        let mut groups = Self { boxes: Vec::new(), first: Vec::new(), triangles };
        for (at, &triangle) in groups.triangles.iter().enumerate() {
            if at == 0 || key(groups.triangles[at - 1]) != key(triangle) {
                groups.boxes.push(Bounded(all[triangle as usize]));
                groups.first.push(at as u32);
            }
        }
        groups.first.push(groups.triangles.len() as u32);
        groups
    }

    pub(super) fn members(&self, group: u32) -> &[u32] {
        let [from, to] = [group, group + 1].map(|g| self.first[g as usize] as usize);
        &self.triangles[from..to]
    }
}

fn bounds_of([a, b, c]: &[Vec3; 3]) -> Aabb {
    Aabb { min: a.min(*b).min(*c).into(), max: a.max(*b).max(*c).into() }
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

/// A tree cut in the middle of its triangles at every level: never deep, whatever the input. The way out for input
/// on which the better builder degenerates (many equal boxes, nested shrinking triangles).
fn balanced(boxes: &[Bounded]) -> Bvh2 {
    let mut tree = Bvh2 { primitive_indices: (0..boxes.len() as u32).collect(), ..Bvh2::default() };
    tree.nodes.push(Bvh2Node::default());
    let mut stack = vec![(0usize, 0usize, boxes.len())];
    while let Some((node, first, end)) = stack.pop() {
        let range = &mut tree.primitive_indices[first..end];
        let union = range.iter().fold(Aabb::empty(), |u, &i| u.union(&boxes[i as usize].0));
        if range.len() <= 4 {
            tree.nodes[node] = Bvh2Node::new(union, range.len() as u32, first as u32);
            continue;
        }
        let extent = (union.max - union.min).to_array();
        let axis = (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b])).unwrap_or(0);
        let centre = |i: u32| boxes[i as usize].0.min[axis] + boxes[i as usize].0.max[axis];
        let middle = range.len() / 2;
        range.select_nth_unstable_by(middle, |&a, &b| centre(a).total_cmp(&centre(b)).then(a.cmp(&b)));
        let children = tree.nodes.len();
        tree.nodes.extend([Bvh2Node::default(); 2]);
        tree.nodes[node] = Bvh2Node::new(union, 0, children as u32);
        stack.extend([(children, first, first + middle), (children + 1, first + middle, end)]);
    }
    tree
}
