//! The warp equation: where the pixels of one view land in another.

use super::frame::NEAREST_DEPTH;
use crate::camera::View;
use glam::{DMat3, Mat3, Vec3};

/// Where the pixels of one view land in another.
///
/// Source: McMillan 1997, the warp equation: with disparity d the target of pixel (x, y) is `M (x, y, 1) + d t` in
/// homogeneous picture coordinates: one matrix for all pixels, one multiply-add and one division each. The two eyes
/// enter only by their difference, so the result does not lose bits far from the origin.
#[derive(Clone, Copy, Debug)]
pub struct PixelWarp {
    /// Target from source picture coordinates, for points at infinity.
    matrix: Mat3,
    /// Added once per unit of disparity.
    translation: Vec3,
    size: [f32; 2],
}

impl PixelWarp {
    /// The warp from `source` to `target`.
    pub fn new(source: &View, target: &View) -> Self {
        let pixel_from_scene: DMat3 = target.scene_from_pixel_f64.inverse();
        Self {
            matrix: (pixel_from_scene * source.scene_from_pixel_f64).as_mat3(),
            translation: (pixel_from_scene * (source.eye_f64 - target.eye_f64)).as_vec3(),
            size: target.size.map(|s| s as f32),
        }
    }

    /// The matrix, and what is added to its product per unit of disparity.
    pub(super) fn parts(&self) -> (Mat3, Vec3) {
        (self.matrix, self.translation)
    }

    /// The target pixel of the centre of source pixel (x, y), and its disparity there. `None` where it lies outside
    /// the picture, at or behind the eye, or where its disparity is not a number.
    #[inline(always)]
    pub fn target(&self, x: u32, y: u32, disparity: f32) -> Option<(u32, u32, f32)> {
        let (sx, sy, inverse) = self.point(x, y, disparity)?;
        // Tested as floats: casting first would turn NaN into 0 and -0.3 into 0.
        if !(sx >= 0.0 && sy >= 0.0 && sx < self.size[0] && sy < self.size[1]) {
            return None;
        }
        Some((sx as u32, sy as u32, disparity * inverse))
    }

    /// The target picture point of the centre of source pixel (x, y), in or out of the picture, and the factor from
    /// its disparity in the source to that in the target. `None` at or behind the eye.
    #[inline(always)]
    pub fn point(&self, x: u32, y: u32, disparity: f32) -> Option<(f32, f32, f32)> {
        let [x, y] = [x as f32 + 0.5, y as f32 + 0.5];
        let m = &self.matrix;
        let p = m.x_axis * x + (m.y_axis * y + m.z_axis) + self.translation * disparity;
        // Before any division, and so that NaN fails: in front of the eye by at least the nearest depth.
        if !(disparity >= 0.0 && p.z > disparity * NEAREST_DEPTH) {
            return None;
        }
        let inverse = 1.0 / p.z;
        Some((p.x * inverse, p.y * inverse, inverse))
    }
}
