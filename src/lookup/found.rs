//! The light that a look-up finds around a point.

use super::policy::EDGE_GAP;
use glam::Vec3;

/// Sums over the samples around a point that lie on its plane.
#[derive(Default)]
pub(super) struct Sums {
    pub(super) light: Vec3,
    pub(super) smooth: Vec3,
    /// Sum of the bilinear weights.
    pub(super) coverage: f32,
    /// Sum of the weights of samples behind the plane.
    pub(super) open: f32,
    pub(super) spread_and_jump: [f32; 2],
}

/// The light that one reference has for a point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sampled {
    /// Light straight from the lights.
    pub(super) light: Vec3,
    pub(super) smooth: Vec3,
    /// Weight in the mean over references: coverage times density squared.
    pub(super) weight: f32,
    /// Samples per unit of surface area, scene units.
    pub(super) density: f32,
    /// The share of bilinear weight that was found, 0..1.
    pub(super) coverage: f32,
    /// The share of bilinear weight of samples behind the surface, which ends before them, 0..1.
    pub(super) open: f32,
    /// The difference between the samples' direct light, as a share of all light of the brightest.
    pub(super) spread: f32,
    /// The spread where the samples lie on both sides of a shadow's edge, else zero.
    pub(super) jump: f32,
}

/// The spread of a few values as a share of the largest plus the `smooth` light there, and the
/// jump: the spread where one gap is most of the range, or where the range exceeds `wide` times the
/// largest, else zero.
#[inline]
pub(super) fn spread_and_jump(brightness: &mut [f32], wide: f32, smooth: f32) -> [f32; 2] {
    brightness.sort_unstable_by(f32::total_cmp);
    let (Some(&least), Some(&most)) = (brightness.first(), brightness.last()) else { return [0.0; 2] };
    let range = most - least;
    let gap = brightness.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f32::max);
    let spread = range / (most + smooth).max(f32::MIN_POSITIVE);
    [spread, if gap >= EDGE_GAP * range || range > wide * most { spread } else { 0.0 }]
}

/// The light found for a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoundLight {
    /// Light straight from the lights, as the radiance of a white surface.
    pub light: Vec3,
    /// Smooth light, as the radiance of a white surface; zero without bounces.
    pub smooth: Vec3,
    /// True where the direct light is extrapolated beyond the samples, or interpolated between
    /// samples on both sides of a shadow's edge.
    pub is_guess: bool,
}
