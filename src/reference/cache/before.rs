//! References as they were before objects moved, so that an undone edit brings all light back.

use super::entry::{CachedReference, ReferenceId};
use crate::scene::Scene;
use std::sync::Arc;

/// States that are kept: the first, and the latest ones. An object that is dragged leaves many, and
/// undoing that leads to the first.
const MAX_STATES: usize = 3;

/// References of earlier geometries, oldest first. They have no use but to come back, so they take
/// only what the budget leaves.
#[derive(Clone, Debug, Default)]
pub(super) struct Before {
    states: Vec<(Arc<Scene>, Vec<CachedReference>)>,
}

impl Before {
    /// Keeps the references of a geometry.
    pub(super) fn keep(&mut self, scene: &Arc<Scene>, entries: &[CachedReference]) {
        self.states.retain(|state| !state.0.has_same_geometry(scene));
        if self.states.len() >= MAX_STATES {
            self.states.remove(1);
        }
        self.states.push((scene.clone(), entries.to_vec()));
    }

    /// Takes out the references of a geometry, if they were kept.
    pub(super) fn take(&mut self, scene: &Scene) -> Vec<CachedReference> {
        let at = self.states.iter().position(|state| state.0.has_same_geometry(scene));
        at.map(|at| self.states.remove(at).1).unwrap_or_default()
    }

    /// Forgets a reference.
    pub(super) fn forget(&mut self, id: ReferenceId) {
        self.states.iter_mut().for_each(|state| state.1.retain(|entry| entry.id != id));
    }

    pub(super) fn clear(&mut self) {
        self.states.clear();
    }

    /// Drops states, the second first, until the rest takes no more than some bytes.
    pub(super) fn shrink(&mut self, bytes: usize) {
        let size = |(_, entries): &(Arc<Scene>, Vec<CachedReference>)| -> usize {
            entries.iter().map(|entry| entry.frame.bytes()).sum()
        };
        while !self.states.is_empty() && self.states.iter().map(size).sum::<usize>() > bytes {
            let at = 1.min(self.states.len() - 1);
            self.states.remove(at);
        }
    }
}
