//! Two rows of fluted columns that carry two architraves.

use super::{palette::Palette, plan::RoomName};
use crate::scene::SceneBuilder;
use crate::scene::builtin::parts::column;
use crate::scene::builtin::shapes::{Faces, Local, block};
use glam::DVec3;

/// World x of each row of columns.
pub(super) const ROWS_X: [f64; 2] = [13.5, 20.5];
/// World z of each column in a row.
pub(super) const COLUMNS_Z: [f64; 4] = [10.7, 14.5, 18.3, 22.1];
const HALL_AXIS_X: f64 = 17.0;
const ARCHITRAVE_HALF_M: f64 = 0.48;
/// Height of the architraves. Deeper ones would shade the aisles from the lamps.
const ARCHITRAVE_DROP_M: f64 = 0.15;
const BEAM_HALF_M: f64 = 0.14;
const BEAM_DROP_M: f64 = 0.12;

pub(super) fn add_to(b: &mut SceneBuilder, p: &Palette) {
    let top = RoomName::Hall.room().ceiling - ARCHITRAVE_DROP_M;
    for x in ROWS_X {
        for z in COLUMNS_Z {
            column(b, &p.parts(), &Local::at(DVec3::new(x, 0.0, z)), top);
        }
    }
    beams(b, p);
}

/// Adds the architraves over the columns, and the beams across the nave between the coffers.
fn beams(b: &mut SceneBuilder, p: &Palette) {
    let room = RoomName::Hall.room();
    let [_, _, z0, z1] = room.area;
    let ends = Faces::ALL.without(Faces::TOP).without(Faces::BACK);
    for x in ROWS_X {
        let low = DVec3::new(x - ARCHITRAVE_HALF_M, room.ceiling - ARCHITRAVE_DROP_M, z0);
        let high = DVec3::new(x + ARCHITRAVE_HALF_M, room.ceiling, z1);
        block(b, &Local::WORLD, [low, high], ends, p.trim);
    }
    let half = (ROWS_X[1] - ROWS_X[0]) / 2.0 - ARCHITRAVE_HALF_M;
    for z in COLUMNS_Z {
        let low = DVec3::new(HALL_AXIS_X - half, room.ceiling - BEAM_DROP_M, z - BEAM_HALF_M);
        let high = DVec3::new(HALL_AXIS_X + half, room.ceiling, z + BEAM_HALF_M);
        let between = Faces::ALL.without(Faces::TOP).without(Faces::LEFT).without(Faces::RIGHT);
        block(b, &Local::WORLD, [low, high], between, p.trim);
    }
}
