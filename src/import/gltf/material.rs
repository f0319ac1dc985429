//! Reading a material: its values, checked and clamped to their ranges.

use super::document::{Document, Found, List};
use super::schema::{self, TextureInfo};
use crate::import::surfaces::GLASS_ETA;
use crate::import::{options::Limits, tally::Tally, trouble::Trouble};
use glam::{DVec3, Vec2, Vec3};

/// Use of a texture: the index of its image, and the transform of texture coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Use {
    pub(super) image: usize,
    pub(super) scale: Vec2,
    pub(super) offset: Vec2,
}

/// Meaning of alpha (`alphaMode`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Alpha {
    Opaque,
    Mask { cutoff: f32 },
    Blend,
}

/// A material as in the file, with all values in range.
#[derive(Clone, Debug)]
pub(super) struct GltfMaterial {
    /// Base colour factor.
    pub(super) base: Vec3,
    pub(super) opacity: f32,
    pub(super) alpha: Alpha,
    pub(super) metallic: f32,
    pub(super) roughness: f32,
    pub(super) transmission: f32,
    pub(super) eta: f32,
    /// Factor of the reflectance of what is not metal.
    pub(super) specular: Vec3,
    /// Share and roughness of a clear coat over all.
    pub(super) clearcoat: [f32; 2],
    pub(super) emission: Vec3,
    /// Texture of base colour and alpha.
    pub(super) base_use: Option<Use>,
    /// Texture of roughness (green) and metalness (blue).
    pub(super) metal_use: Option<Use>,
    /// Texture of emission.
    pub(super) glow_use: Option<Use>,
}

/// Returns which set of texture coordinates a texture uses: 0 or 1.
pub(super) fn uv_set(info: Option<&TextureInfo>) -> u32 {
    let transform = |i: &TextureInfo| i.extensions.transform.as_ref().and_then(|t| t.tex_coord);
    info.map_or(0, |i| transform(i).unwrap_or(i.tex_coord)).min(1)
}

/// Reader of one material. Values out of range are counted as troubles.
pub(super) struct MaterialReader<'a, 'd, 't> {
    pub(super) document: &'d Document<'t>,
    pub(super) tally: &'a mut Tally,
    /// Index of the material.
    pub(super) index: usize,
}

impl MaterialReader<'_, '_, '_> {
    pub(super) fn read(&mut self, json: &schema::Material) -> GltfMaterial {
        let pbr = &json.pbr_metallic_roughness;
        let [r, g, b, a] = pbr.base_color_factor.map(|c| self.within(c, 1.0));
        let strength = json.extensions.emissive_strength.as_ref().and_then(|e| e.emissive_strength);
        let glow = DVec3::from_array(json.emissive_factor) * strength.unwrap_or(1.0);
        let metallic = self.within(pbr.metallic_factor, 1.0);
        let metal = pbr.metallic_roughness_texture.as_ref();
        let specular = self.specular(json.extensions.specular.as_ref());
        let coat = json.extensions.clearcoat.as_ref();
        let coat = coat.map_or([0.0; 2], |c| [c.clearcoat_factor, c.clearcoat_roughness_factor]);
        let transmission = json.extensions.transmission.as_ref().map_or(0.0, |t| t.transmission_factor);
        let ior = json.extensions.ior.as_ref().and_then(|i| i.ior).unwrap_or(f64::from(GLASS_ETA));
        GltfMaterial {
            base: Vec3::new(r, g, b),
            opacity: a,
            alpha: self.alpha(json),
            metallic,
            roughness: self.within(pbr.roughness_factor, 1.0),
            transmission: self.within(transmission, 1.0),
            eta: self.eta(ior),
            specular,
            clearcoat: coat.map(|c| self.within(c, 1.0)),
            emission: Vec3::from_array(glow.to_array().map(|c| self.within(c, f64::from(Limits::RADIANCE)))),
            base_use: self.used(pbr.base_color_texture.as_ref()),
            metal_use: self.used(metal),
            glow_use: self.used(json.emissive_texture.as_ref().filter(|_| glow != DVec3::ZERO)),
        }
    }

    fn note(&mut self, trouble: Trouble, detail: &str) {
        self.document.note(self.document.fault(List::Materials, self.index, trouble, detail), self.tally);
    }

    /// Clamps a value to 0 to `max`.
    fn within(&mut self, value: f64, max: f64) -> f32 {
        if !(0.0..=max).contains(&value) {
            self.note(Trouble::OUT_OF_RANGE, &format!("{value}"));
        }
        if value.is_nan() { 0.0 } else { value.clamp(0.0, max) as f32 }
    }

    fn specular(&mut self, specular: Option<&schema::Specular>) -> Vec3 {
        let Some(specular) = specular else { return Vec3::ONE };
        let color = DVec3::from_array(specular.specular_color_factor) * specular.specular_factor;
        Vec3::from_array(color.to_array().map(|c| if c.is_nan() { 1.0 } else { c.clamp(0.0, 25.0) as f32 }))
    }

    /// Clamps an index of refraction to 1 to 10. In the extension, 0 stands for an infinite one,
    /// which is not supported.
    fn eta(&mut self, ior: f64) -> f32 {
        if !(1.0..=10.0).contains(&ior) {
            self.note(Trouble::INDEX_OF_REFRACTION, &format!("{ior}"));
        }
        if ior.is_nan() { GLASS_ETA } else { ior.clamp(1.0, 10.0) as f32 }
    }

    fn alpha(&mut self, json: &schema::Material) -> Alpha {
        match json.alpha_mode.as_deref() {
            None | Some("OPAQUE") => Alpha::Opaque,
            Some("MASK") => Alpha::Mask { cutoff: self.within(json.alpha_cutoff.unwrap_or(0.5), 1.0) },
            Some("BLEND") => Alpha::Blend,
            Some(other) => {
                self.note(Trouble::ALPHA_MODE, other);
                Alpha::Opaque
            }
        }
    }

    fn used(&mut self, info: Option<&TextureInfo>) -> Option<Use> {
        let info = info?;
        match self.image(info) {
            Ok(found) => Some(found),
            Err(fault) => {
                self.document.note(fault, self.tally);
                None
            }
        }
    }

    fn image(&mut self, info: &TextureInfo) -> Found<Use> {
        let texture: schema::Texture = self.document.item(List::Textures, info.index)?;
        let no_picture = || self.document.fault(List::Textures, info.index, Trouble::NO_PICTURE, "");
        let image = texture.source.ok_or_else(no_picture)?;
        let transform = info.extensions.transform.as_ref();
        if transform.is_some_and(|t| t.rotation != 0.0) {
            self.note(Trouble::TURNED_TEXTURE, "");
        }
        let part = |v: Option<[f64; 2]>, or: f64| {
            let v = Vec2::from_array(v.unwrap_or([or; 2]).map(|x| x as f32));
            if v.is_finite() { v } else { Vec2::splat(or as f32) }
        };
        let scale = part(transform.and_then(|t| t.scale), 1.0);
        let offset = part(transform.and_then(|t| t.offset), 0.0);
        // In the extension v grows downwards, as in glTF; here it grows upwards.
        Ok(Use { image, scale, offset: Vec2::new(offset.x, 1.0 - scale.y - offset.y) })
    }
}
