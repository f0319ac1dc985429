//! The materials of this engine, made from the metalness and roughness of those in use.
//!
//! - Transmission is glass, clear or frosted by its roughness: `ior` refracts bodies of a
//!   `thicknessFactor`, and panes without one only reflect; base colour and attenuation tint; the rest
//!   is diffuse.
//! - Metal is a mirror of the base colour, or rough. What is not metal has a clear coat, which is left
//!   out where it is rougher than satin: it then looks matte from everywhere (`surfaces`).
//! - Pictures of metal, roughness and transmission hold for each place, where they vary; metal then
//!   has the colour of its place.
//! - `normalTexture` tilts normals, in the frame of the texture coordinates; `TANGENT` is not read.
//! - `emissiveFactor` times `emissiveStrength` is radiance, multiplied with its texture.
//! - `MASK` removes what is below the cutoff. `BLEND` lets light pass by the alpha of the material and
//!   its texture.

use super::document::{Document, List};
use super::material::{Alpha, GltfMaterial, MaterialReader, Use, metallic_roughness, uv_set};
use super::{pictures::Pictures, schema};
use crate::import::picture::{self, Picture, is_translucent};
use crate::import::surfaces::{COAT, Gloss, METAL, fade, glass_of, reflectance_of, undefined};
use crate::import::{tally::Tally, trouble::Trouble};
use crate::scene::{Material, MaterialId, NormalMap, SceneBuilder, TextureId, TextureRef};
use glam::Vec3;
use std::collections::HashMap;

/// The materials in use.
#[derive(Default)]
pub(super) struct EngineMaterials {
    /// Material and set of texture coordinates, where it has pictures, by index in the file; `None`
    /// for primitives without a material.
    known: HashMap<Option<usize>, (MaterialId, Option<u32>)>,
    /// Materials with their index in the file.
    materials: Vec<(usize, MaterialId, GltfMaterial)>,
}

impl EngineMaterials {
    /// Returns the material of a primitive, and the set of texture coordinates that it uses where
    /// it has pictures.
    pub(super) fn material(
        &mut self,
        index: Option<usize>,
        document: &Document,
        builder: &mut SceneBuilder,
        tally: &mut Tally,
    ) -> (MaterialId, Option<u32>) {
        if let Some(known) = self.known.get(&index) {
            return *known;
        }
        let json = index.map(|i| document.item::<schema::Material>(List::Materials, i));
        let json = json.transpose().unwrap_or_else(|fault| {
            document.note(fault, tally);
            None
        });
        let Some(json) = json else {
            let id = builder.add_material(undefined("default"));
            self.known.insert(index, (id, None));
            return (id, None);
        };
        let index = index.unwrap_or(0);
        let name = json.name.clone().unwrap_or_else(|| format!("material {index}"));
        let read = MaterialReader { document, tally, index }.read(&json);
        let base = metallic_roughness(&json).base_color_texture.clone();
        let metal = metallic_roughness(&json).metallic_roughness_texture.clone();
        let through = json.extensions.transmission.as_ref().and_then(|t| t.transmission_texture.as_ref());
        let glow = json.emissive_texture.as_ref().filter(|_| json.emissive_factor != [0.0; 3]);
        let pictures = [base.as_ref(), glow, metal.as_ref(), json.normal_texture.as_ref(), through];
        let mut sets = pictures.into_iter().flatten().map(|info| uv_set(Some(info)));
        // A vertex has one texture coordinate here: that of the first picture.
        let uv_set = sets.next();
        if let (Some(first), Some(other)) = (uv_set, sets.find(|set| Some(*set) != uv_set)) {
            let detail = format!("{name}, TEXCOORD_{other} instead of TEXCOORD_{first}");
            document.note(document.fault(List::Materials, index, Trouble::UV_SET, &detail), tally);
        }
        let id = builder.add_material(Material::diffuse(&name, read.base));
        self.materials.push((index, id, read));
        self.known.insert(Some(index), (id, uv_set));
        (id, uv_set)
    }

    /// Returns the indices of the images that the materials need.
    pub(super) fn images(&self) -> Vec<usize> {
        let uses = self.materials.iter().flat_map(|(_, _, m)| {
            let relief = m.normal_use.map(|(used, _)| used);
            [m.base_use, m.metal_use, m.glow_use, relief, m.transmission_use]
        });
        let mut images: Vec<usize> = uses.flatten().map(|u| u.image).collect();
        images.sort_unstable();
        images.dedup();
        images
    }

    /// Completes the materials of the builder with their pictures.
    pub(super) fn finish(
        &self,
        pictures: &Pictures,
        builder: &mut SceneBuilder,
        document: &Document,
        tally: &mut Tally,
    ) {
        let mut painter = Painter {
            pictures,
            textures: HashMap::new(),
            masks: HashMap::new(),
            blended: HashMap::new(),
            checker: None,
        };
        for (index, id, read) in &self.materials {
            let name = std::mem::take(&mut builder.materials[id.0 as usize].name);
            let (material, trouble) = painter.material(&name, read, builder);
            builder.materials[id.0 as usize] = material;
            if let Some(trouble) = trouble {
                document.note(document.fault(List::Materials, *index, trouble, &name), tally);
            }
        }
    }
}

/// Makes the materials of the scene from materials of the file and pictures.
struct Painter<'a> {
    pictures: &'a Pictures,
    textures: HashMap<usize, TextureId>,
    /// Textures by image and by the bits of the threshold.
    masks: HashMap<(usize, u32), TextureId>,
    /// Textures by image and by the bits of the opacity.
    blended: HashMap<(usize, u32), TextureId>,
    checker: Option<TextureId>,
}

impl Painter<'_> {
    fn material(
        &mut self,
        name: &str,
        read: &GltfMaterial,
        builder: &mut SceneBuilder,
    ) -> (Material, Option<Trouble>) {
        let mut material = Material::diffuse(name, read.base);
        let mean = |used: Option<Use>| {
            let picture = used.and_then(|u| self.pictures.get(u.image));
            picture.map_or(Vec3::ONE, |p| picture::mean_color(&p.texture))
        };
        material.emission = read.emission;
        material.emits_from_front = read.is_one_sided && material.is_emissive();
        if let Some(used) = read.glow_use {
            material.emission_texture = self.shown(used, builder);
        }
        if let Some((used, strength)) = read.normal_use {
            let map = self.shown(used, builder);
            material.detail.normal = map.map(|texture| NormalMap { texture, strength });
        }
        let base = read.base_use.and_then(|u| self.pictures.get(u.image));
        let mean_base = read.base * mean(read.base_use);
        let kept = if read.transmission > 0.0 {
            material.is_thin = read.is_thin;
            let shares = read.transmission_use.and_then(|used| self.shown(used, builder));
            let transmittance = match shares {
                // Base colour and share are those of each place.
                Some(_) => read.attenuation,
                None => mean_base * read.transmission * read.attenuation,
            };
            let varied = self.varied_metal(read);
            let roughness = if varied.is_some() { read.roughness } else { self.metal_and_roughness(read)[1] };
            material.kind = glass_of(read.eta, transmittance, roughness);
            material.detail.roughness_texture = varied.and_then(|used| self.shown(used, builder));
            (material.detail.transmission, material.detail.transmission_texture) =
                (read.transmission, shares);
            if shares.is_some() { 1.0 } else { 1.0 - read.transmission }
        } else {
            // What is seen through has no coat here.
            let is_cloth = || base.is_some_and(|p| is_translucent(p.texture.texels.iter().map(|t| t[3])));
            if read.alpha != Alpha::Blend || opacity(read, base) >= 1.0 && !is_cloth() {
                self.reflect(read, mean_base, &mut material, builder);
            }
            1.0
        };
        material.diffuse *= kept;
        if let Some(used) = read.base_use.filter(|_| material.diffuse != Vec3::ZERO) {
            material.diffuse_texture = Some(self.color(used, builder));
        }
        let trouble = self.cut(read, base, &mut material, builder);
        // The mean of a texture is below its brightest texel: the sum may still reflect more light
        // than arrives.
        material.scale_to_conserve();
        (material, trouble)
    }

    /// Makes a material reflect: evenly, or by its pictures where these vary or metal has a picture
    /// of its colour.
    fn reflect(
        &mut self,
        read: &GltfMaterial,
        mean_base: Vec3,
        material: &mut Material,
        builder: &mut SceneBuilder,
    ) {
        let gloss = self.gloss(read);
        let is_coated = gloss.roughness < self.metal_and_roughness(read)[1];
        let varied = self.varied_metal(read).filter(|_| !is_coated);
        let is_picture_of_metal = gloss.metalness > 0.0 && read.base_use.is_some() && !is_coated;
        let Some(used) = varied else {
            match is_picture_of_metal {
                true => gloss.apply_by_place(material),
                false => gloss.apply(material, mean_base),
            }
            return;
        };
        let factors = Gloss { metalness: read.metallic, roughness: read.roughness, ..gloss };
        let picture = self.pictures.get(used.image);
        let texels = picture.iter().flat_map(|p| p.texture.texels.iter());
        if factors.is_matte_by_place(texels.map(|&[_, g, b, _]| [b, g])) {
            return;
        }
        factors.apply_always(material);
        let map = self.shown(used, builder);
        (material.detail.metalness_texture, material.detail.roughness_texture) = (map, map);
    }

    /// The texture of metal and roughness where it varies.
    fn varied_metal(&self, read: &GltfMaterial) -> Option<Use> {
        let used = read.metal_use?;
        let texels = &self.pictures.get(used.image)?.texture.texels;
        let first = *texels.first()?;
        texels.iter().any(|texel| texel[1..3] != first[1..3]).then_some(used)
    }

    /// How the surface reflects. A clear coat takes the place of the reflection of what is below
    /// it, unless that is metal.
    fn gloss(&self, read: &GltfMaterial) -> Gloss {
        let [metalness, mut roughness] = self.metal_and_roughness(read);
        let mut coat = (read.specular * reflectance_of(read.eta)).min(Vec3::ONE);
        let [share, of_coat] = read.clearcoat;
        if share > 0.0 && metalness <= METAL && of_coat < roughness {
            (coat, roughness) = (Vec3::splat(COAT * share), of_coat);
        }
        Gloss { metalness, roughness, coat }
    }

    /// Metalness and roughness, without a clear coat.
    fn metal_and_roughness(&self, read: &GltfMaterial) -> [f32; 2] {
        // Green is roughness, blue is metalness, both linear.
        let picture = read.metal_use.and_then(|u| self.pictures.get(u.image));
        let mean = picture.map_or(Vec3::ONE, |p| picture::mean_linear(&p.texture));
        [read.metallic * mean.z, read.roughness * mean.y]
    }

    fn color(&mut self, used: Use, builder: &mut SceneBuilder) -> TextureRef {
        if let Some(shown) = self.shown(used, builder) {
            return shown;
        }
        TextureRef::plain(*self.checker.get_or_insert_with(|| builder.add_texture(picture::checker())))
    }

    /// Returns a picture as a texture; `None` where it could not be read.
    fn shown(&mut self, used: Use, builder: &mut SceneBuilder) -> Option<TextureRef> {
        let picture = self.pictures.get(used.image)?;
        let new = || builder.add_texture(picture.texture.clone());
        let texture = *self.textures.entry(used.image).or_insert_with(new);
        Some(used.of(texture))
    }

    /// Applies the alpha of a material: `MASK`, and `BLEND` with a texture of varying alpha, cut
    /// holes; other `BLEND` attenuates evenly.
    fn cut(
        &mut self,
        read: &GltfMaterial,
        base: Option<&Picture>,
        material: &mut Material,
        builder: &mut SceneBuilder,
    ) -> Option<Trouble> {
        let (varies, opacity) = (base.is_some_and(|p| p.alpha_varies), opacity(read, base));
        match (read.alpha, read.base_use) {
            (Alpha::Opaque, _) => None,
            (Alpha::Blend, _) if material.is_glass() => None,
            (Alpha::Mask { cutoff }, Some(used)) if varies => {
                material.alpha_texture = self.mask(used, cutoff / opacity, builder);
                None
            }
            (Alpha::Blend, Some(used)) if varies => self.blend(used, opacity, material, builder),
            (Alpha::Mask { cutoff }, _) if opacity < cutoff => Some(Trouble::MASKED_AWAY),
            (Alpha::Blend, _) if opacity < 1.0 => {
                fade(material, opacity);
                None
            }
            _ => None,
        }
    }

    /// Makes the surface see-through by the alpha of its picture times `opacity`. A mirror is cut
    /// out instead, and reported.
    fn blend(
        &mut self,
        used: Use,
        opacity: f32,
        material: &mut Material,
        builder: &mut SceneBuilder,
    ) -> Option<Trouble> {
        let picture = self.pictures.get(used.image)?;
        let is_cut = opacity >= 1.0 && !is_translucent(picture.texture.texels.iter().map(|t| t[3]));
        if is_cut || material.is_view_dependent() {
            material.alpha_texture = self.mask(used, 0.5 / opacity, builder);
            return (!is_cut).then_some(Trouble::BLENDED);
        }
        let faded = |a: u8| (f32::from(a) * opacity + 0.5) as u8;
        let new = || builder.add_texture(picture::with_alpha(&picture.texture, faded));
        let texture = *self.blended.entry((used.image, opacity.to_bits())).or_insert_with(new);
        material.cover_by(used.of(texture));
        None
    }

    /// Returns a texture whose alpha passes one half where that of the picture passes `threshold`;
    /// `None` where every texel does.
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
        Some(used.of(texture))
    }
}

/// Opacity of a material, but for a texture of varying alpha.
fn opacity(read: &GltfMaterial, base: Option<&Picture>) -> f32 {
    let flat = || base.and_then(|p| p.texture.texels.first()).map_or(1.0, |t| f32::from(t[3]) / 255.0);
    read.opacity * if base.is_some_and(|p| p.alpha_varies) { 1.0 } else { flat() }
}
