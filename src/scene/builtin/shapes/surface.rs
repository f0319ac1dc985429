//! Smooth surfaces given by a function of two parameters.

use super::Local;
use crate::scene::{MaterialId, SceneBuilder};
use glam::{DVec3, Vec2, Vec3};

/// How a surface closes along a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Closing {
    /// The surface has an edge at both ends.
    Open,
    /// The end joins the beginning.
    Around,
    /// Each end is a single point.
    Poles,
}

/// A grid over u and v in 0..=1. The front of the surface is the side to which `dP/du cross dP/dv`
/// points.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Grid {
    /// Number of cells along u.
    pub(crate) nu: u32,
    /// Number of cells along v.
    pub(crate) nv: u32,
    /// How the surface closes along u; never with poles.
    pub(crate) u: Closing,
    /// How the surface closes along v.
    pub(crate) v: Closing,
}

impl Grid {
    /// Adds the surface `point(u, v)`, given in `frame`, with smooth normals.
    pub(crate) fn add_to(
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
                // The positions along a seam or at a pole must have equal bits, or light would
                // leak.
                positions.push(
                    frame.point(point(f64::from(i) / f64::from(self.nu), f64::from(j) / f64::from(self.nv))),
                );
            }
        }
        let triangles = self.triangles();
        let shared: Vec<[u32; 3]> =
            triangles.iter().map(|t| t.map(|v| self.index(v % columns, v / columns))).collect();
        let normals = smooth_normals(&positions, &shared);
        let first = b.positions.len() as u32;
        for j in 0..rows {
            for i in 0..columns {
                let k = (j * columns + i) as usize;
                let uv = Vec2::new(i as f32 / self.nu as f32, j as f32 / self.nv as f32);
                b.add_vertex(positions[k], normals[self.index(i, j) as usize], uv);
            }
        }
        for t in triangles {
            b.add_triangle(t.map(|v| first + v), material);
        }
    }

    /// Returns the grid point that represents all those at the same position.
    fn canonical(&self, i: u32, j: u32) -> [u32; 2] {
        let around = |t: u32, n: u32, closing| if closing == Closing::Around { t % n } else { t };
        let at_pole = self.v == Closing::Poles && (j == 0 || j == self.nv);
        [if at_pole { 0 } else { around(i, self.nu, self.u) }, around(j, self.nv, self.v)]
    }

    fn index(&self, i: u32, j: u32) -> u32 {
        let [i, j] = self.canonical(i, j);
        j * (self.nu + 1) + i
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
}

/// Returns the area-weighted mean of the face normals around each position. It needs no derivatives
/// and no special case at poles.
pub(super) fn smooth_normals(positions: &[DVec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let mut sums = vec![DVec3::ZERO; positions.len()];
    for t in triangles {
        let [a, b, c] = t.map(|v| positions[v as usize]);
        let area = (b - a).cross(c - a);
        for &v in t {
            sums[v as usize] += area;
        }
    }
    sums.iter().map(|n| n.normalize_or(DVec3::Y).as_vec3()).collect()
}

/// Adds a surface of revolution around the y axis of the frame. The profile is a list of
/// `[radius, height]` from bottom to top.
pub(crate) fn lathe(
    b: &mut SceneBuilder,
    frame: &Local,
    profile: &[[f64; 2]],
    segments: u32,
    material: MaterialId,
) {
    let nv = profile.len() as u32 - 1;
    Grid { nu: segments, nv, u: Closing::Around, v: Closing::Open }.add_to(b, frame, material, |u, v| {
        let [radius, height] = profile[(v * f64::from(nv)).round() as usize];
        on_circle(u, radius, height)
    });
}

/// Returns the point at the share `u` of a horizontal circle, counter-clockwise seen from above, so
/// that the front of a surface that rises with v is its outside.
pub(crate) fn on_circle(u: f64, radius: f64, height: f64) -> DVec3 {
    let (sin, cos) = (u * std::f64::consts::TAU).sin_cos();
    DVec3::new(radius * cos, height, -radius * sin)
}

/// Adds a round tube along a closed curve. `radius` depends on the position along the curve.
pub(crate) fn closed_tube(
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
        // For the curves used here, the direction from the origin is never parallel to the tangent.
        let side = centre.cross(tangent).normalize_or(DVec3::Y);
        let up = tangent.cross(side);
        let (sin, cos) = (u * std::f64::consts::TAU).sin_cos();
        centre + radius(v) * (side * cos + up * sin)
    });
}

/// Adds a straight round bar between two world positions, closed by flat ends.
pub(crate) fn bar(
    b: &mut SceneBuilder,
    [from, to]: [DVec3; 2],
    radius: f64,
    segments: u32,
    material: MaterialId,
) {
    let axis = (to - from).normalize_or(DVec3::Y);
    let side = axis.any_orthonormal_vector();
    let up = axis.cross(side);
    let ring = |u: f64| {
        let (sin, cos) = (u * std::f64::consts::TAU).sin_cos();
        radius * (side * cos + up * sin)
    };
    let tube = Grid { nu: segments, nv: 1, u: Closing::Around, v: Closing::Open };
    tube.add_to(b, &Local::WORLD, material, |u, v| from.lerp(to, v) + ring(u));
    for (end, axis) in [(from, -axis), (to, axis)] {
        let middle = b.add_vertex(end, axis.as_vec3(), Vec2::ZERO);
        let rim: Vec<u32> = (0..segments)
            .map(|i| b.add_vertex(end + ring(f64::from(i) / f64::from(segments)), axis.as_vec3(), Vec2::ZERO))
            .collect();
        for i in 0..rim.len() {
            let (p, q) = (rim[i], rim[(i + 1) % rim.len()]);
            // The rim is counter-clockwise seen from the side to which the bar's axis points.
            b.add_triangle(if end == to { [middle, p, q] } else { [middle, q, p] }, material);
        }
    }
}
