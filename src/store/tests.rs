//! Faults: whatever happens to the files, what is read is right, and what was whole is found.

mod faults;
mod files;
mod pixels;

use super::codec::{decode, encode};
use super::content::SceneContent;
use super::record::write_record;
use super::summary::{Purpose, RecordSummary};
use crate::camera::Camera;
use crate::lookup::LookupSet;
use crate::reference::{ReferenceCache, ReferenceFrame};
use crate::scene::builtin;
use crate::trace::parallel::NEVER;
use crate::trace::{TraceSettings, Tracer};
use glam::DVec3;
use std::sync::Arc;

/// A scene, and what it consists of.
struct Stage {
    tracer: Tracer,
    content: SceneContent,
}

impl Stage {
    fn new(name: &str) -> Self {
        let tracer = Tracer::new(Arc::new(builtin::build(name).unwrap()));
        let content = SceneContent::new(tracer.scene());
        Self { tracer, content }
    }

    /// The start view, moved to the right, in metres.
    fn camera(&self, right: f64) -> Camera {
        let start = *self.tracer.scene().start();
        Camera { eye: start.eye + DVec3::X * right, ..start }
    }

    /// Two references of nearby poses: the second lights only what the first does not know.
    fn sparse(&self, size: [u32; 2], settings: &TraceSettings, right: f64) -> [ReferenceFrame; 2] {
        let mut cache = ReferenceCache::new(self.tracer.scene(), 1 << 30);
        let trace = |cache: &ReferenceCache, right: f64| {
            let known = LookupSet::new(cache, self.tracer.epoch());
            let camera = self.camera(right);
            ReferenceFrame::trace_sparse(&self.tracer, &camera, size, settings, &known, NEVER).unwrap()
        };
        let first = trace(&cache, 0.0);
        cache.insert(Arc::new(first.clone()));
        let second = trace(&cache, right);
        [first, second]
    }

    fn summary(&self, reference: &ReferenceFrame) -> RecordSummary {
        RecordSummary::of(reference, Purpose::LookUp, self.tracer.scene(), &self.content)
    }

    /// The bytes of a record.
    fn record(&self, reference: &ReferenceFrame) -> Vec<u8> {
        let pixels = encode(reference, &self.tracer, &self.content);
        write_record(&self.summary(reference).write(), &pixels, 7).unwrap()
    }

    /// A reference as it is read after it was written.
    fn stored(&self, reference: &ReferenceFrame) -> ReferenceFrame {
        let pixels = encode(reference, &self.tracer, &self.content);
        let summary = RecordSummary::read(&self.summary(reference).write()).unwrap();
        decode(&pixels, &summary, &self.tracer, &self.content).unwrap()
    }
}

/// All that a pixel stores, by its bits.
fn bits(frame: &ReferenceFrame, pixel: u32) -> (u32, u32, u32, Option<u32>, u8) {
    let at = pixel as usize;
    let smooth = frame.packed_smooth().0.get(at).copied();
    let light = frame.packed_light().0[at];
    (frame.disparity()[at].to_bits(), frame.triangle()[at], light, smooth, frame.reflections(pixel))
}

const TRACE: TraceSettings = TraceSettings { samples: 2, bounces: 1, seed: 3 };
