//! A view of a mode that looks smooth light up, from nothing until a deadline.

use super::{
    deadline::Deadline,
    frame::Frame,
    request::FrameRequest,
    rest::RestPicture,
    schedule::SLICE_TIME,
    settings::{RenderSettings, WalkthroughSettings},
};
use crate::{
    camera::Camera,
    reference::ReferenceCache,
    trace::{Tracer, parallel::Stop},
};
use std::{sync::Arc, time::Instant};

/// A picture of one reference, which is lit as long as the time allows, and then looked up. Time
/// that is left goes to passes of the full tracer.
#[derive(Debug)]
pub(super) struct TimedRest {
    tracer: Arc<Tracer>,
    cache: ReferenceCache,
    camera: Camera,
    size: [u32; 2],
    rest: RestPicture,
    /// The first looked-up frame, with the radiance of the picture so far. Empty before it.
    frame: Frame,
    has_rehearsed: bool,
}

impl TimedRest {
    pub(super) fn new(
        tracer: Arc<Tracer>,
        render: RenderSettings,
        camera: &Camera,
        size: [u32; 2],
        deadline: Deadline,
    ) -> Self {
        let cache_bytes = WalkthroughSettings::default().cache_bytes;
        let mut cache = ReferenceCache::new(tracer.scene(), cache_bytes);
        cache.prepare_cells(tracer.scene(), &render.trace);
        let request = FrameRequest::new(&tracer, camera, size, &render);
        let rest = RestPicture::new(&request).until(deadline);
        Self { rest, cache, camera: *camera, size, frame: Frame::default(), has_rehearsed: false, tracer }
    }

    /// Does the next step, or a part of it. Returns false where nothing is left to do.
    pub(super) fn step(&mut self, stop: Stop<'_>) -> bool {
        let start = Instant::now();
        if !self.has_rehearsed {
            self.rest.rehearse(&self.tracer, &mut self.cache);
            self.has_rehearsed = true;
        }
        let stop = || stop() || start.elapsed() >= SLICE_TIME;
        let has_improved = self.rest.step(&self.tracer, &mut self.cache, &stop);
        self.update();
        has_improved
    }

    /// Shows what there is, where nothing is shown yet.
    pub(super) fn conclude(&mut self) {
        if !self.rest.is_shown() {
            self.rest.conclude(&self.tracer, &mut self.cache);
            self.update();
        }
    }

    fn update(&mut self) {
        if !self.rest.is_shown() {
            return;
        }
        if self.frame.radiance.is_empty() {
            self.frame = self.rest.frame().clone();
            if let Some(own) = self.rest.own(&self.cache) {
                self.frame.stats.rays += own.rays;
            }
        }
        self.rest.write_to(&mut self.frame);
    }

    /// The picture so far.
    pub(super) fn frame(&self) -> &Frame {
        &self.frame
    }

    /// Begins again with other settings. The references are kept.
    pub(super) fn restart(&mut self, render: RenderSettings) {
        self.cache.prepare_cells(self.tracer.scene(), &render.trace);
        let request = FrameRequest::new(&self.tracer, &self.camera, self.size, &render);
        let rest = RestPicture::new(&request);
        self.rest = match self.rest.deadline() {
            Some(deadline) => rest.until(deadline),
            None => rest,
        };
    }
}
