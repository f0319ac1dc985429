//! Triangles that coincide exactly with an earlier one. Some exporters write thousands of them.
//! Rounding would choose between two surfaces at the same distance pixel by pixel, so rays only
//! meet the first.

use super::Scene;
use super::connectivity::{PositionKey, corner_keys};
use rayon::prelude::*;

/// Triangles with the same corners as an earlier one.
pub(super) struct Duplicates {
    /// Triangles hidden by the earlier one, ascending.
    pub(super) hidden: Vec<u32>,
    /// Number of triangles that rays must still meet, because one of the two is glass, has an alpha
    /// texture, emits differently, or has another material and faces the other way.
    pub(super) seen: usize,
}

impl Duplicates {
    pub(super) fn find(scene: &Scene) -> Self {
        let corners = |t: u32| {
            let mut corners = corner_keys(scene, t);
            corners.sort_unstable();
            corners
        };
        let mut order: Vec<(u64, u32)> =
            scene.triangle_indices().into_par_iter().map(|t| (fingerprint(&corners(t)), t)).collect();
        order.par_sort_unstable();
        let mut found = Self { hidden: Vec::new(), seen: 0 };
        for equal in order.chunk_by(|a, b| a.0 == b.0).filter(|group| group.len() > 1) {
            let first = equal[0].1;
            for &(_, later) in equal[1..].iter().filter(|(_, later)| corners(*later) == corners(first)) {
                if hides(scene, first, later) {
                    found.hidden.push(later);
                } else {
                    found.seen += 1;
                }
            }
        }
        found.hidden.sort_unstable();
        found
    }
}

/// True if a triangle hides a later one in the same place. One of another material that faces the
/// other way is seen from there.
fn hides(scene: &Scene, first: u32, later: u32) -> bool {
    let [a, b] = [first, later].map(|t| scene.material_of(t));
    let is_same = scene.triangle_materials[first as usize] == scene.triangle_materials[later as usize];
    // The other side of a lamp that emits from its front is seen as well.
    let has_two_looks = !is_same || a.has_dark_back();
    let looks_alike =
        !has_two_looks || is_wound_alike(&corner_keys(scene, first), &corner_keys(scene, later));
    a.is_opaque()
        && b.is_opaque()
        && (a.emission, a.emission_texture, a.emits_from_front)
            == (b.emission, b.emission_texture, b.emits_from_front)
        && looks_alike
}

/// True where two triangles with the same corners name them in the same order.
fn is_wound_alike(a: &[PositionKey; 3], b: &[PositionKey; 3]) -> bool {
    (0..3).any(|turn| (0..3).all(|i| a[i] == b[(i + turn) % 3]))
}

fn fingerprint(corners: &[[u32; 3]; 3]) -> u64 {
    corners.as_flattened().iter().fold(0, |hash: u64, &word| {
        let mixed = (hash ^ u64::from(word)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        mixed ^ (mixed >> 29)
    })
}
