//! The parts of glTF 2.0's JSON that are read. Lists stay as text until an item is needed: a broken item costs only
//! itself, and an item that nobody uses costs nothing.
//!
//! Source: the glTF 2.0 specification, section 5, and the KHR extensions named in the fields.

use serde::Deserialize;
use serde_json::value::RawValue;
use std::borrow::Cow;

#[derive(Deserialize, Default)]
#[serde(default, rename_all = "camelCase")]
pub(crate) struct Root<'t> {
    pub(crate) asset: Asset,
    pub(crate) scene: Option<usize>,
    #[serde(borrow)]
    pub(crate) scenes: Vec<&'t RawValue>,
    #[serde(borrow)]
    pub(crate) nodes: Vec<&'t RawValue>,
    #[serde(borrow)]
    pub(crate) meshes: Vec<&'t RawValue>,
    #[serde(borrow)]
    pub(crate) materials: Vec<&'t RawValue>,
    #[serde(borrow)]
    pub(crate) textures: Vec<&'t RawValue>,
    #[serde(borrow)]
    pub(crate) images: Vec<&'t RawValue>,
    #[serde(borrow)]
    pub(crate) accessors: Vec<&'t RawValue>,
    #[serde(borrow)]
    pub(crate) buffer_views: Vec<&'t RawValue>,
    #[serde(borrow)]
    pub(crate) buffers: Vec<&'t RawValue>,
    #[serde(borrow)]
    pub(crate) cameras: Vec<&'t RawValue>,
    #[serde(borrow)]
    pub(crate) animations: Vec<&'t RawValue>,
    pub(crate) extensions_used: Vec<String>,
    pub(crate) extensions_required: Vec<String>,
    #[serde(borrow)]
    pub(crate) extensions: RootExtensions<'t>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub(crate) struct RootExtensions<'t> {
    #[serde(borrow, rename = "KHR_lights_punctual")]
    pub(crate) lights: Lights<'t>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub(crate) struct Lights<'t> {
    #[serde(borrow)]
    pub(crate) lights: Vec<&'t RawValue>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub(crate) struct Asset {
    pub(crate) version: Option<String>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub(crate) struct Scene {
    pub(crate) nodes: Vec<usize>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub(crate) struct Node {
    pub(crate) name: Option<String>,
    pub(crate) children: Vec<usize>,
    pub(crate) mesh: Option<usize>,
    pub(crate) camera: Option<usize>,
    pub(crate) skin: Option<usize>,
    pub(crate) matrix: Option<[f64; 16]>,
    pub(crate) translation: Option<[f64; 3]>,
    pub(crate) rotation: Option<[f64; 4]>,
    pub(crate) scale: Option<[f64; 3]>,
    pub(crate) extensions: NodeExtensions,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub(crate) struct NodeExtensions {
    #[serde(rename = "KHR_lights_punctual")]
    pub(crate) light: Option<NodeLight>,
}

#[derive(Deserialize)]
pub(crate) struct NodeLight {
    pub(crate) light: usize,
}

#[derive(Deserialize)]
pub(crate) struct Mesh<'t> {
    pub(crate) name: Option<String>,
    #[serde(borrow)]
    pub(crate) primitives: Vec<&'t RawValue>,
}

#[derive(Deserialize)]
pub(crate) struct Primitive<'t> {
    #[serde(default)]
    pub(crate) attributes: Attributes,
    pub(crate) indices: Option<usize>,
    pub(crate) material: Option<usize>,
    pub(crate) mode: Option<u32>,
    #[serde(borrow, default)]
    pub(crate) targets: Option<&'t RawValue>,
}

#[derive(Deserialize, Default)]
#[serde(default, rename_all = "UPPERCASE")]
pub(crate) struct Attributes {
    pub(crate) position: Option<usize>,
    pub(crate) normal: Option<usize>,
    pub(crate) texcoord_0: Option<usize>,
    pub(crate) texcoord_1: Option<usize>,
    pub(crate) color_0: Option<usize>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Accessor {
    pub(crate) buffer_view: Option<usize>,
    #[serde(default)]
    pub(crate) byte_offset: u64,
    pub(crate) count: u64,
    pub(crate) component_type: u32,
    #[serde(rename = "type")]
    pub(crate) shape: String,
    #[serde(default)]
    pub(crate) normalized: bool,
    pub(crate) sparse: Option<Sparse>,
}

#[derive(Deserialize)]
pub(crate) struct Sparse {
    pub(crate) count: u64,
    pub(crate) indices: SparsePart,
    pub(crate) values: SparsePart,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct SparsePart {
    pub(crate) buffer_view: usize,
    #[serde(default)]
    pub(crate) byte_offset: u64,
    pub(crate) component_type: Option<u32>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct BufferView {
    pub(crate) buffer: usize,
    #[serde(default)]
    pub(crate) byte_offset: u64,
    pub(crate) byte_length: u64,
    pub(crate) byte_stride: Option<u64>,
}

#[derive(Deserialize)]
pub(crate) struct Buffer<'t> {
    #[serde(borrow)]
    pub(crate) uri: Option<Cow<'t, str>>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct Image<'t> {
    #[serde(borrow)]
    pub(crate) uri: Option<Cow<'t, str>>,
    pub(crate) buffer_view: Option<usize>,
}

#[derive(Deserialize)]
pub(crate) struct Texture {
    pub(crate) source: Option<usize>,
}

#[derive(Deserialize, Default)]
#[serde(default, rename_all = "camelCase")]
pub(crate) struct Material {
    pub(crate) name: Option<String>,
    pub(crate) pbr_metallic_roughness: Pbr,
    pub(crate) emissive_factor: [f64; 3],
    pub(crate) emissive_texture: Option<TextureInfo>,
    pub(crate) alpha_mode: Option<String>,
    pub(crate) alpha_cutoff: Option<f64>,
    pub(crate) extensions: MaterialExtensions,
}

#[derive(Deserialize)]
#[serde(default, rename_all = "camelCase")]
pub(crate) struct Pbr {
    pub(crate) base_color_factor: [f64; 4],
    pub(crate) base_color_texture: Option<TextureInfo>,
    pub(crate) metallic_factor: f64,
    pub(crate) roughness_factor: f64,
    pub(crate) metallic_roughness_texture: Option<TextureInfo>,
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
pub(crate) struct MaterialExtensions {
    #[serde(rename = "KHR_materials_transmission")]
    pub(crate) transmission: Option<Transmission>,
    #[serde(rename = "KHR_materials_ior")]
    pub(crate) ior: Option<Ior>,
    #[serde(rename = "KHR_materials_emissive_strength")]
    pub(crate) emissive_strength: Option<EmissiveStrength>,
}

#[derive(Deserialize, Default)]
#[serde(default, rename_all = "camelCase")]
pub(crate) struct Transmission {
    pub(crate) transmission_factor: f64,
}

#[derive(Deserialize)]
pub(crate) struct Ior {
    pub(crate) ior: Option<f64>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct EmissiveStrength {
    pub(crate) emissive_strength: Option<f64>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(crate) struct TextureInfo {
    pub(crate) index: usize,
    #[serde(default)]
    pub(crate) tex_coord: u32,
    #[serde(default)]
    pub(crate) extensions: TextureExtensions,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub(crate) struct TextureExtensions {
    #[serde(rename = "KHR_texture_transform")]
    pub(crate) transform: Option<TextureTransform>,
}

#[derive(Deserialize, Default)]
#[serde(default, rename_all = "camelCase")]
pub(crate) struct TextureTransform {
    pub(crate) offset: Option<[f64; 2]>,
    pub(crate) scale: Option<[f64; 2]>,
    pub(crate) rotation: f64,
    pub(crate) tex_coord: Option<u32>,
}

#[derive(Deserialize)]
pub(crate) struct Camera {
    pub(crate) name: Option<String>,
    pub(crate) perspective: Option<Perspective>,
}

#[derive(Deserialize)]
pub(crate) struct Perspective {
    pub(crate) yfov: f64,
}

#[derive(Deserialize)]
pub(crate) struct Light {
    pub(crate) name: Option<String>,
    #[serde(rename = "type")]
    pub(crate) kind: String,
    pub(crate) color: Option<[f64; 3]>,
    pub(crate) intensity: Option<f64>,
}
