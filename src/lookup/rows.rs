//! What is done with the light of a tile row by row, in SIMD lanes: resetting it, turning sums into
//! means, and interpolating rows between those that were looked up.

use super::policy::{MAX_JUMP, MAX_LOSS, MAX_STEP, MIN_COVERAGE, ONE_PLANE};
use super::tile::{TileLight, TilePoints};
use crate::math::simd;
use crate::raster::pixel_types::NO_SUPPLIER;
use crate::trace::{TILE_RAYS, TILE_SIDE};
use fearless_simd::{Simd, SimdBase, SimdMask, dispatch, f32x8, mask32x8, prelude::*};

/// The rows that are looked up in a tile that shows one plane; one bit per pixel.
pub(super) const ROWS_LOOKED_UP: u64 = 0xff00_ff00_00ff_00ff;

/// The other rows, each with the rows above and below that it is interpolated from, and the weight
/// of the latter.
const ROWS_BETWEEN: [(usize, usize, usize, f32); 4] =
    [(1, 0, 2, 0.5), (3, 2, 5, 1.0 / 3.0), (4, 2, 5, 2.0 / 3.0), (6, 5, 7, 0.5)];

/// Eight values of a row of a tile.
#[inline(always)]
pub(super) fn load<S: Simd>(simd: S, from: &[f32; TILE_RAYS], at: usize) -> f32x8<S> {
    f32x8::from_slice(simd, &from[at..at + TILE_SIDE])
}

#[inline(always)]
pub(super) fn store<S: Simd>(value: f32x8<S>, to: &mut [f32; TILE_RAYS], at: usize) {
    value.store_slice(&mut to[at..at + TILE_SIDE]);
}

impl TilePoints {
    /// True where all pixels show the same plane, of however many triangles.
    pub(super) fn is_one_plane(&self) -> bool {
        dispatch!(simd::level(), simd => self.is_one_plane_in(simd))
    }

    #[inline(always)]
    fn is_one_plane_in<S: Simd>(&self, simd: S) -> bool {
        let [x, y, z] = &self.normal;
        let values = [&self.height, x, y, z];
        let mut is_near = mask32x8::splat(simd, true);
        for (values, most) in values.into_iter().zip([-self.height[0], 1.0, 1.0, 1.0]) {
            let (first, most) = (f32x8::splat(simd, values[0]), f32x8::splat(simd, ONE_PLANE * most));
            for at in (0..TILE_RAYS).step_by(TILE_SIDE) {
                is_near &= (load(simd, values, at) - first).abs().simd_le(most);
            }
        }
        is_near.all_true()
    }
}

impl TileLight {
    /// Forgets the light of the last tile, for references of this noise.
    pub(super) fn reset(&mut self, noise: f32) {
        let [red, green, blue] = &mut self.light;
        let [smooth_red, smooth_green, smooth_blue] = &mut self.smooth;
        let zeros = [red, green, blue, smooth_red, smooth_green, smooth_blue];
        zeros.into_iter().for_each(|values| values.fill(0.0));
        for values in [&mut self.weight, &mut self.coverage, &mut self.jump, &mut self.best_weight] {
            values.fill(0.0);
        }
        self.smoothed.fill(f32::INFINITY);
        self.slot.fill(NO_SUPPLIER);
        (self.known, self.covered, self.noise) = (0, 0, noise);
    }

    /// Turns the weighted sums of some pixels, one bit each, into means.
    pub(super) fn divide_by_weight(&mut self, pixels: u64) {
        dispatch!(simd::level(), simd => self.divide_rows(simd, pixels));
    }

    #[inline(always)]
    fn divide_rows<S: Simd>(&mut self, simd: S, pixels: u64) {
        let one = f32x8::splat(simd, 1.0);
        for at in (0..TILE_RAYS).step_by(TILE_SIDE).filter(|at| pixels >> at & 0xff != 0) {
            let weight = load(simd, &self.weight, at);
            let has_light = weight.simd_gt(f32x8::splat(simd, 0.0));
            let divided = mask32x8::from_bitmask(simd, pixels >> at & 0xff) & has_light;
            let inverse = divided.select(one / weight, one);
            for channel in self.light.iter_mut().chain(&mut self.smooth) {
                store(load(simd, channel, at) * inverse, channel, at);
            }
            self.known |= divided.to_bitmask() << at;
        }
    }

    /// Marks the pixels, of those given, whose light needs no further reference: all that have any,
    /// or with `is_strict` all whose light is not extrapolated.
    #[inline(always)]
    pub(super) fn cover<S: Simd>(&mut self, simd: S, pixels: u64, is_strict: bool) {
        let least = f32x8::splat(simd, if is_strict { MIN_COVERAGE } else { f32::NEG_INFINITY });
        for at in (0..TILE_RAYS).step_by(TILE_SIDE).filter(|at| pixels >> at & 0xff != 0) {
            let has_light = load(simd, &self.weight, at).simd_gt(f32x8::splat(simd, 0.0));
            let is_enough = has_light & load(simd, &self.coverage, at).simd_ge(least);
            self.covered |= is_enough.to_bitmask() << at & pixels;
        }
    }

    /// Interpolates the rows between [`ROWS_LOOKED_UP`] where those above and below agree.
    pub(super) fn interpolate_rows(&mut self) {
        dispatch!(simd::level(), simd => {
            for between in ROWS_BETWEEN {
                self.interpolate_row(simd, between);
            }
        });
    }

    #[inline(always)]
    fn interpolate_row<S: Simd>(&mut self, simd: S, (row, above, below, share): (usize, usize, usize, f32)) {
        let [at, a, b] = [row, above, below].map(|row| row * TILE_SIDE);
        let agree = self.agree(simd, a, b);
        let bits = agree.to_bitmask();
        if bits == 0 {
            return;
        }
        let share_of_below = f32x8::splat(simd, share);
        for channel in self.light.iter_mut().chain(&mut self.smooth) {
            let (first, second) = (load(simd, channel, a), load(simd, channel, b));
            let between = first + (second - first) * share_of_below;
            store(agree.select(between, load(simd, channel, at)), channel, at);
        }
        let coverage = load(simd, &self.coverage, a).min(load(simd, &self.coverage, b));
        store(agree.select(coverage, load(simd, &self.coverage, at)), &mut self.coverage, at);
        let smoothed = load(simd, &self.smoothed, a).max(load(simd, &self.smoothed, b));
        store(agree.select(smoothed, load(simd, &self.smoothed, at)), &mut self.smoothed, at);
        let nearer = if share < 0.5 { a } else { b };
        for lane in (0..TILE_SIDE).filter(|lane| bits >> lane & 1 == 1) {
            self.slot[at + lane] = self.slot[nearer + lane];
        }
        self.known |= bits << at;
    }

    /// The columns in which the light of two rows is known, not a guess, and nearly equal.
    #[inline(always)]
    fn agree<S: Simd>(&self, simd: S, a: usize, b: usize) -> mask32x8<S> {
        let zero = f32x8::splat(simd, 0.0);
        let (mut step, mut most) = (zero, zero);
        for c in 0..3 {
            let first = load(simd, &self.light[c], a) + load(simd, &self.smooth[c], a);
            let second = load(simd, &self.light[c], b) + load(simd, &self.smooth[c], b);
            step = step.max((first - second).abs());
            most = most.max(first.max(second));
        }
        self.is_good(simd, a) & self.is_good(simd, b) & step.simd_le(most * MAX_STEP)
    }

    /// The columns of a row in which light is known and not a guess, as [`Self::is_guess`] says.
    #[inline(always)]
    fn is_good<S: Simd>(&self, simd: S, at: usize) -> mask32x8<S> {
        mask32x8::from_bitmask(simd, self.known >> at & 0xff)
            & load(simd, &self.coverage, at).simd_ge(f32x8::splat(simd, MIN_COVERAGE))
            & load(simd, &self.jump, at).simd_le(f32x8::splat(simd, MAX_JUMP * self.noise))
            & load(simd, &self.smoothed, at).simd_le(f32x8::splat(simd, MAX_LOSS * self.noise))
    }
}
