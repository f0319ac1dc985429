//! Hashes of triangles.

use super::hasher::{ContentHash, ContentHasher};
use crate::scene::Scene;
use glam::{DVec3, I64Vec3};
use rayon::prelude::*;

/// Steps of a hashed coordinate per scene unit. A step is less than 1/250,000 of the scene's
/// diagonal.
///
/// A change of the model's box moves the origin of scene space, and with it the rounding of all
/// coordinates, by up to 2^-15 units. It must not change the hash of what stayed in its place. With
/// this step at most one triangle in twenty is hashed differently then, which costs time only.
const STEPS_PER_UNIT: f64 = 512.0;

/// Returns the hashes of all triangles of a scene, each with its triangle, ascending.
///
/// A triangle is hashed by its corners in world space, their normals, and, where its material has a
/// texture, their texture coordinates. Its number, the order and the winding of its corners, its
/// material and the names and files that it belongs to do not matter. Light does not depend on the
/// winding: surfaces are lit and emit on both sides, and the inside of a solid of glass follows
/// from its mesh.
pub fn hashes_of_triangles(scene: &Scene) -> Vec<(ContentHash, u32)> {
    let mut hashes: Vec<(ContentHash, u32)> =
        scene.triangle_indices().into_par_iter().map(|t| (hash_triangle(scene, t), t)).collect();
    hashes.par_sort_unstable();
    hashes
}

/// A corner of a triangle as it is hashed: steps from the world's origin, normal and texture
/// coordinate by their bits.
type Corner = ([i64; 3], [u32; 3], [u32; 2]);

fn hash_triangle(scene: &Scene, triangle: u32) -> ContentHash {
    let vertices = scene.triangles[triangle as usize].map(|v| v as usize);
    let material = scene.material_of(triangle);
    let is_textured = material.textures().next().is_some();
    // Adding zero makes -0 equal to +0.
    let normal = |v: usize| scene.normals.get(v).map_or([0; 3], |n| (*n + 0.0).to_array().map(f32::to_bits));
    let uv = |v: usize| scene.uvs.get(v).map_or([0; 2], |uv| (*uv + 0.0).to_array().map(f32::to_bits));
    let corner =
        |v: usize| -> Corner { (steps(scene, v), normal(v), if is_textured { uv(v) } else { [0; 2] }) };
    let mut corners = vertices.map(corner);
    corners.sort_unstable();
    let mut hasher = ContentHasher::new(b"triangle");
    hasher.word(scene.frame.units_per_metre.to_bits());
    for (steps, normal, uv) in corners {
        steps.into_iter().for_each(|at| hasher.word(at as u64));
        let [x, y, z] = normal.map(u64::from);
        let [u, v] = uv.map(u64::from);
        hasher.word(x | y << 32);
        hasher.word(z);
        hasher.word(u | v << 32);
    }
    hasher.finish()
}

/// A vertex in steps from the world's origin.
fn steps(scene: &Scene, vertex: usize) -> [i64; 3] {
    let frame = &scene.frame;
    // The origin is a whole number of scene units.
    let units: DVec3 = frame.origin_in_world_m * frame.units_per_metre + scene.positions[vertex].as_dvec3();
    // Far outside of the range of i64 the conversion saturates.
    let steps: I64Vec3 = (units * STEPS_PER_UNIT).round().as_i64vec3();
    steps.to_array()
}
