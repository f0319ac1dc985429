//! Lights that show a picture: screens, light boxes and lamp shades. The picture decides where the
//! light is sampled, so that a small bright window on a dark screen is found.

use super::{Light, LightPicture, Scene};
use crate::raster::color::luminance;
use glam::{Vec2, Vec3};

/// Largest number of pieces of a light.
const MAX_PIECES: usize = 1 << 16;

/// Largest number of pieces along an edge of a triangle.
const MAX_PER_EDGE: usize = 64;

/// Texels along an edge of a piece, where the limits allow it.
const TEXELS_PER_PIECE: f32 = 4.0;

/// Part of the samples that is divided by area, whatever the picture: a piece whose light was
/// missed is still sampled, with a weight of at most its inverse.
const EVEN_PART: f64 = 1.0 / 16.0;

/// Points along each edge at which the light of a piece is measured.
const MEASURED: usize = 4;

/// A piece of a triangle, with the mean of the picture on it.
struct Piece {
    corners: [Vec3; 3],
    uvs: [Vec2; 3],
    area: f64,
    mean: Vec3,
}

/// Returns the light of connected triangles of one material with a picture; `None` where the
/// picture is black there.
pub(super) fn of(scene: &Scene, group: &[u32]) -> Option<Light> {
    let most = ((MAX_PIECES / group.len()).max(1) as f64).sqrt() as usize;
    let pieces: Vec<Piece> = group
        .iter()
        .flat_map(|&t| pieces_of(scene, t, most))
        .filter(|piece| piece.area > 0.0) // in f32, a piece of a tiny triangle may collapse
        .collect();
    let area: f64 = pieces.iter().map(|p| p.area).sum();
    let sum = pieces.iter().fold([0.0; 3], |sum: [f64; 3], piece| {
        let mean = piece.mean.to_array();
        std::array::from_fn(|i| sum[i] + f64::from(mean[i]) * piece.area)
    });
    let mean = Vec3::from_array(sum.map(|channel| (channel / area) as f32));
    let material = scene.material_of(group[0]);
    let mean_luminance = f64::from(luminance(mean * material.emission));
    if mean_luminance <= 0.0 {
        return None;
    }
    // A colour that the measured places miss may still be there.
    let mean = mean.max(Vec3::splat(mean.max_element() / 1024.0));
    // Probability of each piece: by its light, and a part by its area.
    let probability = |piece: &Piece| {
        let light = f64::from(luminance(piece.mean * material.emission)) / mean_luminance;
        (EVEN_PART + (1.0 - EVEN_PART) * light) * piece.area / area
    };
    let mut cumulative = 0.0;
    let mut cumulative_area: Vec<f32> = pieces
        .iter()
        .map(|piece| {
            cumulative += probability(piece);
            cumulative as f32
        })
        .collect();
    *cumulative_area.last_mut()? = 1.0;
    let picture = LightPicture {
        material: scene.triangle_materials[group[0] as usize],
        mean,
        hull: group.iter().map(|&t| scene.corners(t)).collect(),
        sampled_area: pieces.iter().map(|piece| (piece.area / probability(piece)) as f32).collect(),
        uvs: pieces.iter().map(|piece| piece.uvs).collect(),
    };
    Some(Light::Triangles {
        corners: pieces.iter().map(|piece| piece.corners).collect(),
        cumulative_area,
        area: area as f32,
        radiance: material.emission * mean,
        picture: Some(Box::new(picture)),
        has_one_side: material.emits_from_front,
    })
}

/// Cuts a triangle into pieces of a few texels.
fn pieces_of(scene: &Scene, triangle: u32, most: usize) -> Vec<Piece> {
    let corners = scene.corners(triangle);
    let uvs =
        scene.triangles[triangle as usize].map(|v| scene.uvs.get(v as usize).copied().unwrap_or(Vec2::ZERO));
    let per_edge = per_edge(scene, triangle, uvs).clamp(1, most.min(MAX_PER_EDGE));
    let at = |i: usize, j: usize| [i as f32 / per_edge as f32, j as f32 / per_edge as f32];
    let mut pieces = Vec::with_capacity(per_edge * per_edge);
    for i in 0..per_edge {
        for j in 0..per_edge - i {
            let upright = [at(i, j), at(i + 1, j), at(i, j + 1)];
            pieces.push(piece(scene, triangle, (corners, uvs), upright));
            if i + j + 2 <= per_edge {
                let turned = [at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                pieces.push(piece(scene, triangle, (corners, uvs), turned));
            }
        }
    }
    pieces
}

/// Returns the number of pieces along an edge for the resolution of the picture.
fn per_edge(scene: &Scene, triangle: u32, uvs: [Vec2; 3]) -> usize {
    let material = scene.material_of(triangle);
    let used = [material.emission_texture, material.coverage_texture].into_iter().flatten();
    let texels = |map: super::TextureRef| {
        let texture = &scene.textures[map.texture.0 as usize];
        let size = Vec2::new(texture.width as f32, texture.height as f32) * map.scale;
        let [a, b, c] = uvs.map(|uv| uv * size);
        (b - a).length().max((c - b).length()).max((a - c).length())
    };
    let most = used.map(texels).fold(1.0, f32::max);
    (most / TEXELS_PER_PIECE).ceil().min(MAX_PER_EDGE as f32) as usize
}

fn piece(
    scene: &Scene,
    triangle: u32,
    (corners, uvs): ([Vec3; 3], [Vec2; 3]),
    places: [[f32; 2]; 3],
) -> Piece {
    let point =
        |[b1, b2]: [f32; 2]| corners[0] + (corners[1] - corners[0]) * b1 + (corners[2] - corners[0]) * b2;
    let uv = |[b1, b2]: [f32; 2]| uvs[0] + (uvs[1] - uvs[0]) * b1 + (uvs[2] - uvs[0]) * b2;
    let (corners, uvs) = (places.map(point), places.map(uv));
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    let area = (b - a).cross(c - a).length() / 2.0;
    Piece { corners, uvs, area, mean: mean_texel(scene, triangle, uvs) }
}

/// Returns the mean of the picture over the middles of small triangles.
fn mean_texel(scene: &Scene, triangle: u32, [a, b, c]: [Vec2; 3]) -> Vec3 {
    let material = scene.material_of(triangle);
    let (mut sum, mut count) = (Vec3::ZERO, 0.0);
    let step = 1.0 / MEASURED as f32;
    for i in 0..MEASURED {
        for j in 0..MEASURED - i {
            let turned = (i + j + 2 <= MEASURED).then_some(2.0 / 3.0);
            for within in [Some(1.0 / 3.0), turned].into_iter().flatten() {
                let [b1, b2] = [(i as f32 + within) * step, (j as f32 + within) * step];
                let uv = a + (b - a) * b1 + (c - a) * b2;
                sum += material.emission_texel(&scene.textures, uv);
                count += 1.0;
            }
        }
    }
    sum / count
}
