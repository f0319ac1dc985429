//! The outline of a plane surface: the edges around the triangles that lie in one plane with a
//! given one, have its material, and hang together with it.

use afterimage::Scene;
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::collections::{HashMap, HashSet};

/// Number of triangles of a surface that are looked at; a surface of more is shown as its first
/// triangle alone.
const MOST_TRIANGLES: usize = 200_000;

/// Planes whose normals differ by less are one: the cosine of half a degree.
const SAME_NORMAL: f32 = 0.999_96;

/// A corner as a key: equal bits are one place.
type Place = [u32; 3];

/// Returns the outline of the surface around a triangle as lines in world metres.
pub fn surface_outline(scene: &Scene, triangle: u32) -> Vec<[DVec3; 2]> {
    let members = coplanar(scene, triangle);
    let connected = connected(scene, triangle, &members);
    // An edge inside of the surface belongs to two of its triangles.
    let mut uses: HashMap<[Place; 2], (usize, [Vec3; 2])> = HashMap::new();
    for edge in connected.iter().flat_map(|t| edges(scene.corners(*t))) {
        uses.entry(key(edge)).or_insert((0, edge)).0 += 1;
    }
    let around = uses.into_values().filter(|(count, _)| *count == 1);
    around.map(|(_, edge)| edge.map(|p| scene.frame.world_from_scene(p))).collect()
}

/// Triangles of the same material in the plane of one, which is the first.
fn coplanar(scene: &Scene, triangle: u32) -> Vec<u32> {
    let [a, b, c] = scene.corners(triangle);
    let normal = (b - a).cross(c - a).normalize_or_zero();
    let size = (b - a).length().max((c - a).length());
    let material = scene.triangle_materials[triangle as usize];
    let is_in_plane = |t: &u32| {
        let [p, q, r] = scene.corners(*t);
        let is_near = |point: Vec3| (point - a).dot(normal).abs() < 1e-3 * size.max(1e-3);
        scene.triangle_materials[*t as usize] == material
            && [p, q, r].into_iter().all(is_near)
            && (q - p).cross(r - p).normalize_or_zero().dot(normal).abs() > SAME_NORMAL
    };
    let found: Vec<u32> = (0..scene.triangles.len() as u32).into_par_iter().filter(is_in_plane).collect();
    if found.len() > MOST_TRIANGLES { vec![triangle] } else { found }
}

/// Those of the triangles that are reached from one over shared corners.
fn connected(scene: &Scene, triangle: u32, members: &[u32]) -> Vec<u32> {
    let mut at_place: HashMap<Place, Vec<u32>> = HashMap::new();
    for t in members {
        for corner in scene.corners(*t) {
            at_place.entry(place(corner)).or_default().push(*t);
        }
    }
    let (mut reached, mut next) = (HashSet::from([triangle]), vec![triangle]);
    while let Some(t) = next.pop() {
        let around = scene.corners(t).map(|corner| at_place.remove(&place(corner)).unwrap_or_default());
        next.extend(around.into_iter().flatten().filter(|neighbour| reached.insert(*neighbour)));
    }
    reached.into_iter().collect()
}

fn edges([a, b, c]: [Vec3; 3]) -> [[Vec3; 2]; 3] {
    [[a, b], [b, c], [c, a]]
}

fn place(p: Vec3) -> Place {
    // Minus zero is zero.
    (p + Vec3::ZERO).to_array().map(f32::to_bits)
}

fn key([a, b]: [Vec3; 2]) -> [Place; 2] {
    let (a, b) = (place(a), place(b));
    if a < b { [a, b] } else { [b, a] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use afterimage::scene::{Material, SceneBuilder};
    use glam::Vec2;

    #[test]
    fn the_outline_of_a_wall_of_two_quads_is_its_border() {
        let mut b = SceneBuilder::new("wall");
        let [m, other] = ["m", "n"].map(|name| b.add_material(Material::diffuse(name, Vec3::ONE)));
        let p = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
        let mut quad = |x: f64, z: f64, m| {
            b.add_quad([p(x, 0.0, z), p(x + 2.0, 0.0, z), p(x + 2.0, 3.0, z), p(x, 3.0, z)], Vec2::ONE, m);
        };
        quad(0.0, 0.0, m);
        quad(2.0, 0.0, m);
        quad(4.0, 0.0, other);
        quad(0.0, 5.0, m);
        quad(9.0, 0.0, m);
        let scene = b.finish().unwrap();
        let lines = surface_outline(&scene, 0);
        let length: f64 = lines.iter().map(|[a, b]| a.distance(*b)).sum();
        assert_eq!(lines.len(), 6, "{lines:?}");
        assert!((length - 14.0).abs() < 1e-3, "{length}");
    }
}
