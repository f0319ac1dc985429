//! The building: the part of a model that decides where one enters it, how fast one flies, and
//! what the plan shows. The ground around it and a few objects far away do not count.
//!
//! 1. The triangles are grouped into pieces (`pieces`): triangles that share vertex positions.
//!    Level triangles and all others form separate pieces, so that a ground plane does not belong
//!    to the walls that were drawn on it.
//! 2. Pieces are *sheets* (level, covering their plan once: floors, ground, terrain), *plates*
//!    (thin for their width: the rim of a base plate) or *bodies*: walls, furniture, roofs.
//! 3. Bodies near each other form clusters (`clusters`). The main cluster is the one with the
//!    largest area.
//! 4. Sheets and plates near the main cluster are added, except those that lie low, as ground does,
//!    and those that are far wider than the cluster, as a sky is. The floor of a room that lacks a
//!    wall is added too: it is as wide as the others.
//!
//! A model that is only ground, and one whose bodies are spread so widely that no cluster holds
//! most of them, is a building as a whole.
//!
//! All thresholds are ratios of lengths or areas of the model itself. The corners of the result are
//! coordinates of the model's vertices, so adding ground or far objects leaves their bits.

mod clusters;
mod pieces;
#[cfg(test)]
mod tests;

use clusters::{Cluster, main_cluster};
use glam::DVec3;
use pieces::{Piece, pieces_of};

/// Largest ratio of the diagonals of a roof and of the cluster that it covers. A flat roof on
/// columns has up to five times the diagonal of one column; a sky has more than ten times that of a
/// house.
const MAX_ROOF_RATIO: f64 = 8.0;

/// Largest number of times that level pieces and bodies are added in turn. Real models need two.
const MAX_ROUNDS: usize = 8;

/// Returns the lower and upper corner of the box of the building in world metres, given the box of
/// the model without strays and the scale of scene space.
///
/// The scale, a power of two, only keeps areas in the range of f64.
pub(super) fn extent(
    positions: &[DVec3],
    triangles: &[[u32; 3]],
    whole: [DVec3; 2],
    units_per_metre: f64,
) -> [DVec3; 2] {
    let pieces = pieces_of(positions, triangles, units_per_metre);
    let (bodies, level): (Vec<&Piece>, Vec<&Piece>) = pieces.iter().partition(|p| p.is_body());
    let found = if bodies.is_empty() {
        main_cluster(&level)
    } else {
        main_cluster(&bodies).map(|main| with_level_pieces(main, &bodies, &level))
    };
    let Some(Cluster { low, high, .. }) = found else { return whole };
    let (low, high) = (low.max(whole[0]), high.min(whole[1]));
    if low.cmple(high).all() { [low, high] } else { whole }
}

/// Adds the sheets and plates that belong to the main cluster of bodies, and the bodies that come
/// near with them, such as the other columns below a roof.
fn with_level_pieces(mut main: Cluster, bodies: &[&Piece], level: &[&Piece]) -> Cluster {
    for _ in 0..MAX_ROUNDS {
        let before = (main.low, main.high);
        main.grow(level, |main, piece| !surrounds(piece, main));
        if (main.low, main.high) == before {
            break;
        }
        main.grow(bodies, |_, _| true);
    }
    main
}

/// Largest distance between the sides of a floor and of the walls on it, in diagonals of the walls.
const FLUSH: f64 = 1e-3;

/// True if a sheet or plate is ground below a cluster, or a sky above it.
fn surrounds(piece: &Piece, cluster: &Cluster) -> bool {
    let flush = FLUSH * cluster.diagonal();
    let [below, above] = [cluster.low - piece.low, piece.high - cluster.high];
    let sides = [below.x, above.x, below.z, above.z];
    let sticks_out = sides.map(|by| by > flush);
    let is_low = piece.mean_height < cluster.low.y + (cluster.high.y - cluster.low.y) / 2.0;
    if !is_low {
        let is_wide = piece.diagonal() > MAX_ROOF_RATIO * cluster.diagonal();
        return is_wide && sticks_out.contains(&true);
    }
    // The floor of a room that lacks a wall is as wide as the other walls.
    let is_flush = |first: usize| sides[first..first + 2].iter().all(|by| by.abs() <= flush);
    !match sticks_out {
        [true, false, false, false] | [false, true, false, false] => is_flush(2),
        [false, false, true, false] | [false, false, false, true] => is_flush(0),
        _ => false,
    }
}
