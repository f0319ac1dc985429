//! Materials: metal and roughness to what this engine traces.
//!
//! - transmission is glass: `ior` refracts, the base colour dims what passes; what is not transmitted is diffuse
//! - metal above 0.9 with a roughness below 0.1 is a mirror of the base colour
//! - everything else is diffuse in its base colour: there is no glossy reflection here
//! - `emissiveFactor` times `emissiveStrength` is radiance; a texture of it gives its mean colour
//! - `MASK` cuts away below the cutoff; `BLEND` thins evenly, or cuts at one half where a texture's alpha varies

use crate::import::gltf::document::{Document, Found, List};
use crate::import::gltf::nodes::BRIGHTEST;
use crate::import::gltf::pictures::Pictures;
use crate::import::gltf::schema;
use crate::import::gltf::schema::TextureInfo;
use crate::import::materials::NEUTRAL;
use crate::import::picture;
use crate::import::picture::Picture;
use crate::import::report::{Tally, Trouble};
use crate::scene::{Material, MaterialId, MaterialKind, SceneBuilder, TextureId, TextureRef};
use glam::{DVec3, Vec2, Vec3};
use std::collections::HashMap;

/// Refraction where `KHR_materials_ior` is not given.
const IOR: f64 = 1.5;

/// The materials in use.
#[derive(Default)]
pub(crate) struct Palette {
    /// By their number in the file; `None` is for faces without one.
    known: HashMap<Option<usize>, (MaterialId, u32)>,
    /// With their numbers in the file.
    looks: Vec<(usize, MaterialId, Look)>,
}

/// A texture in use: the number of its image, and how coordinates are changed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Use {
    pub(crate) image: usize,
    scale: Vec2,
    offset: Vec2,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Alpha {
    Opaque,
    Mask { cutoff: f32 },
    Blend,
}

/// A material as the file has it, in range.
#[derive(Clone, Debug)]
struct Look {
    base: Vec3,
    opacity: f32,
    alpha: Alpha,
    metallic: f32,
    roughness: f32,
    transmission: f32,
    eta: f32,
    emission: Vec3,
    base_use: Option<Use>,
    metal_use: Option<Use>,
    glow_use: Option<Use>,
}

impl Palette {
    /// The material of a primitive, and which texture coordinates it wants.
    pub(crate) fn material(
        &mut self,
        index: Option<usize>,
        document: &Document,
        builder: &mut SceneBuilder,
        tally: &mut Tally,
    ) -> (MaterialId, u32) {
        if let Some(known) = self.known.get(&index) {
            return *known;
        }
        let json = index.map(|i| document.item::<schema::Material>(List::Materials, i));
        let json = json.transpose().unwrap_or_else(|fault| {
            document.note(fault, tally);
            None
        });
        let Some(json) = json else {
            let id = builder.add_material(Material::diffuse("default", Vec3::splat(NEUTRAL)));
            self.known.insert(index, (id, 0));
            return (id, 0);
        };
        let index = index.unwrap_or(0);
        let name = json.name.clone().unwrap_or_else(|| format!("material {index}"));
        let mut reader = Reader { document, tally, index };
        let look = reader.look(&json);
        let uv_set = uv_set(json.pbr_metallic_roughness.base_color_texture.as_ref());
        let id = builder.add_material(Material::diffuse(&name, look.base));
        self.looks.push((index, id, look));
        self.known.insert(Some(index), (id, uv_set));
        (id, uv_set)
    }

    /// The images that the materials need.
    pub(crate) fn images(&self) -> Vec<usize> {
        let uses = self.looks.iter().flat_map(|(_, _, l)| [l.base_use, l.metal_use, l.glow_use]);
        let mut images: Vec<usize> = uses.flatten().map(|u| u.image).collect();
        images.sort_unstable();
        images.dedup();
        images
    }

    /// Gives the builder its materials as they are with their pictures.
    pub(crate) fn paint(
        &self,
        pictures: &Pictures,
        builder: &mut SceneBuilder,
        document: &Document,
        tally: &mut Tally,
    ) {
        let mut painter =
            Painter { pictures, textures: HashMap::new(), masks: HashMap::new(), checker: None };
        for (index, id, look) in &self.looks {
            let name = std::mem::take(&mut builder.materials[id.0 as usize].name);
            let (material, trouble) = painter.material(&name, look, builder);
            builder.materials[id.0 as usize] = material;
            if let Some(trouble) = trouble {
                document.note(document.fault(List::Materials, *index, trouble, &name), tally);
            }
        }
    }
}

fn uv_set(info: Option<&TextureInfo>) -> u32 {
    let transform = |i: &TextureInfo| i.extensions.transform.as_ref().and_then(|t| t.tex_coord);
    info.map_or(0, |i| transform(i).unwrap_or(i.tex_coord)).min(1)
}

/// Reads one material.
struct Reader<'a, 'd, 't> {
    document: &'d Document<'t>,
    tally: &'a mut Tally,
    index: usize,
}

impl Reader<'_, '_, '_> {
    fn look(&mut self, json: &schema::Material) -> Look {
        let pbr = &json.pbr_metallic_roughness;
        let [r, g, b, a] = pbr.base_color_factor.map(|c| self.within(c, 1.0));
        let strength = json.extensions.emissive_strength.as_ref().and_then(|e| e.emissive_strength);
        let glow = DVec3::from_array(json.emissive_factor) * strength.unwrap_or(1.0);
        let metallic = self.within(pbr.metallic_factor, 1.0);
        // Only what could make a mirror is decoded.
        let metal = pbr.metallic_roughness_texture.as_ref().filter(|_| metallic > METAL);
        let transmission = json.extensions.transmission.as_ref().map_or(0.0, |t| t.transmission_factor);
        let ior = json.extensions.ior.as_ref().and_then(|i| i.ior).unwrap_or(IOR);
        Look {
            base: Vec3::new(r, g, b),
            opacity: a,
            alpha: self.alpha(json),
            metallic,
            roughness: self.within(pbr.roughness_factor, 1.0),
            transmission: self.within(transmission, 1.0),
            eta: self.eta(ior),
            emission: Vec3::from_array(glow.to_array().map(|c| self.within(c, BRIGHTEST))),
            base_use: self.used(pbr.base_color_texture.as_ref()),
            metal_use: self.used(metal),
            glow_use: self.used(json.emissive_texture.as_ref().filter(|_| glow != DVec3::ZERO)),
        }
    }

    fn note(&mut self, trouble: Trouble, detail: &str) {
        self.document.note(self.document.fault(List::Materials, self.index, trouble, detail), self.tally);
    }

    fn within(&mut self, value: f64, most: f64) -> f32 {
        if !(0.0..=most).contains(&value) {
            self.note(Trouble::OUT_OF_RANGE, &format!("{value}"));
        }
        if value.is_nan() { 0.0 } else { value.clamp(0.0, most) as f32 }
    }

    /// 0 stands for "as if infinitely dense" in the extension; nothing here is.
    fn eta(&mut self, ior: f64) -> f32 {
        if !(1.0..=10.0).contains(&ior) {
            self.note(Trouble::INDEX_OF_REFRACTION, &format!("{ior}"));
        }
        if ior.is_nan() { IOR as f32 } else { ior.clamp(1.0, 10.0) as f32 }
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
        // The extension counts v downwards, as glTF does; ours goes up.
        Ok(Use { image, scale, offset: Vec2::new(offset.x, 1.0 - scale.y - offset.y) })
    }
}

/// Above this a surface is metal, and below [`POLISHED`] it mirrors.
const METAL: f32 = 0.9;
const POLISHED: f32 = 0.1;

/// Makes materials of looks and pictures.
struct Painter<'a> {
    pictures: &'a Pictures,
    textures: HashMap<usize, TextureId>,
    /// By image and threshold.
    masks: HashMap<(usize, u32), TextureId>,
    checker: Option<TextureId>,
}

impl Painter<'_> {
    fn material(
        &mut self,
        name: &str,
        look: &Look,
        builder: &mut SceneBuilder,
    ) -> (Material, Option<Trouble>) {
        let mut material = Material::diffuse(name, look.base);
        let mean = |used: Option<Use>| {
            let picture = used.and_then(|u| self.pictures.get(u.image));
            picture.map_or(Vec3::ONE, |p| picture::mean_color(&p.texture))
        };
        material.emission = look.emission * mean(look.glow_use);
        let base = look.base_use.and_then(|u| self.pictures.get(u.image));
        let mean_base = look.base * mean(look.base_use);
        let kept = if look.transmission > 0.0 {
            let transmittance = mean_base * look.transmission;
            material.kind = MaterialKind::Glass { eta: look.eta, transmittance };
            1.0 - look.transmission
        } else if self.is_mirror(look) {
            material.kind = MaterialKind::Mirror { reflectance: mean_base, fresnel: false };
            0.0
        } else {
            1.0
        };
        material.diffuse *= kept;
        if let Some(used) = look.base_use.filter(|_| kept > 0.0) {
            material.diffuse_texture = Some(self.color(used, builder));
        }
        let trouble = self.cut(look, base, &mut material, builder);
        // A texture's mean is below its brightest texel: together they may still reflect more than arrives.
        material.scale_to_conserve();
        (material, trouble)
    }

    fn is_mirror(&self, look: &Look) -> bool {
        // Green is roughness, blue is metal, both linear.
        let picture = look.metal_use.and_then(|u| self.pictures.get(u.image));
        let mean = picture.map_or(Vec3::ONE, |p| picture::mean_linear(&p.texture));
        look.metallic * mean.z > METAL && look.roughness * mean.y < POLISHED
    }

    fn color(&mut self, used: Use, builder: &mut SceneBuilder) -> TextureRef {
        let Some(picture) = self.pictures.get(used.image) else {
            let checker = *self.checker.get_or_insert_with(|| builder.add_texture(picture::checker()));
            return TextureRef::plain(checker);
        };
        let new = || builder.add_texture(picture.texture.clone());
        let texture = *self.textures.entry(used.image).or_insert_with(new);
        TextureRef { texture, scale: used.scale, offset: used.offset }
    }

    /// Alpha: holes, or an even thinning.
    fn cut(
        &mut self,
        look: &Look,
        base: Option<&Picture>,
        material: &mut Material,
        builder: &mut SceneBuilder,
    ) -> Option<Trouble> {
        let varies = base.is_some_and(|p| p.alpha_varies);
        let flat = base.and_then(|p| p.texture.texels.first()).map_or(1.0, |t| f32::from(t[3]) / 255.0);
        let opacity = look.opacity * if varies { 1.0 } else { flat };
        match (look.alpha, look.base_use) {
            (Alpha::Opaque, _) => None,
            (Alpha::Blend, _) if material.is_view_dependent() => None,
            (Alpha::Mask { cutoff }, Some(used)) if varies => {
                material.alpha_texture = self.mask(used, cutoff / opacity, builder);
                None
            }
            (Alpha::Blend, Some(used)) if varies => {
                material.alpha_texture = self.mask(used, 0.5 / opacity, builder);
                Some(Trouble::BLENDED)
            }
            (Alpha::Mask { cutoff }, _) if opacity < cutoff => Some(Trouble::MASKED_AWAY),
            (Alpha::Blend, _) if opacity < 1.0 => {
                material.diffuse *= opacity;
                material.kind = MaterialKind::Glass { eta: 1.0, transmittance: Vec3::splat(1.0 - opacity) };
                None
            }
            _ => None,
        }
    }

    /// A texture whose alpha passes one half where the picture's passes `threshold`; none where every texel does.
    fn mask(&mut self, used: Use, threshold: f32, builder: &mut SceneBuilder) -> Option<TextureRef> {
        let picture = self.pictures.get(used.image)?;
        if threshold <= 0.0 {
            return None;
        }
        let new = || {
            let scaled = |a: u8| (f32::from(a) * 0.5 / threshold + 0.5) as u8; // saturates
            builder.add_texture(picture::with_alpha(&picture.texture, scaled))
        };
        let texture = *self.masks.entry((used.image, threshold.to_bits())).or_insert_with(new);
        Some(TextureRef { texture, scale: used.scale, offset: used.offset })
    }
}
