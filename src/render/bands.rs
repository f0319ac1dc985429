//! Pictures of any size, rendered some rows at a time: every pixel is traced in full, with the same
//! bits as in the whole picture.

pub use super::accumulate::Background;
use super::{
    accumulate::{Pass, PassTile, latched, tile_corners, trace_tiles},
    frame::Frame,
};
use crate::camera::{Camera, View};
use crate::lookup::pixels_of_tile;
use crate::raster::pixel_types::{NO_SUPPLIER, PixelMap, PixelType};
#[cfg(feature = "experiments")]
use crate::trace::parallel::NEVER;
use crate::trace::{NO_TRIANGLE, RayCounts, TILE_SIDE, TraceSettings, Tracer, parallel::Stop};
use glam::Vec3;
use std::{
    ops::Range,
    sync::atomic::{AtomicBool, Ordering},
};

/// Some rows of a picture with all that is known of each pixel. Row-major, top row first.
#[derive(Clone, Debug)]
pub struct Band {
    /// The view of the whole picture.
    pub view: View,
    /// Index of the first row.
    pub first_row: u32,
    /// Linear, scene-referred Rec. 709 radiance.
    pub radiance: Vec<Vec3>,
    /// The part of each pixel that is not background, 0..1.
    pub coverage: Vec<f32>,
    /// 1 / depth along the viewing axis in scene units, through the pixel's centre; 0 where the sky
    /// is seen.
    pub disparity: Vec<f32>,
    /// First triangle, [`NO_TRIANGLE`] for the sky.
    pub triangle: Vec<u32>,
    /// How each pixel came to its colour.
    pub types: PixelMap,
    /// The reference that supplied each pixel, [`NO_SUPPLIER`] for none.
    pub supplier: Vec<u8>,
}

impl From<Frame> for Band {
    /// A whole picture as one band, in which a pixel is background or not.
    fn from(frame: Frame) -> Self {
        // The cap of a section has no triangle, but a depth.
        let coverage = |&disparity: &f32| if disparity > 0.0 { 1.0 } else { 0.0 };
        Self {
            view: frame.view,
            first_row: 0,
            radiance: frame.radiance,
            coverage: frame.disparity.iter().map(coverage).collect(),
            disparity: frame.disparity,
            triangle: frame.triangle,
            types: frame.types,
            supplier: frame.supplier,
        }
    }
}

/// A picture to be rendered band by band.
#[derive(Debug)]
pub struct BandedPicture<'a> {
    /// The scene, ready to be traced.
    pub tracer: &'a Tracer,
    /// The pose.
    pub camera: &'a Camera,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Sample count, bounces and seed.
    pub trace: TraceSettings,
    /// Rays through different points of each pixel, at least one. With one it is the picture of
    /// mode `full`, with more that of [`super::render_antialiased`].
    pub passes: u32,
    /// What the sky contributes.
    pub background: Background,
}

impl BandedPicture<'_> {
    /// Approximate number of pixels in a band.
    const BAND_PIXELS: u32 = 1 << 17;

    /// The rows of each band, from the top. The height of a band is a whole number of tiles.
    pub fn bands(&self) -> impl Iterator<Item = Range<u32>> + use<> {
        let ([width, height], side) = (self.size, TILE_SIDE as u32);
        let rows = (Self::BAND_PIXELS / width.max(1)).next_multiple_of(side).max(side);
        (0..height).step_by(rows as usize).map(move |y| y..(y + rows).min(height))
    }

    /// The work of all bands as [`Self::render`] reports it: pixels times passes.
    pub fn work(&self) -> u64 {
        self.size.map(u64::from).iter().product::<u64>() * u64::from(self.passes.max(1))
    }

    /// Traces one band. Returns `None` after a stop. `report` is called from all threads with the
    /// work that was done since its last call.
    pub fn render(
        &self,
        rows: Range<u32>,
        stop: Stop<'_>,
        report: &(dyn Fn(u64) + Sync),
    ) -> Option<(Band, RayCounts)> {
        let view = View::new(self.camera, &self.tracer.scene().frame, self.size);
        let (passes, count) = (self.all_passes(&view), self.passes.max(1));
        let mut tiles: Vec<PassTile> = tile_corners(rows.clone(), self.size[0]).map(PassTile::new).collect();
        let is_stopped = AtomicBool::new(false);
        let stop = latched(stop, &is_stopped);
        let rays = trace_tiles(&mut tiles, |tile| {
            let rays = tile.trace_all(&passes, &stop);
            if !is_stopped.load(Ordering::Relaxed) {
                report(pixels_of_tile(tile.corner, self.size).count() as u64 * u64::from(count));
            }
            rays
        });
        (!is_stopped.load(Ordering::Relaxed)).then(|| (self.assemble(view, rows, &tiles), rays))
    }

    fn all_passes(&self, view: &View) -> Vec<Pass<'_>> {
        let count = self.passes.max(1);
        let pass = |number| Pass::new(self.tracer, view, &self.trace, (number, count), self.background);
        (0..count).map(pass).collect()
    }

    /// Traces the tile around a pixel. Returns the pixels of the tile with their radiance, which
    /// has the bits of [`Self::render`].
    #[cfg(feature = "experiments")]
    pub(crate) fn tile_at(&self, pixel: [u32; 2]) -> impl Iterator<Item = (usize, Vec3)> + use<> {
        let view = View::new(self.camera, &self.tracer.scene().frame, self.size);
        let (count, size) = (self.passes.max(1), self.size);
        let mut tile = PassTile::new(pixel.map(|at| at - at % TILE_SIDE as u32));
        tile.trace_all(&self.all_passes(&view), NEVER);
        pixels_of_tile(tile.corner, size).map(move |(i, pixel)| (pixel, tile.sums[i] / count as f32))
    }

    fn assemble(&self, view: View, rows: Range<u32>, tiles: &[PassTile]) -> Band {
        let first = rows.start as usize * self.size[0] as usize;
        let count = (rows.end - rows.start) as usize * self.size[0] as usize;
        let samples = self.passes.max(1) as f32;
        let mut band = Band {
            view,
            first_row: rows.start,
            radiance: vec![Vec3::ZERO; count],
            coverage: vec![0.0; count],
            disparity: vec![0.0; count],
            triangle: vec![NO_TRIANGLE; count],
            types: vec![PixelType::Unseen; count],
            supplier: vec![NO_SUPPLIER; count],
        };
        for tile in tiles {
            for (i, pixel) in pixels_of_tile(tile.corner, self.size) {
                let at = pixel - first;
                band.radiance[at] = tile.sums[i] / samples;
                band.coverage[at] = tile.hits[i] as f32 / samples;
                (band.disparity[at], band.triangle[at]) = (tile.disparity[i], tile.triangle[i]);
            }
        }
        band
    }
}
