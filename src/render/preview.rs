//! When a view is lit coarsely before its first frame, so that a window shows coarse light instead
//! of noise.

use super::frame::Frame;
use crate::camera::{Camera, SceneFrame, View};
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

/// The part of the mean depth of a frame, and of its field of view, by which the eye may move and
/// turn until the next frame shows something else.
const CONTINUED: f64 = 0.5;

/// A mean over a frame reads one pixel in this many.
const MEAN_STEP: usize = 61;

/// True where a frame shows most of what is seen from another pose: light that it knows is carried
/// on, and a preview would only delay the next frame.
pub(super) fn is_continued(frame: &Frame, camera: &Camera, scene: &SceneFrame) -> bool {
    let depths = frame.disparity.iter().step_by(MEAN_STEP);
    let (sum, count) = depths.fold((0.0, 0u32), |(sum, n), &d| (sum + f64::from(d), n + 1));
    let moved = camera.eye.distance(frame.camera.eye) * scene.units_per_metre * sum / f64::from(count.max(1));
    let turned = camera.forward().angle_between(frame.camera.forward());
    let is_elsewhere = *camera != frame.camera && count > 0;
    is_elsewhere && moved < CONTINUED && turned < CONTINUED * camera.fov_y
}

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

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn a_step_continues_a_frame_and_a_jump_does_not() {
        let scene = SceneFrame { origin_in_world_m: DVec3::ZERO, units_per_metre: 2.0 };
        let camera = Camera::look_at(DVec3::ZERO, DVec3::NEG_Z, 60.0);
        // Everything is ten metres away.
        let frame = Frame { camera, disparity: vec![1.0 / 20.0; 500], ..Frame::default() };
        let moved = |metres: f64| Camera { eye: DVec3::X * metres, ..camera };
        let turned = |yaw: f64| Camera { yaw, ..camera };
        assert!(is_continued(&frame, &moved(0.5), &scene) && is_continued(&frame, &turned(0.3), &scene));
        assert!(!is_continued(&frame, &moved(6.0), &scene) && !is_continued(&frame, &turned(0.7), &scene));
        assert!(!is_continued(&frame, &camera, &scene), "the same view again is not motion");
        assert!(!is_continued(&Frame::default(), &moved(0.5), &scene));
    }
}
