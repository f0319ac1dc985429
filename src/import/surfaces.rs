//! Rules about materials that all formats share.

use crate::scene::{Material, MaterialKind};
use glam::Vec3;

/// Diffuse reflectance of a face whose material is not defined: a neutral grey.
pub(super) const NEUTRAL: f32 = 0.6;

/// Index of refraction of glass that does not state its own: window glass.
pub(super) const GLASS_ETA: f32 = 1.5;

/// Reflectance of a clear coat at normal incidence: varnish, with an index of refraction of 1.5.
pub(super) const COAT: f32 = 0.04;

/// Roughness of a material that becomes rough and has none: a satin varnish.
pub(super) const DEFAULT_ROUGHNESS: f32 = 0.3;

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

/// Makes a matte material let `1 - opacity` of the light through, without refraction.
pub(super) fn thin(material: &mut Material, opacity: f32) {
    material.diffuse *= opacity;
    material.kind = MaterialKind::Glass { eta: 1.0, transmittance: Vec3::splat(1.0 - opacity) };
}
