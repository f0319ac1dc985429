//! The materials that the parts are made of.

use crate::scene::MaterialId;

/// Materials of the parts; each gallery fills them from its own palette.
#[derive(Clone, Copy, Debug)]
pub(in crate::scene::builtin) struct Materials {
    pub(in crate::scene::builtin) stone: MaterialId,
    pub(in crate::scene::builtin) plaster: MaterialId,
    pub(in crate::scene::builtin) white: MaterialId,
    pub(in crate::scene::builtin) wood: MaterialId,
    pub(in crate::scene::builtin) iron: MaterialId,
    pub(in crate::scene::builtin) gilt: MaterialId,
    pub(in crate::scene::builtin) bronze: MaterialId,
    pub(in crate::scene::builtin) jade: MaterialId,
    pub(in crate::scene::builtin) black: MaterialId,
    pub(in crate::scene::builtin) cloth: MaterialId,
    pub(in crate::scene::builtin) glass: MaterialId,
}
