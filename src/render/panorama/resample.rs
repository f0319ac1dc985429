//! Interpolates the pixels of a panorama between those of a patch.

use crate::camera::View;
use glam::{DVec3, Vec3};

/// A pinhole picture between whose pixels others are interpolated.
pub(super) struct PatchPicture<'a> {
    pixels: &'a [Vec3],
    size: [i32; 2],
    pixel_from_scene: glam::DMat3,
}

impl<'a> PatchPicture<'a> {
    /// A picture of a view, row-major.
    pub(super) fn new(view: &View, pixels: &'a [Vec3]) -> Self {
        let size = view.size.map(|side| side as i32);
        Self { pixels, size, pixel_from_scene: view.scene_from_pixel_f64.inverse() }
    }

    /// The radiance that a direction shows, by the bicubic curve through the pixels around it.
    /// It stays between the four nearest pixels, so that lamps have no dark rims.
    ///
    /// Source: Catmull and Rom, "A class of local interpolating splines", 1974. We differ: the
    /// result is clamped.
    pub(super) fn at(&self, direction: DVec3) -> Vec3 {
        let q = self.pixel_from_scene * direction;
        let (x, y) = (q.x / q.z - 0.5, q.y / q.z - 0.5);
        let (left, top) = (x.floor(), y.floor());
        let (across, down) = (weights((x - left) as f32), weights((y - top) as f32));
        let (left, top) = (left as i32, top as i32);
        let mut sum = Vec3::ZERO;
        let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for (row, down) in (-1..).zip(down) {
            let mut of_row = Vec3::ZERO;
            for (column, across) in (-1..).zip(across) {
                let pixel = self.pixel(left + column, top + row);
                of_row += pixel * across;
                if row >> 1 == 0 && column >> 1 == 0 {
                    (low, high) = (low.min(pixel), high.max(pixel));
                }
            }
            sum += of_row * down;
        }
        sum.max(low).min(high)
    }

    /// The radiance on straight lines between the four nearest pixels, for comparison.
    #[cfg(test)]
    pub(super) fn linear_at(&self, direction: DVec3) -> Vec3 {
        let q = self.pixel_from_scene * direction;
        let (x, y) = (q.x / q.z - 0.5, q.y / q.z - 0.5);
        let (left, top) = (x.floor(), y.floor());
        let (across, down) = ((x - left) as f32, (y - top) as f32);
        let row = |y: i32| self.pixel(left as i32, y).lerp(self.pixel(left as i32 + 1, y), across);
        row(top as i32).lerp(row(top as i32 + 1), down)
    }

    /// A pixel of the picture; beyond its edge, the nearest.
    fn pixel(&self, x: i32, y: i32) -> Vec3 {
        let [width, height] = self.size;
        let at = y.clamp(0, height - 1) as usize * width as usize + x.clamp(0, width - 1) as usize;
        self.pixels[at]
    }
}

/// Catmull-Rom weights of the pixels at -1, 0, 1 and 2 for a place between 0 and 1.
fn weights(t: f32) -> [f32; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [
        0.5 * (-t3 + 2.0 * t2 - t),
        0.5 * (3.0 * t3 - 5.0 * t2 + 2.0),
        0.5 * (-3.0 * t3 + 4.0 * t2 + t),
        0.5 * (t3 - t2),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_sum_to_one_and_reproduce_pixels_and_lines() {
        for t in [0.0, 0.1, 0.5, 0.75, 1.0] {
            let w = weights(t);
            assert!((w.iter().sum::<f32>() - 1.0).abs() < 1e-6);
            let line: f32 = (-1..).zip(w).map(|(at, w)| at as f32 * w).sum();
            assert!((line - t).abs() < 1e-6, "{line} {t}");
        }
        assert_eq!(weights(0.0), [0.0, 1.0, 0.0, 0.0]);
    }
}
