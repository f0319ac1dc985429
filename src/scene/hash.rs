//! The hash that identifies a scene.

use super::{Detail, Encoding, Light, MaterialKind, Sampling, Scene, Sky};
use bytemuck::NoUninit;
use glam::Vec3;
use sha2::{Digest, Sha256};

/// Version of the format of the hashed bytes. A change of the format needs a new number.
const VERSION: &[u8] = b"afterimage scene 1";

/// Returns the SHA-256 of everything that decides a picture, as lower-case hexadecimal digits.
/// Names, views, the camera path and warnings are left out, and so is what follows from the rest:
/// emissive surfaces as lights, features and solids.
///
/// Numbers are hashed in the byte order of the processor, which is little-endian on all supported
/// ones.
pub(super) fn of(scene: &Scene) -> String {
    let mut hasher = SceneHasher(Sha256::new());
    hasher.add(VERSION);
    hasher.add(&scene.positions);
    hasher.add(&scene.normals);
    hasher.add(&scene.uvs);
    hasher.add(&scene.triangles);
    hasher.add(&scene.triangle_materials.iter().map(|id| id.0).collect::<Vec<_>>());
    hasher.add(&[scene.frame.origin_in_world_m]);
    hasher.add(&[scene.frame.units_per_metre]);
    hasher.add_materials(scene);
    hasher.add_light_sources(scene);
    for t in scene.textures.iter() {
        hasher.add(&[t.width, t.height, u32::from(t.encoding == Encoding::Srgb)]);
        hasher.add(&t.texels);
    }
    hasher.0.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

struct SceneHasher(Sha256);

impl SceneHasher {
    /// Hashes values with their total size, so that different sequences of calls hash different
    /// bytes.
    fn add<T: NoUninit>(&mut self, values: &[T]) {
        let bytes: &[u8] = bytemuck::cast_slice(values);
        self.0.update((bytes.len() as u64).to_le_bytes());
        self.0.update(bytes);
    }

    fn add_materials(&mut self, scene: &Scene) {
        self.add(&[scene.materials.len() as u64]);
        for material in &scene.materials {
            let kind = match material.kind {
                MaterialKind::Diffuse => [0, 0],
                MaterialKind::Mirror { fresnel, .. } => [1, u32::from(fresnel)],
                MaterialKind::Glass { eta, .. } => [2, eta.to_bits()],
                MaterialKind::Glossy { roughness, .. } => [3, roughness.to_bits()],
                MaterialKind::Frosted { eta, .. } => [4, eta.to_bits()],
            };
            self.add(&kind);
            if let MaterialKind::Frosted { roughness, .. } = material.kind {
                self.add(&[roughness]);
            }
            self.add(&[material.diffuse, material.emission, material.specular()]);
            for texture in [material.diffuse_texture, material.alpha_texture] {
                self.add(texture.map(|t| t.texture.0).as_slice());
                self.add(texture.map(|t| [t.scale, t.offset]).as_slice());
            }
            for (slot, texture) in (0u32..).zip(material.texture_slots()) {
                let Some(sampling) = texture.map(|t| t.sampling) else { continue };
                if sampling != Sampling::default() {
                    self.add(&[3, slot, u32::from(sampling.code()), sampling.turn.to_bits()]);
                }
            }
            if material.is_thin {
                self.add(&[4u32]);
            }
            if material.has_dark_back() {
                self.add(&[6u32]);
            }
            // Materials without these keep their bytes.
            for (tag, texture) in [(1, material.coverage_texture), (2, material.emission_texture)] {
                if let Some(t) = texture {
                    self.add(&[tag, t.texture.0]);
                    self.add(&[t.scale, t.offset]);
                }
            }
            if material.detail != Detail::default() {
                self.add_detail(&material.detail);
            }
        }
    }

    fn add_detail(&mut self, detail: &Detail) {
        self.add(&[5u32]);
        self.add(&detail.numbers());
        for texture in detail.textures() {
            self.add(texture.map(|t| t.texture.0).as_slice());
            self.add(texture.map(|t| [t.scale, t.offset]).as_slice());
        }
    }

    fn add_light_sources(&mut self, scene: &Scene) {
        for light in &scene.lights {
            if let Light::Point { position, intensity, beam, profile } = light {
                self.add(&[*position, *intensity]);
                let cone = beam.map(|b| [b.direction, Vec3::new(b.cos_inner, b.cos_outer, 0.0)]);
                // Lights without a cone keep their bytes.
                cone.iter().for_each(|cone| self.add(cone));
                if let Some(profile) = profile {
                    self.add(&profile.axes());
                    self.add(&[profile.profile().code()]);
                    self.add(&profile.profile().numbers().collect::<Vec<f32>>());
                }
            }
        }
        let sun = scene.sun.map(|s| [s.direction, Vec3::splat(s.angular_radius), s.irradiance]);
        self.add(sun.as_slice());
        match &scene.sky {
            None => self.add::<[Vec3; 3]>(&[]),
            Some(sky) => self.add_sky(sky),
        }
    }

    fn add_sky(&mut self, sky: &Sky) {
        match sky {
            Sky::Gradient(s) => self.add(&[[s.zenith, s.horizon, s.ground]]),
            Sky::Cie(s) => {
                self.add(&[[s.zenith, s.ground, s.sun_direction]]);
                self.add(&[s.kind as u32]);
            }
            Sky::Physical(s) => {
                self.add(&[s.sun_direction(), s.ground()]);
                self.add(&[s.turbidity(), s.albedo(), s.brightness()]);
            }
            Sky::Picture(s) => {
                self.add(&s.image.size());
                self.add(s.image.digest());
                self.add(&[s.rotation_deg, s.brightness]);
            }
            Sky::Dimmed(dimmed) => {
                self.add_sky(&dimmed.sky);
                self.add(&[dimmed.factor]);
            }
        }
    }
}
