//! The profile of a plane: where the closed bodies of a scene are cut, as segments in the plane.

use super::solids::Solids;
use crate::scene::Scene;
use glam::Vec3;
use rayon::prelude::*;

/// Largest number of rows into which the segments are sorted.
const MAX_ROWS: usize = 1024;

/// The cut through one triangle.
#[derive(Clone, Copy, Debug)]
struct Segment {
    body: u32,
    /// Where an edge of the triangle goes down through the plane, and where one goes up: the body
    /// is on the side of smaller first coordinates where the second one grows.
    ends: [[f32; 2]; 2],
}

/// The cut through the closed bodies of a scene by a plane across an axis. Its coordinates are those
/// of the two axes that follow, scene space.
#[derive(Debug)]
pub(super) struct Profile {
    axis: usize,
    /// Sorted by row, and by body in a row; a segment is in every row that it touches.
    segments: Vec<Segment>,
    /// The first segment of each row, and their number.
    rows: Vec<u32>,
    low: f32,
    per_unit: f32,
}

impl Profile {
    /// Cuts the bodies of a scene.
    pub(super) fn new(scene: &Scene, solids: &Solids, axis: usize, at: f32) -> Self {
        let cut = |triangle: u32| {
            let (body, is_turned) = solids.material_at(triangle)?;
            let mut ends = crossing(scene.corners(triangle), axis, at)?;
            if is_turned {
                ends.swap(0, 1);
            }
            Some(Segment { body, ends })
        };
        let all: Vec<Segment> = (0..scene.triangles.len() as u32).into_par_iter().filter_map(cut).collect();
        let heights = || all.iter().flat_map(|segment| segment.ends.map(|end| end[1]));
        let low = heights().fold(f32::INFINITY, f32::min);
        let high = heights().fold(f32::NEG_INFINITY, f32::max);
        let count = all.len().clamp(1, MAX_ROWS);
        let mut profile = Self { axis, segments: Vec::new(), rows: vec![0; count + 1], low, per_unit: 0.0 };
        if high > low {
            profile.per_unit = count as f32 / (high - low);
        }
        let mut in_rows: Vec<(u32, Segment)> = Vec::with_capacity(all.len() * 2);
        for segment in all {
            let [first, last] = profile.rows_of(segment.ends.map(|end| end[1]));
            in_rows.extend((first..=last).map(|row| (row as u32, segment)));
        }
        // Stable, and of triangles in order: the sums below do not depend on threads.
        in_rows.sort_by_key(|(row, segment)| (*row, segment.body));
        for (row, _) in &in_rows {
            profile.rows[*row as usize + 1] += 1;
        }
        for row in 0..count {
            profile.rows[row + 1] += profile.rows[row];
        }
        profile.segments = in_rows.into_iter().map(|(_, segment)| segment).collect();
        profile
    }

    /// First and last row between two heights, in any order.
    fn rows_of(&self, [a, b]: [f32; 2]) -> [usize; 2] {
        let last = self.rows.len() - 2;
        [a.min(b), a.max(b)].map(|height| (((height - self.low) * self.per_unit) as usize).min(last))
    }

    fn row(&self, row: usize) -> &[Segment] {
        &self.segments[self.rows[row] as usize..self.rows[row + 1] as usize]
    }

    fn place(&self, point: Vec3) -> [f32; 2] {
        [point[(self.axis + 1) % 3], point[(self.axis + 2) % 3]]
    }

    /// True where a point of the plane lies in material: the segments beyond it are counted by
    /// body. An end belongs to one of two segments, so that a loop is crossed an even number of
    /// times.
    pub(super) fn is_inside(&self, solids: &Solids, point: Vec3) -> bool {
        let [u, v] = self.place(point);
        let [row, _] = self.rows_of([v, v]);
        let (mut depth, mut body, mut signed, mut count) = (0, u32::MAX, 0, 0);
        for segment in self.row(row) {
            if segment.body != body {
                depth += solids.depth_in(body, signed, count);
                (body, signed, count) = (segment.body, 0, 0);
            }
            let [[u0, v0], [u1, v1]] = segment.ends;
            if (v0 <= v) != (v1 <= v) && u0 + (u1 - u0) * ((v - v0) / (v1 - v0)) > u {
                count += 1;
                signed += if v1 > v0 { 1 } else { -1 };
            }
        }
        depth + solids.depth_in(body, signed, count) > 0
    }

    /// True where the outline of a body is at most `reach` away from a point of the plane.
    pub(super) fn is_at_outline(&self, point: Vec3, reach: f32) -> bool {
        let [u, v] = self.place(point);
        let [first, last] = self.rows_of([v - reach, v + reach]);
        (first..=last).flat_map(|row| self.row(row)).any(|segment| {
            let [[u0, v0], [u1, v1]] = segment.ends;
            let ([du, dv], [pu, pv]) = ([u1 - u0, v1 - v0], [u - u0, v - v0]);
            let along = ((pu * du + pv * dv) / (du * du + dv * dv).max(f32::MIN_POSITIVE)).clamp(0.0, 1.0);
            (pu - du * along).hypot(pv - dv * along) <= reach
        })
    }
}

/// Where the edges of a triangle go down and up through a plane across an axis. Both triangles of an
/// edge get the same bits.
fn crossing(corners: [Vec3; 3], axis: usize, at: f32) -> Option<[[f32; 2]; 2]> {
    let is_above = corners.map(|corner| corner[axis] >= at);
    let through = |goes_up: bool| {
        let k = (0..3).find(|&k| is_above[k] != goes_up && is_above[(k + 1) % 3] == goes_up)?;
        let (mut below, mut above) = (corners[k], corners[(k + 1) % 3]);
        if !goes_up {
            std::mem::swap(&mut below, &mut above);
        }
        let point = below + (above - below) * ((at - below[axis]) / (above[axis] - below[axis]));
        Some([point[(axis + 1) % 3], point[(axis + 2) % 3]])
    };
    Some([through(false)?, through(true)?])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::key::Key;
    use crate::scene::builtin;
    use crate::trace::Tracer;
    use std::sync::Arc;

    /// Random points of planes through embedded scenes: the profile finds the material that rays in
    /// space find.
    #[test]
    fn a_profile_has_its_inside_where_rays_have_it() {
        let (mut inside, mut differ) = (0, 0);
        for name in ["gallery", "cornell", "mirrors"] {
            let tracer = Tracer::new(Arc::new(builtin::build(name).unwrap()));
            let (scene, bvh) = (tracer.scene(), tracer.bvh());
            let solids = Solids::find(scene, bvh);
            let corners = scene.building_m.map(|p| scene.frame.scene_from_world_f64(p).as_vec3());
            for plane in 0..9 {
                let (axis, part) = (plane % 3, 0.2 + 0.29 * (plane / 3) as f32);
                let at = corners[0][axis] + (corners[1] - corners[0])[axis] * part;
                let profile = Profile::new(scene, &solids, axis, at);
                for i in 0..2000 {
                    let [u, v] = Key::of_pixel(plane as u64, i).pair();
                    let mut parts = Vec3::ZERO;
                    (parts[(axis + 1) % 3], parts[(axis + 2) % 3]) = (u, v);
                    let mut point = corners[0] + (corners[1] - corners[0]) * parts;
                    point[axis] = at;
                    let found = profile.is_inside(&solids, point);
                    inside += u32::from(found);
                    differ += u32::from(found != solids.is_inside(scene, bvh, point));
                }
            }
        }
        assert!(inside > 100, "{inside}");
        assert!(differ * 1000 <= inside, "{differ} of {inside}");
    }
}
