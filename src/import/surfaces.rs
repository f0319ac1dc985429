//! Rules about materials that all formats share.

use super::picture::{Picture, is_translucent};
use crate::scene::{Material, MaterialKind, SMOOTH, TextureRef};
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

/// Roughness from which on a clear coat is left out. Over a base of albedo 0.5, a coat of 0.5 adds
/// 4 % of the radiance seen from above and 8 % at 75 degrees, in even light; exporters write 0.5
/// where no value was chosen.
const MATTE_COAT: f32 = 0.5;

/// Roughness from which on a metal is matte in its colour. Exporters that know no metal leave both
/// values out, which means a metal of roughness 1.
const MATTE_METAL: f32 = 0.95;

/// The material of faces whose material is not defined.
pub(super) fn undefined(name: &str) -> Material {
    Material::diffuse(name, Vec3::splat(NEUTRAL))
}

/// How a surface of the metallic-roughness model reflects (glTF 2.0, section 3.9.2 and appendix B).
#[derive(Clone, Copy, Debug)]
pub(super) struct Gloss {
    pub(super) metalness: f32,
    pub(super) roughness: f32,
    /// Reflectance at normal incidence of what is not metal.
    pub(super) coat: Vec3,
}

impl Gloss {
    /// Makes a material with the base colour as its diffuse part reflect. `mean_base` is the mean
    /// base colour with its texture, which becomes the colour of metal.
    pub(super) fn apply(self, material: &mut Material, mean_base: Vec3) {
        let Self { metalness, roughness, coat } = self;
        let is_metal = metalness > METAL;
        if is_metal && roughness < SMOOTH {
            material.diffuse = Vec3::ZERO;
            material.kind = MaterialKind::Mirror { reflectance: mean_base, fresnel: false };
            return;
        }
        let metalness = if is_metal { 1.0 } else { metalness };
        let reflectance = coat.lerp(mean_base, metalness);
        if roughness < matte_from(metalness) && reflectance.max_element() > 0.0 {
            material.diffuse *= 1.0 - metalness;
            material.kind = MaterialKind::Glossy { reflectance, roughness };
        }
    }
}

impl Gloss {
    /// [`Self::apply`] where metal has the colour of its place: the base colour of the material
    /// with its texture.
    pub(super) fn apply_by_place(self, material: &mut Material) {
        let metalness = if self.metalness > METAL { 1.0 } else { self.metalness };
        if self.roughness < matte_from(metalness) {
            Self { metalness, ..self }.apply_always(material);
        }
    }

    /// Makes a material reflect whatever its roughness, with metal in the colour of its place.
    pub(super) fn apply_always(self, material: &mut Material) {
        material.kind = MaterialKind::Glossy { reflectance: self.coat, roughness: self.roughness };
        material.detail.metalness = self.metalness;
    }

    /// True where next to no place reflects. `texels` are metalness and roughness, which multiply
    /// those of this.
    pub(super) fn is_matte_by_place(&self, texels: impl Iterator<Item = [u8; 2]>) -> bool {
        /// Share of places that may reflect in a matte surface: noise of compressed pictures.
        const SHARE: f32 = 1.0 / 100.0;
        let (mut shiny, mut count) = (0u32, 0u32);
        for [metalness, roughness] in texels {
            let share = |byte: u8| f32::from(byte) / 255.0;
            let matte = matte_from(self.metalness * share(metalness));
            shiny += u32::from(self.roughness * share(roughness) < matte);
            count += 1;
        }
        shiny as f32 <= SHARE * count as f32
    }
}

/// Roughness from which on a surface of this metalness is matte.
fn matte_from(metalness: f32) -> f32 {
    MATTE_COAT + (MATTE_METAL - MATTE_COAT) * metalness
}

/// Gives a material a picture of roughness (green), or makes it matte where next to no place of it
/// reflects then.
pub(super) fn roughen(material: &mut Material, texture: TextureRef, picture: &Picture) {
    let MaterialKind::Glossy { roughness, reflectance } = material.kind else { return };
    let gloss = Gloss { metalness: material.detail.metalness, roughness, coat: reflectance };
    if gloss.is_matte_by_place(picture.texture.texels.iter().map(|&[_, g, ..]| [255, g])) {
        material.kind = MaterialKind::Diffuse;
    } else {
        material.detail.roughness_texture = Some(texture);
    }
}

/// Makes a material matte whose pictures were to say where it reflects, and did not.
pub(super) fn settle(material: &mut Material) {
    let MaterialKind::Glossy { roughness, .. } = material.kind else { return };
    let metalness = material.detail.metalness;
    if material.detail.roughness_texture.is_none() && roughness >= matte_from(metalness) {
        material.kind = MaterialKind::Diffuse;
    }
}

/// Reflectance at normal incidence of a dielectric with this index of refraction.
pub(super) fn reflectance_of(eta: f32) -> f32 {
    let ratio = (eta - 1.0) / (eta + 1.0);
    ratio * ratio
}

/// Clear or frosted glass.
pub(super) fn glass_of(eta: f32, transmittance: Vec3, roughness: f32) -> MaterialKind {
    match roughness < SMOOTH {
        true => MaterialKind::Glass { eta, transmittance },
        false => MaterialKind::Frosted { eta, transmittance, roughness },
    }
}

/// Removes the surface where the alpha of its picture says so: cut out at one half, or see-through
/// where the picture is translucent.
pub(super) fn cover(material: &mut Material, texture: TextureRef, picture: &Picture) {
    cover_with(material, texture, is_translucent(picture.texture.texels.iter().map(|t| t[3])));
}

/// [`cover`] by a texture that is known to be translucent or not. Mirrors and glass are cut out:
/// they have a specular part of their own.
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
