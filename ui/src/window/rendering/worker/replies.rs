//! Replies of the render thread: pictures and references that the window has requested.

use super::super::{Message, Picture, ReferenceRadiance};
use super::state::Worker;
use afterimage::Walkthrough;
use afterimage::reference::{ReferenceFrame, ReferenceId};
use std::sync::Arc;

impl Worker {
    /// Sends the picture that was requested, once the frame is complete.
    pub(super) fn send_picture(&mut self) {
        let Some(walk) = self.walk.as_ref().filter(|_| self.wants_picture) else { return };
        let frame = walk.frame();
        let is_paused = self.request.is_some_and(|w| w.is_paused);
        if frame.radiance.is_empty() || !(frame.stats.is_complete || is_paused) {
            return;
        }
        self.wants_picture = false;
        self.send(Message::Picture(Picture {
            size: frame.view.size,
            radiance: frame.radiance.clone(),
            scene: walk.tracer().scene().clone(),
            camera: frame.camera,
            settings: walk.settings().render,
            is_complete: frame.stats.is_complete,
            refined: frame.stats.refined,
            references: useful_references(walk),
        }));
    }

    /// Sends the light that a reference holds: the part that does not depend on the direction of
    /// view.
    pub(super) fn send_reference(&self, id: ReferenceId) {
        let Some(walk) = &self.walk else { return };
        let entry = walk.cache().entries().iter().find(|e| e.id == id);
        let radiance = entry.map(|entry| {
            let (frame, tracer) = (&entry.frame, walk.tracer());
            let count = frame.view.pixel_count() as u32;
            (0..count).map(|p| frame.has_light(p).then(|| frame.diffuse_radiance(tracer, p))).collect()
        });
        let (camera, size) =
            entry.map_or((walk.frame().camera, [0, 0]), |e| (e.frame.camera, e.frame.view.size));
        self.send(Message::Reference(ReferenceRadiance { id, camera, size, radiance }));
    }
}

/// Returns the references from which the view can be rendered again.
fn useful_references(walk: &Walkthrough) -> Vec<Arc<ReferenceFrame>> {
    let is_used = |id| walk.settings().render.mode.looks_up() || walk.used().contains(&id);
    walk.cache().entries().iter().filter(|e| is_used(e.id)).map(|e| Arc::clone(&e.frame)).collect()
}
