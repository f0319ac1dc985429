//! Temporal stability of a walk: how much the same surface points change from frame to frame.
//!
//! A matte point has the same radiance from every viewpoint, so a change of its colour is an error
//! that flickers. Points on a lattice of the last frame are projected into the new one, and those
//! that show the same triangle there are compared.

use super::frame::{Frame, TemporalStability};
use crate::camera::{PixelWarp, View};
use crate::raster::{color::srgb_from_linear, pixel_types::NO_SUPPLIER};
use crate::scene::Scene;
use crate::trace::NO_TRIANGLE;
use glam::Vec3;

/// One pixel in this many per axis is compared: 57,600 of 1280x720, in under 1 % of the frame's
/// time.
const LATTICE: usize = 4;

/// A pixel of the last frame to be compared.
#[derive(Clone, Copy, Debug)]
struct Point {
    pixel: [u32; 2],
    disparity: f32,
    triangle: u32,
    /// True where a reference supplied the colour.
    is_reused: bool,
    /// Display values in sRGB, 0..1, of a matte surface without texture; `None` for others.
    shown: Option<Vec3>,
}

/// Compares each frame with the previous one.
#[derive(Debug, Default)]
pub(super) struct TemporalStabilityMeter {
    view: Option<View>,
    points: Vec<Point>,
}

impl TemporalStabilityMeter {
    /// Compares a frame with the previous one and keeps its points for the next. Returns `None` for
    /// the first frame.
    pub(super) fn measure(&mut self, scene: &Scene, frame: &Frame) -> Option<TemporalStability> {
        let stability = self.view.map(|last| self.compare(&last, frame));
        self.keep_points(scene, frame);
        stability
    }

    fn compare(&self, last: &View, frame: &Frame) -> TemporalStability {
        let warp = PixelWarp::new(last, &frame.view);
        let (mut compared, mut flips, mut matte, mut squares) = (0u32, 0u32, 0u32, 0f64);
        for point in &self.points {
            let Some((x, y, _)) = warp.target(point.pixel[0], point.pixel[1], point.disparity) else {
                continue;
            };
            let at = (y * frame.view.size[0] + x) as usize;
            if frame.triangle[at] != point.triangle {
                continue;
            }
            compared += 1;
            flips += u32::from((frame.supplier[at] != NO_SUPPLIER) != point.is_reused);
            if let Some(shown) = point.shown {
                matte += 1;
                squares += f64::from((display(frame.radiance[at]) - shown).length_squared());
            }
        }
        let mean_square = squares / f64::from(3 * matte.max(1));
        TemporalStability {
            compared,
            flips_percent: 100.0 * f64::from(flips) / f64::from(compared.max(1)),
            psnr_db: -10.0 * mean_square.log10(),
        }
    }

    fn keep_points(&mut self, scene: &Scene, frame: &Frame) {
        self.view = Some(frame.view);
        self.points.clear();
        let [width, height] = frame.view.size.map(|s| s as usize);
        for y in (LATTICE / 2..height).step_by(LATTICE) {
            for x in (LATTICE / 2..width).step_by(LATTICE) {
                let at = y * width + x;
                let triangle = frame.triangle[at];
                if triangle == NO_TRIANGLE {
                    continue;
                }
                let material = &scene.materials[scene.triangle_materials[triangle as usize].0 as usize];
                let is_plain = !material.is_view_dependent() && material.diffuse_texture.is_none();
                self.points.push(Point {
                    pixel: [x as u32, y as u32],
                    disparity: frame.disparity[at],
                    triangle,
                    is_reused: frame.supplier[at] != NO_SUPPLIER,
                    shown: is_plain.then(|| display(frame.radiance[at])),
                });
            }
        }
    }
}

fn display(radiance: Vec3) -> Vec3 {
    Vec3::from(radiance.to_array().map(|c| srgb_from_linear(c.clamp(0.0, 1.0))))
}
