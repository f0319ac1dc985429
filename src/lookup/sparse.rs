//! Sparse references, which light only the pixels that older references do not know well enough.
//!
//! Light is resampled once, when a frame looks it up: a sparse reference copies none from others.

use super::growing::GrowingReference;
use super::open_pixels::store_hit;
use super::policy::ESTIMATE_STEP;
use super::{LookupSet, TileLight, TileSurfaces, ViewLookup, tile::inside_mask};
use crate::camera::{Camera, View};
use crate::reference::{ReferenceFrame, SmoothSamples, placement::OpenSpot};
use crate::trace::parallel::Stop;
use crate::trace::{ArrivingLight, TILE_SIDE, TraceSettings, Tracer};
use glam::Vec2;
use rayon::prelude::*;

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
        let mut reference = GrowingReference::begin(tracer, camera, size, settings, known);
        reference.light(tracer, known, settings.samples.max(1), stop).then(|| reference.finish())
    }

    /// Traces a reference whose pixels are lit only where `is_wanted` holds, whatever other
    /// references know: `empty` is a set without any. Returns `None` after a stop.
    pub(crate) fn trace_where(
        tracer: &Tracer,
        camera: &Camera,
        size: [u32; 2],
        settings: &TraceSettings,
        empty: &LookupSet<'_>,
        is_wanted: impl Fn(u32) -> bool,
        stop: Stop<'_>,
    ) -> Option<Self> {
        let mut reference = GrowingReference::begin_where(tracer, camera, size, settings, empty, is_wanted);
        reference.light(tracer, empty, settings.samples.max(1), stop).then(|| reference.finish())
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
