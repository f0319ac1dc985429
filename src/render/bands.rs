//! Pictures of any size, some rows at a time: every pixel traced in full, with the bits it has in the whole picture.

use super::frame::{Frame, NO_SUPPLIER};
use super::refine::{offset_of_pass, pixels_of_tile, seed_of_pass};
use crate::camera::{Camera, View};
use crate::raster::pixel_types::{PixelMap, PixelType};
use crate::trace::NO_TRIANGLE;
use crate::trace::parallel::Stop;
use crate::trace::{RayCounts, TILE_RAYS, TILE_SIDE, TraceSettings, Tracer};
use glam::Vec3;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

/// Some rows of a picture with all that is known of each pixel. Row-major, top row first.
#[derive(Clone, Debug)]
pub struct Band {
    /// The view of the whole picture.
    pub view: View,
    /// The first of the rows.
    pub first_row: u32,
    /// Linear, scene-referred Rec. 709.
    pub radiance: Vec<Vec3>,
    /// The part of each pixel that is not background, 0..1.
    pub coverage: Vec<f32>,
    /// 1 / depth along the viewing axis in scene units, through the pixel's centre; 0 where the sky is seen.
    pub disparity: Vec<f32>,
    /// First triangle, [`NO_TRIANGLE`] for the sky.
    pub triangle: Vec<u32>,
    /// How each pixel came to its colour.
    pub types: PixelMap,
    /// Which of the references supplied it; [`NO_SUPPLIER`] for none.
    pub supplier: Vec<u8>,
}

/// A whole picture is a band too. A pixel of it is background or it is not.
impl From<Frame> for Band {
    fn from(frame: Frame) -> Self {
        let coverage = |&t: &u32| if t == NO_TRIANGLE { 0.0 } else { 1.0 };
        Self {
            view: frame.view,
            first_row: 0,
            radiance: frame.radiance,
            coverage: frame.triangle.iter().map(coverage).collect(),
            disparity: frame.disparity,
            triangle: frame.triangle,
            types: frame.types,
            supplier: frame.supplier,
        }
    }
}

/// What the sky adds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Background {
    /// Its light.
    #[default]
    Shown,
    /// Nothing: radiance is that of the model alone, multiplied by its coverage.
    LeftOut,
}

/// A picture to be made band by band.
#[derive(Debug)]
pub struct BandedPicture<'a> {
    /// The scene.
    pub tracer: &'a Tracer,
    /// Where it is seen from.
    pub camera: &'a Camera,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Samples, bounces, seed.
    pub trace: TraceSettings,
    /// Rays through different points of each pixel, at least one: with one it is the picture of mode `full`, with more
    /// that of [`super::render_antialiased`].
    pub passes: u32,
    /// What the sky adds.
    pub background: Background,
}

/// What one pixel has gathered.
#[derive(Clone, Copy)]
struct Gathered {
    sum: Vec3,
    hits: u32,
    disparity: f32,
    triangle: u32,
}

/// Of a tile, with the index of each pixel in its band.
struct TracedTile {
    corner: [u32; 2],
    pixels: Vec<Gathered>,
    rays: RayCounts,
}

impl BandedPicture<'_> {
    /// A band holds about so many pixels.
    const BAND_PIXELS: u32 = 1 << 17;

    /// The bands, from the top: whole tiles high.
    pub fn bands(&self) -> impl Iterator<Item = Range<u32>> + use<> {
        let ([width, height], side) = (self.size, TILE_SIDE as u32);
        let rows = (Self::BAND_PIXELS / width.max(1)).next_multiple_of(side).max(side);
        (0..height).step_by(rows as usize).map(move |y| y..(y + rows).min(height))
    }

    /// Pixels times passes: what [`Self::render`] counts.
    pub fn work(&self) -> u64 {
        self.size.map(u64::from).iter().product::<u64>() * u64::from(self.passes.max(1))
    }

    /// Traces one band; `None` after a stop. `note` is told from the threads how much more is done.
    pub fn render(
        &self,
        rows: Range<u32>,
        stop: Stop<'_>,
        note: &(dyn Fn(u64) + Sync),
    ) -> Option<(Band, RayCounts)> {
        let view = View::new(self.camera, &self.tracer.scene().frame, self.size);
        let (side, passes) = (TILE_SIDE as u32, self.passes.max(1));
        let views: Vec<View> = (0..passes).map(|pass| view.shifted(offset_of_pass(pass, passes))).collect();
        let (columns, lines) = (self.size[0].div_ceil(side), (rows.end - rows.start).div_ceil(side));
        let stopped = AtomicBool::new(false);
        let trace = |index: u32| {
            if stopped.load(Ordering::Relaxed) || stop() {
                stopped.store(true, Ordering::Relaxed);
                return None;
            }
            let corner = [index % columns * side, rows.start + index / columns * side];
            let Some(tile) = self.trace_tile(&views, corner, stop) else {
                stopped.store(true, Ordering::Relaxed);
                return None;
            };
            note(tile.pixels.len() as u64 * u64::from(passes));
            Some(tile)
        };
        let tiles: Option<Vec<TracedTile>> = (0..columns * lines).into_par_iter().map(trace).collect();
        Some(self.assembled(view, rows.clone(), &tiles?))
    }

    /// `None` after a stop: with many passes a tile takes a while.
    fn trace_tile(&self, views: &[View], corner: [u32; 2], stop: Stop<'_>) -> Option<TracedTile> {
        let nothing = Gathered { sum: Vec3::ZERO, hits: 0, disparity: 0.0, triangle: NO_TRIANGLE };
        let places: Vec<usize> = pixels_of_tile(corner, self.size).map(|(_, pixel)| pixel).collect();
        let mut pixels = vec![nothing; places.len()];
        let mut rays = RayCounts::default();
        for (pass, view) in (0..).zip(views) {
            if stop() {
                return None;
            }
            let trace = TraceSettings { seed: seed_of_pass(self.trace.seed, pass), ..self.trace };
            for (gathered, &pixel) in pixels.iter_mut().zip(&places) {
                let traced = self.tracer.pixel(view, pixel as u32, &trace, &mut rays);
                if pass == 0 {
                    gathered.disparity = traced.hit.map_or(0.0, |hit| 1.0 / hit.t);
                    gathered.triangle = traced.hit.map_or(NO_TRIANGLE, |hit| hit.triangle);
                }
                gathered.hits += u32::from(traced.hit.is_some());
                if traced.hit.is_some() || self.background == Background::Shown {
                    gathered.sum += traced.radiance;
                }
            }
        }
        debug_assert!(pixels.len() <= TILE_RAYS);
        Some(TracedTile { corner, pixels, rays })
    }

    fn assembled(&self, view: View, rows: Range<u32>, tiles: &[TracedTile]) -> (Band, RayCounts) {
        let first = rows.start as usize * self.size[0] as usize;
        let count = (rows.end - rows.start) as usize * self.size[0] as usize;
        let samples = self.passes.max(1) as f32;
        let mut rays = RayCounts::default();
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
            rays += tile.rays;
            for ((_, pixel), gathered) in pixels_of_tile(tile.corner, self.size).zip(&tile.pixels) {
                let at = pixel - first;
                band.radiance[at] = gathered.sum / samples;
                band.coverage[at] = gathered.hits as f32 / samples;
                (band.disparity[at], band.triangle[at]) = (gathered.disparity, gathered.triangle);
            }
        }
        (band, rays)
    }
}
