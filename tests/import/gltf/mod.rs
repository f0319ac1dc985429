//! glTF with small models that are built here: every way to store one, right and wrong.

mod compression;
mod extensions;
mod geometry;
mod lamps;
mod surfaces;
mod trouble;

pub(crate) use lamps::profile;

use super::Folder;
use afterimage::scene::{Scene, SceneError};
use bytemuck::Pod;
use serde_json::{Value, json};

const U8: u32 = 5121;
const U16: u32 = 5123;
const U32: u32 = 5125;
const F32: u32 = 5126;

/// Corners of a unit square in the plane z = 0, counter-clockwise seen from +Z.
const SQUARE: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];

/// A model being built: its JSON, and one buffer.
struct Model {
    json: Value,
    bin: Vec<u8>,
}

impl Model {
    /// A model without a mesh.
    fn empty() -> Self {
        let json = json!({
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}], "nodes": [], "meshes": [],
            "accessors": [], "bufferViews": [], "materials": [], "textures": [], "images": [], "cameras": [],
        });
        Self { json, bin: Vec::new() }
    }

    /// The unit square as two triangles.
    fn square() -> Self {
        let mut model = Self::empty();
        let position = model.accessor(&SQUARE, F32, "VEC3");
        let indices = model.accessor(&[0u16, 1, 2, 0, 2, 3], U16, "SCALAR");
        model.mesh(json!({"attributes": {"POSITION": position}, "indices": indices}));
        model.node(json!({"mesh": 0}));
        model
    }

    /// The unit square with texture coordinates, and one material.
    fn painted(material: Value) -> Self {
        let mut model = Self::square();
        // v grows downwards: the corner (0, 0) shows the lower left texel of the picture.
        let uvs = model.accessor(&[[0.0f32, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]], F32, "VEC2");
        let primitive = &mut model.json["meshes"][0]["primitives"][0];
        primitive["attributes"]["TEXCOORD_0"] = uvs.into();
        primitive["material"] = 0.into();
        model.push("materials", material);
        model
    }

    fn push(&mut self, list: &str, item: Value) -> usize {
        let list = self.json[list].as_array_mut().unwrap();
        list.push(item);
        list.len() - 1
    }

    fn view(&mut self, bytes: &[u8]) -> usize {
        while !self.bin.len().is_multiple_of(4) {
            self.bin.push(0);
        }
        let offset = self.bin.len();
        self.bin.extend_from_slice(bytes);
        self.push("bufferViews", json!({"buffer": 0, "byteOffset": offset, "byteLength": bytes.len()}))
    }

    fn accessor<T: Pod>(&mut self, elements: &[T], component: u32, shape: &str) -> usize {
        let view = self.view(bytemuck::cast_slice(elements));
        let count = elements.len();
        self.push(
            "accessors",
            json!({"bufferView": view, "count": count, "componentType": component, "type": shape}),
        )
    }

    fn mesh(&mut self, primitive: Value) -> usize {
        self.push("meshes", json!({"primitives": [primitive]}))
    }

    /// Adds a root node of the scene.
    fn node(&mut self, node: Value) -> usize {
        let index = self.push("nodes", node);
        self.json["scenes"][0]["nodes"].as_array_mut().unwrap().push(index.into());
        index
    }

    /// Adds an image, whose bytes are in the buffer, and a texture of it.
    fn texture(&mut self, picture: &[u8]) -> usize {
        let view = self.view(picture);
        let image = self.push("images", json!({"bufferView": view, "mimeType": "image/png"}));
        self.push("textures", json!({"source": image}))
    }

    /// Returns the model as one text, with the buffer in it.
    fn embedded(&self) -> String {
        let uri = format!("data:application/octet-stream;base64,{}", base64(&self.bin));
        self.text(Some(&uri))
    }

    fn text(&self, uri: Option<&str>) -> String {
        let mut json = self.json.clone();
        let mut buffer = json!({"byteLength": self.bin.len()});
        if let Some(uri) = uri {
            buffer["uri"] = uri.into();
        }
        json["buffers"] = json!([buffer]);
        serde_json::to_string_pretty(&json).unwrap()
    }

    fn glb(&self) -> Vec<u8> {
        let mut text = self.text(None).into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut bin = self.bin.clone();
        bin.resize(bin.len().next_multiple_of(4), 0);
        let word = |n: usize| (n as u32).to_le_bytes();
        let header = [b"glTF".as_slice(), &word(2), &word(28 + text.len() + bin.len())].concat();
        [&header, word(text.len()).as_slice(), b"JSON", &text, &word(bin.len()), b"BIN\0", &bin].concat()
    }

    fn try_load(&self) -> Result<Scene, SceneError> {
        load_text(&self.embedded())
    }

    fn load(&self) -> Scene {
        self.try_load().unwrap()
    }
}

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let group = |c: &[u8]| {
        let word = u32::from_be_bytes([0, c[0], *c.get(1).unwrap_or(&0), *c.get(2).unwrap_or(&0)]);
        let digit = |i: usize| {
            if i <= c.len() { DIGITS[((word >> (18 - 6 * i)) & 63) as usize] as char } else { '=' }
        };
        (0..4).map(digit).collect::<String>()
    };
    bytes.chunks(3).map(group).collect()
}

fn load_text(text: &str) -> Result<Scene, SceneError> {
    let folder = Folder::with_obj("").add("scene.gltf", text);
    super::load(&folder.path("scene.gltf"), &folder.options, &|_, _| true)
}
