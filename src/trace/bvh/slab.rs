//! Intersects a ray with the boxes of a node's children, all in one step.
//!
//! Source: Ize, "Robust BVH Ray Traversal", JCGT 2013: the far distance is widened by the rounding
//! error of its own computation, so that no box is missed whose content is hit.

use super::node::{Node, WIDTH};
use crate::math::Ray;
use fearless_simd::{f32x8, prelude::*};

/// Factor of the far distance: 1 + 2 gamma(3), with gamma(3) the bound on the relative error of
/// `(bound - origin) * inverse`.
pub(super) const FAR_SLACK: f32 = 1.000_000_4;

/// Smallest magnitude of a direction's component: 2^-80.
pub(super) const TINY: f32 = f32::from_bits((127 - 80) << 23);

/// Returns a component of a direction whose inverse is finite. A zero would give 0 * inf = NaN for
/// an origin in the plane; [`TINY`] bends the ray by less than any rounding.
#[inline(always)]
pub(in crate::trace) fn safe_component(d: f32) -> f32 {
    if d.abs() < TINY { TINY.copysign(d) } else { d }
}

/// A ray prepared for box tests.
pub(super) struct SlabRay<S: Simd> {
    origin: [f32x8<S>; 3],
    /// One over the components of the direction.
    inverse: [f32x8<S>; 3],
    /// Per axis, the index into [`Node::bounds`] of the plane met first; that of the other is `^
    /// 1`.
    near: [usize; 3],
}

impl<S: Simd> SlabRay<S> {
    /// Prepares a ray.
    #[inline(always)]
    pub(super) fn new(simd: S, ray: &Ray) -> Self {
        let inverse = ray.direction.to_array().map(|d| 1.0 / safe_component(d));
        Self {
            origin: splat(simd, ray.origin.to_array()),
            inverse: splat(simd, inverse),
            near: std::array::from_fn(|axis| 2 * axis + usize::from(inverse[axis] < 0.0)),
        }
    }

    /// Returns a bit per child that the ray meets before `t_max`, and the distances at which it
    /// enters them.
    #[inline(always)]
    pub(super) fn children(&self, node: &Node, t_max: f32) -> (u32, [f32; WIDTH]) {
        let simd = self.origin[0].simd;
        let [x, y, z] = self.near;
        // Enter at the farthest near plane, not before the origin.
        let enter = self.plane(node, x).max(self.plane(node, y)).max(self.plane(node, z));
        let enter = enter.max(f32x8::splat(simd, 0.0));
        // Leave at the nearest far plane, not after the end.
        let leave = self.plane(node, x ^ 1).min(self.plane(node, y ^ 1)).min(self.plane(node, z ^ 1));
        let leave = (leave * f32x8::splat(simd, FAR_SLACK)).min(f32x8::splat(simd, t_max));
        (enter.simd_le(leave).to_bitmask() as u32, enter.into())
    }

    /// Distance to plane `which` of each child's box.
    #[inline(always)]
    fn plane(&self, node: &Node, which: usize) -> f32x8<S> {
        let (origin, inverse) = (self.origin[which / 2], self.inverse[which / 2]);
        (f32x8::load_array_ref(origin.simd, &node.bounds[which]) - origin) * inverse
    }
}

#[inline(always)]
fn splat<S: Simd>(simd: S, [x, y, z]: [f32; 3]) -> [f32x8<S>; 3] {
    [f32x8::splat(simd, x), f32x8::splat(simd, y), f32x8::splat(simd, z)]
}
