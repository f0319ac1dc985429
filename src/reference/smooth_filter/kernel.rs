//! One step of the filter, row by row: each pixel becomes a weighted mean of the nine pixels around
//! it, some pixels apart.
//!
//! A row and the row of a neighbour are runs of numbers, so that every loop works on vectors. No
//! result depends on their width, because each pixel's sums are formed in the order of the
//! neighbours.

use super::surfaces::{Likenesses, Surfaces};
use crate::math::simd;
use fearless_simd::dispatch;
use rayon::prelude::*;
use std::ops::Range;

/// Differences of light, in standard deviations, beyond which neighbours share none: the edge of a
/// wall, not noise.
const MAX_DEVIATIONS: f32 = 4.0;

/// Light of each half of the samples of a pixel: the sums of red, green and blue and the number of
/// samples, all divided by the same weight, of the first half, then of the second.
pub(super) type Halves = [f32; 8];

/// The light of each pixel in a layer in planes: red, green, blue, and the variance of that light,
/// its channels added up.
pub(super) type Light = [Vec<f32>; 4];

/// A kernel: how pixels share light with the pixels a step away.
pub(super) struct Kernel<'a> {
    pub(super) surfaces: &'a Surfaces,
    pub(super) likenesses: &'a Likenesses,
}

/// A run of pixels of one row, and their neighbours in one direction.
struct Run<'a> {
    /// Columns of the run.
    columns: Range<usize>,
    /// Index of the first pixel, and of its neighbour.
    at: usize,
    other: usize,
    /// Number of the direction, 0..8.
    direction: usize,
    shares: &'a [u8],
    /// Weight in the kernel of a full share, divided by 255.
    weight: f32,
}

/// Buffers for a row.
#[derive(Default)]
struct Row {
    /// Weights of the neighbours in each direction.
    weights: [Vec<f32>; 8],
    /// Distance from a pixel to its neighbour in each direction, in pixels of the picture.
    offsets: [isize; 8],
    total: Vec<f32>,
    sum: Vec<f32>,
}

impl Row {
    fn begin(&mut self, width: usize) {
        for buffer in self.weights.iter_mut().chain([&mut self.sum]) {
            buffer.clear();
            buffer.resize(width, 0.0);
        }
        self.total.clear();
        self.total.resize(width, 4.0);
    }
}

impl Kernel<'_> {
    /// Widens a layer: pixels share light as far as their surfaces are alike, and their light is
    /// the same but for noise. `noise` receives the variance of the wider light.
    pub(super) fn widen(&self, layer: &[Halves], light: &Light, wider: &mut [Halves], noise: &mut [f32]) {
        let width = self.surfaces.size[0].max(1);
        let rows = wider.par_chunks_mut(width).zip(noise.par_chunks_mut(width)).enumerate();
        rows.for_each_init(Row::default, |row, (y, (out, noise))| {
            let first = y * width;
            out.copy_from_slice(&layer[first..first + width]);
            noise.copy_from_slice(&light[3][first..first + width]);
            row.begin(width);
            for run in self.surfaces.spans(y).flat_map(|span| self.runs(y, span)) {
                row.offsets[run.direction] = run.other.cast_signed() - run.at.cast_signed();
                let weights = &mut row.weights[run.direction][run.columns.clone()];
                Self::weigh(&run, light, weights);
            }
            for span in self.surfaces.spans(y) {
                let (start, column) = (first + span.start, span.start);
                let (out, noise) = (&mut out[span.clone()], &mut noise[span]);
                dispatch!(simd::level(), _simd => blend(out, layer, start, column, row));
                dispatch!(simd::level(), _simd => blend_noise(noise, &light[3], start, column, row));
            }
        });
    }

    /// The weights of the neighbours of a run.
    fn weigh(run: &Run<'_>, light: &Light, weights: &mut [f32]) {
        let [here, there] = [run.at, run.other]
            .map(|first| light.each_ref().map(|plane| &plane[first..first + weights.len()]));
        dispatch!(simd::level(), _simd => agree(weights, run.shares, run.weight, &here, &there));
    }

    /// The mean of values over the nine pixels around each, as far as their surfaces are alike.
    pub(super) fn average(&self, values: &[f32], averaged: &mut [f32]) {
        let width = self.surfaces.size[0];
        averaged.par_chunks_mut(width.max(1)).enumerate().for_each_init(Row::default, |row, (y, out)| {
            let start = &values[y * width..(y + 1) * width];
            out.copy_from_slice(start);
            row.begin(width);
            let Row { weights, sum, total, .. } = row;
            sum.iter_mut().zip(start).for_each(|(sum, value)| *sum = value * 4.0);
            for run in self.surfaces.spans(y).flat_map(|span| self.runs(y, span)) {
                let count = run.columns.len();
                let weights = &mut weights[0][..count];
                dispatch!(simd::level(), _simd => scale(weights, run.shares, run.weight));
                let values = &values[run.other..run.other + count];
                dispatch!(simd::level(), _simd => add_weighted(&mut sum[run.columns.clone()], values, weights));
                dispatch!(simd::level(), _simd => sum_up(&mut total[run.columns.clone()], weights));
            }
            for span in self.surfaces.spans(y) {
                let (out, sum, total) = (&mut out[span.clone()], &sum[span.clone()], &total[span]);
                dispatch!(simd::level(), _simd => divide(out, sum, total));
            }
        });
    }

    /// The pixels of a part of a row, with their neighbours in each of the eight directions.
    fn runs(&self, y: usize, span: Range<usize>) -> impl Iterator<Item = Run<'_>> {
        let [width, height] = self.surfaces.size;
        let step = self.likenesses.step;
        let neighbours = self.likenesses.shares.iter().zip(super::surfaces::DIRECTIONS);
        let both = neighbours.flat_map(|(plane, (dx, dy))| {
            [(plane, dx, dy.cast_signed(), true), (plane, -dx, -dy.cast_signed(), false)]
        });
        both.enumerate().filter_map(move |(direction, (plane, dx, dy, is_ahead))| {
            let [across, down] = [dx, dy].map(|d| d * step.cast_signed());
            let row = y.checked_add_signed(down).filter(|&row| row < height)?;
            let (left, right) = (across.min(0).unsigned_abs(), across.max(0).unsigned_abs());
            let columns = span.start.max(left)..span.end.min(width.saturating_sub(right));
            let (at, shifted) = (y * width + columns.start, columns.start.checked_add_signed(across)?);
            let other = row * width + shifted;
            if columns.is_empty() {
                return None;
            }
            let from = if is_ahead { at } else { other };
            let shares = &plane[from..from + columns.len()];
            let weight = if dx == 0 || dy == 0 { 2.0 } else { 1.0 } / 255.0;
            Some(Run { columns, at, other, direction, shares, weight })
        })
    }
}

/// The weighted means of pixels and their neighbours, from pixel `start` of the layer and `column`
/// of the row on.
#[inline(always)]
fn blend(out: &mut [Halves], layer: &[Halves], start: usize, column: usize, row: &Row) {
    let last = layer.len() - 1;
    for (i, out) in out.iter_mut().enumerate() {
        let at = start + i;
        let (mut sum, mut total) = (layer[at].map(|value| value * 4.0), 4.0);
        for (weights, offset) in row.weights.iter().zip(row.offsets) {
            // Beyond the edges of the picture the weight is zero, whatever pixel is read.
            let weight = weights[column + i];
            let other = &layer[at.wrapping_add_signed(offset).min(last)];
            sum.iter_mut().zip(other).for_each(|(sum, value)| *sum += value * weight);
            total += weight;
        }
        let share = 1.0 / total;
        *out = sum.map(|sum| sum * share);
    }
}

/// The variances of the means that [`blend`] forms, with values taken as independent of each other.
/// From the second kernel on they are not, so the variance is too low: with full weights by a
/// factor of 0.39 after three kernels and 0.13 after five.
#[inline(always)]
fn blend_noise(out: &mut [f32], noise: &[f32], start: usize, column: usize, row: &Row) {
    let last = noise.len() - 1;
    for (i, out) in out.iter_mut().enumerate() {
        let at = start + i;
        let (mut sum, mut total) = (noise[at] * 16.0, 4.0);
        for (weights, offset) in row.weights.iter().zip(row.offsets) {
            let weight = weights[column + i];
            sum += noise[at.wrapping_add_signed(offset).min(last)] * (weight * weight);
            total += weight;
        }
        *out = sum / (total * total);
    }
}

/// Weights of neighbours by likeness of surface and agreement of light.
#[inline(always)]
fn agree(weights: &mut [f32], shares: &[u8], weight: f32, here: &[&[f32]; 4], there: &[&[f32]; 4]) {
    let count = weights.len();
    let ([r, g, b, v], [or, og, ob, ov]) = (here.map(|p| &p[..count]), there.map(|p| &p[..count]));
    let shares = &shares[..count];
    for i in 0..count {
        let (dr, dg, db) = (r[i] - or[i], g[i] - og[i], b[i] - ob[i]);
        let apart = dr * dr + dg * dg + db * db;
        let most = MAX_DEVIATIONS * MAX_DEVIATIONS * (v[i] + ov[i]);
        let differs = 1.0 - apart / most.max(f32::MIN_POSITIVE);
        let agreement = if apart <= 0.0 { 1.0 } else { differs.max(0.0) };
        weights[i] = weight * f32::from(shares[i]) * agreement;
    }
}

/// Weights of neighbours by likeness of surface.
#[inline(always)]
fn scale(weights: &mut [f32], shares: &[u8], weight: f32) {
    weights.iter_mut().zip(shares).for_each(|(w, &share)| *w = weight * f32::from(share));
}

#[inline(always)]
fn add_weighted(sums: &mut [f32], values: &[f32], weights: &[f32]) {
    for ((sum, value), weight) in sums.iter_mut().zip(values).zip(weights) {
        *sum += value * weight;
    }
}

#[inline(always)]
fn sum_up(totals: &mut [f32], weights: &[f32]) {
    totals.iter_mut().zip(weights).for_each(|(total, weight)| *total += weight);
}

#[inline(always)]
fn divide(out: &mut [f32], sums: &[f32], totals: &[f32]) {
    for ((out, sum), total) in out.iter_mut().zip(sums).zip(totals) {
        *out = sum / total;
    }
}

#[cfg(test)]
mod tests {
    use super::super::surfaces::{DIRECTIONS, Facet, Kind, surface_likeness};
    use super::*;
    use crate::math::key::Key;
    use glam::Vec3;

    const SIZE: [usize; 2] = [137, 11];

    /// Pixels of a rough floor; some have no samples. In three rows of four, columns 20 to 119 have
    /// none.
    fn facets() -> Vec<Option<Facet>> {
        (0..SIZE[0] * SIZE[1])
            .map(|at| {
                let [a, b] = Key::of_pixel(5, at as u32).pair();
                let [c, d] = Key::of_pixel(6, at as u32).pair();
                let place = Vec3::new((at % SIZE[0]) as f32, 0.1 * a, (at / SIZE[0]) as f32);
                let normal = Vec3::new(0.5 * b - 0.25, 1.0, 0.5 * c - 0.25).normalize_or(Vec3::Y);
                let is_in_gap = at / SIZE[0] % 4 != 1 && (20..120).contains(&(at % SIZE[0]));
                (d < 0.9 && !is_in_gap).then_some(Facet { position: place, normal })
            })
            .collect()
    }

    fn surfaces(facets: &[Option<Facet>]) -> Surfaces {
        let lit: Vec<u32> = (0..facets.len() as u32).filter(|&at| facets[at as usize].is_some()).collect();
        let found: Vec<_> = lit.iter().map(|&at| facets[at as usize]).collect();
        Surfaces::new(SIZE, &lit, &found)
    }

    /// Calls `visit` with the neighbours of a pixel and their weights, in the order of the kernel.
    fn visit_neighbours(facets: &[Option<Facet>], at: usize, step: isize, mut visit: impl FnMut(usize, f32)) {
        let place = [at % SIZE[0], at / SIZE[0]].map(usize::cast_signed);
        for (dx, dy) in DIRECTIONS {
            for sign in [1, -1] {
                let there = [place[0] + sign * dx * step, place[1] + sign * dy.cast_signed() * step];
                let [x, y] = there.map(|c| usize::try_from(c).unwrap_or(usize::MAX));
                if x >= SIZE[0] || y >= SIZE[1] {
                    continue;
                }
                let other = y * SIZE[0] + x;
                let (Some(a), Some(b)) = (facets[at.min(other)], facets[at.max(other)]) else { continue };
                let share = (surface_likeness(&a, &b) * 255.0).round_ties_even();
                visit(other, if dx == 0 || dy == 0 { 2.0 / 255.0 } else { 1.0 / 255.0 } * share);
            }
        }
    }

    #[test]
    fn averages_are_those_of_a_slow_twin_at_every_pixel_and_step() {
        let facets = facets();
        let surfaces = surfaces(&facets);
        let values: Vec<f32> = (0..facets.len()).map(|at| Key::of_pixel(9, at as u32).pair()[0]).collect();
        let mut shared = 0;
        for step in [1, 2, 8, 32] {
            let likenesses = surfaces.likenesses(step, Kind::Surface);
            let kernel = Kernel { surfaces: &surfaces, likenesses: &likenesses };
            let mut averaged = vec![0.0; values.len()];
            kernel.average(&values, &mut averaged);
            for at in 0..values.len() {
                let (mut sum, mut total) = (4.0 * values[at], 4.0);
                visit_neighbours(&facets, at, step.cast_signed(), |other, weight| {
                    sum += values[other] * weight;
                    total += weight;
                    shared += usize::from(weight > 0.0);
                });
                let expected = if facets[at].is_some() { sum / total } else { values[at] };
                assert_eq!(averaged[at].to_bits(), expected.to_bits(), "pixel {at}, step {step}");
            }
        }
        assert!(shared > 1000, "{shared} neighbours share values");
    }

    #[test]
    fn light_without_noise_stays_where_it_differs_and_noise_is_averaged() {
        let facets = facets();
        let surfaces = surfaces(&facets);
        let likenesses = surfaces.likenesses(1, Kind::Surface);
        let kernel = Kernel { surfaces: &surfaces, likenesses: &likenesses };
        let layer: Vec<Halves> = (0..facets.len())
            .map(|at| {
                if facets[at].is_none() {
                    [0.0; 8]
                } else {
                    [(at % 3) as f32, 1.0, 2.0, 1.0, (at % 3) as f32, 1.0, 2.0, 1.0]
                }
            })
            .collect();
        let plane = |number: usize| layer.iter().map(|halves| halves[number]).collect::<Vec<f32>>();
        let (mut wider, mut noise) = (vec![Halves::default(); layer.len()], vec![0.0; layer.len()]);
        for (variance, is_kept) in [(0.0, true), (1e6, false)] {
            let light = [plane(0), plane(1), plane(2), vec![variance; layer.len()]];
            kernel.widen(&layer, &light, &mut wider, &mut noise);
            // A mean of nine pixels alike has the variance of one times the sum of squared weights.
            let least = 36.0 / 256.0 * variance;
            assert!(noise.iter().all(|&noise| noise <= variance && noise >= 0.999 * least));
            assert!(variance == 0.0 || noise.iter().any(|&noise| noise < 0.3 * variance));
            let moved = wider.iter().zip(&layer).map(|(a, b)| (a[0] / a[3].max(1e-9) - b[0]).abs());
            assert_eq!(moved.fold(0.0, f32::max) < 1e-6, is_kept, "variance {variance}");
        }
    }
}
