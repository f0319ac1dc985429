//! A walk whose references are stored.

use super::settings::{Mode, RenderSettings};
use super::walkthrough::Walkthrough;
use crate::camera::Camera;
use crate::store::StoreSession;

/// A view at rest is stored again when its samples are as many times as many: a kill loses little,
/// and all records of a view together have a third more samples than the last.
const QUADRUPLED: u32 = 4;

impl Walkthrough {
    /// Sets the store of references that is read and written. References that are traced from now
    /// on have other random numbers than those in the store. Returns the store before.
    pub fn set_store(&mut self, store: Option<StoreSession>) -> Option<StoreSession> {
        self.drop_refinement();
        let number = store.as_ref().map_or(0, StoreSession::last_number);
        self.references_made = self.references_made.max(number);
        std::mem::replace(&mut self.store, store)
    }

    /// The store that is read and written.
    pub fn store_mut(&mut self) -> Option<&mut StoreSession> {
        self.store.as_mut()
    }

    /// Reads the stored references that serve a view. Mode `full` uses none.
    pub(super) fn read_store(&mut self, camera: &Camera, size: [u32; 2]) {
        let RenderSettings { mode, trace } = self.settings.render;
        if let Some(store) = self.store.as_mut().filter(|_| mode != Mode::Full) {
            store.read_for((camera, size), &trace, mode.purpose(), &mut self.cache);
        }
    }

    /// Reads the stored references that serve a pose where a reference is wanted. Returns true
    /// where there were some.
    pub(super) fn read_ahead(&mut self, pose: &Camera, size: [u32; 2]) -> bool {
        let RenderSettings { mode, trace } = self.settings.render;
        let store = self.store.as_mut();
        store.is_some_and(|store| store.read_ahead((pose, size), &trace, mode.purpose(), &mut self.cache) > 0)
    }

    /// Stores the reference of the view at rest where it has grown by much.
    pub(super) fn store_refined(&mut self) {
        self.store_grown(QUADRUPLED);
    }

    /// Stores the reference of the view at rest where it has this many times the samples that were
    /// stored of it.
    fn store_grown(&mut self, times: u32) {
        let Some((refinement, store)) = self.refinement.as_ref().zip(self.store.as_mut()) else { return };
        let Some(reference) = refinement.reference(&self.cache) else { return };
        let samples = self.refined_stored;
        if reference.settings.samples >= samples.saturating_mul(times).max(samples.saturating_add(1)) {
            self.refined_stored = reference.settings.samples;
            store.keep(&reference, self.settings.render.mode.purpose());
        }
    }

    /// Drops the work of [`Self::refine`], so that the next frame shows its mode's picture again.
    /// The reference that it has lit is stored.
    pub fn drop_refinement(&mut self) {
        self.store_grown(1);
        self.refinement = None;
        self.refined_stored = 0;
    }
}
