//! Shading normals tilted by a normal map.
//!
//! The tangent frame is that of the triangle: the directions in which the place in the picture
//! moves right and up. Mirrored texture coordinates so keep their relief, and vertex tangents are
//! not needed. The frame is straightened about the interpolated normal, as in Mikkelsen,
//! "Simulation of Wrinkled Surfaces Revisited", 2008.

use crate::scene::{NormalMap, Scene};
use glam::{DVec3, Vec2, Vec3};

/// Returns the shading normal of a point, tilted by the normal map of its material; the plain one
/// where there is none, where the map or the texture coordinates give no direction, and where the
/// tilted one would leave the viewer's side of the triangle.
///
/// `plain` is the interpolated and `geometric` the triangle's normal, both of unit length and on
/// the viewer's side, which is the front where `is_front`.
pub(super) fn tilted(
    scene: &Scene,
    triangle: u32,
    uv: Vec2,
    (plain, geometric): (Vec3, Vec3),
    is_front: bool,
) -> Vec3 {
    let Some(map) = scene.material_of(triangle).detail.normal else { return plain };
    let direction = map.direction(&scene.textures, uv);
    if direction.x == 0.0 && direction.y == 0.0 {
        return plain;
    }
    // From behind, a bump is a dent: the whole direction is turned.
    let [out, side] = if is_front { [plain, geometric] } else { [-plain, -geometric] };
    let Some([right, up]) = tangents(scene, triangle, &map, out) else { return plain };
    let turned = right * direction.x + up * direction.y + out * direction.z;
    match turned.try_normalize() {
        Some(n) if n.dot(side) > 0.0 && direction.z > 0.0 => {
            if is_front {
                n
            } else {
                -n
            }
        }
        _ => plain,
    }
}

/// Unit directions, at right angles to a unit normal on the front side, in which the place in a
/// picture moves right and up; `None` where texture coordinates have no area.
fn tangents(scene: &Scene, triangle: u32, map: &NormalMap, normal: Vec3) -> Option<[Vec3; 2]> {
    let [a, b, c] = scene.triangles[triangle as usize].map(|vertex| vertex as usize);
    let [e1, e2] = [b, c].map(|v| (scene.positions[v] - scene.positions[a]).as_dvec3());
    let uvs = &*scene.uvs;
    let uv = |v: usize| uvs.get(v).copied().unwrap_or_default();
    let [d1, d2] = [b, c].map(|v| map.texture.along(uv(v) - uv(a)).as_dvec2());
    // In f64, so that products of small numbers do not vanish.
    let area = d1.perp_dot(d2);
    if area == 0.0 || !area.is_finite() {
        return None;
    }
    let hand = area.signum();
    let along: DVec3 = (e1 * d2.y - e2 * d1.y) * hand;
    let normal = normal.as_dvec3();
    let right = (along - normal * normal.dot(along)).try_normalize()?;
    Some([right.as_vec3(), (normal.cross(right) * hand).as_vec3()])
}
