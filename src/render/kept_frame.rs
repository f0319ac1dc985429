//! The pixels that a frame shaded itself: kept as a reference, and shown in the smooth light that
//! they share with their neighbours.

use super::{frame::Frame, worklist::WorkList};
use crate::reference::ReferenceFrame;
use crate::trace::{NO_TRIANGLE, PixelTrace, TraceSettings, Tracer};
use glam::Vec3;

/// The pixels that a frame shaded itself with these settings, as a reference for the next frames.
/// The frame must be complete and of a mode that looks up.
pub(super) fn reference(
    tracer: &Tracer,
    trace: &TraceSettings,
    shaded: &WorkList<PixelTrace>,
    frame: &Frame,
) -> ReferenceFrame {
    let depths = frame.disparity.iter().map(|d| 1.0 / d);
    let hits =
        depths.zip(&frame.triangle).map(|(t, &triangle)| (triangle != NO_TRIANGLE).then_some((t, triangle)));
    let lights = shaded.done().map(|(_, traced)| traced.light);
    let (camera, size) = (&frame.camera, frame.view.size);
    ReferenceFrame::from_lit_pixels(tracer, camera, size, trace, hits, shaded.pixels(), lights)
}

/// Shows, in the pixels that a frame shaded itself, the smooth light that a reference of its view
/// and size holds near there, instead of their own.
pub(super) fn show_shared_light(
    tracer: &Tracer,
    reference: &ReferenceFrame,
    shaded: &WorkList<PixelTrace>,
    frame: &mut Frame,
) {
    let view = frame.view;
    for (pixel, traced) in shaded.done() {
        let Some(hit) = traced.hit else { continue };
        let point = tracer.surface(&Tracer::primary_ray(&view, pixel as u32), &hit);
        let Some(shared) = reference.smooth_light_near(tracer, pixel as u32, &point) else { continue };
        let change = tracer.albedo(&hit) * (shared - traced.light.smooth());
        if change.is_finite() {
            let radiance = &mut frame.radiance[pixel];
            *radiance = (*radiance + change).max(Vec3::ZERO);
        }
    }
}
