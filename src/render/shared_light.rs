//! Smooth light that the pixels of a frame share with their neighbours.

use super::{frame::Frame, worklist::WorkList};
use crate::reference::ReferenceFrame;
use crate::trace::{PixelTrace, Tracer};
use glam::Vec3;

/// Shows, in the pixels that a frame shaded itself, the smooth light that a reference of its view
/// and size holds near there, instead of their own.
pub(super) fn show(
    tracer: &Tracer,
    reference: &ReferenceFrame,
    shaded: &WorkList<PixelTrace>,
    frame: &mut Frame,
) {
    let view = frame.view;
    for (pixel, traced) in shaded.done() {
        let Some(hit) = traced.hit else { continue };
        let ray = Tracer::primary_ray(&view, pixel as u32);
        let point = tracer.surface(&ray, &hit);
        let Some(shared) = reference.smooth_light_near(tracer, pixel as u32, &point) else { continue };
        let change = tracer.albedo(&hit, ray.direction) * (shared - traced.light.smooth());
        if change.is_finite() {
            let radiance = &mut frame.radiance[pixel];
            *radiance = (*radiance + change).max(Vec3::ZERO);
        }
    }
}
