//! Sample points in the unit square, and mappings from there to directions and triangles.

use glam::{Mat3, Vec3};
use std::f32::consts::TAU;

/// 2^32 / golden ratio. Integer overflow gives the fraction of a multiple exactly, without a call
/// to `floor`.
pub(crate) const GOLDEN: u32 = 0x9e37_79b9;

/// The largest f32 below one.
pub(crate) const BELOW_ONE: f32 = 1.0 - f32::EPSILON / 2.0;

/// Returns point `index` of `count` in the unit square, moved by `shift` and wrapped (a
/// Cranley-Patterson rotation).
///
/// The points are a rank-1 lattice: evenly stratified along x for any count, and spaced by the
/// golden ratio along y. All samples of a light share one random shift, which keeps the estimate
/// unbiased and needs only one hash.
pub fn lattice(index: u32, count: u32, shift: [f32; 2]) -> [f32; 2] {
    let along = (index as f32 + shift[0]) / count as f32;
    let across = (index.wrapping_mul(GOLDEN) >> 8) as f32 * (1.0 / 16_777_216.0) + shift[1];
    [below_one(along), below_one(if across >= 1.0 { across - 1.0 } else { across })]
}

/// Clamps values that rounding raised to one.
fn below_one(x: f32) -> f32 {
    x.min(BELOW_ONE)
}

/// Returns a direction about +Z with density cos / pi (Malley's method: a disk projected up to the
/// hemisphere).
pub fn cosine_hemisphere(u: [f32; 2]) -> Vec3 {
    let r = u[0].sqrt();
    let (sin, cos) = (TAU * u[1]).sin_cos();
    Vec3::new(r * cos, r * sin, (1.0 - u[0]).max(0.0).sqrt())
}

/// Returns a direction in the cone of half-angle `acos(cos_max)` about +Z, uniform in solid angle.
pub fn uniform_cone(u: [f32; 2], cos_max: f32) -> Vec3 {
    let cos_theta = 1.0 - u[0] * (1.0 - cos_max);
    let sin_theta = (1.0 - cos_theta * cos_theta).max(0.0).sqrt();
    let (sin, cos) = (TAU * u[1]).sin_cos();
    Vec3::new(sin_theta * cos, sin_theta * sin, cos_theta)
}

/// Returns barycentric coordinates (b1, b2) uniform over a triangle.
pub fn uniform_triangle(u: [f32; 2]) -> [f32; 2] {
    let root = u[0].sqrt();
    [root * (1.0 - u[1]), root * u[1]]
}

/// Returns a right-handed orthonormal frame whose third axis is the unit vector `n`.
///
/// Source: Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 2017. It has no branch and
/// no singular direction.
pub fn frame_around(n: Vec3) -> Mat3 {
    let sign = 1f32.copysign(n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    Mat3::from_cols(
        Vec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x),
        Vec3::new(b, sign + n.y * n.y * a, -n.y),
        n,
    )
}
