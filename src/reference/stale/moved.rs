//! Which light objects that moved, came or went can change.

use super::changed_lights::ChangedLights;
use super::mark::{MAX_CHANGE, Mark, SAFETY, was_black};
use super::places::Places;
use super::shaft::{Bounds, Shaft, bounds_of};
use super::transport::{MAX_BOXES, TransportDifference};
use crate::math::key::Key;
use crate::reference::{Directory, ReferenceFrame};
use crate::scene::content::{ContentHash, MaterialContent, materials_of_both};
use crate::scene::{Light, Scene};
use crate::trace::{NO_TRIANGLE, RayCounts, SurfacePoint, TILE_SIDE, TraceSettings, Tracer, parallel::Stop};
use glam::Vec3;
use rayon::prelude::*;

/// Shadow rays by which a lamp is found to reach a point.
const SAMPLES: u32 = 16;

/// Objects that moved: boxes around where they were and where they are, scene space.
#[derive(Debug)]
pub(crate) struct Moved {
    boxes: Vec<Bounds>,
    /// True where a mirror is among them. What it reflects of lamps is concentrated, and samples
    /// miss it.
    has_mirror: bool,
}

/// What is known about the light that some references hold.
struct Known<'a> {
    states: [&'a Tracer; 2],
    /// The number of a triangle in the second state; [`NO_TRIANGLE`] of one that is gone.
    number: &'a (dyn Fn(u32) -> u32 + Sync),
    lights: ChangedLights<'a>,
    /// The doubt about smooth light; `None` where nothing is known about it.
    places: Option<Places<'a>>,
}

impl Moved {
    /// Encloses triangles that are gone from one scene, and those that another has in addition.
    pub(super) fn new(gone: (&Scene, &[u32]), added: (&Scene, &[u32])) -> Self {
        let corners = |(scene, triangles): (&Scene, &[u32])| -> Vec<[Vec3; 3]> {
            triangles.iter().map(|&triangle| scene.corners(triangle)).collect()
        };
        let is_mirror = |(scene, triangles): (&Scene, &[u32])| {
            triangles.iter().any(|&triangle| scene.material_of(triangle).is_mirror())
        };
        let has_mirror = is_mirror(gone) || is_mirror(added);
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
        let boxes = parts.into_iter().map(|part| bounds_of(part.into_iter().flatten())).collect();
        Self { boxes, has_mirror }
    }

    /// Encloses the triangles of a scene through which light passes otherwise than in another state
    /// of it: for shadow rays, panes that become opaque have come.
    pub(super) fn by_transmission(old: &Scene, new: &Scene) -> Self {
        let materials = materials_of_both([old, new]);
        let changed = changed_transmission([old, new], &materials);
        let moved = Self::new((old, &changed), (new, &[]));
        let mirrors = |of: usize| -> Vec<ContentHash> {
            let scene = [old, new][of];
            let kinds = scene.materials.iter().zip(&materials[of]);
            kinds.filter(|(m, _)| m.is_mirror()).map(|(_, content)| content.reflection).collect()
        };
        // Other mirrors may have changed as well.
        Self { has_mirror: moved.has_mirror || mirrors(0) != mirrors(1), ..moved }
    }

    /// Marks the pixels of references, whose triangles still have their numbers of before. `states`
    /// are the one that their light was traced in, and the same with the surfaces of now; `number`
    /// is the number in the second of a triangle, [`NO_TRIANGLE`] of one that is gone. Direct light
    /// holds where no lamp that reaches the pixel, before or now, shines past what moved.
    pub(crate) fn marks(
        &self,
        frames: &[&ReferenceFrame],
        states: [&Tracer; 2],
        directory: &Directory,
        number: &(dyn Fn(u32) -> u32 + Sync),
        stop: Stop<'_>,
    ) -> Vec<Vec<Mark>> {
        let bounces = frames.iter().map(|frame| frame.settings.bounces).max().unwrap_or(0);
        let places = frames.first().filter(|_| !self.has_mirror || bounces == 0).map(|first| {
            let settings = TraceSettings { bounces, ..first.settings };
            let difference = TransportDifference::new(states, &self.boxes, &settings);
            Places::new(&difference, (states[0], directory), frames, stop)
        });
        let lights = ChangedLights::between(states.map(|state| &**state.scene()));
        let known = Known { states, number, lights, places };
        frames.iter().map(|frame| self.marks_of_frame(frame, &known)).collect()
    }

    fn marks_of_frame(&self, frame: &ReferenceFrame, known: &Known<'_>) -> Vec<Mark> {
        let [width, height] = frame.view.size;
        let side = TILE_SIDE as u32;
        let mut marks = vec![Mark::Holds; frame.view.pixel_count()];
        let rows = marks.par_chunks_mut((width * side) as usize).zip((0..height).into_par_iter().step_by(8));
        rows.for_each(|(marks, y0)| {
            for x0 in (0..width).step_by(TILE_SIDE) {
                let columns = x0..(x0 + side).min(width);
                let pixels = (y0..(y0 + side).min(height))
                    .flat_map(|y| columns.clone().map(move |x| y * width + x))
                    .filter(|&pixel| frame.was_lit(pixel) && frame.triangle()[pixel as usize] != NO_TRIANGLE);
                let pixels: Vec<(u32, Vec3)> =
                    pixels.map(|pixel| (pixel, frame.view.eye + frame.offset_from_eye(pixel))).collect();
                let near = self.lights_past(bounds_of(pixels.iter().map(|p| p.1)), known);
                for (pixel, position) in pixels {
                    let is_gone = (known.number)(frame.triangle()[pixel as usize]) == NO_TRIANGLE;
                    let is_stale = is_gone || self.changes_direct(frame, (pixel, position), &near, known);
                    marks[(pixel - y0 * width) as usize] =
                        if is_stale { Mark::Stale } else { known.smooth_mark(frame, pixel) };
                }
            }
        });
        marks
    }

    /// True where direct light may have changed at a pixel: a light that reaches it came or went,
    /// or one of those near may shine past what moved.
    fn changes_direct(
        &self,
        frame: &ReferenceFrame,
        (pixel, position): (u32, Vec3),
        near: &[&Light],
        known: &Known<'_>,
    ) -> bool {
        let reaches =
            |light: &Light, states: &[&Tracer]| reaches(light, (frame, pixel), known.states[0], states);
        let past = |light: &Light| self.is_between([position; 2], light, known.states[0]);
        near.iter().any(|light| past(light) && reaches(light, &known.states))
            || (0..2).any(|state| {
                known.lights.only[state].iter().any(|l| reaches(l, &known.states[state..=state]))
            })
    }

    /// The lights of both states that may shine into a box past what moved.
    fn lights_past<'l>(&self, place: Bounds, known: &Known<'l>) -> Vec<&'l Light> {
        let is_past =
            |light: &&Light| place[0].x <= place[1].x && self.is_between(place, light, known.states[0]);
        known.lights.both.iter().copied().filter(is_past).collect()
    }

    /// False only where nothing that moved lies between a box and a light.
    fn is_between(&self, place: Bounds, light: &Light, tracer: &Tracer) -> bool {
        let Some(light) = bounds_of_light(light, place, tracer.scene()) else {
            return !self.boxes.is_empty();
        };
        let shaft = Shaft::new(place, light);
        self.boxes.iter().any(|&moved| shaft.meets(moved))
    }
}

impl Known<'_> {
    /// What holds of the light of a pixel whose direct light does. Without bounces, light of the
    /// sky is part of that.
    fn smooth_mark(&self, frame: &ReferenceFrame, pixel: u32) -> Mark {
        let other = if frame.settings.bounces > 0 { Mark::DirectHolds } else { Mark::Stale };
        let Some(places) = &self.places else { return other };
        let Some(doubt) = places.doubt(self.states[0], frame, pixel) else { return Mark::Holds };
        let light = frame.traced_light(pixel).max_element();
        // No ray was traced for black surfaces.
        let triangle = frame.triangle()[pixel as usize];
        let [before, now] = self.states.map(|state| &**state.scene());
        if light == 0.0 && was_black([(before, triangle), (now, (self.number)(triangle))]) {
            return Mark::Stale;
        }
        if doubt.smooth <= frame.share_of_change() * SAFETY * MAX_CHANGE * light {
            Mark::Holds
        } else {
            other
        }
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

/// True where a light reaches what a pixel shows in one of some states. The pixel's triangle has
/// its number in `old`.
fn reaches(light: &Light, (frame, pixel): (&ReferenceFrame, u32), old: &Tracer, states: &[&Tracer]) -> bool {
    let ray = Tracer::primary_ray(&frame.view, pixel);
    let hit = old.hit_on_triangle(&ray, frame.triangle()[pixel as usize]);
    let Some(hit) = hit else { return true };
    let point: SurfacePoint = old.surface(&ray, &hit).as_stored();
    let shift = Key::of_pixel(frame.settings.seed, pixel).pair();
    let mut rays = RayCounts::default();
    states
        .iter()
        .any(|state| state.irradiance_of_light(light, &point, SAMPLES, shift, &mut rays) != Vec3::ZERO)
}

/// The triangles that let light pass otherwise in one of two states of a geometry than in the
/// other.
fn changed_transmission(states: [&Scene; 2], materials: &[Vec<MaterialContent>; 2]) -> Vec<u32> {
    let passes = |state: usize, triangle: u32| {
        materials[state][states[state].triangle_materials[triangle as usize].0 as usize].transmission
    };
    let triangles = (0..states[1].triangles.len() as u32).into_par_iter();
    triangles.filter(|&triangle| passes(0, triangle) != passes(1, triangle)).collect()
}

/// True where direct light is the same everywhere in two states of a scene. Without bounces, light
/// of the sky is part of it.
pub(crate) fn keeps_direct_light(states: [&Scene; 2], has_bounces: bool) -> bool {
    states[0].has_same_geometry(states[1])
        && (has_bounces || states[0].sky == states[1].sky)
        && ChangedLights::between(states).only.iter().all(Vec::is_empty)
        && changed_transmission(states, &materials_of_both(states)).is_empty()
}
