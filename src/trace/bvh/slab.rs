//! The boxes of a node's children against a ray, all in one step.
//!
//! Source: Ize, "Robust BVH Ray Traversal", JCGT 2013: the far distance is widened by the rounding error of its own
//! computation, so that no box is missed whose content is hit.

use super::node::{Node, WIDTH};
use crate::math::Ray;
use fearless_simd::{f32x8, prelude::*};

/// 1 + 2 gamma(3), the bound on the relative error of `(bound - origin) * inverse`.
pub(super) const FAR_SLACK: f32 = 1.000_000_4;

/// The least component of a direction: 2^-80.
pub(super) const TINY: f32 = f32::from_bits((127 - 80) << 23);

/// A component of a direction that may be divided by. Zero would make 0 * inf = NaN for an origin in the plane; it has a
/// finite inverse and bends the ray by less than any rounding.
#[inline(always)]
pub(super) fn safe_component(d: f32) -> f32 {
    if d.abs() < TINY { TINY.copysign(d) } else { d }
}

/// A ray prepared for box tests.
pub(super) struct SlabRay<S: Simd> {
    origin: [f32x8<S>; 3],
    inverse: [f32x8<S>; 3],
    /// Index into [`Node::bounds`] of the plane met first, per axis; the other is `^ 1`.
    near: [usize; 3],
}

impl<S: Simd> SlabRay<S> {
    #[inline(always)]
    pub(super) fn new(simd: S, ray: &Ray) -> Self {
        let inverse = ray.direction.to_array().map(|d| 1.0 / safe_component(d));
        Self {
            origin: splat(simd, ray.origin.to_array()),
            inverse: splat(simd, inverse),
            near: std::array::from_fn(|axis| 2 * axis + usize::from(inverse[axis] < 0.0)),
        }
    }

    /// Which children the ray meets before `t_max` (a bit each), and where it enters them.
    #[inline(always)]
    pub(super) fn children(&self, node: &Node, t_max: f32) -> (u32, [f32; WIDTH]) {
        let simd = self.origin[0].simd;
        let [x, y, z] = self.near;
        let enter = self.plane(node, x).max(self.plane(node, y)).max(self.plane(node, z));
        let enter = enter.max(f32x8::splat(simd, 0.0));
        let leave = self.plane(node, x ^ 1).min(self.plane(node, y ^ 1)).min(self.plane(node, z ^ 1));
        let leave = (leave * f32x8::splat(simd, FAR_SLACK)).min(f32x8::splat(simd, t_max));
        (enter.simd_le(leave).to_bitmask() as u32, enter.into())
    }

    /// Where the ray meets the plane `which` of each child.
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
