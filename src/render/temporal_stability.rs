//! How steady a walk looks: the same surface points from one frame to the next.
//!
//! A matte point has the same light wherever it is seen from, so every change of its colour is an error that flickers. Points
//! of the last frame on a lattice are projected into the new one; compared are those that show the same triangle there.

use super::frame::{Frame, TemporalStability};
use crate::camera::PixelWarp;
use crate::camera::View;
use crate::raster::color::srgb_from_linear;
use crate::raster::pixel_types::NO_SUPPLIER;
use crate::scene::Scene;
use crate::trace::NO_TRIANGLE;
use glam::Vec3;

/// One pixel in so many per axis is compared: 57,600 of 1280x720, at under a hundredth of the frame's time.
const LATTICE: usize = 4;

/// A point of the last frame.
#[derive(Clone, Copy, Debug)]
struct Point {
    pixel: [u32; 2],
    disparity: f32,
    triangle: u32,
    is_lent: bool,
    /// Where its colour is one of a plain matte surface.
    shown: Option<Vec3>,
}

/// Compares each frame with the one before it.
#[derive(Debug, Default)]
pub(crate) struct TemporalStabilityWatch {
    view: Option<View>,
    points: Vec<Point>,
}

impl TemporalStabilityWatch {
    /// Compares a frame with the last one and keeps its points for the next. `None` for the first.
    pub(crate) fn compare(&mut self, scene: &Scene, frame: &Frame) -> Option<TemporalStability> {
        let temporal_stability = self.view.map(|last| self.against(&last, frame));
        self.take(scene, frame);
        temporal_stability
    }

    fn against(&self, last: &View, frame: &Frame) -> TemporalStability {
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
            flips += u32::from((frame.supplier[at] != NO_SUPPLIER) != point.is_lent);
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

    fn take(&mut self, scene: &Scene, frame: &Frame) {
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
                    is_lent: frame.supplier[at] != NO_SUPPLIER,
                    shown: is_plain.then(|| display(frame.radiance[at])),
                });
            }
        }
    }
}

fn display(radiance: Vec3) -> Vec3 {
    Vec3::from(radiance.to_array().map(|c| srgb_from_linear(c.clamp(0.0, 1.0))))
}
