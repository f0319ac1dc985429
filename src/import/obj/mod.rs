//! OBJ models with MTL libraries: text -> faces -> triangles with shared vertices -> materials ->
//! textures.

mod far_uvs;
mod interpret;
mod library;
mod mtl;
mod parse;
mod piece;
mod read;
mod smoothing;
mod textures;
mod weld;

pub(super) use read::read;
