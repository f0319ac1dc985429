//! Choice of the references that are warped into a view.
//!
//! Source: the paper, section 3: several references reduce Type 3; it does not say which to take.
//! We choose: a coarse warp of every reference estimates which parts of the view it covers, and the
//! one that covers most of what is still open is taken next. Greedy coverage is within 63 % of the
//! best choice (Nemhauser et al. 1978).

use crate::camera::{PixelWarp, View};
use crate::reference::{CachedReference, ReferenceCache, ReferenceFrame, ReferenceId, placement::OpenSpot};
use crate::trace::SceneEpoch;
use glam::Vec2;
use rayon::prelude::*;

/// Pixels per axis of a reference of which one takes part in the estimate: 14,400 of a 1280x720
/// reference.
const SOURCE_STEP: usize = 8;

/// Side of a cell of the view in pixels: twice the step, so that a cell is missed only at a
/// magnification of two or more.
const CELL: u32 = 16;

/// Minimum share of the view that another reference must close, 0..1: less than its own warp costs
/// at the price of traced pixels (5 ns against 10 microseconds).
const MIN_GAIN: f32 = 0.0005;

/// Chooses references for a view. Keeps its buffers from view to view.
#[derive(Debug, Default)]
pub struct ReferenceSelector {
    /// Share of each cell that each candidate covers, 0..1.
    coverage: Vec<Vec<f32>>,
    /// Share of each cell that the chosen references leave open, 0..1.
    open: Vec<f32>,
}

impl ReferenceSelector {
    /// Returns the up to `max_references` references that together cover most of a view, best
    /// first, and marks them as used. References of another state of the scene are never among
    /// them.
    pub fn select(
        &mut self,
        cache: &mut ReferenceCache,
        view: &View,
        epoch: SceneEpoch,
        max_references: usize,
    ) -> Vec<CachedReference> {
        let candidates: Vec<ReferenceId> = self.cover_all(cache, view, epoch);
        let chosen = greedy(&self.coverage, max_references, &mut self.open);
        let ids: Vec<ReferenceId> = chosen.into_iter().map(|c| candidates[c]).collect();
        cache.touch(&ids)
    }

    /// Predicts the percentage of a view's pixels that the best `max_references` references leave
    /// open, without rendering it. Appends the open cells to `spots`, if given.
    pub fn predict_open_percent(
        &mut self,
        cache: &ReferenceCache,
        view: &View,
        epoch: SceneEpoch,
        max_references: usize,
        spots: Option<&mut Vec<OpenSpot>>,
    ) -> f64 {
        self.cover_all(cache, view, epoch);
        greedy(&self.coverage, max_references, &mut self.open);
        if self.coverage.is_empty() {
            self.open.resize(cell_counts(view).into_iter().product(), 1.0);
        }
        if let Some(spots) = spots {
            spots.extend(open_spots(view, &self.open));
        }
        f64::from(self.open.iter().sum::<f32>() / self.open.len().max(1) as f32) * 100.0
    }

    /// Fills `coverage` for all references that can be warped and returns their identities. Only a
    /// reference that holds the light of all its pixels can be.
    fn cover_all(&mut self, cache: &ReferenceCache, view: &View, epoch: SceneEpoch) -> Vec<ReferenceId> {
        let can_be_warped = |e: &&CachedReference| e.is_usable(epoch) && e.frame.is_dense();
        let candidates: Vec<&CachedReference> = cache.entries().iter().filter(can_be_warped).collect();
        self.coverage.resize_with(candidates.len(), Vec::new);
        let pairs = self.coverage.par_iter_mut().zip(&candidates);
        pairs.for_each(|(cells, candidate)| cover(&candidate.frame, view, cells));
        candidates.iter().map(|candidate| candidate.id).collect()
    }
}

/// Writes for each cell of `view` the share of its pixels, 0..1, that samples of `reference` reach.
///
/// Where the warp magnifies an area by m, one pixel in m receives a sample. m is measured between a
/// sample and its right and lower neighbours, which accounts for slanted surfaces and for edges.
fn cover(reference: &ReferenceFrame, view: &View, cells: &mut Vec<f32>) {
    let [width, height] = cell_counts(view);
    cells.clear();
    cells.resize(width * height, 0.0);
    let warp = PixelWarp::new(&reference.view, view);
    let columns = reference.view.size[0] as usize;
    let last = |n: u32| (n as usize).saturating_sub(1);
    for y in (SOURCE_STEP / 2..last(reference.view.size[1])).step_by(SOURCE_STEP) {
        for x in (SOURCE_STEP / 2..last(reference.view.size[0])).step_by(SOURCE_STEP) {
            let point =
                |x: usize, y: usize| warp.point(x as u32, y as u32, reference.disparity()[y * columns + x]);
            let Some((px, py, _)) = point(x, y) else { continue };
            if !(px >= 0.0 && py >= 0.0 && px < view.size[0] as f32 && py < view.size[1] as f32) {
                continue;
            }
            let magnification = match (point(x + 1, y), point(x, y + 1)) {
                (Some((rx, ry, _)), Some((lx, ly, _))) => {
                    ((rx - px) * (ly - py) - (ry - py) * (lx - px)).abs()
                }
                _ => f32::INFINITY,
            };
            let cell = &mut cells[(py as u32 / CELL) as usize * width + (px as u32 / CELL) as usize];
            *cell = cell.max(1.0 / magnification.max(1.0));
        }
    }
}

/// Returns the number of columns and rows of cells in a view.
fn cell_counts(view: &View) -> [usize; 2] {
    view.size.map(|s| s.div_ceil(CELL) as usize)
}

/// Returns the cells that are not fully covered, with their open area.
fn open_spots(view: &View, open: &[f32]) -> impl Iterator<Item = OpenSpot> {
    let columns = cell_counts(view)[0];
    let side = CELL as f32;
    let per_cell = 100.0 / open.len().max(1) as f64;
    let spot = move |(cell, share): (usize, &f32)| OpenSpot {
        point: Vec2::new((cell % columns) as f32 + 0.5, (cell / columns) as f32 + 0.5) * side,
        percent: f64::from(*share) * per_cell,
    };
    open.iter().enumerate().filter(|(_, share)| **share > 0.0).map(spot)
}

/// Returns the order in which candidates close most of the open cells. Fills `open` with the share
/// of each cell that stays open, or leaves it empty without candidates. Sample grids count as
/// independent, so the share that two candidates leave open is the product of the shares that each
/// leaves open.
fn greedy(coverage: &[Vec<f32>], max_references: usize, open: &mut Vec<f32>) -> Vec<usize> {
    let count = coverage.first().map_or(0, Vec::len);
    open.clear();
    open.resize(count, 1.0);
    let mut chosen: Vec<usize> = Vec::new();
    while chosen.len() < max_references.min(coverage.len()) {
        let gain = |c: usize| -> f32 {
            coverage[c].iter().zip(open.iter()).map(|(covers, open)| covers * open).sum()
        };
        let best = (0..coverage.len())
            .filter(|c| !chosen.contains(c))
            .map(|c| (c, gain(c)))
            // Of equal gains the newer reference wins: it is later in the list.
            .max_by(|a, b| a.1.total_cmp(&b.1));
        let Some((c, _)) = best.filter(|(_, gain)| *gain >= MIN_GAIN * count as f32) else { break };
        open.iter_mut().zip(&coverage[c]).for_each(|(open, covers)| *open *= 1.0 - covers);
        chosen.push(c);
    }
    chosen
}
