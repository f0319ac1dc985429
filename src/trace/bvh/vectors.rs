//! Vector arithmetic for four triangles at a time.

use fearless_simd::{Simd, f32x4};

/// The difference `a - b`.
#[inline(always)]
pub(in crate::trace) fn sub<S: Simd>(a: &[f32x4<S>; 3], b: &[f32x4<S>; 3]) -> [f32x4<S>; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// The dot product.
#[inline(always)]
pub(in crate::trace) fn dot<S: Simd>(a: &[f32x4<S>; 3], b: &[f32x4<S>; 3]) -> f32x4<S> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The cross product.
#[inline(always)]
pub(in crate::trace) fn cross<S: Simd>(a: &[f32x4<S>; 3], b: &[f32x4<S>; 3]) -> [f32x4<S>; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
