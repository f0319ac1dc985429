//! When a view is lit coarsely before its first frame, so that a window shows coarse light instead
//! of noise.

use crate::camera::{Camera, View};
use crate::lookup::{LookupSet, open_percent};
use crate::reference::ReferenceCache;
use crate::trace::Tracer;

/// A view is previewed where at least this share of its pixels, in percent, has no known light.
const PREVIEWED_PERCENT: f64 = 25.0;

/// Pixels of a frame, along an edge, per pixel of its preview.
const PREVIEW_EDGE: u32 = 4;

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
    is_unknown.then(|| size.map(|edge| edge.div_ceil(PREVIEW_EDGE)))
}
