//! Lights made from emissive triangles.

use super::connectivity::connected_groups;
use super::{Light, MaterialId, Scene, light_picture};
use glam::Vec3;

/// A light of emissive triangles.
pub(super) struct Lamp {
    pub(super) material: MaterialId,
    pub(super) light: Light,
    pub(super) triangles: Vec<u32>,
}

/// Returns the lights formed by the emissive triangles of a scene.
///
/// Triangles of one material that share vertex positions form one light. Two triangles that form a
/// parallelogram become a [`Light::Quad`], which is sampled with less noise than two triangles.
pub(super) fn lights(scene: &Scene) -> Vec<Lamp> {
    let emissive: Vec<u32> =
        scene.triangle_indices().filter(|&t| scene.material_of(t).is_emissive()).collect();
    connected_groups(scene, &emissive, |t| scene.triangle_materials[t as usize])
        .into_iter()
        .filter_map(|group| {
            let material = scene.triangle_materials[group[0] as usize];
            if !scene.material_of(group[0]).emits_evenly() {
                let light = light_picture::of(scene, &group)?;
                return Some(Lamp { material, light, triangles: group });
            }
            let material_of_group = scene.material_of(group[0]);
            let (radiance, has_one_side) = (material_of_group.emission, material_of_group.emits_from_front);
            let corners: Vec<_> = group.iter().map(|&t| scene.corners(t)).collect();
            let quad = as_quad(&corners, radiance, has_one_side);
            let light = quad.unwrap_or_else(|| as_mesh(corners, radiance, has_one_side));
            Some(Lamp { material, light, triangles: group })
        })
        .collect()
}

/// Returns two triangles as a parallelogram if they form one to within rounding.
///
/// The front of one that emits from its front is that of the first triangle; the other must have
/// the same.
fn as_quad(corners: &[[Vec3; 3]], radiance: Vec3, has_one_side: bool) -> Option<Light> {
    /// Allowed distance of the fourth corner from its ideal position, as a share of the longer
    /// edge. Decimal coordinates in a file cause errors of a few units in the last place.
    const TOLERANCE: f32 = 1.0 / 1024.0;
    let [a, b] = corners else { return None };
    let mut unshared = b.iter().filter(|p| !a.contains(p));
    let far = unshared.next()?;
    if unshared.next().is_some() {
        return None;
    }
    // The corner of `a` that `b` does not share lies opposite `far`.
    let opposite = (0..3).find(|&i| !b.contains(&a[i]))?;
    let (corner, p, q) = (a[opposite], a[(opposite + 1) % 3], a[(opposite + 2) % 3]);
    let (edge_u, edge_v) = (p - corner, q - corner);
    let size = edge_u.length().max(edge_v.length());
    let is_parallelogram = (corner + edge_u + edge_v - *far).length() <= size * TOLERANCE;
    let front = |[p, q, r]: &[Vec3; 3]| (*q - *p).cross(*r - *p);
    let faces_alike = !has_one_side || front(a).dot(front(b)) > 0.0;
    let quad = Light::Quad { corner, edge_u, edge_v, radiance, has_one_side };
    (is_parallelogram && faces_alike).then_some(quad)
}

fn as_mesh(corners: Vec<[Vec3; 3]>, radiance: Vec3, has_one_side: bool) -> Light {
    let areas: Vec<f32> = corners.iter().map(|[a, b, c]| (b - a).cross(c - a).length() / 2.0).collect();
    let area: f32 = areas.iter().sum();
    let add = |sum: &mut f32, a: &f32| {
        *sum += a / area;
        Some(*sum)
    };
    let mut cumulative_area: Vec<f32> = areas.iter().scan(0.0, add).collect();
    if let Some(last) = cumulative_area.last_mut() {
        *last = 1.0;
    }
    Light::Triangles { corners, cumulative_area, area, radiance, picture: None, has_one_side }
}
