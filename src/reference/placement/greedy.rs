//! Of some poses around the predicted way the one whose reference shows most of what will be open, per cost of tracing it.
//!
//! Sources: Fleishman, Cohen-Or and Lischinski, "Automatic Camera Placement for Image-Based Modeling" (2000): cameras are
//! chosen one by one, each for the most of what those before it do not show. Among sets of poses of equal cost such a
//! choice covers at least 1 - 1/e = 63 % of what the best set of as many does (Nemhauser, Wolsey and Fisher 1978).
//! We differ: what is to be covered is what the next frames will see, not all surfaces, so that the choice can be made
//! between two frames.

use super::{OpenSpot, PlacementRule, SPARSE_WORTH_PERCENT, Situation};
use crate::camera::{Camera, View};
use crate::math::Ray;
use crate::reference::placement::extrapolate::{ahead, moved};
use glam::Vec3;
use rayon::prelude::*;

/// See the module.
pub const GREEDY: PlacementRule = PlacementRule {
    name: "greedy",
    about: "where most of what is unknown ahead is seen",
    has_threshold: true,
    poses_ahead: PlacementRule::none_ahead,
    decide,
    keeps: |lit_percent, percent| lit_percent > percent.min(SPARSE_WORTH_PERCENT),
};

/// The frames whose open pixels are to be covered, counted from now.
const TARGET_FRAMES: [f64; 3] = [1.0, 4.0, 8.0];

/// How far ahead candidates stand, in frames.
const CANDIDATE_FRAMES: [f64; 4] = [0.0, 2.0, 4.0, 8.0];

/// How far candidates are turned from the predicted direction, as shares of the vertical field of view.
const CANDIDATE_TURNS: [f64; 3] = [0.0, -0.5, 0.5];

/// How far behind the predicted eye candidates step back, as a share of the depth they look at: a wider picture.
const STEP_BACK: f64 = 0.15;

/// What seeing a pixel and looking its light up costs, as a share of lighting it: 0.1 us against 2.4.
const SEEING_COST: f64 = 0.04;

/// A point is seen from a candidate where nothing stands within this share of the way to it.
const SEEN_SHARE: f32 = 0.99;

/// A surface point that a frame ahead will have to light itself.
struct OpenPoint {
    position: Vec3,
    /// From the eye that will see it, along the ray, scene units.
    distance: f32,
    /// Of the pixels of the frames ahead, on average.
    percent: f64,
}

fn decide(now: &mut Situation<'_>) -> Option<Camera> {
    let (seen, worth) = (now.seen, now.seen.worth_percent(now.percent));
    if !seen.is_sparse && seen.open_percent <= now.percent {
        return None;
    }
    // The next frames would be cut there as well.
    if seen.is_sparse && seen.was_cut && seen.open_percent > worth {
        return Some(seen.camera);
    }
    let points = open_points(now);
    if points.iter().map(|p| p.percent).sum::<f64>() <= worth {
        return None;
    }
    let mut best: Option<(f64, Camera)> = None;
    for candidate in candidates(now) {
        let covered = covered_percent(now, &points, &candidate);
        if covered <= worth {
            continue;
        }
        let value = covered / cost(now, &candidate);
        if best.is_none_or(|(most, _)| value > most) {
            best = Some((value, candidate));
        }
    }
    best.map(|(_, camera)| camera)
}

/// What tracing a reference takes, as a share of lighting all of its pixels.
fn cost(now: &mut Situation<'_>, candidate: &Camera) -> f64 {
    match now.seen.is_sparse {
        true => SEEING_COST + (now.foresee)(candidate, None) / 100.0,
        false => 1.0,
    }
}

fn candidates(now: &Situation<'_>) -> Vec<Camera> {
    let mut found: Vec<Camera> = Vec::new();
    for frames in CANDIDATE_FRAMES {
        let on_the_way = ahead(now.seen, now.tracer, frames);
        for turn in CANDIDATE_TURNS {
            let turned = Camera { yaw: on_the_way.yaw + turn * on_the_way.fov_y, ..on_the_way };
            if !found.contains(&turned) {
                found.push(turned);
            }
        }
    }
    let back = stepped_back(now);
    found.extend(back);
    found
}

/// The present pose a step further back, where there is room.
fn stepped_back(now: &Situation<'_>) -> Option<Camera> {
    let camera = now.seen.camera;
    let frame = &now.tracer.scene().frame;
    let eye = frame.scene_from_world_f64(camera.eye).as_vec3();
    let forward = camera.forward();
    let hit = now.tracer.closest(&Ray::new(eye, forward.as_vec3()))?;
    let depth_m = f64::from(hit.t) / frame.units_per_metre;
    let eye = moved(now.tracer, camera.eye, -forward * depth_m * STEP_BACK);
    Some(Camera { eye, ..camera })
}

/// What the next frames will have to light.
fn open_points(now: &mut Situation<'_>) -> Vec<OpenPoint> {
    let (mut points, mut spots) = (Vec::new(), Vec::new());
    for frames in TARGET_FRAMES {
        let target = ahead(now.seen, now.tracer, frames);
        spots.clear();
        (now.foresee)(&target, Some(&mut spots));
        let view = View::new(&target, &now.tracer.scene().frame, now.size);
        points.extend(spots.iter().filter_map(|spot| open_point(now, &view, spot)));
    }
    points
}

fn open_point(now: &Situation<'_>, view: &View, spot: &OpenSpot) -> Option<OpenPoint> {
    let ray = Ray::new(view.eye, view.direction_of_point(spot.point.x, spot.point.y));
    let hit = now.tracer.closest(&ray)?;
    let way = ray.direction * hit.t;
    let percent = spot.percent / TARGET_FRAMES.len() as f64;
    Some(OpenPoint { position: view.eye + way, distance: way.length(), percent })
}

/// How much of the open pixels a reference would serve: those it sees, fewer where it sees them from further away.
fn covered_percent(now: &Situation<'_>, points: &[OpenPoint], candidate: &Camera) -> f64 {
    let view = View::new(candidate, &now.tracer.scene().frame, now.size);
    let covered = |point: &OpenPoint| {
        let way = point.position - view.eye;
        if !is_in_picture(&view, way) {
            return 0.0;
        }
        let ray = Ray { origin: view.eye, direction: way, t_max: SEEN_SHARE };
        if now.tracer.closest(&ray).is_some() {
            return 0.0;
        }
        let finer = f64::from(point.distance / way.length());
        point.percent * (finer * finer).min(1.0)
    };
    // Collected before it is added up: the same bits at any number of threads.
    points.par_iter().map(covered).collect::<Vec<f64>>().iter().sum()
}

/// True where a direction in scene space leads through the picture.
fn is_in_picture(view: &View, way: Vec3) -> bool {
    let [right, down, forward] = view.scene_from_camera.transpose().mul_vec3(way).to_array();
    let tan_y = view.tan_half_fov_y;
    let tan_x = tan_y * view.size[0] as f32 / view.size[1].max(1) as f32;
    forward > 0.0 && right.abs() <= tan_x * forward && down.abs() <= tan_y * forward
}
