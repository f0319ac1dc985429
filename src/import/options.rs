//! How a model is read, and the sizes beyond which it is not.

use super::units::{Unit, Up};

/// How to read a model. The default takes everything from the file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImportOptions {
    /// Length unit of the model. `None` takes it from the `.afterimage.toml` next to the model,
    /// else from the file's header, else guesses it by size.
    pub unit: Option<Unit>,
    /// Axis of the model that points up. `None` takes it from the `.afterimage.toml` next to the
    /// model, else +Y.
    pub up: Option<Up>,
    /// Allows the model to open textures and libraries outside its own folder.
    pub allow_outside: bool,
    /// Sizes beyond which a file is refused.
    pub limits: Limits,
}

/// Sizes beyond which a file is refused rather than read.
#[derive(Clone, Debug, PartialEq)]
pub struct Limits {
    /// Maximum size of an OBJ file, in bytes.
    pub obj_bytes: u64,
    /// Maximum size of a glTF file, in bytes.
    pub gltf_bytes: u64,
    /// Maximum size of all buffers of a glTF file together, in bytes.
    pub buffers_bytes: u64,
    /// Maximum number of vertices, and of triangles, that a glTF file makes with every instance of
    /// every mesh: a few bytes can ask for a million instances.
    pub gltf_vertices: usize,
    /// Maximum size of one material library, in bytes.
    pub mtl_bytes: u64,
    /// Maximum number of materials in all libraries together.
    pub materials: usize,
    /// Maximum number of face corners in an OBJ file.
    pub corners: usize,
    /// Maximum width and height of a picture, in texels.
    pub texture_side: u32,
    /// Maximum size of one picture, as a file and decoded, in bytes.
    pub texture_bytes: u64,
    /// Maximum size of all pictures together, decoded, in bytes.
    pub textures_bytes: u64,
    /// Maximum size of the file of a sky picture, in bytes.
    pub sky_bytes: u64,
}

impl Limits {
    /// Maximum length of the name of a material or a file, in bytes.
    pub const NAME_BYTES: usize = 4096;

    /// Maximum radiance or intensity that a file may give. Larger values are mistakes, and overflow
    /// in sums.
    pub const RADIANCE: f32 = 1e9;
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            obj_bytes: 4 << 30,
            gltf_bytes: 4 << 30,
            buffers_bytes: 4 << 30,
            gltf_vertices: 50_000_000,
            mtl_bytes: 16 << 20,
            materials: 1_000_000,
            corners: 1_000_000_000,
            texture_side: 16_384,
            texture_bytes: 256 << 20,
            textures_bytes: 2 << 30,
            sky_bytes: 512 << 20,
        }
    }
}
