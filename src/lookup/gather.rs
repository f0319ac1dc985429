//! Gathers one reference's light for a row of eight pixels at a time, in SIMD lanes. The scalar
//! twin is `LookupReference::light_at` in `point.rs`.
//!
//! The projection is the warp equation in reverse, with the view as source. Whether a sample lies
//! on a pixel's surface is decided in disparity, which is linear in picture coordinates over a
//! plane.

use super::policy::{DEPTH_ROUNDING, MAX_MAGNIFICATION, MIN_WEIGHT, PLANE_TOLERANCE};
use super::tile::{TileLight, TilePoints};
use super::{point::LookupReference, rows::load, sums::Gathered, taps::Taps};
use crate::camera::{NEAREST_DEPTH, PixelWarp};
use crate::reference::light::UNLIT;
use crate::trace::TILE_SIDE;
use fearless_simd::{Simd, SimdBase, SimdMask, f32x8, mask32x8, prelude::*, u32x8};
use glam::Vec3;

/// The projection of a view's pixels into one reference.
#[derive(Debug)]
pub(super) struct ReferenceProjection<'a> {
    pub(super) reference: &'a LookupReference<'a>,
    pub(super) warp: PixelWarp,
    /// Vector from the reference's eye to the view's, scene units.
    pub(super) eye_offset: Vec3,
    /// Samples of the reference per pixel of the view for a surface at equal distance from both.
    pub(super) density: f32,
}

impl ReferenceProjection<'_> {
    /// Rates this reference for a pixel: samples per pixel, up to one; a hundredth of that where
    /// the point projects into the picture but the sample there belongs to another surface or is
    /// unlit; zero where the point is outside the picture or faces away.
    pub(super) fn rank(&self, points: &TilePoints, pixel: usize) -> f32 {
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
        let is_known = (r.disparity[at] - expected).abs() <= tolerance * expected
            && r.light[at] != UNLIT
            && r.is_alike(at, points.triangle[pixel]);
        density.min(1.0) * r.quality * if is_known { 1.0 } else { 0.01 }
    }

    /// Adds this reference's light to the open pixels of a row of a tile. `open` has one bit per
    /// pixel of the tile.
    #[inline(always)]
    pub(super) fn gather_row<S: Simd>(
        &self,
        simd: S,
        slot: u8,
        row: usize,
        points: &TilePoints,
        open: u64,
        found: &mut TileLight,
    ) {
        let at = row * TILE_SIDE;
        let footprint = self.project(simd, row, points, open);
        if !footprint.valid.any_true() {
            return;
        }
        let triangle = &points.triangle[at..at + TILE_SIDE];
        let gathered = self.collect(simd, &footprint, triangle);
        if gathered.total.simd_ge(f32x8::splat(simd, MIN_WEIGHT)).any_true() {
            gathered.add_to(simd, (slot, self.reference), at, footprint.density, found);
        }
    }

    /// Projects a row of pixels into the reference.
    #[inline(always)]
    fn project<S: Simd>(&self, simd: S, row: usize, points: &TilePoints, open: u64) -> Footprint<S> {
        let r = self.reference;
        let at = row * TILE_SIDE;
        let disparity = load(simd, &points.disparity, at);
        let q = self.homogeneous(simd, row, points.corner, disparity);
        let [nx, ny, nz] = &points.normal;
        let normal = [load(simd, nx, at), load(simd, ny, at), load(simd, nz, at)];
        let view_height = load(simd, &points.height, at);
        let height = view_height + along(&normal, self.eye_offset);
        let inverse = f32x8::splat(simd, 1.0) / q[2];
        let (x, y) = (q[0] * inverse, q[1] * inverse);
        // Compare the pixel's area on the surface with that of a sample.
        let density = height / view_height * inverse * inverse * inverse * self.density;
        let zero = f32x8::splat(simd, 0.0);
        // Keep open pixels in front of the eye, on the facing side, inside the picture, not too
        // coarse.
        let valid = mask32x8::from_bitmask(simd, open >> at & 0xff)
            & q[2].simd_gt(disparity * NEAREST_DEPTH)
            & height.simd_lt(zero)
            & x.simd_ge(zero)
            & y.simd_ge(zero)
            & x.simd_lt(f32x8::splat(simd, r.size[0]))
            & y.simd_lt(f32x8::splat(simd, r.size[1]))
            & density.simd_ge(f32x8::splat(simd, 1.0 / MAX_MAGNIFICATION));
        let inverse_height = f32x8::splat(simd, 1.0) / height;
        // Express the surface's plane as disparity by picture coordinates.
        let s = &r.frame.view.scene_from_pixel;
        // No closures over vectors here and below: they are not compiled for the dispatched level.
        let plane = [
            along(&normal, s.x_axis) * inverse_height,
            along(&normal, s.y_axis) * inverse_height,
            along(&normal, s.z_axis) * inverse_height,
        ];
        let slack = q[2] / disparity * inverse_height * (PLANE_TOLERANCE * r.step);
        let tolerance = f32x8::splat(simd, DEPTH_ROUNDING) - slack;
        Footprint { valid, x, y, density, plane, tolerance }
    }

    /// Applies the warp equation to a row of pixels. Returns homogeneous picture coordinates.
    #[inline(always)]
    fn homogeneous<S: Simd>(
        &self,
        simd: S,
        row: usize,
        corner: [u32; 2],
        disparity: f32x8<S>,
    ) -> [f32x8<S>; 3] {
        let first = corner[0] as f32 + 0.5;
        let x = f32x8::from_fn(simd, |i| first + i as f32);
        let (m, t) = self.warp.parts();
        let line = m.y_axis * (corner[1] as f32 + row as f32 + 0.5) + m.z_axis;
        [
            x * m.x_axis.x + disparity * t.x + line.x,
            x * m.x_axis.y + disparity * t.y + line.y,
            x * m.x_axis.z + disparity * t.z + line.z,
        ]
    }

    /// Sums the light of the samples that lie on the pixels' surfaces.
    #[inline(always)]
    fn collect<S: Simd>(&self, simd: S, f: &Footprint<S>, triangle: &[u32]) -> Gathered<S> {
        let r = self.reference;
        let (zero, one, half) = (f32x8::splat(simd, 0.0), f32x8::splat(simd, 1.0), f32x8::splat(simd, 0.5));
        // Find the four samples around each point, and their bilinear weights.
        let [x0, wx] = corners(simd, f.valid.select(f.x, one), r.size[0]);
        let [y0, wy] = corners(simd, f.valid.select(f.y, one), r.size[1]);
        // Evaluate the plane's disparity at the four samples.
        let [px, py, p] = f.plane;
        let p00 = px * (x0 + half) + py * (y0 + half) + p;
        let expected = [p00, p00 + px, p00 + py, p00 + px + py];
        let (ux, uy) = (one - wx, one - wy);
        let weights = [ux * uy, wx * uy, ux * wy, wx * wy];
        let taps = Taps::load(simd, r, x0, y0);
        let mut g = Gathered::nothing(simd, f.valid);
        // One call for each sample: a loop would keep its sums in memory.
        let agree = [
            self.take::<S, 0>(simd, f, &taps, triangle, [expected[0], weights[0]], &mut g),
            self.take::<S, 1>(simd, f, &taps, triangle, [expected[1], weights[1]], &mut g),
            self.take::<S, 2>(simd, f, &taps, triangle, [expected[2], weights[2]], &mut g),
            self.take::<S, 3>(simd, f, &taps, triangle, [expected[3], weights[3]], &mut g),
        ];
        if !r.smooth.is_empty() {
            let smooth = taps.smooth(simd, r);
            for k in 0..4 {
                let light = unpack(simd, smooth[k], r.smooth_scale.exponent_offset);
                g.take_smooth(agree[k], light, agree[k].select(weights[k], zero), simd);
            }
        }
        g
    }

    /// Takes the light of sample `K` of eight points, where its disparity and normal agree with
    /// their planes. `expected` is the disparity of the plane there, `weight` the bilinear weight.
    #[inline(always)]
    fn take<S: Simd, const K: usize>(
        &self,
        simd: S,
        f: &Footprint<S>,
        taps: &Taps<S>,
        triangle: &[u32],
        [expected, weight]: [f32x8<S>; 2],
        gathered: &mut Gathered<S>,
    ) -> mask32x8<S> {
        let r = self.reference;
        let off = (taps.disparity[K] - expected).abs();
        let on_plane = f.valid & off.simd_le(f.tolerance * expected);
        let agrees = taps.alike(simd, K, r, triangle, on_plane);
        let light = unpack(simd, taps.light[K], r.scale.exponent_offset);
        gathered.take(K, agrees, light, agrees.select(weight, f32x8::splat(simd, 0.0)), simd);
        agrees
    }
}

/// The projections of eight pixels into a reference.
struct Footprint<S: Simd> {
    /// Pixels that project into the picture, on a surface that faces it, at a sufficient density.
    valid: mask32x8<S>,
    /// Picture coordinates in samples.
    x: f32x8<S>,
    y: f32x8<S>,
    /// Samples per pixel of the view.
    density: f32x8<S>,
    /// Disparity of the pixel's plane: its slope per picture coordinate, and its value at the
    /// corner.
    plane: [f32x8<S>; 3],
    /// The difference allowed between the disparities of a sample and of the plane, as a share.
    tolerance: f32x8<S>,
}

#[inline(always)]
fn along<S: Simd>(normal: &[f32x8<S>; 3], v: Vec3) -> f32x8<S> {
    normal[0] * v.x + normal[1] * v.y + normal[2] * v.z
}

/// The first of the two samples around each picture coordinate, and the bilinear weight of the
/// second.
#[inline(always)]
fn corners<S: Simd>(simd: S, at: f32x8<S>, size: f32) -> [f32x8<S>; 2] {
    let at = (at - f32x8::splat(simd, 0.5)).max(f32x8::splat(simd, 0.0)).min(f32x8::splat(simd, size - 1.0));
    let first = at.floor().min(f32x8::splat(simd, size - 2.0));
    [first, at - first]
}

/// Unpacks eight words as [`crate::raster::rgb9e5::Rgb9e5Scale::unpack`] does one.
#[inline(always)]
fn unpack<S: Simd>(simd: S, word: u32x8<S>, exponent_offset: u32) -> [f32x8<S>; 3] {
    let nine = u32x8::splat(simd, 0x1ff);
    let step = f32x8::from_bits(((word >> 27) + u32x8::splat(simd, exponent_offset)) << 23);
    let channel = |bits: u32x8<S>| (bits & nine).to_float::<f32x8<S>>() * step;
    [channel(word), channel(word >> 9), channel(word >> 18)]
}
