//! Reading a material: its values, checked and clamped to their ranges.

use super::document::{Document, Found, List};
use super::schema::{self, TextureInfo};
use crate::import::surfaces::{GLASS_ETA, METAL};
use crate::import::{options::Limits, tally::Tally, trouble::Trouble};
use crate::scene::{Sampling, TextureId, TextureRef, Wrap};
use glam::{DVec3, Vec2, Vec3};
use std::borrow::Cow;

/// Use of a texture: the index of its image, and the transform of texture coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Use {
    pub(super) image: usize,
    pub(super) scale: Vec2,
    pub(super) offset: Vec2,
    pub(super) sampling: Sampling,
}

impl Use {
    /// Returns the use of a texture that was made of the image.
    pub(super) fn of(self, texture: TextureId) -> TextureRef {
        TextureRef { sampling: self.sampling, ..TextureRef::new(texture, self.scale, self.offset) }
    }
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
    /// A pane without thickness: what is transmitted goes straight on.
    pub(super) is_thin: bool,
    /// Share of light that passes one of two faces of the body that the material fills.
    pub(super) attenuation: Vec3,
    pub(super) emission: Vec3,
    /// True where only the front emits.
    pub(super) is_one_sided: bool,
    /// Texture of base colour and alpha.
    pub(super) base_use: Option<Use>,
    /// Texture of roughness (green) and metalness (blue).
    pub(super) metal_use: Option<Use>,
    /// Texture of emission.
    pub(super) glow_use: Option<Use>,
    /// Texture of directions, and the factor of their tilt.
    pub(super) normal_use: Option<(Use, f32)>,
    /// Texture of transmission (red).
    pub(super) transmission_use: Option<Use>,
}

/// Returns which set of texture coordinates a texture uses.
pub(super) fn uv_set(info: Option<&TextureInfo>) -> u32 {
    let transform = |i: &TextureInfo| i.extensions.transform.as_ref().and_then(|t| t.tex_coord);
    info.map_or(0, |i| transform(i).unwrap_or(i.tex_coord))
}

/// Returns the values of metalness and roughness, also of a material of specular and glossiness.
///
/// A dark surface with a bright reflection is a metal of that colour, and others are not: the
/// extension has no metalness, and reflections of other materials do not differ much.
pub(super) fn metallic_roughness(json: &schema::Material) -> Cow<'_, schema::Pbr> {
    let Some(other) = &json.extensions.spec_gloss else { return Cow::Borrowed(&json.pbr_metallic_roughness) };
    let [r, g, b, alpha] = other.diffuse_factor;
    let [diffuse, specular] = [[r, g, b], other.specular_factor].map(|c| c.into_iter().fold(0.0, f64::max));
    /// Reflectance at normal incidence that no dielectric of a building reaches.
    const METALLIC: f64 = 0.25;
    let is_metal = specular > METALLIC && specular > diffuse && other.diffuse_texture.is_none();
    let [r, g, b] = if is_metal { other.specular_factor } else { [r, g, b] };
    Cow::Owned(schema::Pbr {
        base_color_factor: [r, g, b, alpha],
        base_color_texture: other.diffuse_texture.clone(),
        metallic_factor: if is_metal { 1.0 } else { 0.0 },
        roughness_factor: 1.0 - other.glossiness_factor,
        metallic_roughness_texture: None,
    })
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
        let pbr = &metallic_roughness(json);
        let [r, g, b, a] = pbr.base_color_factor.map(|c| self.within(c, 1.0));
        let strength = json.extensions.emissive_strength.as_ref().and_then(|e| e.emissive_strength);
        let glow = DVec3::from_array(json.emissive_factor) * strength.unwrap_or(1.0);
        let metallic = self.within(pbr.metallic_factor, 1.0);
        let metal = pbr.metallic_roughness_texture.as_ref();
        let specular = self.specular(json.extensions.specular.as_ref());
        let coat = json.extensions.clearcoat.as_ref();
        let coat = coat.map_or([0.0; 2], |c| [c.clearcoat_factor, c.clearcoat_roughness_factor]);
        if coat[0] > 0.0 && pbr.metallic_factor > f64::from(METAL) {
            self.note(Trouble::METAL_COAT, json.name.as_deref().unwrap_or(""));
        }
        let through = json.extensions.transmission.as_ref();
        let transmission = through.map_or(0.0, |t| t.transmission_factor);
        let through = through.and_then(|t| t.transmission_texture.as_ref()).filter(|_| transmission > 0.0);
        let relief = json.normal_texture.as_ref();
        let strength = relief.and_then(|map| map.scale).unwrap_or(1.0) as f32;
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
            is_thin: json.extensions.volume.as_ref().is_none_or(|v| v.thickness_factor <= 0.0),
            attenuation: self.attenuation(json.extensions.volume.as_ref()),
            emission: Vec3::from_array(glow.to_array().map(|c| self.within(c, f64::from(Limits::RADIANCE)))),
            is_one_sided: !json.double_sided,
            base_use: self.used(pbr.base_color_texture.as_ref()),
            metal_use: self.used(metal),
            glow_use: self.used(json.emissive_texture.as_ref().filter(|_| glow != DVec3::ZERO)),
            normal_use: self.used(relief).map(|used| (used, strength)),
            transmission_use: self.used(through),
        }
    }

    /// Returns the share of light that remains at each face of a body of the stated thickness:
    /// `attenuationColor` remains after `attenuationDistance`.
    fn attenuation(&mut self, volume: Option<&schema::Volume>) -> Vec3 {
        let Some(volume) = volume else { return Vec3::ONE };
        let (Some(distance), Some(color)) = (volume.attenuation_distance, volume.attenuation_color) else {
            return Vec3::ONE;
        };
        let color = color.map(|c| self.within(c, 1.0));
        let faces = (volume.thickness_factor / distance / 2.0) as f32;
        if faces > 0.0 && faces.is_finite() {
            Vec3::from_array(color.map(|c| c.powf(faces)))
        } else {
            Vec3::ONE
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
        let others = [&texture.extensions.webp, &texture.extensions.dds];
        let other = others.into_iter().flatten().find_map(|other| other.source);
        let no_picture = || self.document.fault(List::Textures, info.index, Trouble::NO_PICTURE, "");
        let image = other.or(texture.source).ok_or_else(no_picture)?;
        let transform = info.extensions.transform.as_ref();
        let part = |v: Option<[f64; 2]>, or: f64| {
            let v = Vec2::from_array(v.unwrap_or([or; 2]).map(|x| x as f32));
            if v.is_finite() { v } else { Vec2::splat(or as f32) }
        };
        let scale = part(transform.and_then(|t| t.scale), 1.0);
        let offset = part(transform.and_then(|t| t.offset), 0.0);
        let turn = transform.map_or(0.0, |t| t.rotation as f32);
        let turn = if turn.is_finite() { turn } else { 0.0 };
        let (sin, cos) = turn.sin_cos();
        let sampling = Sampling { turn, ..self.sampling(texture.sampler)? };
        // In the extension v grows downwards, as in glTF; here it grows upwards.
        let offset = Vec2::new(offset.x + sin * scale.y, 1.0 - cos * scale.y - offset.y);
        Ok(Use { image, scale, offset, sampling })
    }

    /// Returns edges and filter of a sampler. Distances decide no filter here: of the two, that of
    /// near texels counts.
    fn sampling(&self, index: Option<usize>) -> Found<Sampling> {
        const NEAREST: u32 = 9728;
        let Some(index) = index else { return Ok(Sampling::default()) };
        let sampler: schema::Sampler = self.document.item(List::Samplers, index)?;
        let wrap = |code: Option<u32>| match code {
            Some(33_071) => Wrap::Clamp,
            Some(33_648) => Wrap::Mirror,
            _ => Wrap::Repeat,
        };
        let wrap = [wrap(sampler.wrap_s), wrap(sampler.wrap_t)];
        Ok(Sampling { wrap, is_nearest: sampler.mag_filter == Some(NEAREST), turn: 0.0 })
    }
}
