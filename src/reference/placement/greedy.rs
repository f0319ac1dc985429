//! Rule `greedy`: of several poses around the extrapolated path, the one whose reference covers
//! most of the pixels that will be open, relative to the cost of tracing it.
//!
//! Sources: Fleishman, Cohen-Or and Lischinski, "Automatic Camera Placement for Image-Based
//! Modeling" (2000): cameras are chosen one by one, each for the largest part of the scene that
//! those before it do not cover. Such a choice covers at least 1 - 1/e = 63 % of what the best set
//! of equal size covers (Nemhauser, Wolsey and Fisher 1978). We differ: we cover what the next
//! frames will see instead of all surfaces, so that the choice can be made between two frames.

use super::extrapolate::{moved_freely, pose_after};
use super::rule::{MIN_OPEN_PERCENT_SPARSE, OpenSpot, PlacementRule, Situation};
use crate::camera::{Camera, View};
use crate::math::Ray;
use glam::Vec3;
use rayon::prelude::*;

/// Rule that places a reference where it covers most of the open pixels of the next frames.
pub const GREEDY: PlacementRule = PlacementRule {
    name: "greedy",
    about: "where most open pixels of the next frames are visible",
    has_threshold: true,
    prefetch_poses: PlacementRule::no_prefetch,
    decide,
    keeps_frame: |lit_percent, percent| lit_percent > percent.min(MIN_OPEN_PERCENT_SPARSE),
};

/// Frames whose open pixels are to be covered, counted from now.
const TARGET_FRAMES: [f64; 3] = [1.0, 4.0, 8.0];

/// Numbers of frames that candidate poses are extrapolated by.
const CANDIDATE_FRAMES: [f64; 4] = [0.0, 2.0, 4.0, 8.0];

/// Turns of candidates from the extrapolated direction, as shares of the vertical field of view.
const CANDIDATE_TURNS: [f64; 3] = [0.0, -0.5, 0.5];

/// Distance that a candidate steps back from the present eye, as a share of the depth at the
/// picture's centre. Its picture shows more.
const STEP_BACK: f64 = 0.15;

/// Cost of finding and looking up a pixel, as a share of lighting it: 0.1 us against 2.4 us.
const LOOKUP_COST: f64 = 0.04;

/// Share of the way to a point that must be free for the point to count as visible, 0..1.
const VISIBLE_SHARE: f32 = 0.99;

/// A surface point that one of the next frames will have to light.
struct OpenPoint {
    /// Position in scene space.
    position: Vec3,
    /// Distance from the eye that will see it, scene units.
    distance: f32,
    /// Area in percent of the picture, averaged over the target frames.
    percent: f64,
}

fn decide(now: &mut Situation<'_>) -> Option<Camera> {
    if now.is_covered() {
        return None;
    }
    if now.needs_reference_here() {
        return Some(now.seen.camera);
    }
    let worthwhile = now.seen.worthwhile_percent(now.percent);
    let points = open_points(now);
    if points.iter().map(|p| p.percent).sum::<f64>() <= worthwhile {
        return None;
    }
    let mut best: Option<(f64, Camera)> = None;
    for candidate in candidates(now) {
        let covered = covered_percent(now, &points, &candidate);
        if covered <= worthwhile {
            continue;
        }
        let value = covered / cost(now, &candidate);
        if best.is_none_or(|(most, _)| value > most) {
            best = Some((value, candidate));
        }
    }
    best.map(|(_, camera)| camera)
}

/// Returns the cost of tracing a reference, relative to lighting all of its pixels.
fn cost(now: &mut Situation<'_>, candidate: &Camera) -> f64 {
    match now.seen.is_sparse {
        true => LOOKUP_COST + (now.predict_open)(candidate, None) / 100.0,
        false => 1.0,
    }
}

/// Returns the poses to choose from: on the extrapolated path, straight and turned, and stepped
/// back.
fn candidates(now: &Situation<'_>) -> Vec<Camera> {
    let mut found: Vec<Camera> = Vec::new();
    for frames in CANDIDATE_FRAMES {
        let extrapolated = pose_after(now.seen, now.tracer, frames);
        for turn in CANDIDATE_TURNS {
            let turned = Camera { yaw: extrapolated.yaw + turn * extrapolated.fov_y, ..extrapolated };
            if !found.contains(&turned) {
                found.push(turned);
            }
        }
    }
    let back = stepped_back(now);
    found.extend(back);
    found
}

/// Returns the present pose moved backwards by [`STEP_BACK`], or as far as there is room. `None` if
/// the camera looks into the open.
fn stepped_back(now: &Situation<'_>) -> Option<Camera> {
    let camera = now.seen.camera;
    let frame = &now.tracer.scene().frame;
    let eye = frame.scene_from_world_f64(camera.eye).as_vec3();
    let forward = camera.forward();
    let hit = now.tracer.closest(&Ray::new(eye, forward.as_vec3()))?;
    let depth_m = f64::from(hit.t) / frame.units_per_metre;
    let eye = moved_freely(now.tracer, camera.eye, -forward * depth_m * STEP_BACK);
    Some(Camera { eye, ..camera })
}

/// Returns the surface points that the target frames will have to light.
fn open_points(now: &mut Situation<'_>) -> Vec<OpenPoint> {
    let (mut points, mut spots) = (Vec::new(), Vec::new());
    for frames in TARGET_FRAMES {
        let target = pose_after(now.seen, now.tracer, frames);
        spots.clear();
        (now.predict_open)(&target, Some(&mut spots));
        let view = View::new(&target, &now.tracer.scene().frame, now.size);
        points.extend(spots.iter().filter_map(|spot| open_point(now, &view, spot)));
    }
    points
}

/// Returns the surface point seen at an open spot of a view; `None` for the sky.
fn open_point(now: &Situation<'_>, view: &View, spot: &OpenSpot) -> Option<OpenPoint> {
    let ray = Ray::new(view.eye, view.direction_of_point(spot.point.x, spot.point.y));
    let hit = now.tracer.closest(&ray)?;
    let way = ray.direction * hit.t;
    let percent = spot.percent / TARGET_FRAMES.len() as f64;
    Some(OpenPoint { position: view.eye + way, distance: way.length(), percent })
}

/// Returns the open pixels, in percent, that a reference at `candidate` covers. Points that it sees
/// from farther away than the target frame count less, by the square of the ratio of the distances.
fn covered_percent(now: &Situation<'_>, points: &[OpenPoint], candidate: &Camera) -> f64 {
    let view = View::new(candidate, &now.tracer.scene().frame, now.size);
    let covered = |point: &OpenPoint| {
        let way = point.position - view.eye;
        if !is_in_picture(&view, way) {
            return 0.0;
        }
        let ray = Ray { origin: view.eye, direction: way, t_max: VISIBLE_SHARE };
        if now.tracer.closest(&ray).is_some() {
            return 0.0;
        }
        let finer = f64::from(point.distance / way.length());
        point.percent * (finer * finer).min(1.0)
    };
    // Collected before the sum, so that it has the same bits at any number of threads.
    points.par_iter().map(covered).collect::<Vec<f64>>().iter().sum()
}

/// Returns true if a direction in scene space passes through the picture of a view.
fn is_in_picture(view: &View, way: Vec3) -> bool {
    let [right, down, forward] = view.scene_from_camera.transpose().mul_vec3(way).to_array();
    let tan_y = view.tan_half_fov_y;
    let tan_x = tan_y * view.size[0] as f32 / view.size[1].max(1) as f32;
    forward > 0.0 && right.abs() <= tan_x * forward && down.abs() <= tan_y * forward
}
