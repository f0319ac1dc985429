//! Parts that both galleries are built from: columns, statues, plinths, benches, framed panels, a
//! glass case, a railing with stairs, and the textures.

mod columns;
mod figures;
mod furniture;
mod materials;
mod railing;
mod shell;
mod sides;
mod textures;
mod trim;
mod vitrine;

pub(super) use columns::column;
pub(super) use figures::{Figure, band, boulder, bust, knot, rings, ripples, spire, vase};
pub(super) use furniture::{bench, framed, plinth};
pub(super) use materials::Materials;
pub(super) use railing::{Platform, railing, stairs_up};
pub(super) use shell::{Shell, cells_outside, walls};
pub(super) use sides::{Facing, Gap, Side, WALL_M, openings};
pub(super) use textures::{HARBOUR, MARBLE, TIDE, TILES, WOOD, texture, textured};
pub(super) use trim::{architrave, skirting, stretches};
pub(super) use vitrine::vitrine;
