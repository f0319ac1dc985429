//! Round bodies: displaced spheres, knots, fluted shafts and gears.

use super::surface::{closed_tube, on_circle, smooth_normals};
use super::{Closing, Grid, Local};
use crate::scene::{MaterialId, SceneBuilder};
use glam::{DVec3, Vec2};
use std::collections::HashMap;
use std::f64::consts::TAU;

/// Adds a sphere of `20 * 4^levels` nearly equal triangles. `displaced` maps a unit direction to a
/// point of the surface.
///
/// Vertices are shared, so the body is closed. Normals are area-weighted means of the face normals.
pub(crate) fn icosphere(
    b: &mut SceneBuilder,
    frame: &Local,
    levels: u32,
    material: MaterialId,
    displaced: impl Fn(DVec3) -> DVec3,
) {
    let (directions, faces) = sphere_mesh(levels);
    let positions: Vec<DVec3> = directions.iter().map(|&d| frame.point(displaced(d))).collect();
    let normals = smooth_normals(&positions, &faces);
    let first = b.positions.len() as u32;
    for ((p, n), d) in positions.iter().zip(normals).zip(&directions) {
        let uv = Vec2::new((d.z.atan2(d.x) / TAU) as f32, (d.y * 0.5 + 0.5) as f32);
        b.add_vertex(*p, n, uv);
    }
    for f in faces {
        b.add_triangle(f.map(|v| first + v), material);
    }
}

/// Faces of the icosahedron.
#[rustfmt::skip]
const ICOSAHEDRON: [[u32; 3]; 20] = [
    [0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11],
    [1, 5, 9], [5, 11, 4], [11, 10, 2], [10, 7, 6], [7, 1, 8],
    [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9],
    [4, 9, 5], [2, 4, 11], [6, 2, 10], [8, 6, 7], [9, 8, 1],
];

/// Returns unit directions and faces of an icosahedron whose faces are split `levels` times.
fn sphere_mesh(levels: u32) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let g = (1.0 + 5f64.sqrt()) / 2.0;
    #[rustfmt::skip]
    let corners = [
        [-1.0, g, 0.0], [1.0, g, 0.0], [-1.0, -g, 0.0], [1.0, -g, 0.0],
        [0.0, -1.0, g], [0.0, 1.0, g], [0.0, -1.0, -g], [0.0, 1.0, -g],
        [g, 0.0, -1.0], [g, 0.0, 1.0], [-g, 0.0, -1.0], [-g, 0.0, 1.0],
    ];
    let mut directions = corners.map(|p| DVec3::from(p).normalize_or(DVec3::Y)).to_vec();
    let mut faces = ICOSAHEDRON.to_vec();
    for _ in 0..levels {
        let mut middles: HashMap<(u32, u32), u32> = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                let sum = directions[a as usize] + directions[b as usize];
                directions.push(sum.normalize_or(DVec3::Y));
                directions.len() as u32 - 1
            })
        };
        faces = faces
            .iter()
            .flat_map(|&[a, b, c]| {
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    (directions, faces)
}

/// Adds the (p, q) torus knot as a tube around the origin of the frame. Its axis is z, so it stands
/// upright.
pub(crate) fn torus_knot(
    b: &mut SceneBuilder,
    frame: &Local,
    cells: [u32; 2],
    [p, q]: [f64; 2],
    [ring, tube]: [f64; 2],
    material: MaterialId,
) {
    let curve = |v: f64| {
        let (sin_q, cos_q) = (q * v * TAU).sin_cos();
        let (sin_p, cos_p) = (p * v * TAU).sin_cos();
        let r = ring * (1.0 + 0.42 * cos_q);
        DVec3::new(r * cos_p, r * sin_p, ring * 0.42 * sin_q)
    };
    closed_tube(b, frame, cells, |_| tube, curve, material);
}

/// Adds a torus around the y axis of the frame.
pub(crate) fn torus(
    b: &mut SceneBuilder,
    frame: &Local,
    cells: [u32; 2],
    [ring, tube]: [f64; 2],
    material: MaterialId,
) {
    let grid = Grid { nu: cells[0], nv: cells[1], u: Closing::Around, v: Closing::Around };
    grid.add_to(b, frame, material, |u, v| {
        let (sin, cos) = (v * TAU).sin_cos();
        on_circle(u, ring + tube * cos, tube * sin)
    });
}

/// Adds a shaft with flutes, each `cells` faces wide, and flat fillets between them. All edges are
/// sharp.
pub(crate) fn fluted_shaft(
    b: &mut SceneBuilder,
    frame: &Local,
    [flutes, cells, rows]: [u32; 3],
    radius_at: impl Fn(f64) -> f64,
    height: f64,
    material: MaterialId,
) {
    // Vitruvius, book IV, 3: the width of a fillet is a quarter of that of a flute.
    const FLUTE_SHARE: f64 = 0.8;
    const DEPTH_PER_RADIUS: f64 = 0.075;
    let pitch = 1.0 / f64::from(flutes);
    // Rows are denser at the ends, where the flutes end in apses.
    let crowded = |v: f64| v - 0.8 * (v * TAU).sin() / TAU;
    for flute in 0..flutes {
        let from = f64::from(flute) * pitch;
        let hollow = Grid { nu: cells, nv: rows, u: Closing::Open, v: Closing::Open };
        hollow.add_to(b, frame, material, |u, v| {
            let v = crowded(v);
            // The flute ends in an apse at both ends.
            let apse = (1.0 - ((v - 0.5).abs() * 2.0).powi(24)).max(0.0).sqrt();
            let across = 2.0 * u - 1.0;
            let hollow = DEPTH_PER_RADIUS * (1.0 - across * across).max(0.0).sqrt() * apse;
            on_circle(from + u * pitch * FLUTE_SHARE, radius_at(v) * (1.0 - hollow), v * height)
        });
        Grid { nu: 1, nv: rows, u: Closing::Open, v: Closing::Open }.add_to(b, frame, material, |u, v| {
            let v = crowded(v);
            let turn = if u < 0.5 { from + pitch * FLUTE_SHARE } else { from + pitch };
            on_circle(if turn >= 1.0 - 1e-9 { 0.0 } else { turn }, radius_at(v), v * height)
        });
    }
}

/// Adds a gear around the z axis of the frame: a toothed wheel with a bore, two flat sides and
/// sharp flanks.
pub(crate) fn gear(
    b: &mut SceneBuilder,
    frame: &Local,
    teeth: u32,
    [bore, root, tip]: [f64; 3],
    thickness: f64,
    material: MaterialId,
) {
    const STEPS_PER_TOOTH: u32 = 8;
    let steps = teeth * STEPS_PER_TOOTH;
    let radius = |k: u32| if k % STEPS_PER_TOOTH < STEPS_PER_TOOTH / 2 { tip } else { root };
    let at = |k: u32, r: f64, z: f64| {
        let (sin, cos) = (f64::from(k % steps) / f64::from(steps) * TAU).sin_cos();
        frame.point(DVec3::new(r * cos, r * sin, z))
    };
    let z = thickness / 2.0;
    for k in 0..steps {
        let (r, next) = (radius(k), radius((k + 1) % steps));
        let mut quad = |corners| b.add_quad(corners, Vec2::ONE, material);
        quad([at(k, bore, z), at(k, r, z), at(k + 1, r, z), at(k + 1, bore, z)]);
        quad([at(k + 1, bore, -z), at(k + 1, r, -z), at(k, r, -z), at(k, bore, -z)]);
        quad([at(k, r, -z), at(k + 1, r, -z), at(k + 1, r, z), at(k, r, z)]);
        quad([at(k + 1, bore, -z), at(k, bore, -z), at(k, bore, z), at(k + 1, bore, z)]);
        if next != r {
            quad([at(k + 1, r, -z), at(k + 1, next, -z), at(k + 1, next, z), at(k + 1, r, z)]);
        }
    }
}
