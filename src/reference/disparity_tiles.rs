//! Range of disparities in each tile of a reference. The forward warp derives from it where a tile
//! can land, before it looks at any pixel.

use rayon::prelude::*;

/// Width and height of a tile in pixels: wide, because the warp proceeds along rows, and low, so
/// that a tile reaches few target rows.
pub const TILE: [u32; 2] = [64, 8];

/// Smallest and largest usable disparity of each tile, row-major: 8 bytes for 512 pixels.
#[derive(Clone, Debug, Default)]
pub struct DisparityTiles {
    columns: usize,
    ranges: Vec<[f32; 2]>,
}

impl DisparityTiles {
    /// Computes the ranges of a row-major picture of disparities, none of them negative.
    pub fn new(disparity: &[f32], size: [u32; 2]) -> Self {
        let [width, height] = size.map(|s| s as usize);
        let [tile_width, tile_height] = TILE.map(|s| s as usize);
        let columns = width.div_ceil(tile_width);
        let range = |tile: usize| {
            let [x, y] = [tile % columns * tile_width, tile / columns * tile_height];
            let columns = x..width.min(x + tile_width);
            let rows = y..height.min(y + tile_height);
            range_of(rows.flat_map(|y| &disparity[y * width..][columns.clone()]))
        };
        let tiles = columns * height.div_ceil(tile_height);
        Self { columns, ranges: (0..tiles).into_par_iter().map(range).collect() }
    }

    /// Number of tiles in a row of tiles.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Smallest and largest disparity of each tile, row-major. The smallest is above the largest
    /// where no pixel is usable.
    pub fn ranges(&self) -> &[[f32; 2]] {
        &self.ranges
    }
}

/// Returns the range of some disparities. `min` and `max` ignore NaN.
fn range_of<'a>(disparities: impl Iterator<Item = &'a f32>) -> [f32; 2] {
    let range =
        disparities.fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], &d| [low.min(d), high.max(d)]);
    debug_assert!(range[0] >= 0.0, "a negative disparity");
    range
}
