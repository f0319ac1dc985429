//! Which glass triangles bound a closed solid, and on which side its inside lies.

use super::connectivity::{PositionKey, connected_groups, corner_keys};
use super::{Scene, SolidSide};
use glam::{DVec3, Vec3};
use std::collections::HashMap;

/// Returns one entry per triangle if the scene has glass, otherwise nothing.
///
/// Glass triangles connected by shared vertex positions form a body. A body is solid if every edge
/// belongs to exactly two of its triangles with opposite directions; otherwise, and where a
/// material is thin, it is a thin sheet. The sign of the volume gives the winding, so the winding
/// in the file does not matter.
pub(super) fn classify(scene: &Scene) -> Vec<SolidSide> {
    let glass: Vec<u32> = scene.triangle_indices().filter(|&t| scene.material_of(t).is_glass()).collect();
    if glass.is_empty() {
        return Vec::new();
    }
    let mut sides = vec![SolidSide::Thin; scene.triangles.len()];
    for body in connected_groups(scene, &glass, |_| ()) {
        if !is_closed(scene, &body) || body.iter().any(|&t| scene.material_of(t).is_thin) {
            continue;
        }
        let volume: f64 = body.iter().map(|&t| signed_volume(scene.corners(t))).sum();
        let side = if volume >= 0.0 { SolidSide::InsideBehind } else { SolidSide::InsideInFront };
        for t in body {
            sides[t as usize] = side;
        }
    }
    sides
}

/// Returns the signed volume of the tetrahedron between a triangle and the origin.
fn signed_volume(corners: [Vec3; 3]) -> f64 {
    let [a, b, c]: [DVec3; 3] = corners.map(|p| p.as_dvec3());
    a.dot(b.cross(c)) / 6.0
}

/// True if each directed edge is matched by exactly one edge in the opposite direction: the body is
/// closed and wound consistently.
fn is_closed(scene: &Scene, body: &[u32]) -> bool {
    // For each edge: the number of triangles, and the difference between both directions.
    let mut edges: HashMap<[PositionKey; 2], (u32, i32)> = HashMap::new();
    for &triangle in body {
        let corners = corner_keys(scene, triangle);
        for k in 0..3 {
            let (a, b) = (corners[k], corners[(k + 1) % 3]);
            let (count, balance) = edges.entry([a.min(b), a.max(b)]).or_default();
            *count += 1;
            *balance += if a < b { 1 } else { -1 };
        }
    }
    edges.values().all(|&edge| edge == (2, 0))
}
