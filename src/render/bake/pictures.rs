//! Which surfaces a pose shows, by a coarse picture of first hits.

use crate::camera::{Camera, View};
use crate::lookup::TileSurfaces;
use crate::trace::{TILE_SIDE, Tracer, parallel::Stop};
use glam::Vec3;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Pixels of a picture. Rooms are recognised by a tenth of that; more pixels change the choice of
/// poses little.
const PIXELS: f64 = 5000.0;

/// Side of a cell in scene units: a 64th to a 128th of the diagonal of the scene. It is larger than
/// a pixel of a picture in the same room.
const SIDE: f32 = 8.0;

/// A cube of space, and the axis and sign of the side that its surfaces face.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) struct SurfaceCell {
    pub(super) cube: [i32; 3],
    pub(super) side: u8,
}

/// The cells that a pose shows, ascending, with the number of pixels of each.
pub(super) type Shown = Vec<(SurfaceCell, u32)>;

/// The size of the pictures for references of a size.
pub(super) fn picture_size([width, height]: [u32; 2]) -> [u32; 2] {
    let aspect = f64::from(width.max(1)) / f64::from(height.max(1));
    let across = (PIXELS * aspect).sqrt().clamp(8.0, 4096.0);
    [across, across / aspect].map(|edge| (edge.round() as u32).clamp(8, 4096))
}

/// What each of some poses shows. `None` after a stop.
pub(super) fn pictures(
    tracer: &Tracer,
    poses: &[Camera],
    size: [u32; 2],
    stop: Stop<'_>,
) -> Option<Vec<Shown>> {
    let of = |pose: &Camera| (!stop()).then(|| picture(tracer, pose, size, |_, _| true));
    poses.par_iter().map(of).collect()
}

/// What a pose shows at the places of a picture for which `is_counted` holds, given as shares of
/// its width and height.
pub(super) fn picture(
    tracer: &Tracer,
    pose: &Camera,
    size: [u32; 2],
    is_counted: impl Fn(f32, f32) -> bool,
) -> Shown {
    let view = View::new(pose, &tracer.scene().frame, size);
    let mut tile = TileSurfaces::new(&view);
    let mut cells = BTreeMap::new();
    let side = TILE_SIDE as u32;
    for corner in corners(size) {
        tile.trace_behind_glass(tracer, &view, corner);
        for pixel in (0..TILE_SIDE * TILE_SIDE).filter(|pixel| tile.points.wanted >> pixel & 1 == 1) {
            let at = [corner[0] + pixel as u32 % side, corner[1] + pixel as u32 / side];
            let [x, y] = [0, 1].map(|axis| (at[axis] as f32 + 0.5) / size[axis] as f32);
            if is_counted(x, y) {
                *cells.entry(cell_of(&view, &tile, pixel)).or_insert(0) += 1;
            }
        }
    }
    cells.into_iter().collect()
}

fn corners([width, height]: [u32; 2]) -> impl Iterator<Item = [u32; 2]> {
    let rows = (0..height).step_by(TILE_SIDE);
    rows.flat_map(move |y| (0..width).step_by(TILE_SIDE).map(move |x| [x, y]))
}

fn cell_of(view: &View, tile: &TileSurfaces, pixel: usize) -> SurfaceCell {
    let position = view.eye + tile.direction(pixel) * tile.hits.t[pixel];
    let normal = Vec3::from(tile.points.normal.map(|axis| axis[pixel]));
    let axis = normal.abs().max_position();
    let side = axis as u8 + if normal[axis] < 0.0 { 3 } else { 0 };
    SurfaceCell { cube: (position / SIDE).floor().as_ivec3().to_array(), side }
}
