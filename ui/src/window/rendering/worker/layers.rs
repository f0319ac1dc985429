//! Tracing the light of references by groups, so that lights are dimmed without a ray.

use super::super::{Job, Traceable};
use super::state::{Layering, Worker};
use afterimage::render::TracedLayers;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

impl Worker {
    /// Starts to trace the light of a reference by groups, where lights are dimmed or the window
    /// shows their controls, unless something else is being traced.
    pub(super) fn request_layers(&mut self) {
        if !self.can_render() || self.running.is_some() || self.layering.is_some() || self.has_failed_layers {
            return;
        }
        let Some(walk) = &mut self.walk else { return };
        let scene = walk.tracer().scene().full_hash().to_owned();
        let is_wanted = self.knows_lights || walk.tracer().full().is_some();
        let Some(layers) = is_wanted.then(|| walk.layer_job()).flatten() else { return };
        let cancel = Arc::new(AtomicBool::new(false));
        let job = Job { work: Traceable::Layers(layers), cancel: cancel.clone() };
        if self.jobs.send(job).is_ok() {
            self.layering = Some(Layering { cancel, scene });
        }
    }

    /// Adds the light of a reference by groups. The next frame shows it where it was stale.
    pub(super) fn take_layers(&mut self, traced: Option<Box<TracedLayers>>) {
        let is_wanted = self.layering.take().is_some_and(|l| !l.cancel.load(Ordering::Acquire));
        let Some(walk) = self.walk.as_mut().filter(|_| is_wanted) else { return };
        match traced {
            Some(traced) => {
                if walk.insert_layers(*traced) {
                    self.shared.change(|_| ());
                }
            }
            // After a panic, all references would fail.
            None => self.has_failed_layers = true,
        }
    }

    /// Ends the tracing of light by groups. Its outcome still arrives and is then dropped.
    pub(super) fn cancel_layers(&mut self) {
        if let Some(layering) = &self.layering {
            layering.cancel.store(true, Ordering::Release);
        }
    }

    /// Ends the tracing of light by groups unless it is that of a scene, given by its hash at full
    /// light.
    pub(super) fn cancel_layers_except(&mut self, scene: &str) {
        if self.layering.as_ref().is_some_and(|layering| layering.scene != scene) {
            self.cancel_layers();
            self.has_failed_layers = false;
        }
    }
}
