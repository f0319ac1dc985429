//! OBJ models with MTL libraries: text -> repaired text -> `tobj` -> faces -> triangles with shared
//! vertices -> materials -> textures.

mod faces;
mod far_uvs;
mod interpret;
mod library;
mod mtl;
mod numbers;
#[cfg(test)]
mod oracle;
mod parse;
mod piece;
mod read;
mod smoothing;
mod textures;
mod used;
mod weld;

pub(super) use read::read;
