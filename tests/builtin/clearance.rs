//! Camera paths keep clear of all geometry, tested against every triangle.

use super::scene;
use afterimage::scene::{Scene, builtin};
use glam::DVec3;
use rayon::prelude::*;

/// Smallest distance of a camera from any triangle, in metres.
const CLEARANCE_M: f64 = 0.3;

fn triangles_in_world(scene: &Scene) -> Vec<[DVec3; 3]> {
    (0..scene.triangles.len() as u32)
        .map(|t| scene.corners(t).map(|p| scene.frame.world_from_scene(p)))
        .collect()
}

/// Returns the point of a triangle closest to `p`.
///
/// Source: Ericson, Real-Time Collision Detection, 5.1.5.
fn closest_on_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> DVec3 {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return a;
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return b;
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        return a + ab * (d1 / (d1 - d3));
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return c;
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        return a + ac * (d2 / (d2 - d6));
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 - d3 >= 0.0 && d5 - d6 >= 0.0 {
        return b + (c - b) * ((d4 - d3) / ((d4 - d3) + (d5 - d6)));
    }
    a + (ab * vb + ac * vc) / (va + vb + vc)
}

/// True if the line segment between two points intersects a triangle.
fn crosses(from: DVec3, to: DVec3, [a, b, c]: [DVec3; 3]) -> bool {
    let (d, e1, e2) = (to - from, b - a, c - a);
    let h = d.cross(e2);
    let det = e1.dot(h);
    if det == 0.0 {
        return false;
    }
    let s = from - a;
    let q = s.cross(e1);
    let (u, v, t) = (s.dot(h) / det, d.dot(q) / det, e2.dot(q) / det);
    u >= 0.0 && v >= 0.0 && u + v <= 1.0 && (0.0..=1.0).contains(&t)
}

/// Returns the distance from a point to the nearest triangle.
fn clearance(eye: DVec3, triangles: &[[DVec3; 3]]) -> f64 {
    let squared = triangles.iter().fold(f64::INFINITY, |nearest, t| {
        let (low, high) = (t[0].min(t[1]).min(t[2]), t[0].max(t[1]).max(t[2]));
        // Skip the triangle if its bounding box is farther away.
        if eye.clamp(low, high).distance_squared(eye) >= nearest {
            return nearest;
        }
        nearest.min(closest_on_triangle(eye, *t).distance_squared(eye))
    });
    squared.sqrt()
}

#[test]
fn camera_paths_keep_clear_of_all_geometry() {
    for name in builtin::NAMES {
        let scene = scene(name);
        let triangles = triangles_in_world(scene);
        let walk = &scene.walk;
        // The galleries are spacious enough for a larger clearance.
        let clearance_m = if name.starts_with("gallery") { 0.5 } else { CLEARANCE_M };
        (0..walk.frames).into_par_iter().for_each(|i| {
            let distance = clearance(walk.camera(i, walk.frames).unwrap().eye, &triangles);
            assert!(distance >= clearance_m, "{name}: {distance:.3} m at frame {i}");
        });
    }
}

#[test]
fn camera_paths_cross_no_triangle() {
    for name in builtin::NAMES {
        let scene = scene(name);
        let triangles = triangles_in_world(scene);
        for keys in scene.walk.keyframes.windows(2) {
            let hit = triangles.par_iter().any(|t| crosses(keys[0].eye, keys[1].eye, *t));
            assert!(!hit, "{name}: from {} to {}", keys[0].eye, keys[1].eye);
        }
    }
}

#[test]
fn views_keep_clear_of_all_geometry() {
    for name in builtin::NAMES {
        let scene = scene(name);
        let triangles = triangles_in_world(scene);
        for view in &scene.views {
            let distance = clearance(view.camera.eye, &triangles);
            assert!(distance >= CLEARANCE_M, "{name}: view {}: {distance:.3} m", view.name);
        }
    }
}
