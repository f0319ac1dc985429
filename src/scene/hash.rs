//! The hash that identifies a scene.

use super::{Encoding, Light, MaterialKind, Scene, TextureRef};
use glam::Vec3;
use sha2::{Digest, Sha256};

/// Format of the hashed bytes. A change of the format needs a new number.
const VERSION: &[u8] = b"afterimage scene 1";

/// Returns the SHA-256 of everything that decides a picture, as lower-case hexadecimal digits.
/// Names, views, the camera path and warnings are left out, and so is what follows from the rest:
/// emissive surfaces as lights, features and solids.
///
/// All numbers are hashed in the byte order of the processor, which is little-endian on every
/// supported one.
pub(super) fn of(scene: &Scene) -> String {
    let mut hasher = SceneHasher(Sha256::new());
    hasher.block(VERSION);
    hasher.block(bytemuck::cast_slice(&scene.positions));
    hasher.block(bytemuck::cast_slice(&scene.normals));
    hasher.block(bytemuck::cast_slice(&scene.uvs));
    hasher.block(bytemuck::cast_slice(&scene.triangles));
    let ids: Vec<u32> = scene.triangle_materials.iter().map(|id| id.0).collect();
    hasher.block(bytemuck::cast_slice(&ids));
    let origin = scene.frame.origin_in_world_m;
    hasher.block(bytemuck::bytes_of(&[origin.x, origin.y, origin.z, scene.frame.units_per_metre]));
    hasher.materials(scene);
    hasher.light_sources(scene);
    for t in &scene.textures {
        hasher.numbers(&[t.width, t.height, u32::from(t.encoding == Encoding::Srgb)]);
        hasher.block(bytemuck::cast_slice(&t.texels));
    }
    hasher.0.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

struct SceneHasher(Sha256);

impl SceneHasher {
    /// Hashes some bytes with their length, so that no two sequences of blocks have the same bytes.
    fn block(&mut self, bytes: &[u8]) {
        self.0.update((bytes.len() as u64).to_le_bytes());
        self.0.update(bytes);
    }

    fn numbers(&mut self, numbers: &[u32]) {
        self.block(bytemuck::cast_slice(numbers));
    }

    fn vectors(&mut self, vectors: &[Vec3]) {
        self.block(bytemuck::cast_slice(vectors));
    }

    fn texture(&mut self, texture: Option<TextureRef>) {
        match texture {
            None => self.numbers(&[]),
            Some(TextureRef { texture, scale, offset }) => {
                let [scale, offset] = [scale, offset].map(|v| v.to_array().map(f32::to_bits));
                self.numbers(&[texture.0, scale[0], scale[1], offset[0], offset[1]]);
            }
        }
    }

    fn materials(&mut self, scene: &Scene) {
        self.numbers(&[scene.materials.len() as u32]);
        for material in &scene.materials {
            let (kind, parameter) = match material.kind {
                MaterialKind::Diffuse => (0, 0),
                MaterialKind::Mirror { fresnel, .. } => (1, u32::from(fresnel)),
                MaterialKind::Glass { eta, .. } => (2, eta.to_bits()),
            };
            self.numbers(&[kind, parameter]);
            self.vectors(&[material.diffuse, material.emission, material.specular()]);
            self.texture(material.diffuse_texture);
            self.texture(material.alpha_texture);
        }
    }

    fn light_sources(&mut self, scene: &Scene) {
        for light in &scene.lights {
            if let Light::Point { position, intensity } = *light {
                self.vectors(&[position, intensity]);
            }
        }
        let sun = scene.sun.map(|sun| [sun.direction, Vec3::splat(sun.angular_radius), sun.irradiance]);
        self.vectors(sun.as_ref().map_or(&[], |sun| sun));
        let sky = scene.sky.map(|sky| [sky.zenith, sky.horizon, sky.ground]);
        self.vectors(sky.as_ref().map_or(&[], |sky| sky));
    }
}
