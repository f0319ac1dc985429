//! Panoramas of mode `full`: the ray of every pixel is traced.

use super::picture::{Panorama, PanoramaBand};
use crate::render::accumulate::{latched, offset_of_pass};
use crate::trace::parallel::Stop;
use crate::trace::{RayCounts, TraceSettings};
use glam::Vec3;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

/// Approximate number of pixels in a band.
const BAND_PIXELS: u32 = 1 << 17;

/// Pixels that a thread takes at a time.
const CHUNK: usize = 64;

/// A panorama whose rays are traced one by one: slow, and the truth for the other way.
#[derive(Clone, Copy, Debug)]
pub struct TracedPanorama<'a> {
    panorama: Panorama<'a>,
}

impl<'a> TracedPanorama<'a> {
    /// A panorama to be traced.
    pub fn new(panorama: Panorama<'a>) -> Self {
        Self { panorama }
    }

    /// The rows of each band, from the top.
    pub fn bands(&self) -> impl Iterator<Item = Range<u32>> + use<> {
        traced_bands(self.panorama.size)
    }

    /// Traces a band. Returns `None` after a stop. `report` is called from all threads with the
    /// number of pixels that are finished since its last call.
    pub fn render(
        &self,
        rows: Range<u32>,
        stop: Stop<'_>,
        report: &(dyn Fn(u64) + Sync),
    ) -> Option<PanoramaBand> {
        trace_rows(self.panorama.size[0], rows, |pixel, rays| self.pixel(pixel, rays), stop, report)
    }

    /// The mean radiance of a pixel's points. Points and seeds are those of the passes over a
    /// perspective picture.
    fn pixel(&self, pixel: u32, rays: &mut RayCounts) -> Vec3 {
        let Panorama { tracer, camera, settings, points, .. } = self.panorama;
        let (projection, count) = (self.panorama.projection(), points.max(1));
        let mut sum = Vec3::ZERO;
        for number in 0..count {
            let offset = offset_of_pass(number, count);
            let view = projection.tangent_view(camera, &tracer.scene().frame, pixel, offset);
            let seed = settings.trace.seed.wrapping_add(u64::from(number) << 48);
            sum += tracer.pixel(&view, pixel, &TraceSettings { seed, ..settings.trace }, rays).radiance;
        }
        sum / count as f32
    }
}

/// The rows of each band of a picture whose pixels are traced one by one, from the top.
pub(in crate::render) fn traced_bands([width, height]: [u32; 2]) -> impl Iterator<Item = Range<u32>> + use<> {
    let rows = (BAND_PIXELS / width.max(1)).max(1);
    (0..height).step_by(rows as usize).map(move |y| y..(y + rows).min(height))
}

/// Traces some rows of a picture of this width. `radiance_of` traces a pixel, given by its
/// row-major index, and counts its rays. Returns `None` after a stop.
pub(in crate::render) fn trace_rows(
    width: u32,
    rows: Range<u32>,
    radiance_of: impl Fn(u32, &mut RayCounts) -> Vec3 + Sync,
    stop: Stop<'_>,
    report: &(dyn Fn(u64) + Sync),
) -> Option<PanoramaBand> {
    let pixels: Vec<u32> = (rows.start * width..rows.end * width).collect();
    let is_stopped = AtomicBool::new(false);
    let stop = latched(stop, &is_stopped);
    let mut radiance = vec![Vec3::ZERO; pixels.len()];
    let chunks = pixels.par_chunks(CHUNK).zip(radiance.par_chunks_mut(CHUNK));
    let traced = chunks.map(|(pixels, radiance)| {
        let mut rays = RayCounts::default();
        for (&pixel, radiance) in pixels.iter().zip(radiance) {
            if stop() {
                return rays;
            }
            *radiance = radiance_of(pixel, &mut rays);
        }
        report(pixels.len() as u64);
        rays
    });
    let rays = traced.reduce(RayCounts::default, |mut a, b| {
        a += b;
        a
    });
    (!is_stopped.load(Ordering::Relaxed)).then_some(PanoramaBand { rows, radiance, rays })
}
