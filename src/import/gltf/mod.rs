//! glTF 2.0, `.gltf` and `.glb`: document -> buffers -> nodes -> meshes -> materials -> pictures.
//! The format defines metres and +Y up.
//!
//! Why not the crate `gltf`: it rejects a whole file for one bad item, reads buffers and pictures
//! without a limit, and knows no lines. It is the independent second opinion in the tests.

mod accessor;
mod attribute;
mod buffers;
mod compressed_views;
mod document;
mod draco;
mod engine_materials;
mod light_schema;
mod material;
mod mesh;
mod meshopt;
mod nodes;
mod pictures;
mod profiles;
mod read;
mod schema;
mod schema_data;
mod uri;

pub(super) use read::read;
