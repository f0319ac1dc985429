//! What a scene consists of, by content: records name triangles by hashes of their corners, never
//! by their numbers.

use super::hash::ContentHasher;
use crate::scene::{
    Encoding, Light, Material, MaterialKind, Scene, Texture, TextureRef, hash_of_sun_and_sky,
};
use crate::trace::NO_TRIANGLE;
use rayon::prelude::*;

/// Purposes of hashes, so that different things never have the same one.
const TRIANGLE: u64 = 1;
const SURFACE: u64 = 2;
const MATERIAL: u64 = 3;
const TEXTURE: u64 = 4;
const POINT_LIGHT: u64 = 5;
const LIGHT: u64 = 6;

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
        let dependencies = vec![hash_of_surfaces(scene), hash_of_light(scene)];
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
fn hash_of_surfaces(scene: &Scene) -> u128 {
    let textures: Vec<u128> = scene.textures.par_iter().map(hash_of_texture).collect();
    let materials: Vec<u128> = scene.materials.iter().map(|m| hash_of_material(m, &textures)).collect();
    let surface = |triangle: usize| {
        let mut hasher = ContentHasher::new(SURFACE);
        let material = scene.triangle_materials[triangle].0 as usize;
        for vertex in scene.triangles[triangle].map(|vertex| vertex as usize) {
            hasher.floats(&scene.positions[vertex].to_array());
            scene.normals.get(vertex).iter().for_each(|normal| hasher.floats(&normal.to_array()));
            scene.uvs.get(vertex).iter().for_each(|uv| hasher.floats(&uv.to_array()));
        }
        hasher.wide(materials[material]);
        hasher.finish()
    };
    (0..scene.triangles.len()).into_par_iter().map(surface).reduce(|| 0, u128::wrapping_add)
}

fn hash_of_texture(texture: &Texture) -> u128 {
    let mut hasher = ContentHasher::new(TEXTURE);
    hasher.word(u64::from(texture.width) << 32 | u64::from(texture.height));
    hasher.word(u64::from(texture.encoding == Encoding::Srgb));
    hasher.bytes(bytemuck::cast_slice(&texture.texels));
    hasher.finish()
}

/// The hash of a material without its name.
fn hash_of_material(material: &Material, textures: &[u128]) -> u128 {
    let mut hasher = ContentHasher::new(MATERIAL);
    let kind = match material.kind {
        MaterialKind::Diffuse => [0, 0],
        MaterialKind::Mirror { fresnel, .. } => [1, u32::from(fresnel)],
        MaterialKind::Glass { eta, .. } => [2, eta.to_bits()],
    };
    kind.iter().for_each(|word| hasher.word(u64::from(*word)));
    for color in [material.diffuse, material.emission, material.specular()] {
        hasher.floats(&color.to_array());
    }
    for used in [material.diffuse_texture, material.alpha_texture] {
        hasher.word(u64::from(used.is_some()));
        if let Some(TextureRef { texture, scale, offset }) = used {
            hasher.wide(textures.get(texture.0 as usize).copied().unwrap_or(0));
            hasher.floats(&[scale.x, scale.y, offset.x, offset.y]);
        }
    }
    hasher.finish()
}

/// The hash of point lights, sun and sky, and of the transform to world space.
fn hash_of_light(scene: &Scene) -> u128 {
    let points = scene.lights.iter().filter_map(|light| match light {
        Light::Point { position, intensity } => {
            let mut hasher = ContentHasher::new(POINT_LIGHT);
            hasher.floats(&position.to_array());
            hasher.floats(&intensity.to_array());
            Some(hasher.finish())
        }
        _ => None,
    });
    let points = points.fold(0, u128::wrapping_add);
    let mut hasher = ContentHasher::new(LIGHT);
    hasher.wide(points);
    hasher.bytes(&hash_of_sun_and_sky(scene));
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
