//! A band of target rows that one thread fills alone, so that no cell is contended.
//!
//! Each group of 64 pixels of a source row takes two steps: their target cells and keys are
//! computed in vectors, into a scratch buffer that stays in the first-level cache; then each key is
//! entered with one scalar maximum.

use crate::camera::RowWarp;
use crate::warp::source::{Run, Source};
use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};
use std::ops::Range;

/// Maximum number of f32 lanes of a vector.
const MAX_LANES: usize = 16;

/// Pixels per group, a multiple of every vector width.
const GROUP: usize = 4 * MAX_LANES;

/// Consecutive rows of the target.
pub(super) struct Band<'a> {
    /// Keys of these rows, row-major.
    pub(super) keys: &'a mut [u64],
    /// Row range in the target.
    pub(super) rows: Range<u32>,
    /// Width of the target in pixels.
    pub(super) width: u32,
}

/// Target cells, as indices into the band, and keys of a group of samples. A sample that lands
/// outside the band has the key 0, which never wins, and an arbitrary cell.
struct Landings {
    cells: [u32; GROUP],
    keys: [u64; GROUP],
}

impl Band<'_> {
    /// Fills each cell with the largest key that lands on it, with the SIMD instructions of a
    /// level. The result does not depend on the level.
    pub(super) fn fill(&mut self, level: Level, sources: &[Source<'_>]) {
        dispatch!(level, simd => self.fill_in_vectors(simd, sources));
    }

    /// Clears each row shortly before its first sample arrives, so that it is in the cache by then.
    #[inline(always)]
    fn fill_in_vectors<S: Simd>(&mut self, simd: S, sources: &[Source<'_>]) {
        let mut landings = Landings { cells: [0; GROUP], keys: [0; GROUP] };
        let (rows, mut cleared) = (self.rows.clone(), 0);
        for tiles in sources.iter().flat_map(Source::tile_rows) {
            let reached = tiles.last_row_in(&rows).saturating_sub(rows.start);
            let reached = reached as usize * self.width as usize;
            if reached > cleared {
                self.keys[cleared..reached].fill(0);
                cleared = reached;
            }
            for run in tiles.runs_in(&rows) {
                self.splat(simd, &run, &mut landings);
            }
        }
        self.keys[cleared..].fill(0);
    }

    /// Enters all samples of a run of tiles.
    #[inline(always)]
    fn splat<S: Simd>(&mut self, simd: S, run: &Run<'_>, landings: &mut Landings) {
        for y in run.rows.clone() {
            let (row, mut x) = (run.source.warp.row(simd, y), run.columns.start);
            let id = run.source.first_id_of_row(y);
            for disparities in run.disparities(y).chunks(GROUP) {
                self.land(&row, x, id + x, disparities, landings);
                self.keep_nearest(landings, disparities.len());
                x += GROUP as u32;
            }
        }
    }

    /// Computes where the pixels from column `x` on land. `id` is the sample of the first one.
    #[inline(always)]
    fn land<S: Simd>(&self, row: &RowWarp<S>, x: u32, id: u32, disparities: &[f32], landings: &mut Landings) {
        let lanes = S::f32s::LEN;
        let cells = landings.cells.chunks_exact_mut(lanes);
        let keys = landings.keys.chunks_exact_mut(lanes);
        for (i, ((d, cells), keys)) in disparities.chunks(lanes).zip(cells).zip(keys).enumerate() {
            let done = (i * lanes) as u32;
            self.land_vector(row, x + done, id + done, d, cells, keys);
        }
    }

    /// [`Self::land`] for one vector, or part of one at the end of a row.
    #[inline(always)]
    fn land_vector<S: Simd>(
        &self,
        row: &RowWarp<S>,
        x: u32,
        id: u32,
        disparities: &[f32],
        cells: &mut [u32],
        keys: &mut [u64],
    ) {
        let simd = row.token();
        let (sx, sy, disparity, usable) = row.targets(x, load(simd, disparities));
        // Test as floats: a cast would turn NaN and -0.3 into 0.
        let inside = usable
            & sx.simd_ge(0.0)
            & sx.simd_lt(self.width as f32)
            & sy.simd_ge(self.rows.start as f32)
            & sy.simd_lt(self.rows.end as f32);
        let lane = S::u32s::from_fn(simd, |lane| lane as u32);
        let (tx, ty): (S::i32s, S::i32s) = (sx.to_int(), sy.to_int());
        let cell = (ty - self.rows.start as i32) * self.width as i32 + tx;
        // Spread samples outside the band over several cells: on one cell, each store would wait
        // for the one before.
        inside.select(cell.bitcast::<S::u32s>(), lane).store_slice(cells);
        let never = S::u32s::splat(simd, 0);
        let nearness = inside.select(disparity.bitcast::<S::u32s>(), never);
        store_keys(nearness, inside.select(!(lane + id), never), keys);
    }

    /// Keeps the largest key of each cell. A maximum instead of a branch, which the processor could
    /// not predict.
    #[inline(always)]
    fn keep_nearest(&mut self, landings: &Landings, count: usize) {
        let held = &mut *self.keys;
        for (&cell, &key) in landings.cells.iter().zip(&landings.keys).take(count) {
            if let Some(held) = held.get_mut(cell as usize) {
                *held = key.max(*held);
            }
        }
    }
}

/// Loads disparities into a vector. Missing ones become NaN, which lands nowhere.
#[inline(always)]
fn load<S: Simd>(simd: S, disparities: &[f32]) -> S::f32s {
    if disparities.len() == S::f32s::LEN {
        return S::f32s::from_slice(simd, disparities);
    }
    let mut padded = [f32::NAN; MAX_LANES];
    padded[..disparities.len()].copy_from_slice(disparities);
    S::f32s::from_slice(simd, &padded[..S::f32s::LEN])
}

/// Stores keys given by their upper and lower halves.
#[inline(always)]
fn store_keys<S: Simd, V: SimdBase<S, Element = u32>>(high: V, low: V, keys: &mut [u64]) {
    let halves: &mut [u32] = bytemuck::cast_slice_mut(keys);
    let (first, second) =
        if cfg!(target_endian = "little") { low.interleave(high) } else { high.interleave(low) };
    let (to_first, to_second) = halves.split_at_mut(V::LEN);
    first.store_slice(to_first);
    second.store_slice(to_second);
}
