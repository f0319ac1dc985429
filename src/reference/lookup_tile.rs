//! The look-up for a tile of pixels that one view sees: eight pixels at a time, from the few references that serve the
//! tile best.
//!
//! The projection is the warp equation backwards, with the view as source; whether a sample lies on a pixel's surface
//! is decided in disparity, which over a plane is linear in picture coordinates.

use super::PixelWarp;
use super::directory::{ALIKE_COSINE, MOST_SLOTS, SlotMask};
use super::light::UNLIT;
use super::lookup::{
    DEPTH_ROUNDING, LEAST_WEIGHT, LookupReference, LookupSet, MOST_MAGNIFICATION, PLANE_TOLERANCE,
};
use crate::camera::View;
use crate::math::simd;
use crate::trace::{TILE_RAYS, TILE_SIDE};
use arrayvec::ArrayVec;
use fearless_simd::{Simd, SimdBase, SimdMask, dispatch, f32x8, prelude::*, u32x8};
use glam::Vec3;

/// References gathered from for one group of pixels of a tile, at most.
const MOST_BEST: usize = 4;

/// Times that a tile chooses references, each time for a pixel that those before do not cover; pixels that none of
/// them knows then ask every reference.
const MOST_ROUNDS: usize = 4;

/// Light that less than this share of bilinear weight was found for is extrapolated: the nearest samples lie beyond an
/// edge, and what shadow falls along the edge is not known.
const LEAST_COVERAGE: f32 = 0.8;

/// Samples whose brightness jumps by more than this share lie on both sides of a shadow's edge...
const MOST_JUMP: f32 = 0.25;

/// ...if one gap between them is at least this share of their whole range. Four samples of mere noise have such a gap
/// once in eight times.
const EDGE_GAP: f32 = 0.8;

/// The surface points of a tile's pixels.
#[derive(Clone, Debug)]
pub struct TilePoints {
    /// Top left pixel.
    pub corner: [u32; 2],
    /// 1 / depth in scene units.
    pub disparity: [f32; TILE_RAYS],
    /// Triangle of each.
    pub triangle: [u32; TILE_RAYS],
    /// Unit normals on the viewer's side, by axis.
    pub normal: [[f32; TILE_RAYS]; 3],
    /// Component of the way from the eye to the point along the normal; negative.
    pub height: [f32; TILE_RAYS],
    /// Bit per pixel whose light is asked for.
    pub wanted: u64,
}

/// The light arriving at them.
#[derive(Clone, Debug)]
pub struct TileLight {
    /// As the radiance of a white surface, by channel; of pixels that are not `known` meaningless.
    pub light: [[f32; TILE_RAYS]; 3],
    weight: [f32; TILE_RAYS],
    /// The largest share of bilinear weight that any reference's samples had: below one near an edge, where light is
    /// extrapolated.
    pub coverage: [f32; TILE_RAYS],
    /// By how much the samples of the reference that served best differ, as a share of the brightest, where they fall
    /// into two groups as on both sides of a shadow's edge; zero where they are spread evenly, as in noise and penumbra.
    pub jump: [f32; TILE_RAYS],
    /// By how much they differ times how much of it interpolation smooths away: the least of the references asked.
    pub smoothed: [f32; TILE_RAYS],
    /// The slot that served best.
    pub slot: [u8; TILE_RAYS],
    best_weight: [f32; TILE_RAYS],
    /// Bit per pixel whose light was found.
    pub known: u64,
    /// Bit per pixel whose light was interpolated, so that no other reference need be asked.
    covered: u64,
    choice: Option<Choice>,
}

impl TilePoints {
    /// No points yet.
    pub const NONE: Self = Self {
        corner: [0; 2],
        disparity: [0.0; TILE_RAYS],
        triangle: [u32::MAX; TILE_RAYS],
        normal: [[0.0; TILE_RAYS]; 3],
        height: [0.0; TILE_RAYS],
        wanted: 0,
    };

    fn normal_at(&self, pixel: usize) -> Vec3 {
        Vec3::new(self.normal[0][pixel], self.normal[1][pixel], self.normal[2][pixel])
    }
}

impl TileLight {
    /// No light yet.
    pub const NONE: Self = Self {
        light: [[0.0; TILE_RAYS]; 3],
        weight: [0.0; TILE_RAYS],
        coverage: [0.0; TILE_RAYS],
        jump: [0.0; TILE_RAYS],
        smoothed: [f32::INFINITY; TILE_RAYS],
        slot: [0; TILE_RAYS],
        best_weight: [0.0; TILE_RAYS],
        known: 0,
        covered: 0,
        choice: None,
    };

    fn divide_by_weight(&mut self) {
        for pixel in (0..TILE_RAYS).filter(|&pixel| self.weight[pixel] > 0.0) {
            let inverse = 1.0 / self.weight[pixel];
            self.light.iter_mut().for_each(|channel| channel[pixel] *= inverse);
            self.known |= 1 << pixel;
        }
    }

    /// True where a known pixel's light is a guess: extrapolated beyond the samples, or between samples that differ.
    #[inline(always)]
    pub fn is_guess(&self, pixel: usize) -> bool {
        self.is_extrapolated(pixel) || self.jump[pixel] > MOST_JUMP
    }

    /// True where a known pixel's light is extrapolated beyond the samples.
    #[inline(always)]
    pub(super) fn is_extrapolated(&self, pixel: usize) -> bool {
        self.coverage[pixel] < LEAST_COVERAGE
    }

    /// The light of a pixel that is known.
    pub fn at(&self, pixel: usize) -> Vec3 {
        Vec3::new(self.light[0][pixel], self.light[1][pixel], self.light[2][pixel])
    }
}

/// The references chosen for a place: the next tile most likely sees it too.
#[derive(Clone, Debug)]
struct Choice {
    cell: u32,
    normal: Vec3,
    best: ArrayVec<u8, MOST_BEST>,
}

/// How a view's pixels meet one reference.
#[derive(Debug)]
struct Toward<'a> {
    reference: &'a LookupReference<'a>,
    warp: PixelWarp,
    /// The view's eye as seen from the reference's.
    eye_offset: Vec3,
    /// Samples of the reference per pixel of the view, for a surface at equal distance.
    density: f32,
}

/// A look-up set made ready for the pixels of one view.
#[derive(Debug)]
pub struct ViewLookup<'a> {
    set: &'a LookupSet<'a>,
    view: View,
    most: usize,
    toward: Vec<Option<Toward<'a>>>,
}

impl<'a> ViewLookup<'a> {
    /// Takes the references that may be asked, the view, and how many references a pixel is averaged over at most.
    pub fn new(set: &'a LookupSet<'a>, view: &View, most: usize) -> Self {
        let step = view.scene_from_pixel.x_axis.length();
        let toward = |reference: &'a LookupReference<'a>| Toward {
            reference,
            warp: PixelWarp::new(view, &reference.frame.view),
            eye_offset: view.eye_relative_to(&reference.frame.view),
            density: (step / reference.step).powi(2),
        };
        let toward = set.references.iter().map(|r| r.as_ref().map(toward)).collect();
        Self { set, view: *view, most: most.clamp(1, MOST_BEST), toward }
    }

    /// Finds the light of the wanted pixels of a tile.
    pub fn gather(&self, points: &TilePoints, found: &mut TileLight) {
        *found = TileLight { choice: found.choice.take(), ..TileLight::NONE };
        if self.set.usable == 0 || points.wanted == 0 {
            return;
        }
        let mut asked: SlotMask = 0;
        for round in 0..MOST_ROUNDS {
            let open = points.wanted & !found.covered;
            if open == 0 {
                break;
            }
            let pixel = middle_bit(open);
            let best = match round {
                0 => self.choice_near(points, pixel, &mut found.choice),
                _ => self.best_references(points, pixel, asked),
            };
            if best.is_empty() {
                break;
            }
            best.iter().for_each(|&slot| asked |= 1 << slot);
            dispatch!(simd::level(), simd => self.gather_from(simd, &best, points, open, found));
        }
        found.divide_by_weight();
        self.gather_leftovers(points, found);
    }

    /// The best references for a pixel, or those of the tile before where it saw the same place turned alike.
    fn choice_near(
        &self,
        points: &TilePoints,
        pixel: usize,
        choice: &mut Option<Choice>,
    ) -> ArrayVec<u8, MOST_BEST> {
        let cell = self.set.directory.cell_of(self.position(points, pixel));
        let normal = points.normal_at(pixel);
        if let Some(last) = choice.as_ref()
            && last.cell == cell
            && last.normal.dot(normal) > ALIKE_COSINE
        {
            return last.best.clone();
        }
        let best = self.best_references(points, pixel, 0);
        *choice = Some(Choice { cell, normal, best: best.clone() });
        best
    }

    /// Pixels that the tile's best references do not know ask all of their cell's.
    fn gather_leftovers(&self, points: &TilePoints, found: &mut TileLight) {
        let mut open = points.wanted & !found.known;
        while open != 0 {
            let pixel = open.trailing_zeros() as usize;
            open &= open - 1;
            if let Some(light) = self.set.light_at(self.position(points, pixel), points.normal_at(pixel), points.triangle[pixel]) {
                (found.light[0][pixel], found.light[1][pixel], found.light[2][pixel]) = light.into();
                found.known |= 1 << pixel;
            }
        }
    }

    fn position(&self, points: &TilePoints, pixel: usize) -> Vec3 {
        let (x, y) = ((pixel % TILE_SIDE) as f32, (pixel / TILE_SIDE) as f32);
        let [x0, y0] = points.corner.map(|c| c as f32);
        self.view.eye + self.view.direction_of_point(x0 + x + 0.5, y0 + y + 0.5) / points.disparity[pixel]
    }

    /// The references that know a pixel's light, finest first. Where none knows it those that see the place.
    fn best_references(&self, points: &TilePoints, pixel: usize, asked: SlotMask) -> ArrayVec<u8, MOST_BEST> {
        let directory = self.set.directory;
        let cell = directory.cell_of(self.position(points, pixel));
        let mut mask = directory.mask(cell) & self.set.usable & !asked;
        let mut best = ArrayVec::<(f32, u8), { MOST_BEST + 1 }>::new();
        while mask != 0 {
            let slot = mask.trailing_zeros() as u8;
            mask &= mask - 1;
            let Some(toward) = &self.toward[slot as usize] else { continue };
            let rank = toward.rank(points, pixel);
            if rank > 0.0 {
                let at = best.iter().position(|b| b.0 < rank).unwrap_or(best.len());
                best.insert(at, (rank, slot));
                best.truncate(self.most);
            }
        }
        best.into_iter().map(|(_, slot)| slot).collect()
    }

    /// Adds the light of some references to the pixels that are open.
    #[inline(always)]
    fn gather_from<S: Simd>(
        &self,
        simd: S,
        slots: &[u8],
        points: &TilePoints,
        open: u64,
        found: &mut TileLight,
    ) {
        for row in (0..TILE_SIDE).filter(|row| open >> (8 * row) & 0xff != 0) {
            for &slot in slots {
                if let Some(toward) = &self.toward[slot as usize] {
                    toward.gather_row(simd, slot, row, points, open, found);
                }
            }
        }
        for pixel in (0..TILE_RAYS).filter(|pixel| open >> pixel & 1 == 1) {
            // Who asks one reference only takes what it finds.
            let is_enough = found.weight[pixel] > 0.0 && (self.most == 1 || !found.is_extrapolated(pixel));
            found.covered |= u64::from(is_enough) << pixel;
        }
    }
}

/// The set bit nearest to the middle of the word, about: the upper of the lower half.
fn middle_bit(bits: u64) -> usize {
    let low = bits & 0x0000_000f_ffff_ffff;
    if low != 0 { 63 - low.leading_zeros() as usize } else { bits.trailing_zeros() as usize }
}

impl Toward<'_> {
    /// How good this reference is for a pixel: samples per pixel up to one; a hundredth of that where it sees the place
    /// but the very sample there is not the point's; zero where it does not see it.
    fn rank(&self, points: &TilePoints, pixel: usize) -> f32 {
        let [x0, y0] = points.corner;
        let (x, y) = (x0 + (pixel % TILE_SIDE) as u32, y0 + (pixel / TILE_SIDE) as u32);
        let disparity = points.disparity[pixel];
        let Some((sx, sy, inverse)) = self.warp.point(x, y, disparity) else { return 0.0 };
        let r = self.reference;
        let normal = points.normal_at(pixel);
        let height = points.height[pixel] + normal.dot(self.eye_offset);
        if !(sx >= 0.0 && sy >= 0.0 && sx < r.size[0] && sy < r.size[1] && height < 0.0) {
            return 0.0;
        }
        let density = self.density * (height / points.height[pixel]) * inverse.powi(3);
        let (column, row) = (sx as usize, sy as usize);
        let at = row * r.size[0] as usize + column;
        let depth = 1.0 / (inverse * disparity);
        let direction = r.frame.view.direction_of_point(column as f32 + 0.5, row as f32 + 0.5);
        let expected = normal.dot(direction) / height;
        let tolerance = PLANE_TOLERANCE * r.step * depth / -height + DEPTH_ROUNDING;
        let knows = (r.disparity[at] - expected).abs() <= tolerance * expected && r.light[at] != UNLIT
            && r.is_alike(at, points.triangle[pixel]);
        density.min(1.0) * if knows { 1.0 } else { 0.01 }
    }

    /// Adds this reference's light to a row of eight pixels.
    #[inline(always)]
    fn gather_row<S: Simd>(
        &self,
        simd: S,
        slot: u8,
        row: usize,
        points: &TilePoints,
        open: u64,
        found: &mut TileLight,
    ) {
        let r = self.reference;
        let at = row * 8..row * 8 + 8;
        let splat = |x: f32| f32x8::splat(simd, x);
        let load = |from: &[f32; TILE_RAYS]| f32x8::from_slice(simd, &from[at.clone()]);
        let disparity = load(&points.disparity);
        let first = points.corner[0] as f32 + 0.5;
        let x = f32x8::from_fn(simd, |i| first + i as f32);
        let y = points.corner[1] as f32 + row as f32 + 0.5;
        let (m, t) = self.warp.parts();
        let line = m.y_axis * y + m.z_axis;
        let q = [0, 1, 2].map(|k| x * m.x_axis[k] + disparity * t[k] + line[k]);
        let normal = [load(&points.normal[0]), load(&points.normal[1]), load(&points.normal[2])];
        let along = |v: Vec3| normal[0] * v.x + normal[1] * v.y + normal[2] * v.z;
        let height = load(&points.height) + along(self.eye_offset);
        let inverse = splat(1.0) / q[2];
        let (sx, sy) = (q[0] * inverse, q[1] * inverse);
        let zero = splat(0.0);
        let ratio = height / load(&points.height);
        let density = ratio * inverse * inverse * inverse * self.density;
        let open = fearless_simd::mask32x8::from_bitmask(simd, open >> (8 * row) & 0xff);
        let valid = open
            & q[2].simd_gt(disparity * super::frame::NEAREST_DEPTH)
            & height.simd_lt(zero)
            & sx.simd_ge(zero)
            & sy.simd_ge(zero)
            & sx.simd_lt(splat(r.size[0]))
            & sy.simd_lt(splat(r.size[1]))
            & density.simd_ge(splat(1.0 / MOST_MAGNIFICATION));
        if !valid.any_true() {
            return;
        }
        // The plane's disparity at the first sample, and its steps along the axes.
        let s = &r.frame.view.scene_from_pixel;
        let inverse_height = splat(1.0) / height;
        let (px, py) = (along(s.x_axis) * inverse_height, along(s.y_axis) * inverse_height);
        let [x0, wx] = corners(simd, valid.select(sx, splat(1.0)), r.size[0]);
        let [y0, wy] = corners(simd, valid.select(sy, splat(1.0)), r.size[1]);
        let p00 = px * (x0 + splat(0.5)) + py * (y0 + splat(0.5)) + along(s.z_axis) * inverse_height;
        let expected = [p00, p00 + px, p00 + py, p00 + px + py];
        let depth = q[2] / disparity;
        let tolerance = splat(DEPTH_ROUNDING) - depth * inverse_height * (PLANE_TOLERANCE * r.step);
        let taps = Taps::load(r, x0.to_array(), y0.to_array(), &points.triangle[at.clone()]);
        let (ux, uy) = (splat(1.0) - wx, splat(1.0) - wy);
        let weights = [ux * uy, wx * uy, ux * wy, wx * wy];
        let (mut sum, mut total) = ([zero; 3], zero);
        let (mut least, mut most) = (splat(f32::INFINITY), zero);
        let mut brightness = [(valid, zero); 4];
        for k in 0..4 {
            let word = u32x8::load_array_ref(simd, &taps.light[k]);
            let off = (f32x8::load_array_ref(simd, &taps.disparity[k]) - expected[k]).abs();
            let alike = fearless_simd::mask32x8::from_bitmask(simd, taps.alike[k]);
            let agrees = valid & alike & off.simd_le(tolerance * expected[k]);
            let light = unpack(simd, word, r.scale.exponent_offset);
            let weight = agrees.select(weights[k], zero);
            for c in 0..3 {
                sum[c] = sum[c] + agrees.select(light[c], zero) * weight;
            }
            total = total + weight;
            let brightest = light[0].max(light[1]).max(light[2]);
            least = agrees.select(least.min(brightest), least);
            most = agrees.select(most.max(brightest), most);
            brightness[k] = (agrees, brightest);
        }
        let enough = total.simd_ge(splat(LEAST_WEIGHT));
        if !enough.any_true() {
            return;
        }
        // What is extrapolated from few samples yields to what is interpolated, the coarse to the fine.
        let fine = density.min(splat(1.0));
        let scale = enough.select(fine * fine * total * total, zero);
        let weight = scale * total;
        for c in 0..3 {
            (load(&found.light[c]) + sum[c] * scale).store_slice(&mut found.light[c][at.clone()]);
        }
        (load(&found.weight) + weight).store_slice(&mut found.weight[at.clone()]);
        let coverage = load(&found.coverage);
        enough.select(total.max(coverage), coverage).store_slice(&mut found.coverage[at.clone()]);
        let spread = (most - least) / most.max(splat(f32::MIN_POSITIVE));
        let smoothed = load(&found.smoothed);
        let badness = spread * (splat(1.0) - fine);
        enough.select(badness.min(smoothed), smoothed).store_slice(&mut found.smoothed[at.clone()]);
        let best = load(&found.best_weight);
        let better = weight.simd_gt(best);
        let jump = largest_gap(brightness.map(|(agrees, b)| agrees.select(b, most)));
        let jump = jump.simd_ge((most - least) * EDGE_GAP).select(spread, zero);
        better.select(jump, load(&found.jump)).store_slice(&mut found.jump[at.clone()]);
        better.select(weight, best).store_slice(&mut found.best_weight[at]);
        let mut bits = better.to_bitmask();
        while bits != 0 {
            found.slot[row * 8 + bits.trailing_zeros() as usize] = slot;
            bits &= bits - 1;
        }
    }
}

/// The first of the two samples around each picture coordinate, and the weight of the second.
#[inline(always)]
fn corners<S: Simd>(simd: S, at: f32x8<S>, size: f32) -> [f32x8<S>; 2] {
    let at = (at - f32x8::splat(simd, 0.5)).max(f32x8::splat(simd, 0.0)).min(f32x8::splat(simd, size - 1.0));
    let first = at.floor().min(f32x8::splat(simd, size - 2.0));
    [first, at - first]
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

/// The four samples around each of eight places.
struct Taps {
    disparity: [[f32; 8]; 4],
    light: [[u32; 8]; 4],
    /// Bit per lane whose sample is lit and turned like the place.
    alike: [u64; 4],
}

impl Taps {
    #[inline(always)]
    fn load(r: &LookupReference<'_>, x0: [f32; 8], y0: [f32; 8], triangle: &[u32]) -> Self {
        let mut taps = Self { disparity: [[0.0; 8]; 4], light: [[0; 8]; 4], alike: [0; 4] };
        let width = r.size[0] as usize;
        for lane in 0..8 {
            let at = y0[lane] as usize * width + x0[lane] as usize;
            for (k, at) in [at, at + 1, at + width, at + width + 1].into_iter().enumerate() {
                taps.disparity[k][lane] = r.disparity[at];
                taps.light[k][lane] = r.light[at];
                let alike = r.light[at] != UNLIT && r.is_alike(at, triangle[lane]);
                taps.alike[k] |= u64::from(alike) << lane;
            }
        }
        taps
    }
}

/// [`super::light::LightScale::unpack`] for eight words.
#[inline(always)]
fn unpack<S: Simd>(simd: S, word: u32x8<S>, exponent_offset: u32) -> [f32x8<S>; 3] {
    let nine = u32x8::splat(simd, 0x1ff);
    let step = f32x8::from_bits(((word >> 27) + u32x8::splat(simd, exponent_offset)) << 23);
    let channel = |bits: u32x8<S>| (bits & nine).to_float::<f32x8<S>>() * step;
    [channel(word), channel(word >> 9), channel(word >> 18)]
}

const _: () = assert!(MOST_SLOTS <= 256, "a slot fits a byte");
