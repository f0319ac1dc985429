//! The parts of the JSON about data: accessors, buffer views, buffers, and compressed data.
//!
//! Source: the glTF 2.0 specification, section 5, and the extensions named in the fields.

use super::schema::Attributes;
use serde::Deserialize;
use std::borrow::Cow;

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Accessor {
    pub(super) buffer_view: Option<usize>,
    #[serde(default)]
    pub(super) byte_offset: u64,
    pub(super) count: u64,
    pub(super) component_type: u32,
    #[serde(rename = "type")]
    pub(super) shape: String,
    #[serde(default)]
    pub(super) normalized: bool,
    pub(super) sparse: Option<Sparse>,
}

#[derive(Deserialize)]
pub(super) struct Sparse {
    pub(super) count: u64,
    pub(super) indices: SparsePart,
    pub(super) values: SparsePart,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct SparsePart {
    pub(super) buffer_view: usize,
    #[serde(default)]
    pub(super) byte_offset: u64,
    pub(super) component_type: Option<u32>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct BufferView {
    pub(super) buffer: usize,
    #[serde(default)]
    pub(super) byte_offset: u64,
    pub(super) byte_length: u64,
    pub(super) byte_stride: Option<u64>,
    #[serde(default)]
    pub(super) extensions: ViewExtensions,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub(super) struct ViewExtensions {
    #[serde(rename = "EXT_meshopt_compression")]
    pub(super) ext: Option<MeshoptView>,
    #[serde(rename = "KHR_meshopt_compression")]
    pub(super) khr: Option<MeshoptView>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct MeshoptView {
    pub(super) buffer: usize,
    #[serde(default)]
    pub(super) byte_offset: u64,
    pub(super) byte_length: u64,
    pub(super) byte_stride: u64,
    pub(super) count: u64,
    pub(super) mode: String,
    pub(super) filter: Option<String>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct Draco {
    pub(super) buffer_view: usize,
    /// Numbers of the attributes in the compressed mesh.
    pub(super) attributes: Attributes,
}

#[derive(Deserialize)]
pub(super) struct Buffer<'t> {
    #[serde(borrow)]
    pub(super) uri: Option<Cow<'t, str>>,
    #[serde(default)]
    pub(super) extensions: BufferExtensions,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub(super) struct BufferExtensions {
    #[serde(rename = "EXT_meshopt_compression")]
    pub(super) ext: Option<Fallback>,
    #[serde(rename = "KHR_meshopt_compression")]
    pub(super) khr: Option<Fallback>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
pub(super) struct Fallback {
    pub(super) fallback: bool,
}
