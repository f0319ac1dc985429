//! Intersects several rays of one origin and one largest axis with one triangle.
//!
//! The arithmetic is that of [`super::packet`] with rays and triangles exchanged, so the bits are
//! the same. `V` is a vector of as many numbers as there are rays.

use fearless_simd::{Simd, SimdFloat, SimdMask, f32x8};

/// Number of rays of a tile or a bundle that are tested at once.
pub(in crate::trace) const LANES: usize = 8;

/// The shear of as many rays.
pub(super) type Shear8<S> = RayShear<f32x8<S>>;

/// A triangle relative to the origin of several rays, with the axes permuted so that the largest
/// axis of the directions comes last.
#[derive(Clone, Copy)]
pub(in crate::trace) struct SeenTriangle<V> {
    corners: [[V; 3]; 3],
}

/// The shear of several rays (Woop).
#[derive(Clone, Copy)]
pub(in crate::trace) struct RayShear<V> {
    /// Shear of the first permuted axis.
    pub(in crate::trace) x: V,
    /// Shear of the second permuted axis.
    pub(in crate::trace) y: V,
    /// One over the component along the largest axis.
    pub(in crate::trace) z: V,
}

/// The hits of several rays with a triangle.
pub(in crate::trace) struct RayHits<V, M> {
    /// Rays whose line passes through the triangle, in front of or behind their origin.
    pub(in crate::trace) inside: M,
    /// Distance, in units of the direction.
    pub(in crate::trace) t: V,
    /// Barycentric weights of the second and the third corner, times `1 / inverse`.
    weights: [V; 2],
    inverse: V,
}

impl<V: Copy + std::ops::Mul<Output = V>, M> RayHits<V, M> {
    /// Barycentric weights of the second and the third corner.
    #[inline(always)]
    pub(in crate::trace) fn barycentrics(&self) -> [V; 2] {
        [self.weights[0] * self.inverse, self.weights[1] * self.inverse]
    }
}

impl<V> SeenTriangle<V> {
    /// A triangle given by its corners relative to the origin, in the scene's order of axes.
    #[inline(always)]
    pub(in crate::trace) fn new<S: Simd>(simd: S, corners: [[f32; 3]; 3], axis: usize) -> Self
    where
        V: SimdFloat<S, Element = f32>,
    {
        let [a, b, c] = corners;
        Self { corners: [permuted(simd, a, axis), permuted(simd, b, axis), permuted(simd, c, axis)] }
    }

    /// Intersects the rays with the triangle; `None` where no line passes through it.
    #[inline(always)]
    pub(in crate::trace) fn intersect<S: Simd>(
        &self,
        simd: S,
        shear: &RayShear<V>,
    ) -> Option<RayHits<V, V::Mask>>
    where
        V: SimdFloat<S, Element = f32>,
    {
        let zero = V::splat(simd, 0.0);
        // Compute the edge functions in the sheared space.
        let [a, b, c] = &self.corners;
        let (sx, sy) = (shear.x, shear.y);
        let (ax, ay) = (a[0] - sx * a[2], a[1] - sy * a[2]);
        let (bx, by) = (b[0] - sx * b[2], b[1] - sy * b[2]);
        let (cx, cy) = (c[0] - sx * c[2], c[1] - sy * c[2]);
        let mut u = cx * by - cy * bx;
        let mut v = ax * cy - ay * cx;
        let mut w = bx * ay - by * ax;
        // Decide in f64 where an edge function is zero.
        let undecided = u.simd_eq(zero) | v.simd_eq(zero) | w.simd_eq(zero);
        if undecided.any_true() {
            u = decide_in_f64(u, [cx, by, cy, bx]);
            v = decide_in_f64(v, [ax, cy, ay, cx]);
            w = decide_in_f64(w, [bx, ay, by, ax]);
        }
        // Accept edge functions of one sign.
        let negative = u.simd_lt(zero) | v.simd_lt(zero) | w.simd_lt(zero);
        let positive = u.simd_gt(zero) | v.simd_gt(zero) | w.simd_gt(zero);
        let det = u + v + w;
        let inside = !(negative & positive) & det.simd_ne(zero);
        if !inside.any_true() {
            return None;
        }
        let inverse = V::splat(simd, 1.0) / det;
        let t = (u * a[2] + v * b[2] + w * c[2]) * shear.z * inverse;
        Some(RayHits { inside, t, weights: [v, w], inverse })
    }
}

/// A point in the permuted axes, in all lanes. Not a closure: one that returns vectors would not be
/// compiled for the SIMD level that is dispatched to.
#[inline(always)]
fn permuted<S: Simd, V: SimdFloat<S, Element = f32>>(simd: S, p: [f32; 3], axis: usize) -> [V; 3] {
    let (x, y, z) = (p[(axis + 1) % 3], p[(axis + 2) % 3], p[axis]);
    [V::splat(simd, x), V::splat(simd, y), V::splat(simd, z)]
}

/// Computes `a * b - c * d` in f64 in lanes whose f32 result is zero, as for single rays.
#[cold]
fn decide_in_f64<S: Simd, V: SimdFloat<S, Element = f32>>(rounded: V, [a, b, c, d]: [V; 4]) -> V {
    let mut decided = rounded;
    for i in (0..rounded.as_slice().len()).filter(|&i| rounded[i] == 0.0) {
        decided[i] = (f64::from(a[i]) * f64::from(b[i]) - f64::from(c[i]) * f64::from(d[i])) as f32;
    }
    decided
}
