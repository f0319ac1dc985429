//! Triangles connected by equal vertex positions.

use super::Scene;
use std::collections::{BTreeMap, HashMap};
use std::hash::Hash;

/// A vertex position by its bits. Vertices at the same position are equal.
pub(super) type PositionKey = [u32; 3];

/// Returns the positions of the corners of a triangle as keys.
pub(super) fn corner_keys(scene: &Scene, triangle: u32) -> [PositionKey; 3] {
    // Adding zero makes -0 equal to +0.
    scene.corners(triangle).map(|p| (p + 0.0).to_array().map(f32::to_bits))
}

/// Groups `members`, given in ascending order, into connected sets of triangles of one class.
/// Groups and their triangles are in ascending order.
pub(super) fn connected_groups<C: Eq + Hash>(
    scene: &Scene,
    members: &[u32],
    class: impl Fn(u32) -> C,
) -> Vec<Vec<u32>> {
    let mut parent: Vec<usize> = (0..members.len()).collect();
    let mut owner: HashMap<(C, PositionKey), usize> = HashMap::new();
    for (i, &t) in members.iter().enumerate() {
        for corner in corner_keys(scene, t) {
            let first = *owner.entry((class(t), corner)).or_insert(i);
            let (a, b) = (root(&mut parent, first), root(&mut parent, i));
            parent[a.max(b)] = a.min(b);
        }
    }
    // The root of a group is its first member.
    let mut groups: BTreeMap<usize, Vec<u32>> = BTreeMap::new();
    for (i, &t) in members.iter().enumerate() {
        groups.entry(root(&mut parent, i)).or_default().push(t);
    }
    groups.into_values().collect()
}

fn root(parent: &mut [usize], mut i: usize) -> usize {
    while parent[i] != i {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    i
}
