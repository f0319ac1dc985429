//! The diffuse lobe: light is scattered to every side alike (Lambert's law).

use super::lobe::{Facing, Lobe};
use super::scatter::ScatterSet;
use crate::math::sampling::{cosine_hemisphere, frame_around};
use crate::scene::{Material, Texture};
use glam::{Vec2, Vec3};
use std::f32::consts::FRAC_1_PI;

/// A diffuse surface.
#[derive(Clone, Copy, Debug)]
pub struct Diffuse {
    /// Reflectance per channel, 0..1.
    pub albedo: Vec3,
}

impl Diffuse {
    /// The surface that reflects all light.
    pub const WHITE: Self = Self { albedo: Vec3::ONE };

    /// Returns the reflected radiance of a surface that receives `irradiance`.
    #[inline(always)]
    pub fn radiance(self, irradiance: Vec3) -> Vec3 {
        self.albedo * FRAC_1_PI * irradiance
    }

    /// Returns a direction with density cosine / pi about the shading normal; `None` where it would
    /// point into the triangle.
    #[inline(always)]
    pub fn sample_direction(facing: &Facing, random: [f32; 2]) -> Option<Vec3> {
        let direction = frame_around(facing.shading_normal) * cosine_hemisphere(random);
        (facing.geometric_normal.dot(direction) > 0.0).then_some(direction)
    }
}

impl Lobe for Diffuse {
    /// The cosine and the density cancel: the weight is the albedo.
    fn sample(&self, facing: &Facing, _incident: Vec3, random: [f32; 2]) -> ScatterSet {
        Self::sample_direction(facing, random)
            .map_or(ScatterSet::EMPTY, |direction| ScatterSet::reflected(direction, self.albedo))
    }

    fn evaluate(&self, facing: &Facing, _incident: Vec3, scattered: Vec3) -> Vec3 {
        let is_reflected = facing.geometric_normal.dot(scattered) > 0.0;
        if is_reflected { self.radiance(Vec3::ONE) } else { Vec3::ZERO }
    }

    fn pdf(&self, facing: &Facing, _incident: Vec3, scattered: Vec3) -> f32 {
        if facing.geometric_normal.dot(scattered) > 0.0 {
            facing.shading_normal.dot(scattered).max(0.0) * FRAC_1_PI
        } else {
            0.0
        }
    }

    fn is_specular(&self) -> bool {
        false
    }
}

/// Returns the diffuse reflectance of a material, per channel; `uv` returns the texture coordinate
/// and is called for textured materials only.
#[inline(always)]
pub fn albedo(material: &Material, textures: &[Texture], uv: impl FnOnce() -> Vec2) -> Vec3 {
    if material.coverage_texture.is_some() {
        let uv = uv();
        let texel = material.diffuse_texture.map_or(Vec3::ONE, |map| map.color(textures, uv));
        return material.diffuse * texel * material.coverage_at(textures, || uv);
    }
    if material.detail.mixes() {
        let uv = uv();
        let texel = material.diffuse_texture.map_or(Vec3::ONE, |map| map.color(textures, uv));
        return material.diffuse * texel * material.detail.base_at(textures, uv);
    }
    match material.diffuse_texture {
        None => material.diffuse,
        Some(map) => material.diffuse * map.color(textures, uv()),
    }
}
