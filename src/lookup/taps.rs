//! Reads the four samples of a reference around each of eight points into SIMD lanes.
//!
//! Time goes into instructions here, not into memory: neighbouring points share their cache lines.
//! So the two samples of a row are read together, and normals are compared only where a sample lies
//! on the plane of a point but on another triangle.

use super::point::LookupReference;
use crate::reference::light::UNLIT;
use bytemuck::Pod;
use fearless_simd::{Simd, SimdBase, SimdMask, f32x8, f64x4, i32x8, mask32x8, prelude::*, u32x8};

/// Eight points of a row of a tile.
pub(super) const LANES: usize = 8;

/// The samples around eight points, in the order left and right of the upper row, then of the
/// lower.
pub(super) struct Taps<S: Simd> {
    /// Index of the upper left sample of each point.
    first: [usize; LANES],
    width: usize,
    /// 1 / depth of the samples along the reference's viewing axis.
    pub(super) disparity: [f32x8<S>; 4],
    /// Packed light of the samples.
    pub(super) light: [u32x8<S>; 4],
    triangle: [u32x8<S>; 4],
}

impl<S: Simd> Taps<S> {
    /// Reads the samples from column `x` and row `y` on; the next column and row must exist.
    #[inline(always)]
    pub(super) fn load(simd: S, r: &LookupReference<'_>, x: f32x8<S>, y: f32x8<S>) -> Self {
        let width = r.size[0] as usize;
        let row = y.to_int::<i32x8<S>>() * i32x8::splat(simd, width as i32);
        let index: [i32; LANES] = (row + x.to_int::<i32x8<S>>()).into();
        let mut first = [0; LANES];
        for lane in 0..LANES {
            first[lane] = index[lane] as u32 as usize;
        }
        let [a, b, c, d] = words(simd, r.disparity, &first, width);
        Self {
            disparity: [f32x8::from_bits(a), f32x8::from_bits(b), f32x8::from_bits(c), f32x8::from_bits(d)],
            light: words(simd, r.light, &first, width),
            triangle: words(simd, r.triangle, &first, width),
            first,
            width,
        }
    }

    /// The packed smooth light of the samples, of a reference that holds any.
    #[inline(always)]
    pub(super) fn smooth(&self, simd: S, r: &LookupReference<'_>) -> [u32x8<S>; 4] {
        words(simd, r.smooth, &self.first, self.width)
    }

    /// Of the points whose sample `k` lies on their plane, those whose sample is lit and lies on
    /// their triangle or on one with nearly its normal.
    #[inline(always)]
    pub(super) fn alike(
        &self,
        simd: S,
        k: usize,
        r: &LookupReference<'_>,
        triangle: &[u32],
        on_plane: mask32x8<S>,
    ) -> mask32x8<S> {
        let unlit = self.light[k].simd_eq(u32x8::splat(simd, UNLIT));
        let other = !self.triangle[k].simd_eq(u32x8::from_slice(simd, triangle));
        let lit = on_plane & !unlit;
        let open = (lit & other).to_bitmask();
        if open == 0 {
            return lit;
        }
        lit & mask32x8::from_bitmask(simd, !self.unlike(k, r, triangle, open))
    }

    /// Of the points given, those whose sample `k` has another normal.
    #[inline(never)]
    fn unlike(&self, k: usize, r: &LookupReference<'_>, triangle: &[u32], mut open: u64) -> u64 {
        let (mut unlike, offset) = (0, (k & 1) + (k >> 1) * self.width);
        while open != 0 {
            let lane = open.trailing_zeros() as usize;
            unlike |= u64::from(!r.is_alike(self.first[lane] + offset, triangle[lane])) << lane;
            open &= open - 1;
        }
        unlike
    }
}

/// Reads values of four bytes of the four samples.
#[inline(always)]
fn words<S: Simd, T: Pod>(simd: S, from: &[T], first: &[usize; LANES], width: usize) -> [u32x8<S>; 4] {
    let [a, b] = pairs(simd, from, first, 0);
    let [c, d] = pairs(simd, from, first, width);
    let upper = a.deinterleave(b);
    let lower = c.deinterleave(d);
    [upper.0, upper.1, lower.0, lower.1]
}

/// Reads two adjacent values of four bytes for each of eight points: those of four points, then of
/// the other four. A pair travels as the bits of an f64.
#[inline(always)]
fn pairs<S: Simd, T: Pod>(simd: S, from: &[T], first: &[usize; LANES], offset: usize) -> [u32x8<S>; 2] {
    let [a, b, c, d, e, f, g, h] = *first;
    let low =
        [pair(from, a + offset), pair(from, b + offset), pair(from, c + offset), pair(from, d + offset)];
    let high =
        [pair(from, e + offset), pair(from, f + offset), pair(from, g + offset), pair(from, h + offset)];
    [f64x4::from_slice(simd, &low).bitcast(), f64x4::from_slice(simd, &high).bitcast()]
}

#[inline(always)]
fn pair<T: Pod>(from: &[T], at: usize) -> f64 {
    // A window costs one comparison, a range two.
    from.array_windows::<2>()
        .nth(at)
        .map_or(0.0, |pair| bytemuck::pod_read_unaligned(bytemuck::bytes_of(pair)))
}
