//! The closed bodies of a scene: sets of triangles that bound a volume, of any material and with
//! any winding.

use super::Scene;
use super::connectivity::{PositionKey, connected_groups, corner_keys};
use glam::{DVec3, Vec3};
use std::collections::HashMap;

/// Marks a triangle that belongs to no closed body.
pub(crate) const NO_BODY: u32 = u32::MAX;

/// The closed bodies of a scene.
#[derive(Debug, Default)]
pub(crate) struct ClosedBodies {
    /// Index of the body that each triangle bounds, or [`NO_BODY`].
    of_triangle: Vec<u32>,
    /// True for triangles that count as wound the other way.
    is_turned: Vec<bool>,
    /// All bodies.
    pub(crate) list: Vec<ClosedBody>,
}

/// A closed body.
#[derive(Debug)]
pub(crate) struct ClosedBody {
    /// True where all faces are wound alike, so that crossings have a sign; otherwise only their
    /// number says where the inside is.
    pub(crate) is_wound: bool,
    /// Signed volume in cubic scene units: negative where the faces are wound inwards. Of no
    /// meaning where the body is not wound.
    pub(crate) volume: f64,
    /// Lower and upper corner of its box, scene space.
    pub(crate) bounds: [Vec3; 2],
}

/// A face of a group of triangles: one for all triangles with the same corners.
#[derive(Clone)]
struct Face {
    /// The triangle that rays meet.
    triangle: u32,
    corners: [PositionKey; 3],
    /// True where the face counts as wound against its triangle.
    is_turned: bool,
}

impl ClosedBodies {
    /// Finds the closed bodies of a scene.
    ///
    /// Triangles that share vertex positions form a group. A group is closed where every edge
    /// belongs to as many faces in one direction as in the other, or at least to an even number of
    /// faces. Groups that are not closed are taken apart at the edges that do not join exactly two
    /// faces, and the parts are looked at again.
    pub(crate) fn find(scene: &Scene) -> Self {
        let all: Vec<u32> = scene.triangle_indices().collect();
        let mut found = Self {
            of_triangle: vec![NO_BODY; all.len()],
            is_turned: vec![false; all.len()],
            list: Vec::new(),
        };
        for group in connected_groups(scene, &all, |_| ()) {
            let faces = faces_of(scene, &group);
            if !found.add(scene, &faces) {
                for part in parts(&faces) {
                    found.add(scene, &part);
                }
            }
        }
        found
    }

    /// The body that a triangle bounds, and whether the triangle counts as wound the other way.
    #[inline]
    pub(crate) fn of(&self, triangle: u32) -> Option<(u32, bool)> {
        let body = self.of_triangle[triangle as usize];
        (body != NO_BODY).then(|| (body, self.is_turned[triangle as usize]))
    }

    /// Adds some faces as a body if they are closed.
    fn add(&mut self, scene: &Scene, faces: &[Face]) -> bool {
        let Some(is_wound) = closed(faces) else { return false };
        let body = self.list.len() as u32;
        let (mut volume, mut bounds) = (0.0, [Vec3::INFINITY, Vec3::NEG_INFINITY]);
        for face in faces {
            let corners = scene.corners(face.triangle);
            volume += if face.is_turned { -signed_volume(corners) } else { signed_volume(corners) };
            bounds = corners.iter().fold(bounds, |[low, high], &p| [low.min(p), high.max(p)]);
            self.of_triangle[face.triangle as usize] = body;
            self.is_turned[face.triangle as usize] = face.is_turned;
        }
        self.list.push(ClosedBody { is_wound, volume, bounds });
        true
    }
}

/// Returns the signed volume of the tetrahedron between a triangle and the origin.
fn signed_volume(corners: [Vec3; 3]) -> f64 {
    let [a, b, c]: [DVec3; 3] = corners.map(|p| p.as_dvec3());
    a.dot(b.cross(c)) / 6.0
}

/// Returns the faces of a group. Triangles with the same corners that face opposite ways cancel, as
/// between two boxes that stand side by side; where nothing would be left, as of a box that has a
/// face for each side everywhere, one of each is kept.
fn faces_of(scene: &Scene, group: &[u32]) -> Vec<Face> {
    let mut at: HashMap<[PositionKey; 3], usize> = HashMap::with_capacity(group.len());
    let mut found: Vec<(Face, i32)> = Vec::with_capacity(group.len());
    for &triangle in group {
        let corners = corner_keys(scene, triangle);
        let mut sorted = corners;
        sorted.sort_unstable();
        if sorted[0] == sorted[1] || sorted[1] == sorted[2] {
            continue;
        }
        let index = *at.entry(sorted).or_insert_with(|| {
            found.push((Face { triangle, corners, is_turned: false }, 0));
            found.len() - 1
        });
        let (face, count) = &mut found[index];
        // Rays meet the first triangle of those that look alike.
        *count += if is_wound_alike(&face.corners, &corners) { 1 } else { -1 };
    }
    let cancels_all = found.iter().all(|(_, count)| *count == 0);
    let kept = found.into_iter().filter(|(_, count)| cancels_all || *count != 0);
    let turned = kept.map(|(mut face, count)| {
        if count < 0 {
            face.corners.swap(1, 2);
            face.is_turned = true;
        }
        face
    });
    turned.collect()
}

/// True where two triangles with the same corners name them in the same order.
fn is_wound_alike(a: &[PositionKey; 3], b: &[PositionKey; 3]) -> bool {
    (0..3).any(|turn| (0..3).all(|i| a[i] == b[(i + turn) % 3]))
}

/// An edge by its ends in ascending order, and whether a face runs along it in that order.
fn edges(face: &Face) -> [([PositionKey; 2], bool); 3] {
    [0, 1, 2].map(|k| {
        let (a, b) = (face.corners[k], face.corners[(k + 1) % 3]);
        ([a.min(b), a.max(b)], a < b)
    })
}

/// Whether faces are closed and wound alike (`true`), or closed at least (`false`).
fn closed(faces: &[Face]) -> Option<bool> {
    // For each edge: the number of faces, and the difference between both directions.
    let mut count: HashMap<[PositionKey; 2], (u32, i32)> = HashMap::with_capacity(faces.len() * 2);
    for (edge, is_along) in faces.iter().flat_map(edges) {
        let (faces, balance) = count.entry(edge).or_default();
        *faces += 1;
        *balance += if is_along { 1 } else { -1 };
    }
    if count.is_empty() || count.values().any(|(faces, _)| faces % 2 == 1) {
        return None;
    }
    Some(count.values().all(|(_, balance)| *balance == 0))
}

/// The parts of a group that are joined by edges of exactly two faces.
fn parts(faces: &[Face]) -> Vec<Vec<Face>> {
    let mut at_edge: HashMap<[PositionKey; 2], Vec<usize>> = HashMap::with_capacity(faces.len() * 2);
    for (i, face) in faces.iter().enumerate() {
        for (edge, _) in edges(face) {
            at_edge.entry(edge).or_default().push(i);
        }
    }
    let mut part = vec![usize::MAX; faces.len()];
    let mut parts: Vec<Vec<Face>> = Vec::new();
    for first in 0..faces.len() {
        if part[first] != usize::MAX {
            continue;
        }
        part[first] = parts.len();
        let (mut open, mut members) = (vec![first], Vec::new());
        while let Some(i) = open.pop() {
            members.push(faces[i].clone());
            for (edge, _) in edges(&faces[i]) {
                let joined = at_edge.get(&edge).filter(|joined| joined.len() == 2);
                for &next in joined.into_iter().flatten().filter(|&&next| next != i) {
                    if part[next] == usize::MAX {
                        part[next] = parts.len();
                        open.push(next);
                    }
                }
            }
        }
        parts.push(members);
    }
    parts
}
