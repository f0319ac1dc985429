//! Sections through real models against the same models cut beforehand, where they are present.

use super::{TONES, below};
use afterimage::import::{ImportOptions, load};
use afterimage::math::Ray;
use afterimage::trace::Bvh;
use afterimage::{Camera, Scene, Tracer, View};
use glam::{DVec3, Vec3};
use std::path::Path;
use std::sync::Arc;

const SIZE: [u32; 2] = [256, 192];

/// Models all of whose surfaces are closed.
const CLOSED: [&str; 3] = ["fzk_haus/fzk_haus.obj", "fzk_haus/fzk_haus_doors.obj", "office/office_doors.obj"];

fn closed_models() -> Vec<Scene> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/scenes");
    let files = CLOSED.map(|name| folder.join(name));
    let there = files.iter().filter(|file| file.is_file());
    there.map(|file| load(file, &ImportOptions::default(), &|_, _| true).unwrap()).collect()
}

/// The triangles of a scene without what lies above a plane across an axis, scene space.
fn cut_beforehand(scene: &Scene, axis: usize, at: f32) -> Vec<[Vec3; 3]> {
    let mut kept = Vec::new();
    for triangle in 0..scene.triangles.len() as u32 {
        let corners = scene.corners(triangle);
        let mut polygon: Vec<Vec3> = Vec::new();
        for k in 0..3 {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            let (u, v) = (at - a[axis], at - b[axis]);
            if u >= 0.0 {
                polygon.push(a);
            }
            if (u > 0.0 && v < 0.0) || (u < 0.0 && v > 0.0) {
                polygon.push(a + (b - a) * (u / (u - v)));
            }
        }
        kept.extend((2..polygon.len()).map(|k| [polygon[0], polygon[k - 1], polygon[k]]));
    }
    kept
}

/// Depth along a ray in the model cut beforehand: that of the plane where the ray enters between
/// faces whose crossings do not cancel, and otherwise of the nearest face.
fn depth_of_cut(bvh: &Bvh, corners: &[[Vec3; 3]], ray: &Ray, enters: f32) -> f32 {
    let (mut nearest, mut depth) = (f32::INFINITY, 0);
    bvh.any(ray, |hit| {
        let [a, b, c] = corners[hit.triangle as usize];
        nearest = nearest.min(hit.t);
        depth += if (b - a).cross(c - a).dot(ray.direction) > 0.0 { 1 } else { -1 };
        false
    });
    if depth > 0 && enters > 0.0 { enters } else { nearest }
}

/// What the rays of a picture see, counted.
#[derive(Default)]
struct Counts {
    /// Depth differs from that of the model cut beforehand.
    differ: u32,
    /// Something of the model is there.
    seen: u32,
    /// A cap is there.
    capped: u32,
    /// A ray looks into a body, past a cap that is missing.
    open: u32,
}

/// Compares a section through part (0..1) of a scene's building with the model cut beforehand.
fn compare(tracer: &Tracer, axis: usize, part: f64) -> Counts {
    let scene = tracer.scene();
    let [low, high] = scene.building_m;
    let mut plane = scene.frame.origin_in_world_m;
    plane[axis] = low[axis] + (high - low)[axis] * part;
    let cut = tracer.with_section(&[below(axis, plane[axis])], TONES);
    let at = scene.frame.scene_from_world_f64(plane)[axis] as f32;
    let corners = cut_beforehand(scene, axis, at);
    let bvh = Bvh::build(&corners);
    let size = (high - low).length();
    let mut aside = DVec3::new(0.23, 0.31, 0.17) * size;
    aside[axis] = size;
    let middle = (low + high) / 2.0;
    let view = View::new(&Camera::look_at(middle + aside, middle, 45.0), &scene.frame, SIZE);
    let mut counts = Counts::default();
    for pixel in 0..view.pixel_count() as u32 {
        let ray = Tracer::primary_ray(&view, pixel);
        let enters = (at - ray.origin[axis]) / ray.direction[axis];
        let (hit, cap) = (cut.closest_seen(&ray), cut.cap(&ray));
        let depth = hit.map(|hit| hit.t).or(cap.map(|cap| cap.t)).unwrap_or(f32::INFINITY);
        let truth = depth_of_cut(&bvh, &corners, &ray, enters);
        let is_far = (depth / truth - 1.0).abs() > 0.01 || depth.is_finite() != truth.is_finite();
        let is_open = hit.is_some_and(|hit| {
            let [a, b, c] = scene.corners(hit.triangle);
            (b - a).cross(c - a).dot(ray.direction) > 0.0
        });
        counts.differ += u32::from(depth != truth && is_far);
        counts.seen += u32::from(truth.is_finite());
        counts.capped += u32::from(cap.is_some());
        counts.open += u32::from(is_open);
    }
    counts
}

/// Fewer than 0.1 % of camera rays differ in depth by more than 1 %, and no ray looks into a body:
/// its caps are closed.
#[test]
fn sections_of_closed_models_are_those_of_models_cut_beforehand() {
    for scene in closed_models() {
        let tracer = Tracer::new(Arc::new(scene));
        let name = &tracer.scene().name;
        let mut most = 0;
        for (axis, part) in [(0, 0.37), (1, 0.41), (2, 0.63)] {
            let Counts { differ, seen, capped, open } = compare(&tracer, axis, part);
            eprintln!("{name} axis {axis}: {differ} differ, {open} open, {capped} capped of {seen}");
            assert!(
                seen > 500 && differ * 1000 < SIZE[0] * SIZE[1],
                "{name}, axis {axis}: {differ} of {seen}"
            );
            assert!(open * 1000 < SIZE[0] * SIZE[1], "{name}, axis {axis}: {open} open");
            most = most.max(capped);
        }
        assert!(most > 0, "{name}: {most} pixels show caps");
    }
}
