//! Lights, and how emissive triangles become them.

use super::{Material, MaterialId, Sun};
use crate::math::sampling::uniform_triangle;
use glam::Vec3;
use std::collections::HashMap;

/// Something that lights surfaces. Scene space; radiance is linear Rec. 709.
#[derive(Clone, Debug, PartialEq)]
pub enum Light {
    /// A parallelogram that emits from both sides.
    Quad {
        /// One corner.
        corner: Vec3,
        /// From the corner to a neighbour.
        edge_u: Vec3,
        /// From the corner to the other neighbour.
        edge_v: Vec3,
        /// Emitted radiance.
        radiance: Vec3,
    },
    /// A connected emissive mesh that emits from both sides.
    Triangles {
        /// Its triangles' corners.
        corners: Vec<[Vec3; 3]>,
        /// Share of the area in the triangles up to and including each; the last is one.
        cumulative_area: Vec<f32>,
        /// Total area, scene units squared.
        area: f32,
        /// Emitted radiance.
        radiance: Vec3,
    },
    /// A point.
    Point {
        /// Where it is.
        position: Vec3,
        /// Radiant intensity in radiance * scene units squared.
        intensity: Vec3,
    },
    /// A distant disk.
    Sun {
        /// Unit direction towards it.
        direction: Vec3,
        /// Cosine of its angular radius.
        cos_angular_radius: f32,
        /// Irradiance on a surface that faces it.
        irradiance: Vec3,
    },
    /// The scene's sky, as a light.
    Sky,
}

impl From<Sun> for Light {
    fn from(sun: Sun) -> Self {
        let Sun { direction, angular_radius, irradiance } = sun;
        Self::Sun { direction, cos_angular_radius: angular_radius.cos(), irradiance }
    }
}

/// The point of a mesh that belongs to the point `u` of the unit square, uniform by area, and its triangle's number.
/// `cumulative_area` is that of [`Light::Triangles`].
pub(crate) fn point_on_mesh(corners: &[[Vec3; 3]], cumulative_area: &[f32], u: [f32; 2]) -> (Vec3, usize) {
    let chosen = cumulative_area.partition_point(|&c| c <= u[0]).min(corners.len() - 1);
    let below = if chosen == 0 { 0.0 } else { cumulative_area[chosen - 1] };
    let within = ((u[0] - below) / (cumulative_area[chosen] - below)).clamp(0.0, 1.0);
    let [a, b, c] = corners[chosen];
    let [b1, b2] = uniform_triangle([within, u[1]]);
    (a + (b - a) * b1 + (c - a) * b2, chosen)
}

/// The lights that a scene's emissive triangles are.
///
/// Triangles of one material that share vertex positions form one light; two triangles that form a parallelogram
/// become a [`Light::Quad`], which is sampled with less noise than two triangles.
pub(super) fn from_emissive_triangles(
    positions: &[Vec3],
    triangles: &[[u32; 3]],
    triangle_materials: &[MaterialId],
    materials: &[Material],
) -> Vec<Light> {
    let emissive: Vec<usize> =
        (0..triangles.len()).filter(|&t| materials[triangle_materials[t].0 as usize].is_emissive()).collect();
    connected_groups(&emissive, positions, triangles, triangle_materials)
        .into_iter()
        .map(|group| {
            let radiance = materials[triangle_materials[group[0]].0 as usize].emission;
            let corners: Vec<_> =
                group.iter().map(|&t| triangles[t].map(|v| positions[v as usize])).collect();
            as_quad(&corners, radiance).unwrap_or_else(|| as_mesh(corners, radiance))
        })
        .collect()
}

/// Groups of triangles of one material connected by equal vertex positions, in the order of their first triangle.
fn connected_groups(
    members: &[usize],
    positions: &[Vec3],
    triangles: &[[u32; 3]],
    triangle_materials: &[MaterialId],
) -> Vec<Vec<usize>> {
    let mut parent: Vec<usize> = (0..members.len()).collect();
    let mut owner: HashMap<(MaterialId, [u32; 3]), usize> = HashMap::new();
    for (i, &t) in members.iter().enumerate() {
        for v in triangles[t] {
            let key = (triangle_materials[t], (positions[v as usize] + 0.0).to_array().map(f32::to_bits));
            let first = *owner.entry(key).or_insert(i);
            let (a, b) = (root(&mut parent, first), root(&mut parent, i));
            parent[a.max(b)] = a.min(b);
        }
    }
    let mut groups: Vec<Vec<usize>> = Vec::new();
    let mut group_of_root: HashMap<usize, usize> = HashMap::new();
    for (i, &t) in members.iter().enumerate() {
        let r = root(&mut parent, i);
        let group = *group_of_root.entry(r).or_insert_with(|| {
            groups.push(Vec::new());
            groups.len() - 1
        });
        groups[group].push(t);
    }
    groups
}

fn root(parent: &mut [usize], mut i: usize) -> usize {
    while parent[i] != i {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    i
}

/// Two triangles as one parallelogram, where they are one to within rounding.
fn as_quad(corners: &[[Vec3; 3]], radiance: Vec3) -> Option<Light> {
    let [a, b] = corners else { return None };
    let mut unshared = b.iter().filter(|p| !a.contains(p));
    let far = unshared.next()?;
    if unshared.next().is_some() {
        return None;
    }
    // The corner of `a` that `b` does not share lies opposite to `far`.
    let opposite = (0..3).find(|&i| !b.contains(&a[i]))?;
    let (corner, p, q) = (a[opposite], a[(opposite + 1) % 3], a[(opposite + 2) % 3]);
    let (edge_u, edge_v) = (p - corner, q - corner);
    let size = edge_u.length().max(edge_v.length());
    // Decimal coordinates leave a few ulps between p + q - corner and the stored far corner.
    let is_parallelogram = (corner + edge_u + edge_v - *far).length() <= size / 1024.0;
    is_parallelogram.then_some(Light::Quad { corner, edge_u, edge_v, radiance })
}

fn as_mesh(corners: Vec<[Vec3; 3]>, radiance: Vec3) -> Light {
    let areas: Vec<f32> = corners.iter().map(|[a, b, c]| (b - a).cross(c - a).length() / 2.0).collect();
    let area: f32 = areas.iter().sum();
    let mut sum = 0.0;
    let mut cumulative_area: Vec<f32> = areas
        .iter()
        .map(|a| {
            sum += a / area;
            sum
        })
        .collect();
    if let Some(last) = cumulative_area.last_mut() {
        *last = 1.0;
    }
    Light::Triangles { corners, cumulative_area, area, radiance }
}
