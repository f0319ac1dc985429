//! References are carried over to another state of their scene.

use super::{CachedReference, ReferenceCache};
use crate::reference::ReferenceFrame;
use crate::reference::directory::Directory;
use crate::reference::stale::{self, Carried, Mark, Renumbering};
use crate::scene::Scene;
use crate::trace::parallel::{NEVER, Stop};
use crate::trace::{NO_TRIANGLE, Tracer};
use std::{sync::Arc, time::Instant};

impl ReferenceCache {
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
                carried.direct_holds += frame.stale_with_direct();
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

    /// Follows the triangles of a model to their numbers in another geometry of it, loaded again or
    /// with other objects, before [`Self::carry_to`]. Where objects moved, came or went, the light
    /// that they can change is marked as stale. References come back as they were where they have
    /// been in this geometry before. Drops the references of other models, and returns their
    /// number.
    pub fn renumber(&mut self, tracers: [&Tracer; 2]) -> usize {
        let [old, new] = tracers.map(Tracer::scene);
        let count = self.entries.len();
        self.entries.retain(|entry| entry.frame.origin.has_same_geometry(old));
        let mut dropped = count - self.entries.len();
        let back = self.before.take(new);
        self.before.keep(old, &self.entries);
        // References that come back need no numbers.
        self.entries.retain(|entry| !back.iter().any(|old| old.id == entry.id));
        match Renumbering::between(old, new) {
            Some(numbers) => self.follow(&numbers, tracers),
            None => {
                dropped += self.entries.len();
                self.entries.clear();
            }
        }
        let taken = self.entries.iter().fold(0u128, |mask, entry| mask | 1 << entry.slot);
        self.entries.extend(back.into_iter().filter(|entry| taken >> entry.slot & 1 == 0));
        self.entries.sort_by_key(|entry| entry.id);
        self.directory = Arc::new(Directory::new(new));
        self.add_to_directory();
        self.version += 1;
        dropped
    }

    /// Renumbers the triangles of references, and marks what objects that moved can change.
    fn follow(&mut self, numbers: &Renumbering, tracers: [&Tracer; 2]) {
        let mut entries = std::mem::take(&mut self.entries);
        while let Some(first) = entries.first().map(|entry| entry.frame.clone()) {
            let is_alike = |frame: &ReferenceFrame| {
                Arc::ptr_eq(&frame.origin, &first.origin) && frame.settings.bounces == first.settings.bounces
            };
            let (mut group, others): (Vec<_>, Vec<_>) =
                entries.into_iter().partition(|entry| is_alike(&entry.frame));
            entries = others;
            let (state, marks) = self.marks_of_group(numbers, tracers, &group);
            let mut marks = marks.map(Vec::into_iter);
            for entry in &mut group {
                let marks = marks.as_mut().and_then(Iterator::next);
                Arc::make_mut(&mut entry.frame).renumber(&numbers.new_of_old, state.clone(), marks);
            }
            self.entries.append(&mut group);
        }
    }

    /// The state that some references were traced in, with the triangles of now, and what objects
    /// that moved leave of their light; `None` where none moved.
    fn marks_of_group(
        &self,
        numbers: &Renumbering,
        tracers: [&Tracer; 2],
        group: &[CachedReference],
    ) -> (Arc<Scene>, Option<Vec<Vec<Mark>>>) {
        let frames: Vec<&ReferenceFrame> = group.iter().map(|entry| &*entry.frame).collect();
        let origin = &frames[0].origin;
        let state = Arc::new(numbers.state_of(origin, tracers[1].scene()));
        let marks = numbers.moved.as_ref().map(|moved| {
            let states =
                [(0, origin), (1, &state)].map(|(k, scene)| tracers[k].with_same_geometry(scene.clone()));
            let number =
                |triangle: u32| numbers.new_of_old.get(triangle as usize).copied().unwrap_or(NO_TRIANGLE);
            moved.marks(&frames, [&states[0], &states[1]], &self.directory, &number, NEVER)
        });
        (state, marks)
    }
}
