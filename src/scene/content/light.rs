//! Hashes of materials, textures, lights, sun and sky.

use super::hasher::{ContentHash, ContentHasher};
use crate::scene::{
    Detail, Encoding, Light, Material, MaterialKind, Sampling, Scene, Sky, Sun, Texture, TextureRef,
};
use rayon::prelude::*;
use std::sync::Arc;

/// The content of a material, by what its parts decide.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MaterialContent {
    /// What it reflects: diffuse colour, texture, mirror. Direct light elsewhere does not depend on
    /// it.
    pub reflection: ContentHash,
    /// What passes through it, and so along shadow rays: glass and cut-out texels.
    pub transmission: ContentHash,
    /// The radiance that it emits, in linear RGB.
    pub emission: ContentHash,
}

impl MaterialContent {
    /// Hash of the whole material.
    pub fn hash(&self) -> ContentHash {
        let mut hasher = ContentHasher::new(b"material");
        [self.reflection, self.transmission, self.emission].into_iter().for_each(|part| hasher.word(part));
        hasher.finish()
    }
}

/// The content of all that gives light in a scene, or reflects it. Names do not count.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LightContent {
    /// Hash of each texture.
    pub textures: Vec<ContentHash>,
    /// Content of each material.
    pub materials: Vec<MaterialContent>,
    /// Hash of each point light, ascending. Lamps with an area follow from triangles and their
    /// materials.
    pub point_lights: Vec<ContentHash>,
    /// Hash of the sun; zero without one.
    pub sun: ContentHash,
    /// Hash of the sky; zero without one.
    pub sky: ContentHash,
}

impl LightContent {
    /// Hashes the materials, lights, sun and sky of a scene.
    pub fn of(scene: &Scene) -> Self {
        Self::with_textures(scene, scene.textures.iter().map(hash_texture).collect())
    }

    /// The content of an edited state of a scene, which shares its textures: they are not hashed
    /// again.
    pub(crate) fn edited(&self, scene: &Scene) -> Self {
        Self::with_textures(scene, self.textures.clone())
    }

    fn with_textures(scene: &Scene, textures: Vec<ContentHash>) -> Self {
        let mut point_lights: Vec<ContentHash> =
            scene.lights.iter().filter_map(|light| hash_point_light(scene, light)).collect();
        point_lights.sort_unstable();
        Self {
            materials: materials_with(scene, &textures),
            point_lights,
            sun: scene.sun.as_ref().map_or(0, hash_sun),
            sky: scene.sky.as_ref().map_or(0, hash_sky),
            textures,
        }
    }
}

/// Returns the contents of the materials of two scenes, to be compared. Scenes that share their
/// textures are compared by the numbers of these, which is faster than to hash them.
pub(crate) fn materials_of_both(scenes: [&Scene; 2]) -> [Vec<MaterialContent>; 2] {
    if !Arc::ptr_eq(&scenes[0].textures, &scenes[1].textures) {
        return scenes.map(|scene| LightContent::of(scene).materials);
    }
    let numbers: Vec<ContentHash> = (2..).take(scenes[0].textures.len()).collect();
    scenes.map(|scene| materials_with(scene, &numbers))
}

/// The contents of the materials of a scene whose textures have these hashes.
fn materials_with(scene: &Scene, textures: &[ContentHash]) -> Vec<MaterialContent> {
    scene.materials.iter().map(|material| content_of_material(material, textures)).collect()
}

fn content_of_material(material: &Material, textures: &[ContentHash]) -> MaterialContent {
    let texture = |hasher: &mut ContentHasher, used: Option<TextureRef>| match used {
        None => hasher.word(0),
        Some(TextureRef { texture, scale, offset, sampling }) => {
            hasher.word(textures.get(texture.0 as usize).copied().unwrap_or(1));
            hasher.pair(scale);
            hasher.pair(offset);
            // Uses that repeat and filter keep their hashes.
            if sampling != Sampling::default() {
                hasher.word(u64::from(sampling.turn.to_bits()) | u64::from(sampling.code()) << 32);
            }
        }
    };
    let mut reflection = ContentHasher::new(b"reflect.");
    reflection.triple(material.diffuse);
    texture(&mut reflection, material.diffuse_texture);
    let mut transmission = ContentHasher::new(b"transmit");
    texture(&mut transmission, material.alpha_texture);
    if material.coverage_texture.is_some() {
        texture(&mut transmission, material.coverage_texture);
    }
    hash_kind(material.kind, &mut reflection, &mut transmission);
    if material.is_thin {
        transmission.word(3);
    }
    // Materials without detail keep their hashes.
    if material.detail != Detail::default() {
        material.detail.numbers().into_iter().for_each(|number| reflection.number(number));
        material.detail.textures().into_iter().for_each(|used| texture(&mut reflection, used));
    }
    if material.detail.transmission_texture.is_some() {
        transmission.triple(material.diffuse);
        transmission.number(material.detail.transmission);
        texture(&mut transmission, material.diffuse_texture);
        texture(&mut transmission, material.detail.transmission_texture);
    }
    let mut emission = ContentHasher::new(b"emission");
    emission.triple(material.emission);
    if material.has_dark_back() {
        emission.word(1);
    }
    // Materials without these keep their hashes.
    for used in [material.emission_texture, material.coverage_texture].into_iter().filter(Option::is_some) {
        texture(&mut emission, used);
    }
    let [reflection, transmission, emission] =
        [reflection, transmission, emission].map(ContentHasher::finish);
    MaterialContent { reflection, transmission, emission }
}

/// Hashes the specular part of a material: what it reflects and what it transmits.
fn hash_kind(kind: MaterialKind, reflection: &mut ContentHasher, transmission: &mut ContentHasher) {
    match kind {
        MaterialKind::Diffuse => reflection.word(0),
        MaterialKind::Mirror { reflectance, fresnel } => {
            reflection.word(1 + u64::from(fresnel));
            reflection.triple(reflectance);
        }
        MaterialKind::Glass { eta, transmittance } => {
            transmission.number(eta);
            transmission.triple(transmittance);
        }
        MaterialKind::Glossy { reflectance, roughness } => {
            reflection.word(3);
            reflection.triple(reflectance);
            reflection.number(roughness);
        }
        MaterialKind::Frosted { eta, transmittance, roughness } => {
            [eta, roughness].into_iter().for_each(|number| transmission.number(number));
            transmission.triple(transmittance);
        }
    }
}

fn hash_texture(texture: &Texture) -> ContentHash {
    let row = |texels: &[[u8; 4]]| {
        let mut hasher = ContentHasher::new(b"texels..");
        for pair in texels.chunks(2) {
            let [first, last] = [pair[0], pair[pair.len() - 1]].map(|t| u64::from(u32::from_le_bytes(t)));
            hasher.word(first | last << 32);
        }
        hasher.finish()
    };
    let width = texture.width.max(1) as usize;
    let rows: Vec<ContentHash> = texture.texels.par_chunks(width).map(row).collect();
    let mut hasher = ContentHasher::new(b"texture.");
    hasher.word(u64::from(texture.width) | u64::from(texture.height) << 32);
    hasher.word(u64::from(texture.encoding == Encoding::Srgb));
    rows.into_iter().for_each(|row| hasher.word(row));
    hasher.finish()
}

fn hash_point_light(scene: &Scene, light: &Light) -> Option<ContentHash> {
    let Light::Point { position, intensity, beam, profile } = light else { return None };
    let mut hasher = ContentHasher::new(b"point...");
    let at = scene.frame.world_from_scene(*position).as_vec3();
    let square = (scene.frame.units_per_metre * scene.frame.units_per_metre) as f32;
    hasher.triple(at);
    hasher.triple(*intensity / square);
    if let Some(beam) = beam {
        hasher.triple(beam.direction);
        hasher.number(beam.cos_inner);
        hasher.number(beam.cos_outer);
    }
    if let Some(profile) = profile {
        hasher.word(u64::from(profile.profile().code()));
        profile.axes().into_iter().for_each(|axis| hasher.triple(axis));
        profile.profile().numbers().for_each(|number| hasher.number(number));
    }
    Some(hasher.finish())
}

fn hash_sun(sun: &Sun) -> ContentHash {
    let mut hasher = ContentHasher::new(b"sun.....");
    hasher.triple(sun.direction);
    hasher.number(sun.angular_radius);
    hasher.triple(sun.irradiance);
    hasher.finish()
}

fn hash_sky(sky: &Sky) -> ContentHash {
    let mut hasher = ContentHasher::new(b"sky.....");
    match sky {
        Sky::Gradient(sky) => {
            hasher.word(0);
            [sky.zenith, sky.horizon, sky.ground].into_iter().for_each(|c| hasher.triple(c));
        }
        Sky::Cie(sky) => {
            hasher.word(1 + u64::from(sky.kind as u32));
            [sky.zenith, sky.ground, sky.sun_direction].into_iter().for_each(|c| hasher.triple(c));
        }
        Sky::Physical(sky) => {
            hasher.word(8);
            [sky.sun_direction(), sky.ground()].into_iter().for_each(|c| hasher.triple(c));
            [sky.turbidity(), sky.albedo(), sky.brightness()].into_iter().for_each(|n| hasher.number(n));
        }
        Sky::Picture(sky) => {
            hasher.word(9);
            let [width, height] = sky.image.size().map(u64::from);
            hasher.word(width | height << 32);
            sky.image.digest().iter().for_each(|&byte| hasher.word(u64::from(byte)));
            [sky.rotation_deg, sky.brightness].into_iter().for_each(|n| hasher.number(n));
        }
        Sky::Dimmed(dimmed) => {
            hasher.word(10);
            hasher.word(hash_sky(&dimmed.sky));
            hasher.triple(dimmed.factor);
        }
    }
    hasher.finish()
}
