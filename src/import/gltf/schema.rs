//! The parts of the JSON of glTF 2.0 that are read. Items of lists stay text until they are needed:
//! only a broken item is lost, and an unused item costs nothing.
//!
//! Source: the glTF 2.0 specification, section 5, and the KHR extensions named in the fields.

pub(super) use super::light_schema::{Light, Lights, NodeLight, NodeProfile, Profile};
use serde::Deserialize;
use serde_json::value::RawValue;
use std::borrow::Cow;

#[derive(Default)]
pub(super) struct Root<'t> {
    pub(super) asset: Asset,
    pub(super) scene: Option<usize>,
    pub(super) scenes: Vec<&'t RawValue>,
    pub(super) nodes: Vec<&'t RawValue>,
    pub(super) meshes: Vec<&'t RawValue>,
    pub(super) materials: Vec<&'t RawValue>,
    pub(super) textures: Vec<&'t RawValue>,
    pub(super) samplers: Vec<&'t RawValue>,
    pub(super) images: Vec<&'t RawValue>,
    pub(super) accessors: Vec<&'t RawValue>,
    pub(super) buffer_views: Vec<&'t RawValue>,
    pub(super) buffers: Vec<&'t RawValue>,
    pub(super) cameras: Vec<&'t RawValue>,
    pub(super) animations: Vec<&'t RawValue>,
    pub(super) extensions_used: Vec<String>,
    pub(super) extensions_required: Vec<String>,
    pub(super) extensions: RootExtensions<'t>,
}

/// The extensions at the root. Each is read by itself, as the keys of the root are.
#[derive(Default)]
pub(super) struct RootExtensions<'t> {
    /// `KHR_lights_punctual`.
    pub(super) lights: Lights<'t>,
    /// `EXT_lights_ies`.
    pub(super) profiles: Lights<'t>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub(super) struct Asset {
    pub(super) version: Option<String>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub(super) struct Scene {
    pub(super) nodes: Vec<usize>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub(super) struct Node {
    pub(super) name: Option<String>,
    pub(super) children: Vec<usize>,
    pub(super) mesh: Option<usize>,
    pub(super) camera: Option<usize>,
    pub(super) skin: Option<usize>,
    pub(super) matrix: Option<[f64; 16]>,
    pub(super) translation: Option<[f64; 3]>,
    pub(super) rotation: Option<[f64; 4]>,
    pub(super) scale: Option<[f64; 3]>,
    pub(super) extensions: NodeExtensions,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub(super) struct NodeExtensions {
    #[serde(rename = "KHR_lights_punctual")]
    pub(super) light: Option<NodeLight>,
    #[serde(rename = "EXT_lights_ies")]
    pub(super) profile: Option<NodeProfile>,
    #[serde(rename = "EXT_mesh_gpu_instancing")]
    pub(super) instancing: Option<Instancing>,
    #[serde(rename = "KHR_node_visibility")]
    pub(super) visibility: Option<Visibility>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub(super) struct Instancing {
    pub(super) attributes: InstanceAttributes,
}

#[derive(Deserialize, Default)]
#[serde(default, rename_all = "UPPERCASE")]
pub(super) struct InstanceAttributes {
    pub(super) translation: Option<usize>,
    pub(super) rotation: Option<usize>,
    pub(super) scale: Option<usize>,
}

#[derive(Deserialize)]
pub(super) struct Visibility {
    pub(super) visible: Option<bool>,
}

#[derive(Deserialize)]
pub(super) struct Mesh<'t> {
    pub(super) name: Option<String>,
    #[serde(borrow)]
    pub(super) primitives: Vec<&'t RawValue>,
}

#[derive(Deserialize)]
pub(super) struct Primitive<'t> {
    #[serde(default)]
    pub(super) attributes: Attributes,
    pub(super) indices: Option<usize>,
    pub(super) material: Option<usize>,
    pub(super) mode: Option<u32>,
    #[serde(borrow, default)]
    pub(super) targets: Option<&'t RawValue>,
    #[serde(borrow, default)]
    pub(super) extensions: PrimitiveExtensions<'t>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub(super) struct PrimitiveExtensions<'t> {
    #[serde(borrow, rename = "KHR_draco_mesh_compression")]
    pub(super) draco: Option<&'t RawValue>,
}

#[derive(Deserialize, Default)]
#[serde(default, rename_all = "UPPERCASE")]
pub(super) struct Attributes {
    pub(super) position: Option<usize>,
    pub(super) normal: Option<usize>,
    pub(super) texcoord_0: Option<usize>,
    pub(super) texcoord_1: Option<usize>,
    pub(super) texcoord_2: Option<usize>,
    pub(super) texcoord_3: Option<usize>,
    pub(super) color_0: Option<usize>,
}

impl Attributes {
    /// Returns a set of texture coordinates.
    pub(super) fn uvs(&self, set: u32) -> Option<usize> {
        match set {
            0 => self.texcoord_0,
            1 => self.texcoord_1,
            2 => self.texcoord_2,
            3 => self.texcoord_3,
            _ => None,
        }
    }
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Image<'t> {
    #[serde(borrow)]
    pub(super) uri: Option<Cow<'t, str>>,
    pub(super) buffer_view: Option<usize>,
}

#[derive(Deserialize)]
pub(super) struct Texture {
    pub(super) source: Option<usize>,
    pub(super) sampler: Option<usize>,
    #[serde(default)]
    pub(super) extensions: TextureSources,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub(super) struct TextureSources {
    #[serde(rename = "EXT_texture_webp")]
    pub(super) webp: Option<TextureSource>,
    #[serde(rename = "MSFT_texture_dds")]
    pub(super) dds: Option<TextureSource>,
}

#[derive(Deserialize)]
pub(super) struct TextureSource {
    pub(super) source: Option<usize>,
}

#[derive(Deserialize, Default)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Sampler {
    pub(super) mag_filter: Option<u32>,
    pub(super) wrap_s: Option<u32>,
    pub(super) wrap_t: Option<u32>,
}

#[derive(Deserialize, Default)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Material {
    pub(super) name: Option<String>,
    pub(super) pbr_metallic_roughness: Pbr,
    pub(super) emissive_factor: [f64; 3],
    pub(super) emissive_texture: Option<TextureInfo>,
    pub(super) double_sided: bool,
    pub(super) normal_texture: Option<TextureInfo>,
    pub(super) alpha_mode: Option<String>,
    pub(super) alpha_cutoff: Option<f64>,
    pub(super) extensions: MaterialExtensions,
}

#[derive(Deserialize, Clone)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Pbr {
    pub(super) base_color_factor: [f64; 4],
    pub(super) base_color_texture: Option<TextureInfo>,
    pub(super) metallic_factor: f64,
    pub(super) roughness_factor: f64,
    pub(super) metallic_roughness_texture: Option<TextureInfo>,
}

impl Default for Pbr {
    fn default() -> Self {
        Self {
            base_color_factor: [1.0; 4],
            base_color_texture: None,
            metallic_factor: 1.0,
            roughness_factor: 1.0,
            metallic_roughness_texture: None,
        }
    }
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub(super) struct MaterialExtensions {
    #[serde(rename = "KHR_materials_transmission")]
    pub(super) transmission: Option<Transmission>,
    #[serde(rename = "KHR_materials_ior")]
    pub(super) ior: Option<Ior>,
    #[serde(rename = "KHR_materials_emissive_strength")]
    pub(super) emissive_strength: Option<EmissiveStrength>,
    #[serde(rename = "KHR_materials_specular")]
    pub(super) specular: Option<Specular>,
    #[serde(rename = "KHR_materials_clearcoat")]
    pub(super) clearcoat: Option<Clearcoat>,
    #[serde(rename = "KHR_materials_pbrSpecularGlossiness")]
    pub(super) spec_gloss: Option<SpecGloss>,
    #[serde(rename = "KHR_materials_volume")]
    pub(super) volume: Option<Volume>,
}

#[derive(Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Specular {
    pub(super) specular_factor: f64,
    pub(super) specular_color_factor: [f64; 3],
}

impl Default for Specular {
    fn default() -> Self {
        Self { specular_factor: 1.0, specular_color_factor: [1.0; 3] }
    }
}

#[derive(Deserialize, Default)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Clearcoat {
    pub(super) clearcoat_factor: f64,
    pub(super) clearcoat_roughness_factor: f64,
}

#[derive(Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct SpecGloss {
    pub(super) diffuse_factor: [f64; 4],
    pub(super) diffuse_texture: Option<TextureInfo>,
    pub(super) specular_factor: [f64; 3],
    pub(super) glossiness_factor: f64,
}

impl Default for SpecGloss {
    fn default() -> Self {
        let (diffuse_factor, specular_factor) = ([1.0; 4], [1.0; 3]);
        Self { diffuse_factor, diffuse_texture: None, specular_factor, glossiness_factor: 1.0 }
    }
}

#[derive(Deserialize, Default)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Volume {
    pub(super) thickness_factor: f64,
    pub(super) attenuation_distance: Option<f64>,
    pub(super) attenuation_color: Option<[f64; 3]>,
}

#[derive(Deserialize, Default)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct Transmission {
    pub(super) transmission_factor: f64,
    pub(super) transmission_texture: Option<TextureInfo>,
}

#[derive(Deserialize)]
pub(super) struct Ior {
    pub(super) ior: Option<f64>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct EmissiveStrength {
    pub(super) emissive_strength: Option<f64>,
}

#[derive(Deserialize, Clone)]
#[serde(rename_all = "camelCase")]
pub(super) struct TextureInfo {
    pub(super) index: usize,
    #[serde(default)]
    pub(super) tex_coord: u32,
    /// Factor of the tilt, of a normal map only.
    pub(super) scale: Option<f64>,
    #[serde(default)]
    pub(super) extensions: TextureExtensions,
}

#[derive(Deserialize, Default, Clone)]
#[serde(default)]
pub(super) struct TextureExtensions {
    #[serde(rename = "KHR_texture_transform")]
    pub(super) transform: Option<TextureTransform>,
}

#[derive(Deserialize, Default, Clone)]
#[serde(default, rename_all = "camelCase")]
pub(super) struct TextureTransform {
    pub(super) offset: Option<[f64; 2]>,
    pub(super) scale: Option<[f64; 2]>,
    pub(super) rotation: f64,
    pub(super) tex_coord: Option<u32>,
}

#[derive(Deserialize)]
pub(super) struct Camera {
    pub(super) name: Option<String>,
    pub(super) perspective: Option<Perspective>,
}

#[derive(Deserialize)]
pub(super) struct Perspective {
    pub(super) yfov: f64,
}
