//! A reference as the source of a warp: which target rows each of its tiles can reach. A band skips
//! tiles that cannot reach it.

use crate::camera::{PixelWarp, View};
use crate::reference::{ReferenceFrame, disparity_tiles::TILE};
use rayon::prelude::*;
use std::ops::Range;

/// Minimum number of tiles per task; a tile takes about 50 ns.
const MIN_TILES: usize = 128;

/// A reference, prepared for the warp into one view.
pub(super) struct Source<'a> {
    /// Warp from pixels of the reference to pixels of the target.
    pub(super) warp: PixelWarp,
    reference: &'a ReferenceFrame,
    first_id: u32,
    /// Target rows that each tile can reach, row-major. Empty if the tile is not visible.
    spans: Vec<Range<u32>>,
}

/// A row of tiles.
pub(super) struct TileRow<'a> {
    source: &'a Source<'a>,
    index: u32,
    spans: &'a [Range<u32>],
}

/// Neighbouring tiles of a row, as a rectangle of pixels.
pub(super) struct Run<'a> {
    /// Reference that the tiles belong to.
    pub(super) source: &'a Source<'a>,
    /// Pixel rows in the reference.
    pub(super) rows: Range<u32>,
    /// Pixel columns in the reference.
    pub(super) columns: Range<u32>,
}

impl<'a> Source<'a> {
    /// Prepares a reference for the warp into `view`. `first_id` is the sample of its first pixel.
    pub(super) fn new(reference: &'a ReferenceFrame, view: &View, first_id: u32) -> Self {
        let warp = PixelWarp::new(&reference.view, view);
        let ranges = reference.tiles().ranges();
        let columns = reference.tiles().columns();
        let tiles = (0..ranges.len()).into_par_iter().with_min_len(MIN_TILES);
        let pixels = |axis: usize, tile: usize| {
            let pixels = pixels_of_tile(reference.view.size[axis], axis, tile as u32);
            [pixels.start, pixels.end - 1]
        };
        let span = |tile: usize| {
            target_rows(&warp, view, pixels(0, tile % columns), pixels(1, tile / columns), ranges[tile])
        };
        let spans = tiles.map(span).collect();
        Self { warp, reference, first_id, spans }
    }

    /// All rows of tiles, from top to bottom.
    pub(super) fn tile_rows(&self) -> impl Iterator<Item = TileRow<'_>> {
        let rows = self.spans.chunks(self.reference.tiles().columns().max(1));
        rows.zip(0..).map(|(spans, index)| TileRow { source: self, index, spans })
    }

    /// Sample of the first pixel in row `y`.
    pub(super) fn first_id_of_row(&self, y: u32) -> u32 {
        self.first_id + y * self.reference.view.size[0]
    }
}

impl<'a> TileRow<'a> {
    /// End of the rows of a band that any of the tiles can reach.
    pub(super) fn last_row_in(&self, band: &Range<u32>) -> u32 {
        self.spans.iter().map(|span| span.end.min(band.end)).max().unwrap_or(0)
    }

    /// Tiles that can reach a band, with neighbours combined into runs.
    pub(super) fn runs_in(&self, band: &Range<u32>) -> impl Iterator<Item = Run<'a>> {
        let meets = |span: &Range<u32>| span.start < band.end && band.start < span.end;
        let size = self.source.reference.view.size;
        let mut tile = 0;
        std::iter::from_fn(move || {
            let first = tile + self.spans[tile..].iter().position(meets)?;
            tile = first
                + self.spans[first..].iter().position(|s| !meets(s)).unwrap_or(self.spans.len() - first);
            let left = pixels_of_tile(size[0], 0, first as u32).start;
            let right = pixels_of_tile(size[0], 0, tile as u32 - 1).end;
            Some(Run {
                source: self.source,
                rows: pixels_of_tile(size[1], 1, self.index),
                columns: left..right,
            })
        })
    }
}

impl Run<'_> {
    /// Disparities of the run's pixels in row `y` of the reference.
    #[inline(always)]
    pub(super) fn disparities(&self, y: u32) -> &[f32] {
        let row = y as usize * self.source.reference.view.size[0] as usize;
        let columns = self.columns.start as usize..self.columns.end as usize;
        &self.source.reference.disparity()[row..][columns]
    }
}

/// Returns the pixels of a tile along one axis.
fn pixels_of_tile(size: u32, axis: usize, tile: u32) -> Range<u32> {
    let side = TILE[axis];
    tile * side..((tile + 1) * side).min(size)
}

/// Returns the target rows in which samples of a tile may land. Conservative: it may return too
/// many, never too few.
fn target_rows(warp: &PixelWarp, view: &View, x: [u32; 2], y: [u32; 2], disparity: [f32; 2]) -> Range<u32> {
    if disparity[0] > disparity[1] {
        return 0..0;
    }
    let Some([across, down]) = warp.bounds(x, y, disparity) else { return 0..0 };
    let [width, height] = view.size;
    let is_outside = across[1] < 0.0 || across[0] >= width as f32 || down[1] < 0.0;
    if is_outside {
        return 0..0;
    }
    // The casts saturate. A bound of NaN, from an overflow, must not exclude a row.
    let end = if down[1].is_nan() { height } else { (down[1] as u32).saturating_add(1).min(height) };
    (down[0] as u32).min(end)..end
}
