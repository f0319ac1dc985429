//! The references at hand: a byte budget, the choice of the best few for a view, eviction.

use super::ReferenceFrame;
use super::directory::{Directory, MAX_SLOTS};
use super::placement::OpenSpot;
use crate::camera::PixelWarp;
use crate::camera::View;
use crate::scene::Scene;
use crate::trace::SceneEpoch;
use glam::Vec2;
use rayon::prelude::*;
use std::sync::Arc;

/// Names a reference for as long as the program runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ReferenceId(pub u32);

/// A reference in the cache.
#[derive(Clone, Debug)]
pub struct CachedReference {
    /// Its name.
    pub id: ReferenceId,
    /// The picture. A frame in flight keeps it alive after eviction.
    pub frame: Arc<ReferenceFrame>,
    /// Share of recent frames' pixels that it supplied, 0..1, fading.
    pub contribution: f32,
    /// False where frames and new references do without it.
    pub is_enabled: bool,
    last_used: u64,
    /// Its bit in the directory.
    pub(crate) slot: usize,
}

/// The references at one moment; cheap to take, because nothing but names is copied until the cache changes.
#[derive(Clone, Debug)]
pub struct KnownLight {
    directory: Arc<Directory>,
    entries: Vec<CachedReference>,
}

impl KnownLight {
    /// For each cell of the scene, the references that know its light.
    pub fn directory(&self) -> &Directory {
        &self.directory
    }

    /// All references, oldest first.
    pub fn entries(&self) -> &[CachedReference] {
        &self.entries
    }
}

impl CachedReference {
    /// Of this epoch, and not switched off.
    pub(crate) fn is_usable(&self, epoch: SceneEpoch) -> bool {
        self.is_enabled && self.frame.epoch == epoch
    }

    /// Only a reference that holds the light of all its pixels serves the paper's forward warp.
    fn can_be_warped(&self, epoch: SceneEpoch) -> bool {
        self.is_usable(epoch) && self.frame.is_dense()
    }
}

/// References within a byte budget.
#[derive(Debug)]
pub struct ReferenceCache {
    budget_bytes: usize,
    entries: Vec<CachedReference>,
    next_id: u32,
    clock: u64,
    evicted: u64,
    version: u64,
    coverage: Vec<Vec<f32>>,
    open: Vec<f32>,
    directory: Arc<Directory>,
}

impl ReferenceCache {
    /// An empty cache. The budget holds for what is kept; the newest reference always stays.
    pub fn new(scene: &Scene, budget_bytes: usize) -> Self {
        Self {
            budget_bytes,
            entries: Vec::new(),
            next_id: 0,
            clock: 0,
            evicted: 0,
            version: 0,
            coverage: Vec::new(),
            open: Vec::new(),
            directory: Arc::new(Directory::new(scene)),
        }
    }

    /// For each cell of the scene, the references that know its light.
    pub fn directory(&self) -> &Directory {
        &self.directory
    }

    /// All references, oldest first.
    pub fn entries(&self) -> &[CachedReference] {
        &self.entries
    }

    /// Memory held, bytes.
    pub fn bytes(&self) -> usize {
        self.entries.iter().map(|e| e.frame.bytes()).sum()
    }

    /// Memory allowed, bytes.
    pub fn budget_bytes(&self) -> usize {
        self.budget_bytes
    }

    /// Changes the budget and evicts what no longer fits.
    pub fn set_budget_bytes(&mut self, bytes: usize) {
        self.budget_bytes = bytes;
        self.evict();
    }

    /// References evicted so far.
    pub fn evicted(&self) -> u64 {
        self.evicted
    }

    /// Differs whenever what the references know has changed.
    pub fn version(&self) -> u64 {
        self.version
    }

    /// The name of the reference in each slot of a look-up; an unused one where there is none.
    pub fn ids_by_slot(&self) -> Vec<ReferenceId> {
        let count = self.entries.iter().map(|e| e.slot + 1).max().unwrap_or(0);
        let mut ids = vec![ReferenceId(u32::MAX); count];
        self.entries.iter().for_each(|e| ids[e.slot] = e.id);
        ids
    }

    /// The same for another thread: what the references know now.
    pub fn known_light(&self) -> KnownLight {
        KnownLight { directory: Arc::clone(&self.directory), entries: self.entries.clone() }
    }

    /// Drops everything.
    pub fn clear(&mut self) {
        self.version += 1;
        self.entries.clear();
        Arc::make_mut(&mut self.directory).clear();
    }

    /// Adds a reference; evicts the least useful others where the budget is exceeded.
    pub fn insert(&mut self, frame: Arc<ReferenceFrame>) -> ReferenceId {
        let id = ReferenceId(self.next_id);
        self.next_id += 1;
        self.version += 1;
        // A newcomer has no record yet; a full share keeps it until frames have judged it.
        let taken = self.entries.iter().fold(0u128, |mask, e| mask | 1 << e.slot);
        let slot = (!taken).trailing_zeros() as usize;
        Arc::make_mut(&mut self.directory).add(&frame, slot);
        let (contribution, last_used) = (1.0, self.clock);
        self.entries.push(CachedReference { id, frame, contribution, is_enabled: true, last_used, slot });
        self.evict();
        id
    }

    /// Removes a reference; false where there is none of that name.
    pub fn remove(&mut self, id: ReferenceId) -> bool {
        let Some(at) = self.entries.iter().position(|e| e.id == id) else { return false };
        self.version += 1;
        let removed = self.entries.remove(at);
        Arc::make_mut(&mut self.directory).remove(removed.slot);
        true
    }

    /// Switches a reference on or off; false where there is none of that name. One that is off keeps its memory and its
    /// place, but frames and references begun from now on do without it.
    pub fn set_enabled(&mut self, id: ReferenceId, is_enabled: bool) -> bool {
        let entry = self.entries.iter_mut().find(|e| e.id == id);
        entry.map(|entry| entry.is_enabled = is_enabled).is_some()
    }

    /// Makes a reference forget the light of a square of its pixels, because it is wrong; the next frames trace what was
    /// seen there, and the next references light it anew. False where it held none there. A frame or a reference in the
    /// making that uses it goes on with what it was.
    pub fn forget_light(&mut self, id: ReferenceId, corner: [u32; 2], side: u32) -> bool {
        self.version += 1;
        let entry = self.entries.iter_mut().find(|e| e.id == id);
        entry.is_some_and(|entry| Arc::make_mut(&mut entry.frame).forget_light(corner, side) > 0)
    }

    /// Least contribution first, then the longest unused.
    fn evict(&mut self) {
        // One slot is kept free for the next.
        while self.entries.len() > 1 && (self.bytes() > self.budget_bytes || self.entries.len() >= MAX_SLOTS)
        {
            let rank = |e: &CachedReference| (e.contribution, e.last_used);
            let candidates = &self.entries[..self.entries.len() - 1];
            let Some(worst) = (0..candidates.len()).min_by(|&a, &b| {
                let (a, b) = (rank(&candidates[a]), rank(&candidates[b]));
                a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))
            }) else {
                return;
            };
            self.version += 1;
            let removed = self.entries.remove(worst);
            Arc::make_mut(&mut self.directory).remove(removed.slot);
            self.evicted += 1;
        }
    }

    /// The up to `most` references that together cover most of a view, best first. References of another epoch are
    /// never among them.
    ///
    /// Greedy on a coarse warp (see `cover`): the reference that closes most of what is still open is taken next.
    /// Greedy coverage is within 63 % of the best choice (Nemhauser et al. 1978).
    pub fn select(&mut self, view: &View, epoch: SceneEpoch, most: usize) -> Vec<CachedReference> {
        let candidates = self.cover_all(view, epoch);
        let chosen = greedy(&self.coverage, most, &mut self.open);
        self.clock += 1;
        chosen
            .into_iter()
            .map(|c| {
                let entry = &mut self.entries[candidates[c]];
                entry.last_used = self.clock;
                entry.clone()
            })
            .collect()
    }

    /// The share of a view's pixels, in percent, that the best `most` references would leave without information: what
    /// the coarse warp says of a frame that is not rendered. Where they are is told too if a list is given.
    pub fn predict_type3_percent(
        &mut self,
        view: &View,
        epoch: SceneEpoch,
        most: usize,
        spots: Option<&mut Vec<OpenSpot>>,
    ) -> f64 {
        self.cover_all(view, epoch);
        greedy(&self.coverage, most, &mut self.open);
        if self.coverage.is_empty() {
            self.open.resize(cell_counts(view).into_iter().product(), 1.0);
        }
        if let Some(spots) = spots {
            spots.extend(open_spots(view, &self.open));
        }
        f64::from(self.open.iter().sum::<f32>() / self.open.len().max(1) as f32) * 100.0
    }

    /// Fills `coverage` for the references of an epoch and returns their places in `entries`.
    fn cover_all(&mut self, view: &View, epoch: SceneEpoch) -> Vec<usize> {
        let candidates: Vec<usize> =
            (0..self.entries.len()).filter(|&i| self.entries[i].can_be_warped(epoch)).collect();
        self.coverage.resize_with(candidates.len(), Vec::new);
        let entries = &self.entries;
        self.coverage
            .par_iter_mut()
            .zip(&candidates)
            .for_each(|(cells, &i)| cover(&entries[i].frame, view, cells));
        candidates
    }

    /// Records what each selected reference supplied to a finished frame, as shares of its pixels.
    pub fn note_contributions(&mut self, shares: &[(ReferenceId, f32)]) {
        const FADE: f32 = 0.9;
        for entry in &mut self.entries {
            let share = shares.iter().find(|(id, _)| *id == entry.id).map_or(0.0, |(_, share)| *share);
            entry.contribution = entry.contribution * FADE + share * (1.0 - FADE);
        }
    }
}

/// One reference pixel in so many per axis takes part in the choice: 14,400 of a 1280x720 reference.
const SOURCE_STEP: usize = 8;

/// Side of the cells of the view, in pixels: twice the step, so that a cell is missed only from a magnification of
/// two on.
const CELL: u32 = 16;

/// A further reference must close at least this share of the view: less than its own warp costs at the price of
/// traced pixels (5 ns against 10 microseconds).
const MIN_GAIN: f32 = 0.0005;

/// Writes for each cell of `view` which share of its pixels (0..1) samples of `reference` would reach.
///
/// Where the warp magnifies an area by m, one pixel in m gets a sample; m is measured between a sample and its right
/// and lower neighbour, so that slanted surfaces and edges count as what they are.
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

/// Columns and rows of cells of a view.
fn cell_counts(view: &View) -> [usize; 2] {
    view.size.map(|s| s.div_ceil(CELL) as usize)
}

/// The cells of which something is open, by the share of each that is.
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

/// The order in which references close most of what is open; `open` is filled with the share of each cell that stays
/// open, and left empty without references. Their sample grids are taken as independent, so what two leave open is the
/// product of what each leaves open.
fn greedy(coverage: &[Vec<f32>], most: usize, open: &mut Vec<f32>) -> Vec<usize> {
    let count = coverage.first().map_or(0, Vec::len);
    open.clear();
    open.resize(count, 1.0);
    let mut chosen: Vec<usize> = Vec::new();
    while chosen.len() < most.min(coverage.len()) {
        let gain = |c: usize| -> f32 {
            coverage[c].iter().zip(open.iter()).map(|(covers, open)| covers * open).sum()
        };
        let best = (0..coverage.len())
            .filter(|c| !chosen.contains(c))
            .map(|c| (c, gain(c)))
            // Of equals the newer: later in the list.
            .max_by(|a, b| a.1.total_cmp(&b.1));
        let Some((c, _)) = best.filter(|(_, gain)| *gain >= MIN_GAIN * count as f32) else { break };
        open.iter_mut().zip(&coverage[c]).for_each(|(open, covers)| *open *= 1.0 - covers);
        chosen.push(c);
    }
    chosen
}
