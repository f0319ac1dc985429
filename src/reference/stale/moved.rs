//! Which direct light objects that moved, came or went can change.

use super::mark::Mark;
use super::shaft::{Bounds, Shaft, bounds_of};
use crate::math::key::Key;
use crate::reference::ReferenceFrame;
use crate::scene::{Light, Scene};
use crate::trace::{NO_TRIANGLE, RayCounts, SurfacePoint, TILE_SIDE, Tracer};
use glam::Vec3;
use rayon::prelude::*;

/// Boxes at most around what moved.
const MAX_BOXES: usize = 16;

/// Shadow rays by which a lamp is found to reach a point.
const SAMPLES: u32 = 16;

/// Objects that moved: boxes around where they were and where they are, scene space.
#[derive(Debug)]
pub(crate) struct Moved {
    boxes: Vec<Bounds>,
}

impl Moved {
    /// Encloses triangles that are gone from one scene, and those that another has in addition.
    pub(super) fn new(gone: (&Scene, &[u32]), added: (&Scene, &[u32])) -> Self {
        let corners = |(scene, triangles): (&Scene, &[u32])| -> Vec<[Vec3; 3]> {
            triangles.iter().map(|&triangle| scene.corners(triangle)).collect()
        };
        let mut parts = vec![corners(gone), corners(added)];
        parts.retain(|part| !part.is_empty());
        while parts.len() < MAX_BOXES {
            let size = |part: &Vec<[Vec3; 3]>| {
                let [low, high] = bounds_of(part.iter().flatten().copied());
                if part.len() > 1 { low.distance(high) } else { 0.0 }
            };
            let largest = (0..parts.len()).max_by(|&a, &b| size(&parts[a]).total_cmp(&size(&parts[b])));
            let Some(largest) = largest.filter(|&at| size(&parts[at]) > 0.0) else { break };
            let halves = halved(parts.swap_remove(largest));
            parts.extend(halves);
        }
        Self { boxes: parts.into_iter().map(|part| bounds_of(part.into_iter().flatten())).collect() }
    }

    /// Marks the pixels of a reference, whose triangles still have their numbers of before. Direct
    /// light holds where no lamp that reaches the pixel, before or now, shines past what moved. Of
    /// smooth light nothing is known.
    pub(crate) fn marks(
        &self,
        frame: &ReferenceFrame,
        lights: &[Light],
        tracers: [&Tracer; 2],
        gone: impl Fn(u32) -> bool + Sync,
    ) -> Vec<Mark> {
        let [width, height] = frame.view.size;
        let side = TILE_SIDE as u32;
        let kept = if frame.settings.bounces > 0 { Mark::DirectHolds } else { Mark::Holds };
        let mut marks = vec![kept; frame.view.pixel_count()];
        let rows = marks.par_chunks_mut((width * side) as usize).zip((0..height).into_par_iter().step_by(8));
        rows.for_each(|(marks, y0)| {
            for x0 in (0..width).step_by(TILE_SIDE) {
                let columns = x0..(x0 + side).min(width);
                let pixels = (y0..(y0 + side).min(height))
                    .flat_map(|y| columns.clone().map(move |x| y * width + x))
                    .filter(|&pixel| frame.was_lit(pixel) && frame.triangle()[pixel as usize] != NO_TRIANGLE);
                let pixels: Vec<(u32, Vec3)> =
                    pixels.map(|pixel| (pixel, frame.view.eye + frame.offset_from_eye(pixel))).collect();
                let near = self.lights_past(bounds_of(pixels.iter().map(|p| p.1)), lights, frame, tracers[0]);
                for (pixel, position) in pixels {
                    let is_stale = gone(frame.triangle()[pixel as usize])
                        || near.iter().any(|&light| {
                            self.may_hide(light, position, tracers[0])
                                && reaches(light, frame, pixel, tracers)
                        });
                    if is_stale {
                        marks[(pixel - y0 * width) as usize] = Mark::Stale;
                    }
                }
            }
        });
        marks
    }

    /// The lights that may shine into a box past what moved.
    fn lights_past<'l>(
        &self,
        place: Bounds,
        lights: &'l [Light],
        frame: &ReferenceFrame,
        tracer: &Tracer,
    ) -> Vec<&'l Light> {
        // Paths find the sky where there are any.
        let is_direct = |light: &&Light| frame.settings.bounces == 0 || !matches!(light, Light::Sky);
        let is_past = |light: &&Light| place[0].x <= place[1].x && self.is_between(place, light, tracer);
        lights.iter().filter(is_direct).filter(is_past).collect()
    }

    fn may_hide(&self, light: &Light, position: Vec3, tracer: &Tracer) -> bool {
        self.is_between([position; 2], light, tracer)
    }

    /// False only where nothing that moved lies between a box and a light.
    fn is_between(&self, place: Bounds, light: &Light, tracer: &Tracer) -> bool {
        let Some(light) = bounds_of_light(light, place, tracer.scene()) else { return true };
        let shaft = Shaft::new(place, light);
        self.boxes.iter().any(|&moved| shaft.meets(moved))
    }
}

/// Divides triangles into two halves along the longest edge of their box.
fn halved(mut part: Vec<[Vec3; 3]>) -> [Vec<[Vec3; 3]>; 2] {
    let middle = |triangle: &[Vec3; 3]| (triangle[0] + triangle[1] + triangle[2]) / 3.0;
    let [low, high] = bounds_of(part.iter().map(middle));
    let (axis, half) = ((high - low).max_position(), part.len() / 2);
    part.select_nth_unstable_by(half, |a, b| middle(a)[axis].total_cmp(&middle(b)[axis]));
    let upper = part.split_off(half);
    [part, upper]
}

/// A box around a light as it is seen from a place, far enough away to lie behind the whole scene;
/// `None` for light from all sides.
fn bounds_of_light(light: &Light, place: Bounds, scene: &Scene) -> Option<Bounds> {
    match light {
        Light::Quad { corner, edge_u, edge_v, .. } => {
            let (u, v) = (*edge_u, *edge_v);
            Some(bounds_of([*corner, *corner + u, *corner + v, *corner + u + v]))
        }
        Light::Triangles { corners, .. } => Some(bounds_of(corners.iter().flatten().copied())),
        Light::Point { position, .. } => Some([*position; 2]),
        Light::Sun { direction, cos_angular_radius, .. } => {
            let [low, high] = scene.bounds_m.map(|p| scene.frame.scene_from_world_f64(p).as_vec3());
            let far = 2.0 * low.distance(high);
            let sine = (1.0 - cos_angular_radius * cos_angular_radius).max(0.0).sqrt();
            let spread = Vec3::splat(far * sine / cos_angular_radius.max(0.1));
            Some([place[0] + *direction * far - spread, place[1] + *direction * far + spread])
        }
        Light::Sky | Light::SkySuns => None,
    }
}

/// True where a light reaches what a pixel shows, before or now.
fn reaches(light: &Light, frame: &ReferenceFrame, pixel: u32, tracers: [&Tracer; 2]) -> bool {
    let ray = Tracer::primary_ray(&frame.view, pixel);
    let hit = tracers[0].hit_on_triangle(&ray, frame.triangle()[pixel as usize]);
    let Some(hit) = hit else { return true };
    let point: SurfacePoint = tracers[0].surface(&ray, &hit);
    let shift = Key::of_pixel(frame.settings.seed, pixel).pair();
    let mut rays = RayCounts::default();
    tracers
        .iter()
        .any(|tracer| tracer.irradiance_of_light(light, &point, SAMPLES, shift, &mut rays) != Vec3::ZERO)
}
