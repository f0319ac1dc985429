//! Rays from one origin, stored by component.

use super::rays::LANES;
use crate::math::Ray;
use fearless_simd::{Simd, SimdBase, f32x8};
use glam::Vec3;

/// Largest number of rays of a bundle.
pub const BUNDLE_RAYS: usize = 2 * LANES;

/// Smallest number of rays that are traced as a bundle; fewer are traced one at a time.
pub const MIN_RAYS: usize = 3;

/// Up to [`BUNDLE_RAYS`] rays from one origin, scene space.
#[derive(Clone, Debug)]
pub struct RayBundle {
    pub(super) origin: Vec3,
    /// Directions by axis.
    pub(super) directions: [[f32; BUNDLE_RAYS]; 3],
    pub(super) t_max: [f32; BUNDLE_RAYS],
    pub(super) len: usize,
}

impl RayBundle {
    /// A bundle without rays.
    pub fn new(origin: Vec3) -> Self {
        Self { origin, directions: [[0.0; BUNDLE_RAYS]; 3], t_max: [0.0; BUNDLE_RAYS], len: 0 }
    }

    /// Origin of the rays.
    pub fn origin(&self) -> Vec3 {
        self.origin
    }

    /// Number of rays.
    pub fn len(&self) -> usize {
        self.len
    }

    /// True where the bundle has no ray.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Adds a ray from the bundle's origin.
    ///
    /// # Panics
    /// If the bundle has [`BUNDLE_RAYS`] rays already.
    #[inline(always)]
    pub fn push(&mut self, direction: Vec3, t_max: f32) {
        let [dx, dy, dz] = &mut self.directions;
        (dx[self.len], dy[self.len], dz[self.len]) = direction.into();
        self.t_max[self.len] = t_max;
        self.len += 1;
    }

    /// The rays.
    pub fn rays(&self) -> impl Iterator<Item = Ray> {
        (0..self.len).map(|ray| self.ray(ray))
    }

    /// Directions by axis.
    #[inline(always)]
    pub(in crate::trace) fn directions(&self) -> &[[f32; BUNDLE_RAYS]; 3] {
        &self.directions
    }

    /// One of the rays.
    pub fn ray(&self, ray: usize) -> Ray {
        let direction = Vec3::from(self.directions.each_ref().map(|of_axis| of_axis[ray]));
        Ray { origin: self.origin, direction, t_max: self.t_max[ray] }
    }
}

/// Loads eight of a bundle's values: those of the first (0) or the second (1) half.
///
/// Here and elsewhere no closure returns vectors: it would not be compiled for the SIMD level that
/// is dispatched to.
#[inline(always)]
pub(super) fn lane_values<S: Simd>(simd: S, from: &[f32; BUNDLE_RAYS], half: usize) -> f32x8<S> {
    f32x8::from_slice(simd, &from[half * LANES..(half + 1) * LANES])
}
