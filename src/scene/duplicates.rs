//! Triangles that coincide exactly with an earlier one. Some exporters write thousands of them.
//! Rounding would choose between two surfaces at the same distance pixel by pixel, so rays only
//! meet the first.

use super::connectivity::corner_keys;
use super::{Material, Scene};
use rayon::prelude::*;

/// Triangles with the same corners as an earlier one.
pub(super) struct Duplicates {
    /// Triangles hidden by the earlier one, ascending.
    pub(super) hidden: Vec<u32>,
    /// Number of triangles that rays must still meet, because one of the two is glass, has an alpha
    /// texture or emits differently.
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
                if hides(scene.material_of(first), scene.material_of(later)) {
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

/// True if a surface of the first material hides one of the second in the same place.
fn hides(first: &Material, later: &Material) -> bool {
    first.is_opaque() && later.is_opaque() && first.emission == later.emission
}

fn fingerprint(corners: &[[u32; 3]; 3]) -> u64 {
    corners.as_flattened().iter().fold(0, |hash: u64, &word| {
        let mixed = (hash ^ u64::from(word)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        mixed ^ (mixed >> 29)
    })
}
