//! Builds the binary tree with `obvhs` and folds it four children wide.

use super::packet::TrianglePacket;
use super::{Bvh, Child, Node};
use glam::Vec3;
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::bvh2::node::Bvh2Node;
use obvhs::{Boundable, BvhBuildParams};
use rayon::prelude::*;

/// Inner levels a traversal can hold: each leaves at most three siblings on the stack.
pub(super) const MAX_DEPTH: usize = 80;

/// Four triangles a leaf, because a packet tests four at the price of one. Reinsertion of a fifth of the nodes, all of
/// it before leaves are collapsed: on the gallery rays cost 5 % less than with the preset's twentieth before and
/// tenth after, and building takes 1.3 times as long.
const BUILD: BvhBuildParams = BvhBuildParams {
    max_prims_per_leaf: 4,
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
        let mut bvh = Self { nodes: Vec::new(), packets: Vec::new(), root: Child::NONE };
        if corners.is_empty() {
            return bvh;
        }
        let groups = Groups::of_equal_boxes(corners);
        let binary = build_bvh2(&groups.boxes, BUILD, &mut std::time::Duration::default());
        let tree = if depth_of(&binary) <= MAX_DEPTH { binary } else { balanced(&groups.boxes) };
        let counts = triangle_counts(&tree, &groups);
        let mut fold = Fold { tree: &tree, groups: &groups, counts, corners, bvh: &mut bvh };
        let root = fold.child(0);
        bvh.root = root;
        bvh
    }
}

/// Triangles grouped by equal bounding boxes, which the builder sees as one.
///
/// Of many equal boxes the builder merges one pair a round: 20,000 of them took 14 s and gave a tree 20,000 deep.
struct Groups {
    boxes: Vec<Bounded>,
    /// Where each group's triangles begin in `triangles`; one entry more than groups.
    first: Vec<u32>,
    triangles: Vec<u32>,
}

impl Groups {
    fn of_equal_boxes(corners: &[[Vec3; 3]]) -> Self {
        let all: Vec<Aabb> = corners.par_iter().map(bounds_of).collect();
        let key = |i: u32| {
            let aabb = &all[i as usize];
            [aabb.min.to_array(), aabb.max.to_array()].map(|p| p.map(f32::to_bits))
        };
        let mut triangles: Vec<u32> = (0..corners.len() as u32).collect();
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

    fn members(&self, group: u32) -> &[u32] {
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

/// Triangles below each node. Children may stand anywhere in the array, so an explicit stack orders the visit.
fn triangle_counts(tree: &Bvh2, groups: &Groups) -> Vec<u32> {
    let mut counts = vec![0; tree.nodes.len()];
    let mut order = Vec::with_capacity(tree.nodes.len());
    let mut stack = vec![0u32];
    while let Some(i) = stack.pop() {
        order.push(i as usize);
        let node = &tree.nodes[i as usize];
        if !node.is_leaf() {
            stack.extend([node.first_index, node.first_index + 1]);
        }
    }
    for &i in order.iter().rev() {
        let node = &tree.nodes[i];
        let first = node.first_index as usize;
        counts[i] = if node.is_leaf() {
            let members = &tree.primitive_indices[first..first + node.prim_count as usize];
            members.iter().map(|&g| groups.members(g).len() as u32).sum()
        } else {
            counts[first] + counts[first + 1]
        };
    }
    counts
}

/// The state of folding a binary tree into one with four children a node.
struct Fold<'a> {
    tree: &'a Bvh2,
    groups: &'a Groups,
    counts: Vec<u32>,
    corners: &'a [[Vec3; 3]],
    bvh: &'a mut Bvh,
}

impl Fold<'_> {
    /// Folds the subtree at `index`. The machine stack holds at most [`MAX_DEPTH`] calls.
    fn child(&mut self, index: u32) -> Child {
        let node = &self.tree.nodes[index as usize];
        if self.counts[index as usize] <= 4 || node.is_leaf() {
            let triangles = self.triangles_below(index);
            return self.bundle(&triangles, *node.aabb());
        }
        let (members, count) = self.members(index);
        let slot = self.reserve_node();
        let mut node = EMPTY_NODE;
        for (lane, &member) in members[..count].iter().enumerate() {
            let child = self.child(member);
            node.set(lane, child, self.tree.nodes[member as usize].aabb());
        }
        self.bvh.nodes[slot] = node;
        Child(slot as u32)
    }

    /// A leaf, or for more triangles of one box than a leaf holds, nodes of equal boxes above leaves.
    fn bundle(&mut self, triangles: &[u32], aabb: Aabb) -> Child {
        if triangles.len() <= 4 {
            return self.leaf(triangles);
        }
        let slot = self.reserve_node();
        let mut node = EMPTY_NODE;
        for (lane, part) in triangles.chunks(triangles.len().div_ceil(4)).enumerate() {
            let child = self.bundle(part, aabb);
            node.set(lane, child, &aabb);
        }
        self.bvh.nodes[slot] = node;
        Child(slot as u32)
    }

    /// Parents stand before their children, so that a walk down reads memory forwards.
    fn reserve_node(&mut self) -> usize {
        self.bvh.nodes.push(EMPTY_NODE);
        self.bvh.nodes.len() - 1
    }

    /// Up to four descendants that together are `index`: the largest is opened until there are four.
    fn members(&self, index: u32) -> ([u32; 4], usize) {
        let first = self.tree.nodes[index as usize].first_index;
        let mut members = [first, first + 1, 0, 0];
        let mut count = 2;
        while count < 4 {
            let area = |m: u32| self.tree.nodes[m as usize].aabb().half_area();
            let can_open = |m: u32| self.counts[m as usize] > 4 && !self.tree.nodes[m as usize].is_leaf();
            let largest = (0..count)
                .filter(|&i| can_open(members[i]))
                .max_by(|&a, &b| area(members[a]).total_cmp(&area(members[b])));
            let Some(i) = largest else { break };
            let first = self.tree.nodes[members[i] as usize].first_index;
            members[i] = first;
            members[count] = first + 1;
            count += 1;
        }
        (members, count)
    }

    fn triangles_below(&self, index: u32) -> Vec<u32> {
        let mut triangles = Vec::with_capacity(4);
        let mut stack = vec![index];
        while let Some(i) = stack.pop() {
            let node = &self.tree.nodes[i as usize];
            if !node.is_leaf() {
                stack.extend([node.first_index, node.first_index + 1]);
                continue;
            }
            for k in node.first_index..node.first_index + node.prim_count {
                triangles.extend_from_slice(self.groups.members(self.tree.primitive_indices[k as usize]));
            }
        }
        triangles
    }

    fn leaf(&mut self, triangles: &[u32]) -> Child {
        let mut packet = TrianglePacket::EMPTY;
        for (lane, &triangle) in triangles.iter().enumerate() {
            packet.set(lane, triangle, self.corners[triangle as usize]);
        }
        self.bvh.packets.push(packet);
        Child(Child::LEAF | (self.bvh.packets.len() - 1) as u32)
    }
}

/// Boxes that no ray meets.
const EMPTY_NODE: Node = {
    let (low, high) = ([f32::INFINITY; 4], [f32::NEG_INFINITY; 4]);
    Node { bounds: [low, high, low, high, low, high], children: [Child::ABSENT; 4] }
};

impl Node {
    fn set(&mut self, lane: usize, child: Child, aabb: &Aabb) {
        self.children[lane] = child;
        for axis in 0..3 {
            self.bounds[2 * axis][lane] = aabb.min[axis];
            self.bounds[2 * axis + 1][lane] = aabb.max[axis];
        }
    }
}
