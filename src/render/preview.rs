//! When a view is lit coarsely before its first frame, so that a window shows coarse light instead
//! of noise.

use crate::camera::{Camera, View};
use crate::lookup::{LookupSet, open_percent};
use crate::reference::ReferenceCache;
use crate::trace::Tracer;

/// A view is previewed where at least this share of its pixels, in percent, has no known light: a
/// quarter of the picture would be noise, and a preview costs a sixteenth of a frame or less.
const PREVIEWED_PERCENT: f64 = 25.0;

/// Pixels of a frame, along an edge, per pixel of its preview, at least.
const PREVIEW_EDGE: u32 = 4;

/// Pixels of a preview at most, so that it takes no longer for a large window: 65,536 paths with
/// the four samples of a window.
const MAX_PREVIEW_PIXELS: u32 = 1 << 14;

/// The size in pixels of the preview of a frame; `None` where enough is known. A pose that has a
/// reference is not previewed again.
pub(super) fn preview_size(
    tracer: &Tracer,
    cache: &ReferenceCache,
    camera: &Camera,
    size: [u32; 2],
) -> Option<[u32; 2]> {
    if cache.entries().iter().any(|entry| entry.frame.camera == *camera) {
        return None;
    }
    let view = View::new(camera, &tracer.scene().frame, size);
    let lookup = LookupSet::new(cache, tracer.epoch());
    let is_unknown = open_percent(tracer, &view, &lookup, None) >= PREVIEWED_PERCENT;
    let too_large = view.pixel_count() as f64 / f64::from(MAX_PREVIEW_PIXELS);
    let edge = PREVIEW_EDGE.max(too_large.sqrt().ceil() as u32);
    is_unknown.then(|| size.map(|pixels| pixels.div_ceil(edge)))
}
