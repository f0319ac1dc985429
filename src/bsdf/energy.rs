//! How much light a rough lobe scatters in all.
//!
//! A reflectance by Schlick's approximation, `f0 + (1 - f0) (1 - cos)^5`, is linear in `f0`, so two
//! integrals are known for all of them (Karis, "Real Shading in Unreal Engine 4", SIGGRAPH course
//! 2013).

use super::ggx::Ggx;
use crate::math::sampling::lattice;
use crate::scene::SMOOTH;
use glam::{Vec2, Vec3};
use std::sync::LazyLock;

/// Entries of the table by cosine, which are spaced by its root, and by roughness.
const COSINES: usize = 48;
const ROUGHNESSES: usize = 48;

/// Microfacets per entry.
const SAMPLES: u32 = 512;

/// Bound on the error of the table, absolute where it stands for a white lobe and relative for
/// others: it must not turn into a gain of light.
const TABLE_ERROR: f32 = 1.0 / 512.0;
pub(super) const RELATIVE_ERROR: f32 = 1.0 / 128.0;

static TABLE: LazyLock<Vec<Vec2>> = LazyLock::new(|| {
    let at = |i: usize, count: usize| i as f32 / (count - 1) as f32;
    let entry = |i: usize| {
        let root = at(i % COSINES, COSINES).max(0.25 / COSINES as f32);
        integrate(root * root, at(i / COSINES, ROUGHNESSES))
    };
    (0..COSINES * ROUGHNESSES).map(entry).collect()
});

/// The parts of the light that a white lobe, seen at a cosine, reflects by microfacets: that of
/// `f0`, and that of `1 - f0`. The first contains the second.
fn integrate(cos: f32, roughness: f32) -> Vec2 {
    if roughness == 0.0 {
        return Vec2::new(1.0, rise(cos));
    }
    let (ggx, outgoing) = (Ggx::new(roughness), Vec3::new((1.0 - cos * cos).sqrt(), 0.0, cos));
    let sum: Vec2 = (0..SAMPLES)
        .map(|i| {
            let normal = ggx.sample(outgoing, lattice(i, SAMPLES, [0.5; 2]));
            let along = outgoing.dot(normal).max(0.0);
            let incoming = normal * (2.0 * along) - outgoing;
            if incoming.z <= 0.0 {
                return Vec2::ZERO;
            }
            let share = ggx.visible_from_both(outgoing, incoming) / ggx.visible(outgoing);
            Vec2::new(share, share * rise(along))
        })
        .sum();
    sum / SAMPLES as f32
}

/// The rise of reflectance towards grazing angles (Schlick 1994).
pub(super) fn rise(cos: f32) -> f32 {
    let left = (1.0 - cos).clamp(0.0, 1.0);
    let left2 = left * left;
    left2 * left2 * left
}

/// Reflectance of a microfacet at a cosine.
pub(super) fn schlick(reflectance: Vec3, cos: f32) -> Vec3 {
    reflectance + (Vec3::ONE - reflectance) * rise(cos)
}

/// [`integrate`], from the table.
fn parts(cos: f32, roughness: f32) -> Vec2 {
    let place = |share: f32, count: usize| {
        let along = share.clamp(0.0, 1.0) * (count - 1) as f32;
        let first = (along as usize).min(count - 2);
        (first, along - first as f32)
    };
    let ((x, right), (y, up)) = (place(cos.max(0.0).sqrt(), COSINES), place(roughness, ROUGHNESSES));
    let at = |x: usize, y: usize| TABLE[y * COSINES + x];
    let row = |y: usize| at(x, y).lerp(at(x + 1, y), right);
    row(y).lerp(row(y + 1), up)
}

/// Share (0..1) of light that a lobe whose microfacets reflect everything scatters once, seen at a
/// cosine. The rest meets further microfacets.
pub(super) fn scattered_once(cos: f32, roughness: f32) -> f32 {
    parts(cos, roughness).x
}

/// Factor of a lobe for light that meets further microfacets, given what is scattered once in both
/// directions.
///
/// Source: Turquin, "Practical Multiple Scattering Compensation for Microfacet Models", 2019. We
/// differ: of the two directions the one that loses less decides, so light takes a path both ways
/// with the same loss. The lobe never gains energy; half of the loss stays at grazing angles.
pub(super) fn compensation(reflectance: Vec3, once: [f32; 2]) -> Vec3 {
    let most = (once[0].max(once[1]) + TABLE_ERROR).min(1.0);
    Vec3::ONE + reflectance * (1.0 / most - 1.0)
}

/// Share of light, per channel, that a lobe of this reflectance at normal incidence scatters, seen
/// at a cosine.
pub(super) fn reflected(reflectance: Vec3, cos: f32, roughness: f32) -> Vec3 {
    if roughness < SMOOTH {
        return schlick(reflectance, cos);
    }
    let parts = parts(cos, roughness);
    let once = reflectance * (parts.x - parts.y) + Vec3::splat(parts.y);
    (once * compensation(reflectance, [parts.x; 2])).min(Vec3::ONE)
}
