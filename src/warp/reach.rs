//! Which target rows each tile of a reference can reach: a band passes over the tiles that cannot reach it.

use crate::camera::PixelWarp;
use crate::camera::View;
use crate::reference::ReferenceFrame;
use crate::reference::disparity_tiles::TILE;
use rayon::prelude::*;
use std::ops::Range;

/// Tiles a thread takes at a time, some 50 ns each.
const MIN_TILES: usize = 128;

/// A reference, as the warp into one view sees it.
pub(crate) struct Source<'a> {
    /// From its pixels to the target's.
    pub(crate) warp: PixelWarp,
    reference: &'a ReferenceFrame,
    first_id: u32,
    /// Target rows of each tile, row-major; empty where it cannot be seen.
    spans: Vec<Range<u32>>,
}

/// The tiles of some pixel rows of a source.
pub(crate) struct TileRow<'a> {
    source: &'a Source<'a>,
    index: u32,
    spans: &'a [Range<u32>],
}

/// Neighbouring tiles of a row of them.
pub(crate) struct Run<'a> {
    /// Theirs.
    pub(crate) source: &'a Source<'a>,
    /// Pixel rows.
    pub(crate) rows: Range<u32>,
    /// Pixel columns.
    pub(crate) columns: Range<u32>,
}

impl<'a> Source<'a> {
    /// Takes a reference, the view to warp it to and the sample of its first pixel.
    pub(crate) fn new(reference: &'a ReferenceFrame, view: &View, first_id: u32) -> Self {
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

    /// Top to bottom.
    pub(crate) fn tile_rows(&self) -> impl Iterator<Item = TileRow<'_>> {
        let rows = self.spans.chunks(self.reference.tiles().columns().max(1));
        rows.zip(0..).map(|(spans, index)| TileRow { source: self, index, spans })
    }

    /// The sample of the first pixel of a row.
    pub(crate) fn first_id_of_row(&self, y: u32) -> u32 {
        self.first_id + y * self.reference.view.size[0]
    }
}

impl<'a> TileRow<'a> {
    /// The end of the rows of a band that any tile can reach.
    pub(crate) fn last_row_in(&self, band: &Range<u32>) -> u32 {
        self.spans.iter().map(|span| span.end.min(band.end)).max().unwrap_or(0)
    }

    /// The tiles that can reach a band, neighbours together.
    pub(crate) fn runs_in(&self, band: &Range<u32>) -> impl Iterator<Item = Run<'a>> {
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
    /// Of its pixels in a row.
    #[inline(always)]
    pub(crate) fn disparities(&self, y: u32) -> &[f32] {
        let row = y as usize * self.source.reference.view.size[0] as usize;
        let columns = self.columns.start as usize..self.columns.end as usize;
        &self.source.reference.disparity()[row..][columns]
    }
}

fn pixels_of_tile(size: u32, axis: usize, tile: u32) -> Range<u32> {
    let side = TILE[axis];
    tile * side..((tile + 1) * side).min(size)
}

/// Rows of the picture in which samples of a tile may land: more than necessary, never fewer.
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
    // The casts saturate. NaN, from numbers beyond all bounds, must not hide a row.
    let end = if down[1].is_nan() { height } else { (down[1] as u32).saturating_add(1).min(height) };
    (down[0] as u32).min(end)..end
}
