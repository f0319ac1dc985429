//! Sparse references, which light only the pixels that older references do not know well enough.
//!
//! Light is resampled once, when a frame looks it up: a sparse reference copies none from others.

use super::policy::{ESTIMATE_STEP, MAX_SMOOTHED};
use super::{LookupSet, TileLight, TileSurfaces, ViewLookup, pixels_of_tile, tile::inside_mask};
use crate::camera::{Camera, View};
use crate::math::sequence::PointSeed;
use crate::reference::{ReferenceFrame, SmoothSamples, placement::OpenSpot};
use crate::trace::parallel::{Stop, trace_missing};
use crate::trace::{
    ArrivingLight, NO_TRIANGLE, RayCounts, TILE_RAYS, TILE_SIDE, TraceSettings, Tracer, VisibilityBuffer,
};
use glam::Vec2;
use rayon::prelude::*;
use std::time::Instant;

/// A tile of a reference in the making: its hits, and one bit per pixel that can be lit and that
/// has to be lit.
struct HitTile {
    corner: [u32; 2],
    t: [f32; TILE_RAYS],
    triangle: [u32; TILE_RAYS],
    wanted: u64,
    open: u64,
}

/// A reference whose pixels are being lit. It can be interrupted and continued.
#[derive(Debug)]
pub(crate) struct UnfinishedReference {
    frame: ReferenceFrame,
    open: Vec<u32>,
    lights: Vec<Option<ArrivingLight>>,
    secs: f64,
}

impl UnfinishedReference {
    /// Finds the surfaces of a reference, and its pixels whose light `known` does not know well.
    pub(crate) fn begin(
        tracer: &Tracer,
        camera: &Camera,
        size: [u32; 2],
        settings: &TraceSettings,
        known: &LookupSet<'_>,
    ) -> Self {
        let start = Instant::now();
        let view = View::new(camera, &tracer.scene().frame, size);
        let tiles = hit_tiles(tracer, &view, known);
        let open = open_pixels(&tiles, &view);
        let mut frame = ReferenceFrame::empty(tracer, camera, view, settings);
        tiles.iter().for_each(|tile| tile.store_hits(&mut frame, tracer));
        frame.forget_ill_conditioned(tracer);
        frame.rays.primary = view.pixel_count() as u64;
        let lights = vec![None; open.len()];
        Self { frame, open, lights, secs: start.elapsed().as_secs_f64() }
    }

    /// Lights the pixels that are not lit yet. Returns true where none is left.
    pub(crate) fn light(&mut self, tracer: &Tracer, known: &LookupSet<'_>, stop: Stop<'_>) -> bool {
        let start = Instant::now();
        let (frame, view, settings) = (&self.frame, &self.frame.view, &self.frame.settings);
        let (rays, is_complete): (RayCounts, bool) =
            trace_missing(&self.open, &mut self.lights, stop, |pixel, rays: &mut RayCounts| {
                let ray = Tracer::primary_ray(view, pixel);
                let hit = tracer.hit_on_triangle(&ray, frame.triangle()[pixel as usize]);
                let seed = PointSeed::of_pixel(settings.seed, pixel, view.size[0], settings.samples);
                let footprint = hit.map_or(0.0, |hit| view.footprint(ray.direction, hit.t));
                let lighting = known.light_settings(settings, footprint);
                tracer.shade_hit(&ray, hit, &lighting, seed, rays).0.light
            });
        self.frame.rays += rays;
        self.secs += start.elapsed().as_secs_f64();
        is_complete
    }

    /// The reference. To be called once [`Self::light`] has left no pixel.
    pub(crate) fn finish(mut self, tracer: &Tracer) -> ReferenceFrame {
        let start = Instant::now();
        self.frame.store_lit(tracer, &self.open, self.lights.iter().flatten());
        self.frame.secs = self.secs + start.elapsed().as_secs_f64();
        self.frame
    }
}

impl ReferenceFrame {
    /// Traces a reference whose pixels are lit only where `known` does not know their light well.
    /// Returns `None` after a stop.
    pub fn trace_sparse(
        tracer: &Tracer,
        camera: &Camera,
        size: [u32; 2],
        settings: &TraceSettings,
        known: &LookupSet<'_>,
        stop: Stop<'_>,
    ) -> Option<Self> {
        let mut reference = UnfinishedReference::begin(tracer, camera, size, settings, known);
        reference.light(tracer, known, stop).then(|| reference.finish(tracer))
    }

    /// Makes a reference of pixels that a frame has lit, with their light. `hits` holds the
    /// distance and triangle of every pixel, row-major.
    pub fn from_lit_pixels(
        tracer: &Tracer,
        camera: &Camera,
        size: [u32; 2],
        settings: &TraceSettings,
        hits: impl Iterator<Item = Option<(f32, u32)>>,
        pixels: &[u32],
        lights: impl Iterator<Item = ArrivingLight> + Clone,
    ) -> Self {
        let view = View::new(camera, &tracer.scene().frame, size);
        let mut frame = Self::empty(tracer, camera, view, settings);
        for (pixel, hit) in hits.enumerate() {
            store_hit(&mut frame, tracer, pixel, hit);
        }
        frame.forget_ill_conditioned(tracer);
        let lights: Vec<ArrivingLight> = lights.collect();
        frame.store_lit(tracer, pixels, lights.iter());
        frame
    }

    /// Stores the direct light of the listed pixels, and their smooth light filtered.
    fn store_lit<'l>(
        &mut self,
        tracer: &Tracer,
        pixels: &[u32],
        lights: impl Iterator<Item = &'l ArrivingLight> + Clone,
    ) {
        self.store_lights(pixels, lights.clone().map(ArrivingLight::direct));
        self.store_filtered(tracer, pixels, &lights.map(SmoothSamples::from).collect::<Vec<_>>());
    }
}

/// Estimates the share of a view's pixels, in percent, whose light is not known and which a sparse
/// reference there would trace. One tile in sixteen is examined. The open spots are appended to the
/// list, if one is given.
pub fn open_percent(
    tracer: &Tracer,
    view: &View,
    known: &LookupSet<'_>,
    spots: Option<&mut Vec<OpenSpot>>,
) -> f64 {
    let lookup = ViewLookup::new(known, view, 1);
    let tiles: Vec<EstimatedTile> =
        estimated_rows(view).flat_map_iter(|row| estimated_tiles(tracer, view, &lookup, row)).collect();
    let [open, all] = tiles.iter().fold([0, 0], |[open, all], t| [open + t.open, all + t.all]);
    let percent = |open: u32| 100.0 * f64::from(open) / f64::from(all.max(1));
    if let Some(spots) = spots {
        let middle = |corner: [u32; 2]| Vec2::from(corner.map(|c| c as f32 + TILE_SIDE as f32 / 2.0));
        let spot = |t: &EstimatedTile| OpenSpot { point: middle(t.corner), percent: percent(t.open) };
        spots.extend(tiles.iter().filter(|tile| tile.open > 0).map(spot));
    }
    percent(open)
}

/// Pixel counts of a tile.
struct EstimatedTile {
    corner: [u32; 2],
    /// Pixels whose light is needed and not known.
    open: u32,
    /// Pixels inside the picture.
    all: u32,
}

/// Index of the first tile examined.
fn first_estimated(count: u32) -> u32 {
    (ESTIMATE_STEP as u32 / 2).min(count.saturating_sub(1))
}

fn estimated_rows(view: &View) -> impl IndexedParallelIterator<Item = u32> {
    let rows = view.size[1].div_ceil(TILE_SIDE as u32);
    (first_estimated(rows)..rows).into_par_iter().step_by(ESTIMATE_STEP)
}

fn estimated_tiles(
    tracer: &Tracer,
    view: &View,
    lookup: &ViewLookup<'_>,
    row: u32,
) -> impl Iterator<Item = EstimatedTile> {
    let side = TILE_SIDE as u32;
    let columns = view.size[0].div_ceil(side);
    let (mut surfaces, mut light) = (TileSurfaces::new(view), TileLight::NONE);
    (first_estimated(columns)..columns).step_by(ESTIMATE_STEP).map(move |column| {
        let corner = [column * side, row * side];
        surfaces.trace_behind_glass(tracer, view, corner);
        lookup.gather(&surfaces.points, &mut light);
        EstimatedTile {
            corner,
            open: (surfaces.points.wanted & !light.known).count_ones(),
            all: inside_mask(view, corner).count_ones(),
        }
    })
}

fn hit_tiles(tracer: &Tracer, view: &View, known: &LookupSet<'_>) -> Vec<HitTile> {
    let lookup = ViewLookup::new(known, view, 1);
    let side = TILE_SIDE as u32;
    let [columns, rows] = view.size.map(|s| s.div_ceil(side));
    // Objects in a glass case are stored for viewers who look through it: leave clear glass out.
    let mut visible = VisibilityBuffer::default();
    visible.find(tracer, view, true);
    let visible = &visible;
    (0..rows)
        .into_par_iter()
        .flat_map_iter(|row| {
            let (mut surfaces, mut light) = (TileSurfaces::new(view), TileLight::NONE);
            let lookup = &lookup;
            (0..columns).map(move |column| {
                let corner = [column * side, row * side];
                surfaces.settle(tracer, visible, view, corner);
                lookup.gather(&surfaces.points, &mut light);
                let bad = (0..TILE_RAYS).filter(|&i| light.smoothed[i] > MAX_SMOOTHED);
                let bad = bad.fold(0u64, |mask, i| mask | 1 << i);
                HitTile {
                    corner,
                    t: surfaces.hits.t,
                    triangle: surfaces.hits.triangle,
                    wanted: surfaces.points.wanted,
                    open: surfaces.points.wanted & (!light.known | bad),
                }
            })
        })
        .collect()
}

/// The pixels to be lit, tile by tile: the open ones and their neighbours, so that a look-up
/// between lit and unlit pixels finds all its samples in one reference.
fn open_pixels(tiles: &[HitTile], view: &View) -> Vec<u32> {
    // One mark per pixel, with a border of one pixel so that every neighbour has a mark.
    let [width, height] = view.size.map(|s| s as usize);
    let stride = width + 2;
    let mut marks = vec![false; stride * (height + 2)];
    let pixels = |tile: &HitTile, mask: u64| {
        pixels_of_tile(tile.corner, view.size).filter(move |(i, _)| mask >> i & 1 == 1)
    };
    for (_, pixel) in tiles.iter().flat_map(|tile| pixels(tile, tile.open)) {
        for row in 0..3 {
            let at = (pixel / width + row) * stride + pixel % width;
            marks[at..at + 3].fill(true);
        }
    }
    let wanted = tiles.iter().flat_map(|tile| pixels(tile, tile.wanted));
    let is_marked = |pixel: &usize| marks[(pixel / width + 1) * stride + pixel % width + 1];
    wanted.map(|(_, pixel)| pixel).filter(is_marked).map(|pixel| pixel as u32).collect()
}

impl HitTile {
    fn store_hits(&self, frame: &mut ReferenceFrame, tracer: &Tracer) {
        for (i, pixel) in pixels_of_tile(self.corner, frame.view.size) {
            let hit = (self.triangle[i] != NO_TRIANGLE).then_some((self.t[i], self.triangle[i]));
            store_hit(frame, tracer, pixel, hit);
        }
    }
}

fn store_hit(frame: &mut ReferenceFrame, tracer: &Tracer, pixel: usize, hit: Option<(f32, u32)>) {
    let material = hit.map(|(_, triangle)| tracer.scene().material_of(triangle));
    frame.store_hit(pixel, hit, u32::from(material.is_some_and(|m| m.is_view_dependent())));
}
