//! A reference image.
//!
//! Source: the paper, section 3: a reference pixel holds diffuse radiance, the intersection point of its primary ray
//! and the number of reflections. We differ: the point is stored as disparity (1 / depth) along the pixel's ray,
//! which is exact relative to the reference's own eye wherever the scene lies and makes a sky pixel a direction
//! (disparity zero); and the triangle is kept, so that Type 2 pixels know the surface's normal and material.

use super::DisparityTiles;
use crate::camera::{Camera, View};
use crate::trace::parallel::{Stop, tile_order, trace_pixels};
use crate::trace::{PixelTrace, RayCounts, SceneEpoch, TraceSettings, Tracer};
use glam::Vec3;
use std::time::Instant;

/// The triangle of a sky pixel.
pub const NO_TRIANGLE: u32 = u32::MAX;

/// Nothing nearer than this to the eye is kept, in scene units: a millionth of the scene's diagonal. The pixel's
/// footprint there is below the rounding of positions.
pub const NEAREST_DEPTH: f32 = 1.0 / 1024.0;

/// A traced picture that lends its pixels to other views. Structure of arrays, row-major.
#[derive(Debug)]
pub struct ReferenceFrame {
    /// Where it was taken.
    pub camera: Camera,
    /// The same in scene space, with the size.
    pub view: View,
    /// The state of the scene it shows.
    pub epoch: SceneEpoch,
    /// What it was traced with.
    pub settings: TraceSettings,
    /// Seconds it took.
    pub secs: f64,
    /// Rays it took.
    pub rays: RayCounts,
    diffuse: Vec<Vec3>,
    disparity: Vec<f32>,
    tiles: DisparityTiles,
    triangle: Vec<u32>,
    reflections: Vec<u8>,
}

impl ReferenceFrame {
    /// Memory per pixel: three f32 of radiance, one of disparity, a triangle, a count.
    pub const BYTES_PER_PIXEL: usize =
        size_of::<Vec3>() + size_of::<f32>() + size_of::<u32>() + size_of::<u8>();

    /// Memory that tracing one takes per pixel, beside what it keeps.
    pub const TRACING_BYTES_PER_PIXEL: usize = size_of::<Option<PixelTrace>>() + size_of::<u32>();

    /// Traces a reference on the current thread pool. `None` after a stop.
    pub fn trace(
        tracer: &Tracer,
        camera: &Camera,
        size: [u32; 2],
        settings: &TraceSettings,
        stop: Stop<'_>,
    ) -> Option<Self> {
        let start = Instant::now();
        let view = View::new(camera, &tracer.scene().frame, size);
        let order = tile_order(size);
        let mut traced = Vec::new();
        let (rays, complete) = trace_pixels(&order, &mut traced, stop, |pixel, rays| {
            tracer.reference_pixel(&view, pixel, settings, rays)
        });
        if !complete {
            return None;
        }
        let count = view.pixel_count();
        let mut frame = Self {
            camera: *camera,
            view,
            epoch: tracer.epoch(),
            settings: *settings,
            secs: 0.0,
            rays,
            diffuse: vec![Vec3::ZERO; count],
            disparity: vec![f32::NAN; count],
            tiles: DisparityTiles::default(),
            triangle: vec![NO_TRIANGLE; count],
            reflections: vec![0; count],
        };
        for (&pixel, traced) in order.iter().zip(traced.iter().flatten()) {
            frame.store(pixel as usize, traced);
        }
        frame.tiles = DisparityTiles::new(&frame.disparity, size);
        frame.secs = start.elapsed().as_secs_f64();
        Some(frame)
    }

    /// A pixel that must not be reused keeps a disparity of NaN, which no comparison in the warp lets through.
    fn store(&mut self, pixel: usize, traced: &PixelTrace) {
        if !traced.diffuse.is_finite() {
            return;
        }
        self.diffuse[pixel] = traced.diffuse;
        match traced.hit {
            None => self.disparity[pixel] = 0.0,
            Some(hit) if hit.t >= NEAREST_DEPTH => {
                self.disparity[pixel] = 1.0 / hit.t;
                self.triangle[pixel] = hit.triangle;
                self.reflections[pixel] = u8::try_from(traced.reflections).unwrap_or(u8::MAX);
            }
            Some(_) => {}
        }
    }

    /// Memory held, bytes.
    pub fn bytes(&self) -> usize {
        self.view.pixel_count() * Self::BYTES_PER_PIXEL
    }

    /// The part of the radiance that does not depend on the viewer.
    pub fn diffuse(&self) -> &[Vec3] {
        &self.diffuse
    }

    /// 1 / depth along the viewing axis in scene units; 0 for the sky, NaN for a pixel not to be used.
    pub fn disparity(&self) -> &[f32] {
        &self.disparity
    }

    /// The range of disparities in each tile, with which the warp passes over what it cannot need.
    pub fn tiles(&self) -> &DisparityTiles {
        &self.tiles
    }

    /// First triangle met, [`NO_TRIANGLE`] for the sky.
    pub fn triangle(&self) -> &[u32] {
        &self.triangle
    }

    /// Specular bounces; saturates at 255, so a mirror's count never wraps to 0.
    pub fn reflections(&self) -> &[u8] {
        &self.reflections
    }

    /// The stored intersection point of a pixel relative to the reference's eye; meaningless for the sky.
    pub fn offset_from_eye(&self, pixel: u32) -> Vec3 {
        self.view.direction_of_pixel(pixel) / self.disparity[pixel as usize]
    }
}
