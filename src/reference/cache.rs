//! The references at hand: a byte budget, the choice of the best few for a view, eviction.

use super::{PixelWarp, ReferenceFrame};
use crate::camera::View;
use crate::trace::SceneEpoch;
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
    last_used: u64,
}

/// References within a byte budget.
#[derive(Debug)]
pub struct ReferenceCache {
    budget_bytes: usize,
    entries: Vec<CachedReference>,
    next_id: u32,
    clock: u64,
    evicted: u64,
    coverage: Vec<Vec<u64>>,
}

impl ReferenceCache {
    /// An empty cache. The budget holds for what is kept; the newest reference always stays.
    pub fn new(budget_bytes: usize) -> Self {
        Self { budget_bytes, entries: Vec::new(), next_id: 0, clock: 0, evicted: 0, coverage: Vec::new() }
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

    /// Drops everything.
    pub fn clear(&mut self) {
        self.entries.clear();
    }

    /// Adds a reference; evicts the least useful others where the budget is exceeded.
    pub fn insert(&mut self, frame: Arc<ReferenceFrame>) -> ReferenceId {
        let id = ReferenceId(self.next_id);
        self.next_id += 1;
        // A newcomer has no record yet; a full share keeps it until frames have judged it.
        self.entries.push(CachedReference { id, frame, contribution: 1.0, last_used: self.clock });
        self.evict();
        id
    }

    /// Removes a reference; false where there is none of that name.
    pub fn remove(&mut self, id: ReferenceId) -> bool {
        let before = self.entries.len();
        self.entries.retain(|e| e.id != id);
        self.entries.len() < before
    }

    /// Least contribution first, then the longest unused.
    fn evict(&mut self) {
        while self.entries.len() > 1 && self.bytes() > self.budget_bytes {
            let rank = |e: &CachedReference| (e.contribution, e.last_used);
            let candidates = &self.entries[..self.entries.len() - 1];
            let Some(worst) = (0..candidates.len()).min_by(|&a, &b| {
                let (a, b) = (rank(&candidates[a]), rank(&candidates[b]));
                a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))
            }) else {
                return;
            };
            self.entries.remove(worst);
            self.evicted += 1;
        }
    }

    /// The up to `most` references that together cover most of a view, best first. References of another epoch are
    /// never among them.
    ///
    /// Greedy on a coarse warp: every reference is projected into the view at one sample in `STEP`^2, and the one
    /// that covers most cells not yet covered is taken next. Greedy coverage is within 63 % of the best choice
    /// (Nemhauser et al. 1978).
    pub fn select(&mut self, view: &View, epoch: SceneEpoch, most: usize) -> Vec<CachedReference> {
        let candidates: Vec<usize> =
            (0..self.entries.len()).filter(|&i| self.entries[i].frame.epoch == epoch).collect();
        self.coverage.resize_with(candidates.len(), Vec::new);
        for (cells, &i) in self.coverage.iter_mut().zip(&candidates) {
            cover(&self.entries[i].frame, view, cells);
        }
        let chosen = greedy(&self.coverage[..candidates.len()], most);
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

    /// Records what each selected reference supplied to a finished frame, as shares of its pixels.
    pub fn note_contributions(&mut self, shares: &[(ReferenceId, f32)]) {
        const FADE: f32 = 0.9;
        for entry in &mut self.entries {
            let share = shares.iter().find(|(id, _)| *id == entry.id).map_or(0.0, |(_, share)| *share);
            entry.contribution = entry.contribution * FADE + share * (1.0 - FADE);
        }
    }
}

/// One sample in so many per axis takes part in the choice: 14,400 of a 1280x720 reference, some 50 microseconds.
const STEP: u32 = 8;

/// A further reference must cover at least this share of the view's cells that no other covers.
const LEAST_GAIN: f64 = 0.002;

/// Marks the cells of `view` that samples of `reference` reach.
fn cover(reference: &ReferenceFrame, view: &View, cells: &mut Vec<u64>) {
    let [width, height] = view.size.map(|s| s.div_ceil(STEP));
    cells.clear();
    cells.resize((width as usize * height as usize).div_ceil(64), 0);
    let warp = PixelWarp::new(&reference.view, view);
    let [columns, rows] = reference.view.size;
    for y in (STEP / 2..rows).step_by(STEP as usize) {
        for x in (STEP / 2..columns).step_by(STEP as usize) {
            let disparity = reference.disparity()[(y * columns + x) as usize];
            if let Some((tx, ty, _)) = warp.target(x, y, disparity) {
                let cell = (ty / STEP * width + tx / STEP) as usize;
                cells[cell / 64] |= 1 << (cell % 64);
            }
        }
    }
}

fn greedy(coverage: &[Vec<u64>], most: usize) -> Vec<usize> {
    let Some(words) = coverage.first().map(Vec::len) else { return Vec::new() };
    let mut covered = vec![0u64; words];
    let mut chosen: Vec<usize> = Vec::new();
    let least = ((words * 64) as f64 * LEAST_GAIN).max(1.0) as u32;
    while chosen.len() < most {
        let gain = |c: &usize| -> u32 {
            coverage[*c].iter().zip(&covered).map(|(a, b)| (a & !b).count_ones()).sum()
        };
        let best = (0..coverage.len())
            .filter(|c| !chosen.contains(c))
            .map(|c| (gain(&c), std::cmp::Reverse(c)))
            .max();
        let Some((gain, std::cmp::Reverse(c))) = best else { break };
        if gain < least {
            break;
        }
        covered.iter_mut().zip(&coverage[c]).for_each(|(a, b)| *a |= b);
        chosen.push(c);
    }
    chosen
}
