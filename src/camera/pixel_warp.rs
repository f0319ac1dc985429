//! The warp equation: where the pixels of one view land in another.

use crate::camera::{NEAREST_DEPTH, View};
use fearless_simd::prelude::*;
use glam::{DMat3, Mat3, Vec3};

/// Maps pixels of one view with their disparities to picture points of another view.
///
/// Source: McMillan 1997, the warp equation. The target of pixel (x, y) with disparity d is
/// `M (x, y, 1) + d t` in homogeneous picture coordinates: one matrix for all pixels, one
/// multiply-add and one division for each. Only the difference of the two eyes enters, so that the
/// result is precise far from the origin.
#[derive(Clone, Copy, Debug)]
pub struct PixelWarp {
    /// Target picture coordinates from source picture coordinates, for points at infinity.
    matrix: Mat3,
    /// Displacement in homogeneous coordinates per unit of disparity.
    translation: Vec3,
    size: [f32; 2],
}

impl PixelWarp {
    /// Creates the warp from `source` to `target`.
    pub fn new(source: &View, target: &View) -> Self {
        let pixel_from_scene: DMat3 = target.scene_from_pixel_f64.inverse();
        Self {
            matrix: (pixel_from_scene * source.scene_from_pixel_f64).as_mat3(),
            translation: (pixel_from_scene * (source.eye_f64 - target.eye_f64)).as_vec3(),
            size: target.size.map(|s| s as f32),
        }
    }

    /// Matrix M and translation t of the warp equation.
    pub(crate) fn parts(&self) -> (Mat3, Vec3) {
        (self.matrix, self.translation)
    }

    /// Returns the target pixel of the centre of source pixel (x, y), and its disparity there.
    /// `None` if it lies outside the picture, at or behind the eye, or if its disparity is NaN.
    #[inline(always)]
    pub fn target(&self, x: u32, y: u32, disparity: f32) -> Option<(u32, u32, f32)> {
        let (sx, sy, inverse) = self.point(x, y, disparity)?;
        // Test as floats: a cast would turn NaN and -0.3 into 0.
        if !(sx >= 0.0 && sy >= 0.0 && sx < self.size[0] && sy < self.size[1]) {
            return None;
        }
        Some((sx as u32, sy as u32, disparity * inverse))
    }

    /// Returns the target picture point of the centre of source pixel (x, y), inside the picture or
    /// not, and the factor from its disparity in the source to that in the target. `None` at or
    /// behind the eye.
    #[inline(always)]
    pub fn point(&self, x: u32, y: u32, disparity: f32) -> Option<(f32, f32, f32)> {
        let [x, y] = [x as f32 + 0.5, y as f32 + 0.5];
        let m = &self.matrix;
        let p = m.x_axis * x + (m.y_axis * y + m.z_axis) + self.translation * disparity;
        // The point must lie in front of the eye by at least `NEAREST_DEPTH`. Tested before the
        // division; NaN fails.
        if !(disparity >= 0.0 && p.z > disparity * NEAREST_DEPTH) {
            return None;
        }
        let inverse = 1.0 / p.z;
        Some((p.x * inverse, p.y * inverse, inverse))
    }
}

/// [`PixelWarp`] along one row of source pixels, for a vector of pixels at once.
#[derive(Clone, Copy, Debug)]
pub struct RowWarp<S: Simd> {
    simd: S,
    /// Homogeneous coordinates of the row's left end, at infinity.
    start: [S::f32s; 3],
    /// Displacement per pixel.
    step: [S::f32s; 3],
    /// Displacement per unit of disparity.
    translation: [S::f32s; 3],
}

impl PixelWarp {
    /// Returns the warp of the pixels in source row `y`.
    #[inline(always)]
    pub fn row<S: Simd>(&self, simd: S, y: u32) -> RowWarp<S> {
        let m = &self.matrix;
        let [start, step, translation] = [m.y_axis * (y as f32 + 0.5) + m.z_axis, m.x_axis, self.translation]
            .map(|v| v.to_array().map(|c| S::f32s::splat(simd, c)));
        RowWarp { simd, start, step, translation }
    }

    /// Returns bounds of the picture points at which a box of pixels may land, as minimum and
    /// maximum of x and of y. The box is given by the first and last column and row, and by the
    /// smallest and largest disparity. `None` if all of it lies behind the eye; unbounded if a part
    /// of it may.
    ///
    /// Homogeneous coordinates are affine in x, y and disparity, so a picture point lies between
    /// those of the eight corners as long as all are in front of the eye. The bounds are widened by
    /// the rounding errors of a pixel and of a corner.
    pub fn bounds(&self, x: [u32; 2], y: [u32; 2], d: [f32; 2]) -> Option<[[f32; 2]; 2]> {
        /// Relative error of eight roundings of half a unit in the last place, on both sides.
        const ROUNDING: f32 = 8.0 * f32::EPSILON;
        let (x, y) = (x.map(|x| x as f32 + 0.5), y.map(|y| y as f32 + 0.5));
        let (m, t) = (&self.matrix, self.translation);
        let size = m.x_axis.abs() * x[1] + m.y_axis.abs() * y[1] + m.z_axis.abs() + t.abs() * d[1];
        let error = size * ROUNDING;
        // Axis by axis, so that the compiler can process four corners at a time.
        let corners = |axis: usize| {
            let (along, from) =
                (x.map(|x| m.x_axis[axis] * x), y.map(|y| m.y_axis[axis] * y + m.z_axis[axis]));
            let shift = d.map(|d| t[axis] * d);
            std::array::from_fn::<f32, 8, _>(|i| along[i & 1] + from[i >> 1 & 1] + shift[i >> 2])
        };
        let z = corners(2);
        let [nearest, farthest] = range(z);
        if farthest + error.z <= 0.0 {
            return None;
        }
        let nearest = nearest - error.z;
        if nearest.is_nan() || nearest <= 0.0 {
            return Some([[f32::NEG_INFINITY, f32::INFINITY]; 2]);
        }
        let across = |axis: usize| {
            let p = corners(axis);
            let [low, high] = range(std::array::from_fn(|i| p[i] / z[i]));
            let slack = (error[axis] + low.abs().max(high.abs()) * (error.z + nearest * ROUNDING)) / nearest;
            [low - slack, high + slack]
        };
        Some([across(0), across(1)])
    }
}

/// Returns the minimum and maximum. NaN is ignored unless it is the first value.
fn range(values: [f32; 8]) -> [f32; 2] {
    let [mut low, mut high] = [values[0]; 2];
    for v in values {
        low = if v < low { v } else { low };
        high = if v > high { v } else { high };
    }
    [low, high]
}

impl<S: Simd> RowWarp<S> {
    /// Token of the SIMD level.
    #[inline(always)]
    pub fn token(&self) -> S {
        self.simd
    }

    /// Returns [`PixelWarp::target`] of the pixels from column `x` on, without the test against the
    /// picture's size: picture x and y, disparity in the target, and a mask of usable pixels.
    /// Disparities must be NaN or not negative.
    ///
    /// Performs the operations of the scalar version in the same order, none of them fused, so that
    /// all widths give the same bits.
    #[inline(always)]
    pub fn targets(&self, x: u32, disparity: S::f32s) -> (S::f32s, S::f32s, S::f32s, S::mask32s) {
        let x = S::f32s::from_fn(self.simd, |lane| lane as f32) + (x as f32 + 0.5);
        let along = |axis: usize| x * self.step[axis] + self.start[axis] + disparity * self.translation[axis];
        let z = along(2);
        let usable = z.simd_gt(disparity * NEAREST_DEPTH);
        let inverse = S::f32s::splat(self.simd, 1.0) / z;
        (along(0) * inverse, along(1) * inverse, disparity * inverse, usable)
    }
}
