//! Rules about materials that all formats share.

use super::picture::{Picture, is_translucent};
use crate::scene::{Material, MaterialKind, TextureRef};
use glam::Vec3;

/// Diffuse reflectance of a face whose material is not defined: a neutral grey.
pub(super) const NEUTRAL: f32 = 0.6;

/// Index of refraction of glass that does not state its own: window glass.
pub(super) const GLASS_ETA: f32 = 1.5;

/// Above this metalness a surface is a metal.
pub(super) const METAL: f32 = 0.9;

/// Below this roughness a metal is a mirror.
const POLISHED: f32 = 0.1;

/// The material of faces whose material is not defined.
pub(super) fn undefined(name: &str) -> Material {
    Material::diffuse(name, Vec3::splat(NEUTRAL))
}

/// True for a metal that mirrors. Rougher metal is matte, because there is no glossy reflection
/// here.
pub(super) fn is_polished_metal(metalness: f32, roughness: f32) -> bool {
    metalness > METAL && roughness < POLISHED
}

/// Removes the surface where the alpha of its picture says so: cut out at one half, or see-through
/// where the picture is translucent.
pub(super) fn cover(material: &mut Material, texture: TextureRef, picture: &Picture) {
    cover_with(material, texture, is_translucent(picture.texture.texels.iter().map(|t| t[3])));
}

/// [`cover`] by a texture that is known to be translucent or not. Mirrors and glass are cut out: they
/// have a specular part of their own.
pub(super) fn cover_with(material: &mut Material, texture: TextureRef, is_translucent: bool) {
    if is_translucent && material.kind == MaterialKind::Diffuse {
        material.cover_by(texture);
    } else {
        material.alpha_texture = Some(texture);
    }
}

/// Makes a matte material or a mirror let `1 - opacity` of the light through. A mirror becomes a
/// coloured film: one material has one specular part.
pub(super) fn fade(material: &mut Material, opacity: f32) {
    if let MaterialKind::Mirror { reflectance, .. } = material.kind {
        material.diffuse = reflectance;
    }
    thin(material, opacity);
}

/// Makes a matte material let `1 - opacity` of the light through, without refraction.
pub(super) fn thin(material: &mut Material, opacity: f32) {
    material.diffuse *= opacity;
    material.kind = MaterialKind::Glass { eta: 1.0, transmittance: Vec3::splat(1.0 - opacity) };
}
