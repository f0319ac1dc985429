//! Parts that both galleries are built from: columns, statues, plinths, benches, framed panels, a
//! glass case, a railing with stairs, and the textures.

mod columns;
mod figures;
mod furniture;
mod railing;
mod shell;
mod sides;
mod textures;
mod trim;
mod vitrine;

pub(super) use columns::column;
pub(super) use figures::{Figure, band, boulder, bust, knot, rings, ripples, spire, vase};
pub(super) use furniture::{bench, framed, plinth};
pub(super) use railing::{Platform, railing, stairs_up};
pub(super) use shell::{Shell, cells_outside, walls};
pub(super) use sides::{Facing, Gap, Side, WALL_M, openings};
pub(super) use textures::{HARBOUR, MARBLE, TIDE, TILES, WOOD, texture, textured};
pub(super) use trim::{architrave, skirting, stretches};
pub(super) use vitrine::vitrine;

use crate::scene::MaterialId;

/// Materials of the parts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Materials {
    pub(super) stone: MaterialId,
    pub(super) plaster: MaterialId,
    pub(super) white: MaterialId,
    pub(super) wood: MaterialId,
    pub(super) iron: MaterialId,
    pub(super) gilt: MaterialId,
    pub(super) bronze: MaterialId,
    pub(super) jade: MaterialId,
    pub(super) black: MaterialId,
    pub(super) cloth: MaterialId,
    pub(super) glass: MaterialId,
}
