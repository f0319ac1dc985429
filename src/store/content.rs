//! What a scene consists of, by content: records name triangles by hashes of their corners, never
//! by their numbers.

use super::hash::ContentHasher;
use crate::scene::Scene;
use crate::trace::NO_TRIANGLE;
use rayon::prelude::*;

/// Purposes of hashes, so that different things never have the same one.
const TRIANGLE: u64 = 1;
const SCENE: u64 = 2;

/// Added to the hash of a triangle for each earlier one with the same corners.
const TWIN: u128 = 0x9e37_79b9_7f4a_7c15_f39c_c060_5ced_c835;

/// Identities of the triangles and of the light of a scene.
#[derive(Debug)]
pub struct SceneContent {
    hashes: Vec<u128>,
    /// Hash and number of every triangle, by hash.
    by_hash: Vec<(u128, u32)>,
    dependencies: Vec<u128>,
}

impl SceneContent {
    /// Hashes a scene.
    pub fn new(scene: &Scene) -> Self {
        let count = scene.triangles.len() as u32;
        let mut by_hash: Vec<(u128, u32)> =
            (0..count).into_par_iter().map(|triangle| (hash_of(scene, triangle), triangle)).collect();
        by_hash.par_sort_unstable();
        tell_twins_apart(&mut by_hash);
        let mut hashes = vec![0; by_hash.len()];
        by_hash.iter().for_each(|&(hash, triangle)| hashes[triangle as usize] = hash);
        by_hash.par_sort_unstable();
        let mut whole = ContentHasher::new(SCENE);
        whole.bytes(scene.hash.as_bytes());
        Self { hashes, by_hash, dependencies: vec![whole.finish()] }
    }

    /// Hashes of everything that the light of this scene depends on.
    pub fn dependencies(&self) -> &[u128] {
        &self.dependencies
    }

    /// The hash of a triangle; 0 for [`NO_TRIANGLE`].
    pub(super) fn hash_of(&self, triangle: u32) -> u128 {
        self.hashes.get(triangle as usize).copied().unwrap_or(0)
    }

    /// The triangle that has a hash: [`NO_TRIANGLE`] for 0, `None` where the scene has none.
    pub(super) fn triangle_of(&self, hash: u128) -> Option<u32> {
        if hash == 0 {
            return Some(NO_TRIANGLE);
        }
        let at = self.by_hash.binary_search_by_key(&hash, |entry| entry.0).ok()?;
        Some(self.by_hash[at].1)
    }
}

/// The hash of the corners of a triangle. Never 0.
fn hash_of(scene: &Scene, triangle: u32) -> u128 {
    let mut hasher = ContentHasher::new(TRIANGLE);
    scene.corners(triangle).iter().for_each(|corner| hasher.floats(&corner.to_array()));
    hasher.finish().max(1)
}

/// Gives triangles with the same corners different hashes, in the order of their numbers.
fn tell_twins_apart(sorted: &mut [(u128, u32)]) {
    let (mut last, mut twins) = (0, 0u128);
    for entry in sorted {
        twins = if entry.0 == last { twins + 1 } else { 0 };
        last = entry.0;
        entry.0 = entry.0.wrapping_add(twins.wrapping_mul(TWIN)).max(1);
    }
}
