//! What a panorama is rendered from, and its rows.

use super::projection::Equirectangular;
use crate::camera::Camera;
use crate::render::settings::RenderSettings;
use crate::trace::{RayCounts, Tracer};
use glam::Vec3;
use std::ops::Range;

/// Maximum number of pixels: 32768 x 16384. Rows are written as they are rendered, but viewers read
/// whole pictures.
const MAX_PIXELS: u64 = 1 << 29;

/// A panorama to be rendered.
#[derive(Clone, Copy, Debug)]
pub struct Panorama<'a> {
    /// The scene, ready to be traced.
    pub tracer: &'a Tracer,
    /// The eye, and as yaw the direction of the middle of the picture.
    pub camera: &'a Camera,
    /// Width and height in pixels. The width is twice the height.
    pub size: [u32; 2],
    /// Mode, samples, bounces and seed.
    pub settings: &'a RenderSettings,
    /// Points of each pixel that are sampled, at least one. In mode `full` each has all samples;
    /// in the other modes they share them.
    pub points: u32,
}

/// A panorama cannot be rendered.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PanoramaError {
    /// The width is not twice the height, or it is below 8 pixels.
    #[error(
        "a panorama is twice as wide as high: 360 by 180 degrees, and at least 8x4 pixels; make --size {w}x{h}",
        w = nearest(*.0)[0], h = nearest(*.0)[1]
    )]
    Shape([u32; 2]),
    /// It has too many pixels.
    #[error("a panorama of {0} pixels is too large; the maximum is 32768x16384: make --size smaller")]
    TooLarge(u64),
}

/// The panorama whose size is nearest to a wanted one.
fn nearest([width, height]: [u32; 2]) -> [u32; 2] {
    let height = (u64::from(width / 2).midpoint(u64::from(height)) as u32).clamp(4, 16384);
    [2 * height, height]
}

/// Checks the size of a panorama, before anything is allocated.
///
/// # Errors
/// [`PanoramaError`] where the shape is wrong or the picture is too large.
pub(super) fn check(size: [u32; 2]) -> Result<(), PanoramaError> {
    let pixels = size.map(u64::from).iter().product();
    if u64::from(size[0]) != 2 * u64::from(size[1]) || size[1] < 4 {
        return Err(PanoramaError::Shape(size));
    }
    if pixels <= MAX_PIXELS { Ok(()) } else { Err(PanoramaError::TooLarge(pixels)) }
}

impl Panorama<'_> {
    /// Checks a size, before anything is allocated or traced.
    ///
    /// # Errors
    /// [`PanoramaError`] where the width is not twice the height, or there are too many pixels.
    pub fn check(size: [u32; 2]) -> Result<(), PanoramaError> {
        check(size)
    }

    /// Directions of the pixels.
    pub fn projection(&self) -> Equirectangular {
        Equirectangular::new(self.camera, self.size)
    }
}

/// Some rows of a panorama. Row-major, top row first.
#[derive(Clone, Debug, PartialEq)]
pub struct PanoramaBand {
    /// The rows of the panorama that it holds.
    pub rows: Range<u32>,
    /// Linear, scene-referred Rec. 709 radiance.
    pub radiance: Vec<Vec3>,
    /// Rays that it took.
    pub rays: RayCounts,
}
