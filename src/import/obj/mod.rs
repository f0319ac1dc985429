//! OBJ models with MTL libraries: text -> repaired text -> `tobj` -> faces -> triangles with shared
//! vertices -> materials -> textures.

mod far_uvs;
mod interpret;
mod library;
mod mtl;
#[cfg(test)]
mod oracle;
mod parse;
mod piece;
mod read;
mod sanitize;
mod smoothing;
mod textures;
mod weld;

pub(super) use read::read;
