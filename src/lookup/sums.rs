//! Sums over the four samples around each of eight pixels, and how they are added to a tile's
//! light.

use super::policy::{EDGE_GAP, MAX_JUMP, MAX_SMOOTH_SPREAD, MIN_WEIGHT};
use super::rows::{load, store};
use super::{point::LookupReference, tile::TileLight};
use fearless_simd::{Simd, SimdBase, SimdMask, f32x8, mask32x8, prelude::*};

/// Sums over the samples around eight pixels.
pub(super) struct Gathered<S: Simd> {
    sum: [f32x8<S>; 3],
    smooth: [f32x8<S>; 3],
    /// Least and most brightness of the samples' smooth light.
    smooth_range: [f32x8<S>; 2],
    /// Sum of the bilinear weights.
    pub(super) total: f32x8<S>,
    least: f32x8<S>,
    most: f32x8<S>,
    brightness: [(mask32x8<S>, f32x8<S>); 4],
}

impl<S: Simd> Gathered<S> {
    #[inline(always)]
    pub(super) fn nothing(simd: S, valid: mask32x8<S>) -> Self {
        let zero = f32x8::splat(simd, 0.0);
        let least = f32x8::splat(simd, f32::INFINITY);
        Self {
            sum: [zero; 3],
            smooth: [zero; 3],
            smooth_range: [least, zero],
            total: zero,
            least,
            most: zero,
            brightness: [(valid, zero); 4],
        }
    }

    #[inline(always)]
    pub(super) fn take(
        &mut self,
        k: usize,
        agrees: mask32x8<S>,
        light: [f32x8<S>; 3],
        weight: f32x8<S>,
        simd: S,
    ) {
        let zero = f32x8::splat(simd, 0.0);
        for (sum, light) in self.sum.iter_mut().zip(light) {
            *sum += agrees.select(light, zero) * weight;
        }
        self.total += weight;
        let brightest = light[0].max(light[1]).max(light[2]);
        self.least = agrees.select(self.least.min(brightest), self.least);
        self.most = agrees.select(self.most.max(brightest), self.most);
        self.brightness[k] = (agrees, brightest);
    }

    #[inline(always)]
    pub(super) fn take_smooth(
        &mut self,
        agrees: mask32x8<S>,
        light: [f32x8<S>; 3],
        weight: f32x8<S>,
        simd: S,
    ) {
        let zero = f32x8::splat(simd, 0.0);
        for (sum, light) in self.smooth.iter_mut().zip(light) {
            *sum += agrees.select(light, zero) * weight;
        }
        let brightest = light[0].max(light[1]).max(light[2]);
        let [least, most] = self.smooth_range;
        self.smooth_range =
            [agrees.select(least.min(brightest), least), agrees.select(most.max(brightest), most)];
    }

    /// Adds the sums to a tile's light, weighted so that interpolated light outweighs extrapolated
    /// light, and fine references outweigh coarse ones.
    #[inline(always)]
    pub(super) fn add_to(
        &self,
        simd: S,
        (slot, reference): (u8, &LookupReference<'_>),
        at: usize,
        density: f32x8<S>,
        found: &mut TileLight,
    ) {
        let (zero, one) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0));
        // Weight by coverage and density, squared.
        let total = self.total;
        let [least, most] = self.smooth_range;
        let is_smooth = (most - least).simd_le(most * MAX_SMOOTH_SPREAD);
        let enough = total.simd_ge(f32x8::splat(simd, MIN_WEIGHT)) & is_smooth;
        let fine = density.min(one);
        let scale = enough.select(fine * fine * total * total * reference.quality, zero);
        for c in 0..3 {
            store(load(simd, &found.light[c], at) + self.sum[c] * scale, &mut found.light[c], at);
        }
        if !reference.smooth.is_empty() {
            for c in 0..3 {
                let smooth = load(simd, &found.smooth[c], at) + self.smooth[c] * scale;
                store(smooth, &mut found.smooth[c], at);
            }
        }
        let weight = scale * total;
        store(load(simd, &found.weight, at) + weight, &mut found.weight, at);
        // Keep the largest coverage and the smallest loss of any reference.
        let coverage = load(simd, &found.coverage, at);
        store(enough.select(total.max(coverage), coverage), &mut found.coverage, at);
        // Differences of direct light are judged as a share of all light.
        let smallest = f32x8::splat(simd, f32::MIN_POSITIVE);
        let range = self.most - self.least;
        let mut brightest = self.most;
        if !reference.smooth.is_empty() {
            brightest += self.smooth[0].max(self.smooth[1]).max(self.smooth[2]) / total.max(smallest);
        }
        let spread = range / brightest.max(smallest);
        let smoothed = load(simd, &found.smoothed, at);
        let loss = smoothed.min(spread * (one - fine));
        store(enough.select(loss, smoothed), &mut found.smoothed, at);
        // Remember the reference with the largest weight.
        let best = load(simd, &found.best_weight, at);
        let better = weight.simd_gt(best);
        store(better.select(weight, best), &mut found.best_weight, at);
        // Detect the edge of a shadow between the samples, where it would make the light a guess.
        let is_large = enough & spread.simd_gt(f32x8::splat(simd, MAX_JUMP));
        if is_large.any_true() {
            let is_wide = range.simd_gt(self.most * reference.wide);
            let jump = (is_large & (self.has_gap() | is_wide)).select(spread, zero);
            store(load(simd, &found.jump, at).max(jump), &mut found.jump, at);
        }
        let mut bits = better.to_bitmask();
        while bits != 0 {
            found.slot[at + bits.trailing_zeros() as usize] = slot;
            bits &= bits - 1;
        }
    }

    /// True where the samples fall into two groups, as on both sides of a shadow's edge.
    #[inline(always)]
    fn has_gap(&self) -> mask32x8<S> {
        let [a, b, c, d] = &self.brightness;
        let most = self.most;
        largest_gap([
            a.0.select(a.1, most),
            b.0.select(b.1, most),
            c.0.select(c.1, most),
            d.0.select(d.1, most),
        ])
        .simd_ge((self.most - self.least) * EDGE_GAP)
    }
}

/// The largest step from one of four values to the next larger.
#[inline(always)]
fn largest_gap<S: Simd>([a, b, c, d]: [f32x8<S>; 4]) -> f32x8<S> {
    let (low, high) = ((a.min(b), c.min(d)), (a.max(b), c.max(d)));
    let (first, last) = (low.0.min(low.1), high.0.max(high.1));
    let (x, y) = (low.0.max(low.1), high.0.min(high.1));
    let (second, third) = (x.min(y), x.max(y));
    (second - first).max(third - second).max(last - third)
}
