//! Intersects eight rays of one origin and one largest axis with one triangle.
//!
//! The arithmetic is that of [`super::packet`] with rays and triangles exchanged, so the bits are
//! the same.

use fearless_simd::{Simd, SimdBase, SimdMask, f32x8, mask32x8};

/// Number of rays tested at once.
pub(super) const LANES: usize = 8;

/// A triangle relative to the origin of eight rays, with the axes permuted so that the largest axis
/// of the directions comes last.
#[derive(Clone, Copy)]
pub(super) struct SeenTriangle<S: Simd> {
    corners: [[f32x8<S>; 3]; 3],
}

/// The shear of eight rays (Woop).
#[derive(Clone, Copy)]
pub(super) struct Shear8<S: Simd> {
    /// Shear of the first permuted axis.
    pub(super) x: f32x8<S>,
    /// Shear of the second permuted axis.
    pub(super) y: f32x8<S>,
    /// One over the component along the largest axis.
    pub(super) z: f32x8<S>,
}

/// The hits of eight rays with a triangle.
pub(super) struct Hits8<S: Simd> {
    /// Rays whose line passes through the triangle, in front of or behind their origin.
    pub(super) inside: mask32x8<S>,
    /// Distance, in units of the direction.
    pub(super) t: f32x8<S>,
    v: f32x8<S>,
    w: f32x8<S>,
    inverse: f32x8<S>,
}

impl<S: Simd> Hits8<S> {
    /// Barycentric weights of the second and the third corner.
    #[inline(always)]
    pub(super) fn barycentrics(&self) -> [f32x8<S>; 2] {
        [self.v * self.inverse, self.w * self.inverse]
    }
}

impl<S: Simd> SeenTriangle<S> {
    /// A triangle given by its corners relative to the origin, in the scene's order of axes.
    #[inline(always)]
    pub(super) fn new(simd: S, corners: [[f32; 3]; 3], axis: usize) -> Self {
        let [a, b, c] = corners;
        Self { corners: [permuted(simd, a, axis), permuted(simd, b, axis), permuted(simd, c, axis)] }
    }

    /// Intersects eight rays with the triangle; `None` where no line passes through it.
    #[inline(always)]
    pub(super) fn intersect(&self, shear: &Shear8<S>) -> Option<Hits8<S>> {
        let simd = shear.x.simd;
        let zero = f32x8::splat(simd, 0.0);
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
        let inverse = f32x8::splat(simd, 1.0) / det;
        let t = (u * a[2] + v * b[2] + w * c[2]) * shear.z * inverse;
        Some(Hits8 { inside, t, v, w, inverse })
    }
}

/// A point in the permuted axes, in all lanes. Not a closure: one that returns vectors would not be
/// compiled for the SIMD level that is dispatched to.
#[inline(always)]
fn permuted<S: Simd>(simd: S, p: [f32; 3], axis: usize) -> [f32x8<S>; 3] {
    let (x, y, z) = (p[(axis + 1) % 3], p[(axis + 2) % 3], p[axis]);
    [f32x8::splat(simd, x), f32x8::splat(simd, y), f32x8::splat(simd, z)]
}

/// Computes `a * b - c * d` in f64 in lanes whose f32 result is zero, as for single rays.
#[cold]
fn decide_in_f64<S: Simd>(rounded: f32x8<S>, factors: [f32x8<S>; 4]) -> f32x8<S> {
    let [a, b, c, d] = factors.map(f32x8::to_array);
    let mut decided = rounded;
    for i in (0..LANES).filter(|&i| rounded[i] == 0.0) {
        decided[i] = (f64::from(a[i]) * f64::from(b[i]) - f64::from(c[i]) * f64::from(d[i])) as f32;
    }
    decided
}
