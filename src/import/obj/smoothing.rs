//! Normals from smoothing groups, where a model has groups (`s 1`) and no normals (`vn`).

use super::parse::Model;
use super::piece::NONE;
use crate::import::polygon::newell;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// Cosine of the angle between two faces above which their edge stays hard: 80 degrees. Some
/// exporters put all faces into one group, the corners of rooms as well; columns of five sides and
/// more are round.
const CREASE: f32 = 0.173_648_18;

/// Largest number of corners at one vertex that are compared with each other; more share a normal.
const MAX_COMPARED: usize = 256;

/// A corner of a smooth face.
struct SmoothCorner {
    /// Bits of its coordinates: parts of a large model number their vertices on their own.
    position: [u64; 3],
    group: u32,
    /// Number of the corner among those of all faces.
    corner: u32,
    /// Unit normal of its face.
    face_normal: Vec3,
    /// Angle of the face at the corner, in radians.
    angle: f32,
}

/// Gives corners without a normal that of their smoothing group. Positions must be world metres.
pub(super) fn add_normals(model: &mut Model) {
    if model.smoothing.iter().all(|(_, group)| *group == 0) {
        return;
    }
    let mut corners = smooth_corners(model);
    corners.par_sort_unstable_by_key(|c| (c.position, c.group, c.corner));
    let mut found: Vec<(u32, u32)> = Vec::with_capacity(corners.len());
    for at_vertex in corners.chunk_by(|a, b| (a.position, a.group) == (b.position, b.group)) {
        let first = model.normals.len();
        let shared =
            (at_vertex.len() > MAX_COMPARED).then(|| mean_of(at_vertex.iter(), at_vertex[0].face_normal));
        for corner in at_vertex {
            let normal = shared.unwrap_or_else(|| normal_of(corner, at_vertex));
            let known = model.normals[first..].iter().position(|n| *n == normal);
            let index = known.map_or(model.normals.len(), |known| first + known);
            if known.is_none() {
                model.normals.push(normal);
            }
            found.push((corner.corner, index as u32));
        }
    }
    found.par_sort_unstable();
    let mut next = found.iter().peekable();
    for (number, corner) in (0..).zip(model.corners_mut()) {
        if let Some((_, normal)) = next.next_if(|(of, _)| *of == number) {
            corner.normal = *normal;
        }
    }
}

fn smooth_corners(model: &Model) -> Vec<SmoothCorner> {
    let (mut corners, mut number, mut open, mut group) = (Vec::new(), 0, model.smoothing.as_slice(), 0);
    for (i, face) in model.faces().enumerate() {
        while let Some(((_, next), rest)) = open.split_first().filter(|((start, _), _)| *start <= i) {
            (group, open) = (*next, rest);
        }
        let first = number;
        number += face.corners.len() as u32;
        if group == 0 || face.corners.iter().all(|c| c.normal != NONE) {
            continue;
        }
        let positions: Vec<DVec3> =
            face.corners.iter().map(|c| model.positions[c.position as usize]).collect();
        let Some(face_normal) = newell(&positions).try_normalize() else { continue };
        for (k, _) in face.corners.iter().enumerate().filter(|(_, c)| c.normal == NONE) {
            // Adding zero removes the sign of zero.
            let position = (positions[k] + DVec3::ZERO).to_array().map(f64::to_bits);
            let corner = first + k as u32;
            let (face_normal, angle) = (face_normal.as_vec3(), angle_at(&positions, k));
            corners.push(SmoothCorner { position, group, corner, face_normal, angle });
        }
    }
    corners
}

/// Returns the mean of the faces at a vertex, weighted by their angles, without those that meet
/// the corner's own at a crease.
fn normal_of(corner: &SmoothCorner, at_vertex: &[SmoothCorner]) -> Vec3 {
    let is_smooth = |other: &&SmoothCorner| other.face_normal.dot(corner.face_normal) >= CREASE;
    mean_of(at_vertex.iter().filter(is_smooth), corner.face_normal)
}

/// Returns the unit mean of faces, weighted by their angles, or `otherwise` where they cancel.
fn mean_of<'a>(faces: impl Iterator<Item = &'a SmoothCorner>, otherwise: Vec3) -> Vec3 {
    let sum: Vec3 = faces.map(|face| face.face_normal * face.angle).sum();
    sum.try_normalize().unwrap_or(otherwise)
}

fn angle_at(positions: &[DVec3], corner: usize) -> f32 {
    let count = positions.len();
    let to = |i: usize| positions[i % count] - positions[corner];
    let angle = to(corner + 1).angle_between(to(corner + count - 1)) as f32;
    if angle.is_finite() { angle } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corner(face_normal: Vec3) -> SmoothCorner {
        SmoothCorner { position: [0; 3], group: 1, corner: 0, face_normal, angle: 1.0 }
    }

    #[test]
    fn faces_that_meet_at_a_crease_do_not_smooth_each_other() {
        let faces = [corner(Vec3::X), corner(Vec3::Y), corner(Vec3::new(0.8, 0.6, 0.0))];
        let smooth = normal_of(&faces[0], &faces);
        assert!((smooth - Vec3::new(3.0, 1.0, 0.0) / 10f32.sqrt()).length() < 1e-6, "{smooth}");
        assert_eq!(mean_of([corner(Vec3::X), corner(Vec3::NEG_X)].iter(), Vec3::Y), Vec3::Y);
    }
}
