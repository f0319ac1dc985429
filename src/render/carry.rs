//! A walk goes on in another state of its scene.

use super::{renderer::Renderer, walkthrough::Walkthrough};
use crate::lookup::PointCache;
use crate::reference::stale::{Carried, keeps_direct_light};
use crate::trace::{Tracer, parallel::Stop};

impl Walkthrough {
    /// Takes over the references of a walk through another state of the same model, edited or
    /// loaded again: light that still holds is kept. Walks through other models have none to give,
    /// and modes that do not look light up take none. What a stop leaves unexamined is not used
    /// before it is taken over again.
    pub fn take_references(&mut self, mut before: Self, stop: Stop<'_>) -> Carried {
        if !self.settings().render.mode.looks_up() {
            // References of mode `paper` also hold how often light is reflected.
            return Carried { dropped: before.cache.entries().len(), ..Carried::default() };
        }
        let tracer = self.tracer().clone();
        let old = before.tracer().clone();
        self.references_made = before.references_made;
        (self.cache, self.group_tracer) = (before.cache, before.group_tracer);
        let states = [&**old.scene(), &**tracer.scene()];
        if keeps_direct_light(states, self.settings().render.trace.bounces > 0) {
            let points = before.renderer.take_points(&old);
            self.renderer.points.take_direct(points, tracer.epoch());
        }
        let is_edit = old.scene().has_same_geometry(tracer.scene());
        let gone = if is_edit { 0 } else { self.cache.renumber([&old, &tracer]) };
        let carried = self.cache.carry_to(&tracer, stop);
        Carried { dropped: carried.dropped + gone, ..carried }
    }
}

impl Renderer {
    /// Takes out the light of single points that frames have traced so far.
    fn take_points(&mut self, tracer: &Tracer) -> PointCache {
        self.store_points(tracer);
        std::mem::take(&mut self.points)
    }
}
