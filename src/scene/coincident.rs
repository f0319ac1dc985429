//! Triangles that lie on others of another material: walls with a face for each side, which
//! exporters write back to back, and surfaces drawn twice.
//!
//! Distances to both differ only by rounding, so that the nearest hit would change from pixel to
//! pixel. They are marked here, and [`beats`] decides between them.

use super::connectivity::{PositionKey, corner_keys};
use super::{Material, Scene};
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Distance from a plane, relative to the largest coordinate, up to which a corner lies in it.
/// Positions are rounded to 2^-24 of that; a decal 0.1 mm before a wall of 16 m lies at 2^-18.
const IN_PLANE: f64 = 1.0 / (1u64 << 20) as f64;

/// Largest number of triangles at one edge that are compared. More share an edge only in files that
/// are made to be slow.
const MAX_AT_EDGE: usize = 64;

/// Returns for each triangle whether it may lie on one of another material; empty where none does.
///
/// Two such triangles share an edge and lie on the same side of it, or are connected in their plane
/// to triangles that do. Triangles that light can pass are left out.
pub(super) fn find(scene: &Scene) -> Vec<bool> {
    let mut opaque = scene.materials.iter().filter(|m| m.is_opaque());
    if opaque.nth(1).is_none() && !scene.materials.iter().any(Material::has_dark_back) {
        return Vec::new();
    }
    let edges = edges(scene);
    let at_edges = || edges.chunk_by(|a, b| a.0 == b.0).filter(|at| at.len() > 1);
    let mut seeds: Vec<u32> = Vec::new();
    for_pairs(at_edges(), |a, b| {
        if is_on(scene, a, b) {
            seeds.extend([a, b]);
        }
    });
    if seeds.is_empty() {
        return Vec::new();
    }
    spread(scene, &seeds, at_edges())
}

/// An edge by a fingerprint of its ends, and a triangle that has it.
type Edge = (u64, u32);

/// Returns the edges of all opaque triangles that rays meet, sorted.
fn edges(scene: &Scene) -> Vec<Edge> {
    let is_met = |t: &u32| scene.material_of(*t).is_opaque() && scene.hidden.binary_search(t).is_err();
    let of_triangle = |t: u32| {
        let keys = corner_keys(scene, t);
        [0, 1, 2].map(|i| (fingerprint(keys[i]) ^ fingerprint(keys[(i + 1) % 3]), t))
    };
    let mut edges: Vec<Edge> =
        scene.triangle_indices().into_par_iter().filter(is_met).flat_map_iter(of_triangle).collect();
    edges.par_sort_unstable();
    edges
}

fn fingerprint(key: PositionKey) -> u64 {
    key.iter().fold(0x51, |hash: u64, &word| {
        let mixed = (hash ^ u64::from(word)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        mixed ^ (mixed >> 29)
    })
}

fn for_pairs<'a>(at_edges: impl Iterator<Item = &'a [Edge]>, mut visit: impl FnMut(u32, u32)) {
    for at in at_edges {
        let at = &at[..at.len().min(MAX_AT_EDGE)];
        for (i, &(_, a)) in at.iter().enumerate() {
            at[i + 1..].iter().filter(|(_, b)| a != *b).for_each(|&(_, b)| visit(a, b));
        }
    }
}

/// True where two triangles that share an edge overlap in one plane and are of different materials,
/// or of one that emits from its front.
fn is_on(scene: &Scene, a: u32, b: u32) -> bool {
    let is_same = scene.triangle_materials[a as usize] == scene.triangle_materials[b as usize];
    (!is_same || scene.material_of(a).has_dark_back())
        && share_plane(scene.corners(a), scene.corners(b))
        && overlap(scene.corners(a), scene.corners(b))
}

/// True where the corners of the second triangle lie in the plane of the first.
pub(crate) fn share_plane(a: [Vec3; 3], b: [Vec3; 3]) -> bool {
    let largest = a.iter().chain(&b).fold(0.0, |most: f32, p| most.max(p.abs().max_element()));
    let most = f64::from(largest) * IN_PLANE;
    b.iter().all(|&p| plane_distance(a, p) <= most)
}

/// Returns the distance of a point from the plane of a triangle, in scene units.
fn plane_distance(triangle: [Vec3; 3], point: Vec3) -> f64 {
    let [a, b, c, p] = [triangle[0], triangle[1], triangle[2], point].map(Vec3::as_dvec3);
    (p - a).dot((b - a).cross(c - a).normalize_or_zero()).abs()
}

/// True where two triangles in one plane that share an edge lie on the same side of it.
fn overlap(a: [Vec3; 3], b: [Vec3; 3]) -> bool {
    let apex = |t: [Vec3; 3], other: [Vec3; 3]| t.into_iter().find(|p| !other.contains(p));
    let shared: Vec<DVec3> = a.iter().filter(|p| b.contains(p)).map(|p| p.as_dvec3()).collect();
    let (Some(of_a), Some(of_b), &[p, q]) = (apex(a, b), apex(b, a), &shared[..]) else {
        return shared.len() == 3;
    };
    let along = (q - p).normalize_or_zero();
    let across = |apex: Vec3| {
        let to = apex.as_dvec3() - p;
        to - along * along.dot(to)
    };
    across(of_a).dot(across(of_b)) > 0.0
}

/// Marks the triangles that are connected to one of `seeds` in its plane, by edges and with its
/// material: a wall may be cut into other triangles on its other side.
fn spread<'a>(scene: &Scene, seeds: &[u32], at_edges: impl Iterator<Item = &'a [Edge]>) -> Vec<bool> {
    let mut parent: Vec<u32> = scene.triangle_indices().collect();
    for_pairs(at_edges, |a, b| {
        let is_same = scene.triangle_materials[a as usize] == scene.triangle_materials[b as usize];
        if is_same && share_plane(scene.corners(a), scene.corners(b)) {
            let (a, b) = (root(&mut parent, a), root(&mut parent, b));
            parent[a.max(b) as usize] = a.min(b);
        }
    });
    let mut is_seed = vec![false; parent.len()];
    for &seed in seeds {
        is_seed[root(&mut parent, seed) as usize] = true;
    }
    (0..parent.len() as u32).map(|t| is_seed[root(&mut parent, t) as usize]).collect()
}

fn root(parent: &mut [u32], mut i: u32) -> u32 {
    while parent[i as usize] != i {
        parent[i as usize] = parent[parent[i as usize] as usize];
        i = parent[i as usize];
    }
    i
}

/// True where a ray along `direction` shows triangle `a` rather than triangle `b` in the same
/// place: the one that faces it, else the one that comes first in the model.
pub(crate) fn beats(scene: &Scene, a: u32, b: u32, direction: Vec3) -> bool {
    let faces = |t: u32| {
        let [p, q, r] = scene.corners(t).map(Vec3::as_dvec3);
        (q - p).cross(r - p).dot(direction.as_dvec3()) < 0.0
    };
    match (faces(a), faces(b)) {
        (true, false) => true,
        (false, true) => false,
        _ => a < b,
    }
}
