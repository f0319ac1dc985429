//! References that were stored in another state of the scene: which of their light still holds.

use super::content::SceneContent;
use super::summary::RecordSummary;
use crate::reference::{ReferenceCache, ReferenceFrame};
use crate::scene::Scene;
use crate::trace::Tracer;
use crate::trace::parallel::NEVER;
use std::collections::HashMap;
use std::sync::Arc;

/// A reference that was read, and the state that it was lit in.
pub(super) type Loaded = (ReferenceFrame, Vec<u8>);

/// The states of a scene that records were lit in.
#[derive(Debug, Default)]
pub(super) struct States {
    /// By the hash of the state; `None` where it cannot be made again, or says nothing about the
    /// light of now.
    known: HashMap<u128, Option<Arc<Scene>>>,
}

impl States {
    /// Forgets all states: the scene has changed.
    pub(super) fn clear(&mut self) {
        self.known.clear();
    }

    /// True where records of a state may still be of use.
    pub(super) fn may_serve(&self, state: u128) -> bool {
        self.known.get(&state).is_none_or(Option::is_some)
    }

    /// Marks what holds of some references that were read. Those of which nothing is known become
    /// `None`.
    pub(super) fn mark(
        &mut self,
        loaded: &mut [(&RecordSummary, Option<Loaded>)],
        (tracer, content): (&Tracer, &SceneContent),
        cache: &ReferenceCache,
    ) {
        let is_old = |summary: &RecordSummary| !summary.holds_in(content);
        let mut states: Vec<u128> =
            loaded.iter().filter(|(summary, _)| is_old(summary)).map(|(summary, _)| summary.state).collect();
        states.sort_unstable();
        states.dedup();
        for state in states {
            let is_of = |summary: &RecordSummary| is_old(summary) && summary.state == state;
            let mut of_state = loaded.iter_mut().filter(|(summary, found)| is_of(summary) && found.is_some());
            let origin = of_state.next().and_then(|(summary, found)| {
                let (_, bytes) = found.as_ref()?;
                self.origin(summary, bytes, tracer, content)
            });
            let mut frames: Vec<&mut ReferenceFrame> = loaded
                .iter_mut()
                .filter(|(summary, _)| is_of(summary))
                .filter_map(|(_, found)| found.as_mut().map(|(frame, _)| frame))
                .collect();
            let is_marked =
                origin.is_some_and(|origin| cache.mark_others(&mut frames, &origin, tracer, NEVER));
            if !is_marked {
                self.known.insert(state, None);
                loaded.iter_mut().filter(|(summary, _)| is_of(summary)).for_each(|(_, found)| *found = None);
            }
        }
    }

    /// The scene in the state of a record.
    fn origin(
        &mut self,
        summary: &RecordSummary,
        state: &[u8],
        tracer: &Tracer,
        content: &SceneContent,
    ) -> Option<Arc<Scene>> {
        let make = || content.in_state(tracer.scene(), state, &summary.dependencies).map(Arc::new);
        self.known.entry(summary.state).or_insert_with(make).clone()
    }
}
