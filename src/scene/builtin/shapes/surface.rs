//! Smooth surfaces over a grid of two parameters.

use super::Local;
use crate::scene::{MaterialId, SceneBuilder};
use glam::{DVec3, Vec2, Vec3};

/// How the two ends of a parameter meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::scene::builtin) enum Closing {
    /// They do not: the surface has an edge there.
    Open,
    /// The end is the beginning.
    Around,
    /// Each end is one point.
    Poles,
}

/// A grid over u and v in 0..=1. The surface shows its front where `dP/du cross dP/dv` points at the viewer.
#[derive(Clone, Copy, Debug)]
pub(in crate::scene::builtin) struct Grid {
    /// Cells along u.
    pub(in crate::scene::builtin) nu: u32,
    /// Cells along v.
    pub(in crate::scene::builtin) nv: u32,
    /// How u ends; never poles.
    pub(in crate::scene::builtin) u: Closing,
    /// How v ends.
    pub(in crate::scene::builtin) v: Closing,
}

impl Grid {
    /// Adds the surface `point(u, v)` of a frame, with smooth normals.
    pub(in crate::scene::builtin) fn add_to(
        &self,
        b: &mut SceneBuilder,
        frame: &Local,
        material: MaterialId,
        point: impl Fn(f64, f64) -> DVec3,
    ) {
        let (columns, rows) = (self.nu + 1, self.nv + 1);
        let mut positions = Vec::with_capacity((columns * rows) as usize);
        for j in 0..rows {
            for i in 0..columns {
                let [i, j] = self.canonical(i, j);
                // A seam or a pole must be one point to the last bit, or light leaks through it.
                positions.push(
                    frame.point(point(f64::from(i) / f64::from(self.nu), f64::from(j) / f64::from(self.nv))),
                );
            }
        }
        let normals = self.normals(&positions);
        let first = b.positions.len() as u32;
        for j in 0..rows {
            for i in 0..columns {
                let k = (j * columns + i) as usize;
                let uv = Vec2::new(i as f32 / self.nu as f32, j as f32 / self.nv as f32);
                b.add_vertex(positions[k], normals[self.index(i, j)], uv);
            }
        }
        for t in self.triangles() {
            b.add_triangle(t.map(|v| first + v), material);
        }
    }

    /// The grid point that stands for this one where several coincide.
    fn canonical(&self, i: u32, j: u32) -> [u32; 2] {
        let around = |t: u32, n: u32, closing| if closing == Closing::Around { t % n } else { t };
        let at_pole = self.v == Closing::Poles && (j == 0 || j == self.nv);
        [if at_pole { 0 } else { around(i, self.nu, self.u) }, around(j, self.nv, self.v)]
    }

    fn index(&self, i: u32, j: u32) -> usize {
        let [i, j] = self.canonical(i, j);
        (j * (self.nu + 1) + i) as usize
    }

    fn triangles(&self) -> Vec<[u32; 3]> {
        let columns = self.nu + 1;
        let mut triangles = Vec::with_capacity(2 * (self.nu * self.nv) as usize);
        for j in 0..self.nv {
            for i in 0..self.nu {
                let (a, b, c, d) =
                    (j * columns + i, j * columns + i + 1, (j + 1) * columns + i + 1, (j + 1) * columns + i);
                let poles = self.v == Closing::Poles;
                if !(poles && j == 0) {
                    triangles.push([a, b, c]);
                }
                if !(poles && j + 1 == self.nv) {
                    triangles.push([a, c, d]);
                }
            }
        }
        triangles
    }

    /// Area-weighted means of the faces around each grid point: they need no derivative and no special pole.
    fn normals(&self, positions: &[DVec3]) -> Vec<Vec3> {
        let columns = self.nu + 1;
        let mut sums = vec![DVec3::ZERO; positions.len()];
        for t in self.triangles() {
            let [a, b, c] = t.map(|v| positions[v as usize]);
            let area = (b - a).cross(c - a);
            for v in t {
                sums[self.index(v % columns, v / columns)] += area;
            }
        }
        sums.iter().map(|n| n.normalize_or(DVec3::Y).as_vec3()).collect()
    }
}

/// A profile of `[radius, height]` turned about the frame's y, from bottom to top, smooth along its length.
pub(in crate::scene::builtin) fn lathe(
    b: &mut SceneBuilder,
    frame: &Local,
    profile: &[[f64; 2]],
    segments: u32,
    material: MaterialId,
) {
    let nv = profile.len() as u32 - 1;
    let grid = Grid { nu: segments, nv, u: Closing::Around, v: Closing::Open };
    grid.add_to(b, frame, material, |u, v| {
        let [radius, height] = profile[(v * f64::from(nv)).round() as usize];
        on_circle(u, radius, height)
    });
}

/// Counter-clockwise seen from above, so that a surface that climbs with v shows its outside.
pub(in crate::scene::builtin) fn on_circle(u: f64, radius: f64, height: f64) -> DVec3 {
    let (sin, cos) = (u * std::f64::consts::TAU).sin_cos();
    DVec3::new(radius * cos, height, -radius * sin)
}

/// A round tube of one radius along a closed curve.
pub(in crate::scene::builtin) fn closed_tube(
    b: &mut SceneBuilder,
    frame: &Local,
    [around, along]: [u32; 2],
    radius: impl Fn(f64) -> f64,
    curve: impl Fn(f64) -> DVec3,
    material: MaterialId,
) {
    const STEP: f64 = 1e-4;
    let grid = Grid { nu: around, nv: along, u: Closing::Around, v: Closing::Around };
    grid.add_to(b, frame, material, |u, v| {
        let centre = curve(v);
        let (before, after) = (curve(v - STEP), curve(v + STEP));
        let tangent = (after - before).normalize_or(DVec3::X);
        // The direction from the curve's overall centre is never along the tangent of the knots used here.
        let side = centre.cross(tangent).normalize_or(DVec3::Y);
        let up = tangent.cross(side);
        let (sin, cos) = (u * std::f64::consts::TAU).sin_cos();
        centre + radius(v) * (side * cos + up * sin)
    });
}

/// A straight round bar between two points of the world, open at its ends.
pub(in crate::scene::builtin) fn bar(
    b: &mut SceneBuilder,
    [from, to]: [DVec3; 2],
    radius: f64,
    segments: u32,
    material: MaterialId,
) {
    let axis = (to - from).normalize_or(DVec3::Y);
    let side = axis.any_orthonormal_vector();
    let up = axis.cross(side);
    let grid = Grid { nu: segments, nv: 1, u: Closing::Around, v: Closing::Open };
    grid.add_to(b, &Local::WORLD, material, |u, v| {
        let (sin, cos) = (u * std::f64::consts::TAU).sin_cos();
        from.lerp(to, v) + radius * (side * cos + up * sin)
    });
}
