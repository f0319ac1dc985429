//! Triangles that lie exactly on an earlier one, which exporters write by the thousand: of two at one distance rounding
//! would choose, pixel by pixel, so rays are told of the first alone.

use super::{Material, MaterialId};
use glam::Vec3;
use rayon::prelude::*;

/// Triangles that equal an earlier one.
pub(super) struct Duplicates {
    /// Those that the earlier one hides, ascending.
    pub(super) hidden: Vec<u32>,
    /// How many must be seen all the same, because one of the two is glass, cut out or a lamp.
    pub(super) seen: usize,
}

impl Duplicates {
    pub(super) fn find(
        positions: &[Vec3],
        triangles: &[[u32; 3]],
        materials_of: &[MaterialId],
        materials: &[Material],
    ) -> Self {
        let corners = |t: u32| {
            let mut corners =
                triangles[t as usize].map(|v| (positions[v as usize] + 0.0).to_array().map(f32::to_bits));
            corners.sort_unstable();
            corners
        };
        let material = |t: u32| &materials[materials_of[t as usize].0 as usize];
        let mut order: Vec<(u64, u32)> =
            (0..triangles.len() as u32).into_par_iter().map(|t| (fingerprint(&corners(t)), t)).collect();
        order.par_sort_unstable();
        let mut found = Self { hidden: Vec::new(), seen: 0 };
        for equal in order.chunk_by(|a, b| a.0 == b.0).filter(|group| group.len() > 1) {
            let first = equal[0].1;
            for &(_, later) in equal[1..].iter().filter(|(_, later)| corners(*later) == corners(first)) {
                if hides(material(first), material(later)) {
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

/// True where a surface of the first material leaves nothing to see of one of the second in the same place.
fn hides(first: &Material, later: &Material) -> bool {
    first.is_opaque() && later.is_opaque() && first.emission == later.emission
}

fn fingerprint(corners: &[[u32; 3]; 3]) -> u64 {
    corners.as_flattened().iter().fold(0, |hash: u64, &word| {
        let mixed = (hash ^ u64::from(word)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        mixed ^ (mixed >> 29)
    })
}
