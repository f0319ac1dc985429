//! What a scene consists of, by content: records name triangles by hashes of their corners, never
//! by their numbers. Unlike in `scene::content`, all bits of the corners count, because points are
//! found again by the ray's test on their triangle.

use super::hash::ContentHasher;
use crate::scene::Scene;
use crate::scene::content::{LightContent, MaterialContent};
use crate::trace::NO_TRIANGLE;
use rayon::prelude::*;

/// Purposes of hashes, so that different things never have the same one.
const TRIANGLE: u64 = 1;
const SURFACE: u64 = 2;
const LIGHT: u64 = 3;

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
        let light = LightContent::of(scene);
        let dependencies = vec![hash_of_surfaces(scene, &light.materials), hash_of_light(scene, &light)];
        Self { hashes, by_hash, dependencies }
    }

    /// Hashes of everything that the light of this scene depends on: of all surfaces with their
    /// materials, whatever their order, and of the other lights, sun and sky.
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

/// The sum of the hashes of all triangles with their normals, texture coordinates and materials.
/// Lamps are surfaces.
fn hash_of_surfaces(scene: &Scene, materials: &[MaterialContent]) -> u128 {
    let materials: Vec<u64> = materials.iter().map(MaterialContent::hash).collect();
    let surface = |triangle: usize| {
        let mut hasher = ContentHasher::new(SURFACE);
        let material = scene.triangle_materials[triangle].0 as usize;
        for vertex in scene.triangles[triangle].map(|vertex| vertex as usize) {
            hasher.floats(&scene.positions[vertex].to_array());
            scene.normals.get(vertex).iter().for_each(|normal| hasher.floats(&normal.to_array()));
            scene.uvs.get(vertex).iter().for_each(|uv| hasher.floats(&uv.to_array()));
        }
        hasher.word(materials[material]);
        hasher.finish()
    };
    (0..scene.triangles.len()).into_par_iter().map(surface).reduce(|| 0, u128::wrapping_add)
}

/// The hash of point lights, sun and sky, and of the transform to world space.
fn hash_of_light(scene: &Scene, light: &LightContent) -> u128 {
    let mut hasher = ContentHasher::new(LIGHT);
    hasher.word(light.point_lights.len() as u64);
    light.point_lights.iter().for_each(|light| hasher.word(*light));
    hasher.word(light.sun);
    hasher.word(light.sky);
    let frame = &scene.frame;
    frame.origin_in_world_m.to_array().iter().for_each(|value| hasher.word(value.to_bits()));
    hasher.word(frame.units_per_metre.to_bits());
    hasher.finish()
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
