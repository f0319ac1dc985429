//! The pixels of mode `paper`: type and copied light from the warped samples, and secondary rays.

use super::frame::Frame;
use crate::camera::View;
use crate::math::sequence::PointSeed;
use crate::raster::pixel_types::{NO_SUPPLIER, PixelType};
use crate::reference::ReferenceFrame;
use crate::trace::{RayCounts, SurfacePoint, TraceSettings, Tracer};
use crate::warp::{WarpBuffer, classify};
use glam::Vec3;
use rayon::prelude::*;

/// A view's pixels with the samples that were warped to them.
#[derive(Clone, Copy, Debug)]
pub(super) struct WarpedPixels<'a> {
    pub(super) tracer: &'a Tracer,
    pub(super) references: &'a [&'a ReferenceFrame],
    pub(super) warped: &'a WarpBuffer,
}

impl WarpedPixels<'_> {
    /// Gives every pixel its type, and copies what the sample nearest to the eye knows of it.
    pub(super) fn copy_to(&self, frame: &mut Frame) {
        let Self { tracer, references, warped } = *self;
        let width = frame.view.size[0] as usize;
        frame.par_rows_mut(1).enumerate().with_min_len(8).for_each(|(y, rows)| {
            for x in 0..width {
                let pixel = y * width + x;
                rows.types[x] = classify(warped, references, pixel);
                rows.supplier[x] = NO_SUPPLIER;
                if let Some((sample, disparity)) = warped.sample(pixel) {
                    let reference = references[sample.slot()];
                    if !reference.is_sound(tracer, sample.pixel()) {
                        rows.types[x] = PixelType::Unseen;
                        continue;
                    }
                    rows.radiance[x] = reference.diffuse_radiance(tracer, sample.pixel());
                    rows.disparity[x] = disparity;
                    rows.triangle[x] = reference.triangle()[sample.pixel() as usize];
                    rows.supplier[x] = sample.slot() as u8;
                }
            }
        });
    }

    /// Type 2: traces secondary rays from the stored intersection point, as seen from the new eye.
    pub(super) fn specular(
        &self,
        view: &View,
        pixel: u32,
        trace: &TraceSettings,
        rays: &mut RayCounts,
    ) -> Vec3 {
        let Some((sample, _)) = self.warped.sample(pixel as usize) else { return Vec3::ZERO };
        let reference = self.references[sample.slot()];
        let offset = reference.offset_from_eye(sample.pixel());
        let direction = offset + reference.view.eye_relative_to(view);
        let triangle = reference.triangle()[sample.pixel() as usize];
        let position = reference.view.eye + offset;
        let point = SurfacePoint::from_position(self.tracer.scene(), triangle, position, direction);
        let seed = PointSeed::of_pixel(trace.seed, pixel, view.size[0], trace.samples);
        self.tracer.specular_radiance(&point, direction, trace, seed, rays).0
    }
}
