//! Where a placement policy wants the next reference, after a frame.

use super::frame::Frame;
use super::settings::{Mode, WalkthroughSettings};
use crate::camera::{Camera, View};
use crate::lookup::{LookupSet, open_percent};
use crate::reference::{Observation, ReferenceCache};
use crate::trace::Tracer;
use crate::warp::ReferenceSelector;

/// The state of a walk from which the placement rule decides where a reference is wanted.
pub(super) struct Placing<'w> {
    pub(super) tracer: &'w Tracer,
    pub(super) cache: &'w ReferenceCache,
    pub(super) settings: &'w WalkthroughSettings,
    pub(super) selector: &'w mut ReferenceSelector,
}

impl Placing<'_> {
    /// The pose of the reference that the policy wants after a frame, if it wants one. `previous`
    /// is the camera of the frame before.
    pub(super) fn decide(self, frame: &Frame, previous: Camera) -> Option<Camera> {
        let Self { tracer, cache, settings, selector } = self;
        if settings.render.mode == Mode::Full {
            return None;
        }
        let (types, size) = (frame.stats.types.percentages(), frame.view.size);
        let is_sparse = settings.render.mode.looks_up();
        let seen = Observation {
            camera: frame.camera,
            previous,
            open_percent: if is_sparse { types.unseen_percent } else { types.type3_percent },
            is_sparse,
            was_cut: !frame.stats.is_complete,
            held: cache.entries().len(),
        };
        let view = |pose: &Camera| View::new(pose, &tracer.scene().frame, size);
        if is_sparse {
            let lookup = LookupSet::new(cache, tracer.epoch());
            return settings.placement.decide(&seen, size, tracer, &mut |pose, spots| {
                open_percent(tracer, &view(pose), &lookup, spots)
            });
        }
        settings.placement.decide(&seen, size, tracer, &mut |pose, spots| {
            selector.predict_open_percent(cache, &view(pose), tracer.epoch(), settings.max_references, spots)
        })
    }
}
