//! The light of a scene as bytes: materials, sun and sky, without geometry, pictures and names.
//!
//! A record holds the state that its light was traced in. Where the scene was edited since, that
//! state is made again from the scene of now, and what still holds of the light is found as after
//! an edit while the program runs (`reference::stale`). Materials are named by their triangles,
//! pictures by their texels.

use super::bytes::{ByteReader, ByteWriter, list};
use crate::scene::content::{ContentHash, LightContent};
use crate::scene::{
    CieKind, CieSky, Detail, DimmedSky, Gradient, LightSettings, Material, MaterialKind, NormalMap,
    PhysicalSky, PictureSky, Sampling, Scene, SceneEdit, Sky, Sun, TextureId, TextureRef,
};
use glam::{Vec2, Vec3};
use std::collections::HashMap;

/// Largest number of materials of a state, and of its point lights.
const MAX_ENTRIES: usize = 1 << 16;

/// Tag of a sky that is dimmed.
const DIMMED: u8 = 6;

/// Fewest bytes of a material.
const MATERIAL_BYTES: usize = 16 + 2 * 12 + 3;

/// The names by which states tell materials and pictures of a scene.
#[derive(Debug)]
pub(super) struct StateNames {
    /// Hash of the triangles of each material; 0 for one without any.
    pub(super) materials: Vec<u128>,
    pub(super) light: LightContent,
}

/// The state of a scene as bytes.
pub(super) fn write_state(scene: &Scene, names: &StateNames) -> Vec<u8> {
    let mut to = ByteWriter::default();
    let used = scene.materials.iter().zip(&names.materials).filter(|(_, name)| **name != 0);
    let mut used: Vec<(u128, &Material)> = used.map(|(material, &name)| (name, material)).collect();
    used.sort_by_key(|(name, _)| *name);
    to.u32(used.len() as u32);
    for (name, material) in used {
        to.u128(name);
        write_material(&mut to, material, &names.light.textures);
    }
    to.u32(names.light.point_lights.len() as u32);
    names.light.point_lights.iter().for_each(|&light| to.u64(light));
    to.0.push(u8::from(scene.sun.is_some()));
    if let Some(sun) = &scene.sun {
        to.vector(sun.direction);
        to.f32(sun.angular_radius);
        to.vector(sun.irradiance);
    }
    write_sky(&mut to, scene.sky.as_ref());
    to.0
}

/// The edit that leads from a scene to a state of it. `None` where the bytes are none, or name a
/// material, a picture or a point light that the scene does not have.
pub(super) fn read_state(bytes: &[u8], scene: &Scene, names: &StateNames) -> Option<SceneEdit> {
    let mut from = ByteReader(bytes);
    let textures: HashMap<ContentHash, TextureId> =
        names.light.textures.iter().copied().zip((0..).map(TextureId)).collect();
    let stored = list(&mut from, MAX_ENTRIES, MATERIAL_BYTES, |from| {
        Some((from.u128()?, read_material(from, &textures)?))
    })?;
    let stored: HashMap<u128, Material> = stored.into_iter().collect();
    let lights = list(&mut from, MAX_ENTRIES, 8, ByteReader::u64)?;
    (lights == names.light.point_lights).then_some(())?;
    // Materials, sun and sky are written as their groups of lights were set.
    let mut edit = SceneEdit { lights: LightSettings::default(), ..scene.to_edit() };
    for (material, name) in edit.materials.iter_mut().zip(&names.materials).filter(|(_, name)| **name != 0) {
        let known = stored.get(name)?;
        *material = Material { name: std::mem::take(&mut material.name), ..known.clone() };
    }
    if let (Some(ground), Some(name)) = (&mut edit.ground, names.materials.get(edit.materials.len())) {
        // Its material is the one after those of the model.
        ground.albedo = stored.get(name)?.diffuse.x;
    }
    edit.daylight.sun = match from.byte()? {
        0 => None,
        _ => Some(Sun { direction: from.vector()?, angular_radius: from.f32()?, irradiance: from.vector()? }),
    };
    edit.daylight.sky = read_sky(&mut from, edit.daylight.sky.as_ref())?;
    from.0.is_empty().then_some(edit)
}

/// Byte in the place of a material's kind that says that two more textures come before it; one more
/// where the material is thin.
const OTHER_TEXTURES: u8 = 0x80;

/// Tag in front of the detail of a material that has any.
const DETAIL: u8 = 0x40;

fn write_texture(to: &mut ByteWriter, texture: Option<TextureRef>, textures: &[ContentHash]) {
    let hash = texture.and_then(|used| textures.get(used.texture.0 as usize));
    let is_usual = texture.is_none_or(|used| used.sampling == Sampling::default());
    to.0.push(u8::from(hash.is_some()) * if is_usual { 1 } else { 2 });
    if let Some((used, &hash)) = texture.zip(hash) {
        to.u64(hash);
        [used.scale, used.offset].iter().for_each(|pair| to.pair(*pair));
        if used.sampling != Sampling::default() {
            to.0.push(used.sampling.code());
            to.f32(used.sampling.turn);
        }
    }
}

fn write_material(to: &mut ByteWriter, material: &Material, textures: &[ContentHash]) {
    to.vector(material.diffuse);
    to.vector(material.emission);
    for texture in [material.diffuse_texture, material.alpha_texture] {
        write_texture(to, texture, textures);
    }
    let others = [material.coverage_texture, material.emission_texture];
    if material.is_thin || material.emits_from_front || others.iter().any(Option::is_some) {
        let flags = u8::from(material.is_thin) | u8::from(material.emits_from_front) << 1;
        to.0.push(OTHER_TEXTURES | flags);
        others.into_iter().for_each(|texture| write_texture(to, texture, textures));
    }
    if material.detail != Detail::default() {
        to.0.push(DETAIL);
        material.detail.numbers().into_iter().for_each(|number| to.f32(number));
        material.detail.textures().into_iter().for_each(|texture| write_texture(to, texture, textures));
    }
    match material.kind {
        MaterialKind::Diffuse => to.0.push(0),
        MaterialKind::Mirror { reflectance, fresnel } => {
            to.0.push(1 + u8::from(fresnel));
            to.vector(reflectance);
        }
        MaterialKind::Glass { eta, transmittance } => {
            to.0.push(3);
            to.f32(eta);
            to.vector(transmittance);
        }
        MaterialKind::Glossy { reflectance, roughness } => {
            to.0.push(4);
            to.vector(reflectance);
            to.f32(roughness);
        }
        MaterialKind::Frosted { eta, transmittance, roughness } => {
            to.0.push(5);
            to.f32(eta);
            to.vector(transmittance);
            to.f32(roughness);
        }
    }
}

/// A material without its name.
fn read_material(from: &mut ByteReader<'_>, textures: &HashMap<ContentHash, TextureId>) -> Option<Material> {
    let (diffuse, emission) = (from.vector()?, from.vector()?);
    let [diffuse_texture, alpha_texture] = [read_texture(from, textures)?, read_texture(from, textures)?];
    let mut tag = from.byte()?;
    let mut others = [None; 2];
    let [is_thin, emits_from_front] =
        [1, 2].map(|flag| tag & (OTHER_TEXTURES | flag) == OTHER_TEXTURES | flag);
    if tag & OTHER_TEXTURES != 0 {
        others = [read_texture(from, textures)?, read_texture(from, textures)?];
        tag = from.byte()?;
    }
    let mut detail = Detail::default();
    if tag == DETAIL {
        detail = read_detail(from, textures)?;
        tag = from.byte()?;
    }
    let kind = match tag {
        0 => MaterialKind::Diffuse,
        tag @ (1 | 2) => MaterialKind::Mirror { reflectance: from.vector()?, fresnel: tag == 2 },
        3 => MaterialKind::Glass { eta: from.f32()?, transmittance: from.vector()? },
        4 => MaterialKind::Glossy { reflectance: from.vector()?, roughness: from.f32()? },
        5 => {
            let (eta, transmittance, roughness) = (from.f32()?, from.vector()?, from.f32()?);
            MaterialKind::Frosted { eta, transmittance, roughness }
        }
        _ => return None,
    };
    let [coverage_texture, emission_texture] = others;
    let plain =
        Material { emission, emits_from_front, is_thin, detail, kind, ..Material::diffuse("", diffuse) };
    Some(Material { diffuse_texture, alpha_texture, coverage_texture, emission_texture, ..plain })
}

fn read_detail(from: &mut ByteReader<'_>, textures: &HashMap<ContentHash, TextureId>) -> Option<Detail> {
    let [strength, metalness, transmission] = [from.f32()?, from.f32()?, from.f32()?];
    let normal = read_texture(from, textures)?.map(|texture| NormalMap { texture, strength });
    let [metalness_texture, roughness_texture, transmission_texture] =
        [read_texture(from, textures)?, read_texture(from, textures)?, read_texture(from, textures)?];
    Some(Detail {
        normal,
        metalness,
        metalness_texture,
        roughness_texture,
        transmission,
        transmission_texture,
    })
}

fn read_texture(
    from: &mut ByteReader<'_>,
    textures: &HashMap<ContentHash, TextureId>,
) -> Option<Option<TextureRef>> {
    let kind = from.byte()?;
    if kind == 0 {
        return Some(None);
    }
    let texture = *textures.get(&from.u64()?)?;
    let mut used = TextureRef::new(texture, from.pair()?, from.pair()?);
    if kind == 2 {
        used.sampling = Sampling::of_code(from.byte()?, from.f32()?)?;
    }
    Some(Some(used))
}

fn write_sky(to: &mut ByteWriter, sky: Option<&Sky>) {
    match sky {
        None => to.0.push(0),
        Some(Sky::Gradient(sky)) => {
            to.0.push(1);
            [sky.zenith, sky.horizon, sky.ground].iter().for_each(|colour| to.vector(*colour));
        }
        Some(Sky::Cie(sky)) => {
            to.0.push(if sky.kind == CieKind::Overcast { 2 } else { 3 });
            [sky.zenith, sky.ground, sky.sun_direction].iter().for_each(|vector| to.vector(*vector));
        }
        Some(Sky::Physical(sky)) => {
            to.0.push(4);
            [sky.sun_direction(), sky.ground()].iter().for_each(|vector| to.vector(*vector));
            [sky.turbidity(), sky.albedo(), sky.brightness()].iter().for_each(|value| to.f32(*value));
        }
        Some(Sky::Picture(sky)) => {
            to.0.push(5);
            to.0.extend(sky.image.digest());
            [sky.rotation_deg, sky.brightness].iter().for_each(|value| to.f32(*value));
        }
        Some(Sky::Dimmed(dimmed)) => {
            to.0.push(DIMMED);
            to.vector(dimmed.factor);
            write_sky(to, Some(&dimmed.sky));
        }
    }
}

/// Reads a sky, dimmed or not.
fn read_sky(from: &mut ByteReader<'_>, now: Option<&Sky>) -> Option<Option<Sky>> {
    if from.0.first() != Some(&DIMMED) {
        return read_full_sky(from, now);
    }
    from.byte()?;
    let factor = from.vector()?;
    let sky = read_full_sky(from, now)??;
    Some(Some(Sky::Dimmed(Box::new(DimmedSky { sky, factor }))))
}

/// Reads a sky that is not dimmed. Of pictures only that of the scene is known.
fn read_full_sky(from: &mut ByteReader<'_>, now: Option<&Sky>) -> Option<Option<Sky>> {
    let sky = match from.byte()? {
        0 => return Some(None),
        1 => {
            let [zenith, horizon, ground] = [from.vector()?, from.vector()?, from.vector()?];
            Sky::Gradient(Gradient { zenith, horizon, ground })
        }
        tag @ (2 | 3) => {
            let kind = if tag == 2 { CieKind::Overcast } else { CieKind::Clear };
            let [zenith, ground, sun_direction] = [from.vector()?, from.vector()?, from.vector()?];
            Sky::Cie(CieSky { kind, zenith, ground, sun_direction })
        }
        4 => {
            let [sun_direction, ground] = [from.vector()?, from.vector()?];
            let [turbidity, albedo, brightness] = [from.f32()?, from.f32()?, from.f32()?];
            Sky::Physical(PhysicalSky::new(sun_direction, turbidity, albedo, brightness, ground))
        }
        5 => {
            let digest = from.take(32)?;
            let Some(Sky::Picture(PictureSky { image, .. })) = now else { return None };
            (image.digest() == digest).then_some(())?;
            let [rotation_deg, brightness] = [from.f32()?, from.f32()?];
            Sky::Picture(PictureSky { image: image.clone(), rotation_deg, brightness })
        }
        _ => return None,
    };
    Some(Some(sky))
}

impl ByteWriter {
    fn f32(&mut self, value: f32) {
        self.u32(value.to_bits());
    }

    fn vector(&mut self, vector: Vec3) {
        vector.to_array().iter().for_each(|value| self.f32(*value));
    }

    fn pair(&mut self, pair: Vec2) {
        pair.to_array().iter().for_each(|value| self.f32(*value));
    }
}

impl ByteReader<'_> {
    fn byte(&mut self) -> Option<u8> {
        Some(self.take(1)?[0])
    }

    /// A finite number.
    fn f32(&mut self) -> Option<f32> {
        Some(f32::from_bits(self.u32()?)).filter(|value| value.is_finite())
    }

    fn vector(&mut self) -> Option<Vec3> {
        Some(Vec3::new(self.f32()?, self.f32()?, self.f32()?))
    }

    fn pair(&mut self) -> Option<Vec2> {
        Some(Vec2::new(self.f32()?, self.f32()?))
    }
}
