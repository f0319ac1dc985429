//! The surface and the pixel at a point of the viewport. Points are given right and up from its
//! centre, in -1..1.

use super::Obstacles;
use crate::window::gpu::projection::Projection;
use crate::window::rendering::{PublishedFrame, SeenSection, supplier_byte};
use crate::window::state::{AppState, Inspection, PixelFacts, Snap};
use afterimage::raster::pixel_types::PixelType;
use afterimage::raster::rgb9e5;
use afterimage::reference::ReferenceId;
use afterimage::trace::Probe;
use egui::Rect;
use glam::DVec3;

/// Traces a ray through a point of the viewport.
pub(super) fn probe_at(state: &AppState, obstacles: &Obstacles, [x, y]: [f64; 2]) -> Option<Probe> {
    let fly = &state.navigation.fly;
    let direction = fly.direction_through(x, y, state.aspect());
    let tracer = SeenSection::of(state.section(), obstacles.tracer());
    tracer.probe(fly.camera().eye, direction, f64::INFINITY)
}

/// Returns the point that a measurement at a point of the viewport would use.
pub(super) fn snap_at(state: &AppState, obstacles: &Obstacles, at: [f64; 2], viewport: Rect) -> Option<Snap> {
    let probe = probe_at(state, obstacles, at)?;
    let projection = Projection::new(state.navigation.fly.camera(), viewport);
    Some(projection.snapped(probe.position_m, &corners_m(obstacles, &probe)))
}

/// Returns the surface at a point of the viewport, and its pixel where the newest frame shows this
/// pose.
pub(super) fn inspect(state: &AppState, obstacles: &Obstacles, at: [f64; 2]) -> Option<Inspection> {
    let probe = probe_at(state, obstacles, at)?;
    let camera = state.navigation.fly.camera();
    let frame = state.frame.as_ref().filter(|f| f.camera == *camera);
    Some(Inspection {
        position_m: probe.position_m,
        distance_m: probe.distance_m,
        depth_m: (probe.position_m - camera.eye).dot(camera.forward()),
        normal: probe.normal,
        triangle: probe.triangle,
        corners_m: corners_m(obstacles, &probe),
        material: probe.material,
        object: obstacles.tracer().scene().object_of(probe.triangle).cloned(),
        camera: *camera,
        pixel: frame.and_then(|frame| pixel_facts(frame, at, state.aspect())),
    })
}

/// Corners of the triangle that was hit, in world metres.
fn corners_m(obstacles: &Obstacles, probe: &Probe) -> [DVec3; 3] {
    let scene = obstacles.tracer().scene();
    scene.corners(probe.triangle).map(|p| scene.frame.world_from_scene(p))
}

/// Returns what a frame knows about the pixel at a point of a viewport.
fn pixel_facts(frame: &PublishedFrame, [x, y]: [f64; 2], aspect: f64) -> Option<PixelFacts> {
    let [width, height] = frame.size;
    // The frame has the height of the viewport.
    let from_centre = x * aspect * f64::from(height) / 2.0;
    let column = (f64::from(width) / 2.0 + from_centre).floor();
    let row = ((1.0 - y) / 2.0 * f64::from(height)).floor().clamp(0.0, f64::from(height.max(1) - 1));
    if !(column >= 0.0 && column < f64::from(width)) || height == 0 {
        return None;
    }
    let at = [column as u32, row as u32];
    let pixel = at[1] as usize * width as usize + at[0] as usize;
    let byte = *frame.suppliers.get(pixel)?;
    Some(PixelFacts {
        at,
        kind: pixel_type(*frame.types.get(pixel)?),
        supplier: supplier(frame, byte),
        radiance: rgb9e5::unpack(*frame.radiance.get(pixel)?),
    })
}

fn supplier(frame: &PublishedFrame, byte: u8) -> Option<ReferenceId> {
    frame.references.iter().map(|r| r.id).find(|id| supplier_byte(*id) == byte)
}

/// Returns the type of a number.
fn pixel_type(byte: u8) -> PixelType {
    use PixelType::{Reused, Secondary, Uncertain, Unseen};
    let all = [Unseen, Reused, Secondary, Uncertain];
    all.into_iter().find(|t| *t as u8 == byte).unwrap_or_default()
}
