//! Triangulating polygons: quads by the better diagonal, longer ones by ear clipping in the plane
//! of the polygon.

use earcut::Earcut;
use glam::DVec3;

/// Result of a triangulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Filled {
    Whole,
    NoArea,
    /// The triangles do not add up to the area of the polygon: it crosses itself.
    Crossed,
}

/// Triangulator with buffers that are reused from polygon to polygon.
pub(super) struct Filler {
    earcut: Earcut<f64>,
    indices: Vec<u32>,
    /// Triangles of the last polygon, as indices into its corners, with its winding.
    pub(super) triangles: Vec<[u32; 3]>,
}

impl Filler {
    pub(super) fn new() -> Self {
        Self { earcut: Earcut::new(), indices: Vec::new(), triangles: Vec::new() }
    }

    /// Triangulates a polygon of at least three corners; the result is in `triangles`.
    pub(super) fn fill(&mut self, corners: &[DVec3]) -> Filled {
        self.triangles.clear();
        match corners {
            [_, _, _] => self.triangles.push([0, 1, 2]),
            [a, b, c, d] => {
                let normal = (*c - *a).cross(*d - *b);
                match quad(corners, normal) {
                    Some(both) => self.triangles.extend(both),
                    None => return self.clip_ears(corners),
                }
            }
            _ => return self.clip_ears(corners),
        }
        Filled::Whole
    }

    fn clip_ears(&mut self, corners: &[DVec3]) -> Filled {
        // Coordinates relative to a corner keep their digits where the polygon is far from the
        // origin.
        let local = |p: &DVec3| *p - corners[0];
        let doubled_area = newell(corners);
        let Some(normal) = doubled_area.try_normalize() else { return Filled::NoArea };
        let (x, y) = normal.any_orthonormal_pair();
        let flat = corners.iter().map(|p| [local(p).dot(x), local(p).dot(y)]);
        self.earcut.earcut(flat, &[], &mut self.indices);
        let mut filled = 0.0;
        for t in self.indices.chunks_exact(3) {
            let [a, b, c] = [t[0], t[1], t[2]].map(|i| corners[i as usize]);
            let signed = (b - a).cross(c - a).dot(normal);
            filled += signed.abs();
            self.triangles.push(if signed < 0.0 { [t[0], t[2], t[1]] } else { [t[0], t[1], t[2]] });
        }
        /// Relative difference of areas. Rounding and slightly bent polygons stay far below; a
        /// crossing rarely does.
        const TOLERANCE: f64 = 1e-2;
        match (filled - doubled_area.length()).abs() <= TOLERANCE * doubled_area.length() {
            _ if self.triangles.is_empty() => Filled::NoArea,
            true => Filled::Whole,
            false => Filled::Crossed,
        }
    }
}

/// Splits a quad along a diagonal that leaves both triangles facing its front; along the first
/// diagonal where both do. This is right for convex and concave quads. `None` where neither
/// diagonal does.
fn quad(p: &[DVec3], normal: DVec3) -> Option<[[u32; 3]; 2]> {
    let faces_front = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|i| p[i as usize]);
        (b - a).cross(c - a).dot(normal) > 0.0
    };
    let splits = [[[0, 1, 2], [0, 2, 3]], [[1, 2, 3], [1, 3, 0]]];
    splits.into_iter().find(|both| both.iter().all(faces_front))
}

/// Returns Newell's normal: its length is twice the area, for any flat polygon, convex or not.
pub(super) fn newell(corners: &[DVec3]) -> DVec3 {
    let origin = corners[0];
    let edges = corners.windows(2).map(|w| (w[0] - origin).cross(w[1] - origin));
    edges.sum()
}
