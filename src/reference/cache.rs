//! Cache of references with a byte budget, and the policy by which references are evicted.

use super::directory::{Directory, MAX_SLOTS};
use super::light::UNLIT;
use super::stale::{self, Carried, Renumbering};
use super::{LightLayers, ReferenceFrame};
use crate::cells::SurfaceCells;
use crate::scene::Scene;
use crate::trace::{NO_TRIANGLE, SceneEpoch, TraceSettings, Tracer, parallel::Stop};
use std::{sync::Arc, time::Instant};

/// Identifies a reference. Unique while the program runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ReferenceId(pub u32);

/// A reference in the cache.
#[derive(Clone, Debug)]
pub struct CachedReference {
    /// Identity of the reference.
    pub id: ReferenceId,
    /// The reference image. A frame in flight keeps it alive after eviction.
    pub frame: Arc<ReferenceFrame>,
    /// Share of recent frames' pixels that the reference supplied, 0..1, as a decaying mean.
    pub contribution: f32,
    /// False if frames and new references ignore this reference.
    pub is_enabled: bool,
    last_used: u64,
    /// Bit of the reference in the directory.
    pub(crate) slot: usize,
}

impl CachedReference {
    /// Returns true if the reference shows this state of the scene and is enabled.
    pub(crate) fn is_usable(&self, epoch: SceneEpoch) -> bool {
        self.is_enabled && self.frame.epoch == epoch
    }
}

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

    /// Carries the references over to another state of the scene: what still holds is kept, what is
    /// stale is marked and no longer used, and references about which nothing can be said are
    /// dropped.
    ///
    /// References that a stop leaves unexamined stay unused until they are carried over again.
    pub fn carry_to(&mut self, tracer: &Tracer, stop: Stop<'_>) -> Carried {
        let start = Instant::now();
        let mut carried = Carried::default();
        self.cells = None;
        let (entries, mut moves_light) = self.set_lights(tracer, &mut carried);
        moves_light |= !entries.is_empty();
        let key = |entry: &CachedReference| (entry.frame.origin.hash.clone(), entry.frame.settings.bounces);
        let mut groups: Vec<Vec<CachedReference>> = Vec::new();
        for entry in entries {
            match groups.iter_mut().find(|group| key(&group[0]) == key(&entry)) {
                Some(group) => group.push(entry),
                None => groups.push(vec![entry]),
            }
        }
        for group in groups {
            let frames: Vec<&ReferenceFrame> = group.iter().map(|entry| &*entry.frame).collect();
            let marks = stale::marks_of(&frames, tracer, &self.directory, &mut carried, stop);
            if stop() {
                self.entries.extend(group);
                continue;
            }
            let Some(marks) = marks else {
                carried.dropped += group.len();
                let directory = Arc::make_mut(&mut self.directory);
                group.iter().for_each(|entry| directory.remove(entry.slot));
                continue;
            };
            for (mut entry, marks) in group.into_iter().zip(marks) {
                let frame = Arc::make_mut(&mut entry.frame);
                frame.mark(tracer.epoch(), marks);
                carried.pixels += frame.lit() + frame.stale();
                carried.stale += frame.stale();
                carried.direct_holds += frame.held_direct().iter().filter(|&&word| word != UNLIT).count();
                self.entries.push(entry);
            }
        }
        self.entries.sort_by_key(|entry| entry.id);
        if moves_light {
            self.add_to_directory();
        }
        self.version += 1;
        self.evict();
        carried.secs = start.elapsed().as_secs_f64();
        carried
    }

    /// Marks what still holds of the light of references that were traced in another state of the
    /// scene, and are not in the cache. Returns false where nothing can be said about it.
    pub(crate) fn mark_others(
        &self,
        others: &mut [&mut ReferenceFrame],
        origin: &Arc<Scene>,
        tracer: &Tracer,
        stop: Stop<'_>,
    ) -> bool {
        others.iter_mut().for_each(|frame| frame.set_origin(origin));
        let frames: Vec<&ReferenceFrame> = others.iter().map(|frame| &**frame).collect();
        let marks = stale::marks_of(&frames, tracer, &self.directory, &mut Carried::default(), stop);
        let Some(marks) = marks else { return false };
        others.iter_mut().zip(marks).for_each(|(frame, marks)| frame.mark(tracer.epoch(), marks));
        true
    }

    /// Shows the light of the tracer's scene in the references where it follows from what is known,
    /// without a ray: lights were dimmed, switched or coloured. Takes the others out, and returns
    /// them; true where other pixels have light than before.
    fn set_lights(&mut self, tracer: &Tracer, carried: &mut Carried) -> (Vec<CachedReference>, bool) {
        let (mut others, mut moves_light) = (Vec::new(), false);
        for mut entry in std::mem::take(&mut self.entries) {
            if entry.frame.knows_lights(tracer.scene()) {
                let lit = entry.frame.lit();
                Arc::make_mut(&mut entry.frame).set_lights(tracer);
                moves_light |= entry.frame.lit() != lit;
                carried.pixels += entry.frame.lit();
                self.entries.push(entry);
            } else {
                others.push(entry);
            }
        }
        (others, moves_light)
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

    /// Follows the triangles of a model that was loaded again to their new numbers, before
    /// [`Self::carry_to`]. Where objects moved, came or went, smooth light is marked as stale, and
    /// direct light where they can change it. Drops the references of other models, and returns
    /// their number.
    pub fn renumber(&mut self, tracers: [&Tracer; 2]) -> usize {
        let [old, new] = tracers.map(|tracer| &**tracer.scene());
        let before = self.entries.len();
        self.entries.retain(|entry| entry.frame.origin.has_same_geometry(old));
        let renumbering = Renumbering::between(old, new);
        if renumbering.is_none() {
            self.entries.clear();
        }
        let mut states: Vec<(Arc<Scene>, Arc<Scene>)> = Vec::new();
        for (entry, numbers) in self.entries.iter_mut().zip(renumbering.iter().cycle()) {
            let frame = Arc::make_mut(&mut entry.frame);
            let is_gone = |triangle: u32| numbers.new_of_old.get(triangle as usize) == Some(&NO_TRIANGLE);
            let lights = &frame.origin.lights;
            let moved = numbers.moved.as_ref();
            let marks = moved.map(|moved| moved.marks(frame, lights, tracers, is_gone));
            let known = states.iter().find(|(origin, _)| Arc::ptr_eq(origin, &frame.origin));
            let state = known.map(|known| known.1.clone()).unwrap_or_else(|| {
                let state = Arc::new(numbers.state_of(&frame.origin, new));
                states.push((frame.origin.clone(), state.clone()));
                state
            });
            frame.renumber(&numbers.new_of_old, state, marks);
        }
        self.directory = Arc::new(Directory::new(new));
        self.add_to_directory();
        self.version += 1;
        before - self.entries.len()
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
