//! Cache of references with a byte budget, and the policy by which references are evicted.

mod before;
mod carry;
mod entry;

use super::directory::{Directory, MAX_SLOTS};
use super::{LightLayers, ReferenceFrame};
use crate::cells::SurfaceCells;
use crate::scene::Scene;
use crate::trace::{TraceSettings, Tracer};
use before::Before;
pub use entry::{CachedReference, ReferenceId};
use std::sync::Arc;

/// All references at one moment. Cheap to take: images and directory are shared until the cache
/// changes.
#[derive(Clone, Debug)]
pub struct ReferenceSnapshot {
    directory: Arc<Directory>,
    entries: Vec<CachedReference>,
    cells: Option<Arc<SurfaceCells>>,
}

impl ReferenceSnapshot {
    /// Which references hold the light of each cell of the scene.
    pub fn directory(&self) -> &Directory {
        &self.directory
    }

    /// All references, oldest first.
    pub fn entries(&self) -> &[CachedReference] {
        &self.entries
    }

    /// Light at the surfaces that bounce rays meet.
    pub fn cells(&self) -> Option<&SurfaceCells> {
        self.cells.as_deref()
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
    directory: Arc<Directory>,
    cells: Option<Arc<SurfaceCells>>,
    /// References as they were before objects moved.
    before: Before,
}

impl ReferenceCache {
    /// Creates an empty cache. The newest reference is kept even if it exceeds the budget alone.
    pub fn new(scene: &Scene, budget_bytes: usize) -> Self {
        Self {
            budget_bytes,
            entries: Vec::new(),
            next_id: 0,
            clock: 0,
            evicted: 0,
            version: 0,
            directory: Arc::new(Directory::new(scene)),
            cells: None,
            before: Before::default(),
        }
    }

    /// Prepares the cells of cached light for paths of these settings, and keeps those that fit.
    pub fn prepare_cells(&mut self, scene: &Scene, settings: &TraceSettings) {
        if settings.bounces == 0 {
            self.cells = None;
        } else if !self.cells.as_ref().is_some_and(|cells| cells.are_for(settings)) {
            self.cells = Some(Arc::new(SurfaceCells::new(scene, settings)));
        }
    }

    /// Light at the surfaces that bounce rays meet; `None` before [`Self::prepare_cells`].
    pub fn cells(&self) -> Option<&SurfaceCells> {
        self.cells.as_deref()
    }

    /// Which references hold the light of each cell of the scene.
    pub fn directory(&self) -> &Directory {
        &self.directory
    }

    /// All references, oldest first.
    pub fn entries(&self) -> &[CachedReference] {
        &self.entries
    }

    /// Memory of all references in bytes.
    pub fn bytes(&self) -> usize {
        self.entries.iter().map(|e| e.frame.bytes()).sum()
    }

    /// Memory budget in bytes.
    pub fn budget_bytes(&self) -> usize {
        self.budget_bytes
    }

    /// Changes the budget and evicts references that no longer fit.
    pub fn set_budget_bytes(&mut self, bytes: usize) {
        self.budget_bytes = bytes;
        self.evict();
    }

    /// Number of references evicted so far.
    pub fn evicted(&self) -> u64 {
        self.evicted
    }

    /// Counter that changes whenever the stored light changes.
    pub fn version(&self) -> u64 {
        self.version
    }

    /// Identities by slot, up to the last slot in use. Free slots have an identity that no
    /// reference has.
    pub fn ids_by_slot(&self) -> Vec<ReferenceId> {
        let count = self.entries.iter().map(|e| e.slot + 1).max().unwrap_or(0);
        let mut ids = vec![ReferenceId(u32::MAX); count];
        for entry in &self.entries {
            ids[entry.slot] = entry.id;
        }
        ids
    }

    /// Takes a snapshot of all references, for another thread.
    pub fn snapshot(&self) -> ReferenceSnapshot {
        let (directory, entries) = (Arc::clone(&self.directory), self.entries.clone());
        ReferenceSnapshot { directory, entries, cells: self.cells.clone() }
    }

    /// Removes all references.
    pub fn clear(&mut self) {
        self.version += 1;
        self.entries.clear();
        self.before.clear();
        Arc::make_mut(&mut self.directory).clear();
    }

    /// Adds a reference. Evicts the least useful others if the budget is exceeded.
    pub fn insert(&mut self, frame: Arc<ReferenceFrame>) -> ReferenceId {
        let id = ReferenceId(self.next_id);
        self.next_id += 1;
        self.version += 1;
        let taken = self.entries.iter().fold(0u128, |mask, e| mask | 1 << e.slot);
        let slot = (!taken).trailing_zeros() as usize;
        Arc::make_mut(&mut self.directory).add(&frame, slot);
        // A new reference has no record yet. It counts as fully used until frames have been
        // rendered with it.
        let (contribution, last_used) = (1.0, self.clock);
        self.entries.push(CachedReference { id, frame, contribution, is_enabled: true, last_used, slot });
        self.evict();
        id
    }

    /// Removes a reference. Returns false if there is none with this identity.
    pub fn remove(&mut self, id: ReferenceId) -> bool {
        self.before.forget(id);
        let at = self.entries.iter().position(|e| e.id == id);
        at.map(|at| self.remove_at(at)).is_some()
    }

    fn remove_at(&mut self, at: usize) {
        self.version += 1;
        let removed = self.entries.remove(at);
        Arc::make_mut(&mut self.directory).remove(removed.slot);
    }

    /// Enables or disables a reference. Returns false if there is none with this identity. A
    /// disabled reference keeps its memory and its slot, but frames and references started from now
    /// on ignore it.
    pub fn set_enabled(&mut self, id: ReferenceId, is_enabled: bool) -> bool {
        let entry = self.entries.iter_mut().find(|e| e.id == id);
        entry.map(|entry| entry.is_enabled = is_enabled).is_some()
    }

    /// Discards the light in a square of a reference's pixels, because it is wrong. The next frames
    /// trace these surfaces, and the next references light them again; a frame or reference in
    /// progress keeps using the old light. Returns false if the square held no light.
    pub fn forget_light(&mut self, id: ReferenceId, corner: [u32; 2], side: u32) -> bool {
        self.version += 1;
        let entry = self.entries.iter_mut().find(|e| e.id == id);
        entry.is_some_and(|entry| Arc::make_mut(&mut entry.frame).forget_light(corner, side) > 0)
    }

    /// Adds the light by groups of a reference. Returns true where it shows other light of the
    /// tracer's scene than before.
    pub(crate) fn set_layers(&mut self, id: ReferenceId, layers: Arc<LightLayers>, tracer: &Tracer) -> bool {
        let Some(entry) = self.entries.iter_mut().find(|entry| entry.id == id) else { return false };
        let has_changed = Arc::make_mut(&mut entry.frame).set_layers(layers, tracer);
        if has_changed {
            self.add_to_directory();
            self.version += 1;
        }
        self.evict();
        has_changed
    }

    /// Writes the directory again: light that was stale may hold again.
    fn add_to_directory(&mut self) {
        let directory = Arc::make_mut(&mut self.directory);
        directory.clear();
        for entry in &self.entries {
            directory.add(&entry.frame, entry.slot);
        }
    }

    /// Evicts references while the budget is exceeded: smallest contribution first, then the
    /// longest unused. The newest is never evicted.
    fn evict(&mut self) {
        self.before.shrink(self.budget_bytes.saturating_sub(self.bytes()));
        // One slot is kept free for the next reference.
        while self.entries.len() > 1 && (self.bytes() > self.budget_bytes || self.entries.len() >= MAX_SLOTS)
        {
            let candidates = &self.entries[..self.entries.len() - 1];
            let by_use = |&a: &usize, &b: &usize| {
                let (a, b) = (&candidates[a], &candidates[b]);
                a.contribution.total_cmp(&b.contribution).then(a.last_used.cmp(&b.last_used))
            };
            let Some(worst) = (0..candidates.len()).min_by(by_use) else { return };
            self.remove_at(worst);
            self.evicted += 1;
        }
    }

    /// Marks references as just used and returns them, in the order given. Identities without a
    /// reference are skipped.
    pub fn touch(&mut self, ids: &[ReferenceId]) -> Vec<CachedReference> {
        self.clock += 1;
        let mut touch = |id: &ReferenceId| {
            let entry = self.entries.iter_mut().find(|e| e.id == *id)?;
            entry.last_used = self.clock;
            Some(entry.clone())
        };
        ids.iter().filter_map(&mut touch).collect()
    }

    /// Records the share of a finished frame's pixels that each reference supplied, 0..1.
    pub fn note_contributions(&mut self, shares: &[(ReferenceId, f32)]) {
        const DECAY: f32 = 0.9;
        for entry in &mut self.entries {
            let share = shares.iter().find(|(id, _)| *id == entry.id).map_or(0.0, |(_, share)| *share);
            entry.contribution = entry.contribution * DECAY + share * (1.0 - DECAY);
        }
    }
}
