//! What a scene consists of, by content: records name triangles by hashes of their corners, never
//! by their numbers. Unlike in `scene::content`, all bits of the corners count, because points are
//! found again by the ray's test on their triangle.

use super::hash::ContentHasher;
use super::state::{StateNames, read_state, write_state};
use crate::scene::content::{LightContent, MaterialContent};
use crate::scene::{Scene, SceneEdit};
use crate::trace::NO_TRIANGLE;
use rayon::prelude::*;
use std::sync::Arc;

/// Purposes of hashes, so that different things never have the same one.
const TRIANGLE: u64 = 1;
const SURFACE: u64 = 2;
const LIGHT: u64 = 3;
const MATERIAL: u64 = 4;
const GEOMETRY: u64 = 5;
const STATE: u64 = 6;

/// Added to the hash of a triangle for each earlier one with the same corners.
const TWIN: u128 = 0x9e37_79b9_7f4a_7c15_f39c_c060_5ced_c835;

/// Identities of the triangles and of the light of a scene.
#[derive(Debug)]
pub struct SceneContent {
    triangles: Arc<TriangleHashes>,
    dependencies: Vec<u128>,
    names: StateNames,
    geometry: u128,
    state: Vec<u8>,
    state_hash: u128,
}

/// Identities of the triangles of a scene.
#[derive(Debug)]
struct TriangleHashes {
    hashes: Vec<u128>,
    /// Hash and number of every triangle, by hash.
    by_hash: Vec<(u128, u32)>,
}

impl TriangleHashes {
    fn new(scene: &Scene) -> Self {
        let count = scene.triangles.len() as u32;
        let mut by_hash: Vec<(u128, u32)> =
            (0..count).into_par_iter().map(|triangle| (hash_of(scene, triangle), triangle)).collect();
        by_hash.par_sort_unstable();
        tell_twins_apart(&mut by_hash);
        let mut hashes = vec![0; by_hash.len()];
        by_hash.iter().for_each(|&(hash, triangle)| hashes[triangle as usize] = hash);
        by_hash.par_sort_unstable();
        Self { hashes, by_hash }
    }
}

impl SceneContent {
    /// Hashes a scene.
    pub fn new(scene: &Scene) -> Self {
        Self::with_triangles(scene, Arc::new(TriangleHashes::new(scene)), LightContent::of(scene))
    }

    /// The contents of another state of the scene, which shares its geometry and textures.
    pub(super) fn edited(&self, scene: &Scene) -> Self {
        Self::with_triangles(scene, Arc::clone(&self.triangles), self.names.light.edited(scene))
    }

    fn with_triangles(scene: &Scene, triangles: Arc<TriangleHashes>, light: LightContent) -> Self {
        let (surfaces, materials) = hash_surfaces(scene, &light.materials);
        let dependencies = vec![surfaces, hash_of_light(scene, &light)];
        let geometry = hash_of_geometry(scene, &materials);
        let names = StateNames { materials, light };
        let state = write_state(scene, &names);
        let mut hasher = ContentHasher::new(STATE);
        hasher.bytes(&state);
        Self { triangles, dependencies, names, geometry, state_hash: hasher.finish(), state }
    }

    /// Hash of the geometry, and of which triangles have one material.
    pub(super) fn geometry(&self) -> u128 {
        self.geometry
    }

    /// Materials, sun and sky as bytes, and their hash.
    pub(super) fn state(&self) -> (&[u8], u128) {
        (&self.state, self.state_hash)
    }

    /// The scene of these contents in a state that was written of the same geometry. `None` where
    /// it cannot be made again, or does not have the light of these dependencies.
    pub(super) fn in_state(&self, scene: &Scene, state: &[u8], dependencies: &[u128]) -> Option<Scene> {
        let edit: SceneEdit = read_state(state, scene, &self.names)?;
        let found = scene.with_edit(&edit);
        let light = self.names.light.edited(&found);
        let found_dependencies = [hash_surfaces(&found, &light.materials).0, hash_of_light(&found, &light)];
        (found_dependencies == *dependencies).then_some(found)
    }

    /// Hashes of everything that the light of this scene depends on: of all surfaces with their
    /// materials, whatever their order, and of the other lights, sun and sky.
    pub fn dependencies(&self) -> &[u128] {
        &self.dependencies
    }

    /// The hash of a triangle; 0 for [`NO_TRIANGLE`].
    pub(super) fn hash_of(&self, triangle: u32) -> u128 {
        self.triangles.hashes.get(triangle as usize).copied().unwrap_or(0)
    }

    /// The triangle that has a hash: [`NO_TRIANGLE`] for 0, `None` where the scene has none.
    pub(super) fn triangle_of(&self, hash: u128) -> Option<u32> {
        if hash == 0 {
            return Some(NO_TRIANGLE);
        }
        let by_hash = &self.triangles.by_hash;
        let at = by_hash.binary_search_by_key(&hash, |entry| entry.0).ok()?;
        Some(by_hash[at].1)
    }
}

/// The hash of the corners of a triangle. Never 0.
fn hash_of(scene: &Scene, triangle: u32) -> u128 {
    let mut hasher = ContentHasher::new(TRIANGLE);
    scene.corners(triangle).iter().for_each(|corner| hasher.floats(&corner.to_array()));
    hasher.finish().max(1)
}

/// The sum of the hashes of all triangles with their normals, texture coordinates and materials
/// (lamps are surfaces), and for each material that of its triangles without their material: its
/// name in every state of the scene.
fn hash_surfaces(scene: &Scene, materials: &[MaterialContent]) -> (u128, Vec<u128>) {
    let contents: Vec<u64> = materials.iter().map(MaterialContent::hash).collect();
    let none = || (0u128, vec![0u128; contents.len()]);
    let add = |(all, mut by_material): (u128, Vec<u128>), triangle: usize| {
        let material = scene.triangle_materials[triangle].0 as usize;
        let mut hasher = hasher_of_surface(scene, triangle);
        by_material[material] = by_material[material].wrapping_add(hasher.finish());
        hasher.word(contents[material]);
        (all.wrapping_add(hasher.finish()), by_material)
    };
    let join = |(a, mut by_material): (u128, Vec<u128>), (b, other): (u128, Vec<u128>)| {
        by_material.iter_mut().zip(other).for_each(|(sum, more)| *sum = sum.wrapping_add(more));
        (a.wrapping_add(b), by_material)
    };
    let triangles = (0..scene.triangles.len()).into_par_iter().with_min_len(1 << 12);
    let (all, by_material) = triangles.fold(none, add).reduce(none, join);
    (all, by_material)
}

fn hasher_of_surface(scene: &Scene, triangle: usize) -> ContentHasher {
    let mut hasher = ContentHasher::new(SURFACE);
    for vertex in scene.triangles[triangle].map(|vertex| vertex as usize) {
        hasher.floats(&scene.positions[vertex].to_array());
        scene.normals.get(vertex).iter().for_each(|normal| hasher.floats(&normal.to_array()));
        scene.uvs.get(vertex).iter().for_each(|uv| hasher.floats(&uv.to_array()));
    }
    hasher
}

/// The sum of the hashes of the triangles of each material, whatever its number.
fn hash_of_geometry(scene: &Scene, materials: &[u128]) -> u128 {
    let of_material = |name: &u128| {
        let mut hasher = ContentHasher::new(MATERIAL);
        hasher.word(*name as u64);
        hasher.word((*name >> 64) as u64);
        hasher.finish()
    };
    let used = materials.iter().filter(|name| **name != 0);
    let sum = used.map(of_material).fold(0, u128::wrapping_add);
    let mut hasher = ContentHasher::new(GEOMETRY);
    hasher.word(sum as u64);
    hasher.word((sum >> 64) as u64);
    hash_frame(&mut hasher, scene);
    hasher.finish()
}

fn hash_frame(hasher: &mut ContentHasher, scene: &Scene) {
    let frame = &scene.frame;
    frame.origin_in_world_m.to_array().iter().for_each(|value| hasher.word(value.to_bits()));
    hasher.word(frame.units_per_metre.to_bits());
}

/// The hash of point lights, sun and sky, and of the transform to world space.
fn hash_of_light(scene: &Scene, light: &LightContent) -> u128 {
    let mut hasher = ContentHasher::new(LIGHT);
    hasher.word(light.point_lights.len() as u64);
    light.point_lights.iter().for_each(|light| hasher.word(*light));
    hasher.word(light.sun);
    hasher.word(light.sky);
    hash_frame(&mut hasher, scene);
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
