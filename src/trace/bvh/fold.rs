//! Folds a binary tree into nodes of [`WIDTH`] children and leaves of up to four triangles.
//!
//! Source: Ylitie, Karras, Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed
//! Wide BVHs", HPG 2017, section 3.1: dynamic programming from the leaves up finds the fold that
//! costs a random ray least. We differ: a leaf of four triangles costs no more than a leaf of one,
//! because a packet tests four at a time.

use super::node::{Child, Node, WIDTH};
use super::{packet::TrianglePacket, tree::Bvh};
use glam::Vec3;
use obvhs::bvh2::Bvh2;

/// Time of testing a packet of triangles, relative to testing a node. For values from 0.5 to 3 the
/// numbers of nodes and packets that rays visit agree to about 1 %.
const PACKET_COST: f32 = 1.0;

/// The cheapest ways to turn a subtree into at most 1, 2, ... [`WIDTH`] nodes or leaves.
#[derive(Clone, Copy)]
struct Ways {
    /// Cost of each way: surface areas times relative time.
    cost: [f32; WIDTH],
    /// Number of them that the left child gets; 0 where one fewer is no worse.
    left: [u8; WIDTH],
    /// Number of children that the left child gets in a node that holds the whole subtree; 0 for a
    /// leaf.
    children_left: u8,
}

impl Ways {
    /// The only way of a leaf.
    fn of_leaf(cost: f32) -> Self {
        Self { cost: [cost; WIDTH], left: [0; WIDTH], children_left: 0 }
    }

    /// The ways of an inner node with surface area `area`, from those of its children.
    fn of_pair(area: f32, leaf_cost: f32, a: &Self, b: &Self) -> Self {
        // Find the cheapest split of at most `most` parts between the children.
        let split = |most: usize| {
            let cost_of = |left: usize| a.cost[left - 1] + b.cost[most - left - 1];
            let cheapest = (1..most).min_by(|&x, &y| cost_of(x).total_cmp(&cost_of(y))).unwrap_or(1);
            (cheapest as u8, cost_of(cheapest))
        };
        // Compare one leaf, one node, and the children of that node.
        let (children_left, children_cost) = split(WIDTH);
        let node_cost = area + children_cost;
        if leaf_cost <= node_cost && leaf_cost <= children_cost {
            return Self::of_leaf(leaf_cost);
        }
        let mut ways = Self::of_leaf(leaf_cost.min(node_cost));
        ways.children_left = if leaf_cost <= node_cost { 0 } else { children_left };
        // Find the cheapest way into two parts and more.
        for most in 2..=WIDTH {
            let (left, cost) = split(most);
            ways.cost[most - 1] = ways.cost[most - 2].min(cost);
            ways.left[most - 1] = if cost < ways.cost[most - 2] { left } else { 0 };
        }
        ways
    }
}

/// Returns the cheapest ways of every subtree.
fn plan(tree: &Bvh2) -> Vec<Ways> {
    let mut ways = vec![Ways::of_leaf(0.0); tree.nodes.len()];
    let mut counts = vec![0; tree.nodes.len()];
    for i in children_first(tree) {
        let node = &tree.nodes[i];
        let (area, first) = (node.aabb().half_area(), node.first_index as usize);
        if node.is_leaf() {
            counts[i] = 1;
            ways[i] = Ways::of_leaf(area * PACKET_COST);
            continue;
        }
        counts[i] = counts[first] + counts[first + 1];
        let leaf_cost = if counts[i] <= 4 { area * PACKET_COST } else { f32::INFINITY };
        ways[i] = Ways::of_pair(area, leaf_cost, &ways[first], &ways[first + 1]);
    }
    ways
}

/// Returns the node indices with children before their parents. Nodes may lie anywhere in the
/// array, so an explicit stack orders the visit.
fn children_first(tree: &Bvh2) -> impl Iterator<Item = usize> {
    let mut order = Vec::with_capacity(tree.nodes.len());
    let mut stack = vec![0u32];
    while let Some(i) = stack.pop() {
        order.push(i as usize);
        let node = &tree.nodes[i as usize];
        if !node.is_leaf() {
            stack.extend([node.first_index, node.first_index + 1]);
        }
    }
    order.into_iter().rev()
}

/// A fold in progress: appends nodes and packets to a hierarchy.
pub(super) struct Fold<'a> {
    tree: &'a Bvh2,
    ways: Vec<Ways>,
    corners: &'a [[Vec3; 3]],
    bvh: &'a mut Bvh,
}

impl<'a> Fold<'a> {
    /// Plans the fold of a binary tree into an empty hierarchy.
    pub(super) fn new(tree: &'a Bvh2, corners: &'a [[Vec3; 3]], bvh: &'a mut Bvh) -> Self {
        Self { tree, ways: plan(tree), corners, bvh }
    }

    /// Folds the subtree at `index` and returns its root. Recursion is at most
    /// [`super::node::MAX_DEPTH`] deep.
    pub(super) fn child(&mut self, index: u32) -> Child {
        let ways = &self.ways[index as usize];
        if ways.children_left == 0 {
            return self.leaf(&self.triangles_below(index));
        }
        let mut members = Vec::with_capacity(WIDTH);
        self.halve(index, WIDTH, ways.children_left, &mut members);
        let slot = self.reserve_node();
        let mut node = Node::EMPTY;
        for (lane, &member) in members.iter().enumerate() {
            let child = self.child(member);
            node.set(lane, child, self.tree.nodes[member as usize].aabb());
        }
        self.bvh.nodes[slot] = node;
        Child(slot as u32)
    }

    /// Appends to `members` the roots of the cheapest way to turn the subtree at `index` into at
    /// most `most` parts.
    fn roots(&self, index: u32, most: usize, members: &mut Vec<u32>) {
        let ways = &self.ways[index as usize];
        match (1..most).rev().find(|&m| ways.left[m] != 0) {
            Some(m) => self.halve(index, m + 1, ways.left[m], members),
            None => members.push(index),
        }
    }

    /// Appends the roots of both children, `left` of at most `most` parts going to the left one.
    fn halve(&self, index: u32, most: usize, left: u8, members: &mut Vec<u32>) {
        let first = self.tree.nodes[index as usize].first_index;
        self.roots(first, left.into(), members);
        self.roots(first + 1, most - usize::from(left), members);
    }

    /// Appends an empty node. Parents lie before their children, so a traversal reads memory
    /// forwards.
    fn reserve_node(&mut self) -> usize {
        self.bvh.nodes.push(Node::EMPTY);
        self.bvh.nodes.len() - 1
    }

    /// Returns the triangles of a subtree of at most four leaves.
    fn triangles_below(&self, index: u32) -> Vec<u32> {
        let mut triangles = Vec::with_capacity(4);
        let mut stack = vec![index];
        while let Some(i) = stack.pop() {
            let node = &self.tree.nodes[i as usize];
            if node.is_leaf() {
                triangles.push(self.tree.primitive_indices[node.first_index as usize]);
            } else {
                stack.extend([node.first_index, node.first_index + 1]);
            }
        }
        triangles
    }

    /// Appends a packet of up to four triangles.
    fn leaf(&mut self, triangles: &[u32]) -> Child {
        let mut packet = TrianglePacket::EMPTY;
        for (lane, &triangle) in triangles.iter().enumerate() {
            packet.set(lane, triangle, self.corners[triangle as usize]);
        }
        self.bvh.packets.push(packet);
        Child::leaf(self.bvh.packets.len() - 1)
    }
}
