//! A reference that lights only what older references do not know well enough.
//!
//! Each sample is traced once and resampled once, when a frame looks it up: a sparse reference copies no light.

use crate::camera::{Camera, View};
use crate::lookup::tile_surfaces::inside_mask;
use crate::lookup::{LookupSet, TileLight, TileSurfaces, ViewLookup};
use crate::math::key::Key;
use crate::reference::ReferenceFrame;
use crate::reference::placement::OpenSpot;
use crate::trace::parallel::{Stop, trace_pixels};
use crate::trace::{TILE_RAYS, TILE_SIDE, TraceSettings, Tracer};
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::time::Instant;

/// A pixel is lit anew where the look-up's estimate of its own error is above this share of its light: an error that
/// sixteen shadow rays have as well.
const MAX_SMOOTHED: f32 = 0.08;

/// What one tile leaves to do: its pixels, and which of them are to be lit.
struct SeenTile {
    corner: [u32; 2],
    t: [f32; TILE_RAYS],
    triangle: [u32; TILE_RAYS],
    wanted: u64,
    open: u64,
}

impl ReferenceFrame {
    /// Traces a reference whose pixels are lit only where `known` does not know their light well. `None` after a stop.
    pub fn trace_sparse(
        tracer: &Tracer,
        camera: &Camera,
        size: [u32; 2],
        settings: &TraceSettings,
        known: &LookupSet<'_>,
        stop: Stop<'_>,
    ) -> Option<Self> {
        let start = Instant::now();
        let view = View::new(camera, &tracer.scene().frame, size);
        let tiles = see_tiles(tracer, &view, known);
        let open = open_pixels(&tiles, &view);
        let mut frame = Self::empty(tracer, camera, view, settings);
        tiles.iter().for_each(|tile| tile.store_hits(&mut frame, tracer));
        frame.forget_ill_conditioned(tracer);
        let mut lights: Vec<Option<Vec3>> = Vec::new();
        let (rays, complete) = trace_pixels(&open, &mut lights, stop, |pixel, rays| {
            let ray = Tracer::primary_ray(&view, pixel);
            let hit = tracer.hit_on_triangle(&ray, frame.triangle()[pixel as usize]);
            tracer.shade_hit(&ray, hit, settings, Key::of_pixel(settings.seed, pixel), rays).0.light
        });
        if !complete {
            return None;
        }
        frame.store_lights(&open, lights.iter().copied().flatten());
        frame.rays = rays;
        frame.rays.primary += view.pixel_count() as u64;
        frame.secs = start.elapsed().as_secs_f64();
        Some(frame)
    }

    /// A reference of what a frame lit itself: the pixels listed, with their light. `hits` tells distance and triangle
    /// of every pixel.
    pub fn from_lit_pixels(
        tracer: &Tracer,
        camera: &Camera,
        size: [u32; 2],
        settings: &TraceSettings,
        hits: impl Iterator<Item = Option<(f32, u32)>>,
        pixels: &[u32],
        lights: impl Iterator<Item = Vec3> + Clone,
    ) -> Self {
        let view = View::new(camera, &tracer.scene().frame, size);
        let mut frame = Self::empty(tracer, camera, view, settings);
        for (pixel, hit) in hits.enumerate() {
            let specular = hit.is_some_and(|(_, t)| tracer.scene().material_of(t).is_view_dependent());
            frame.store_hit(pixel, hit, u32::from(specular));
        }
        frame.forget_ill_conditioned(tracer);
        frame.store_lights(pixels, lights);
        frame
    }
}

/// One tile in so many per axis is looked at where a view is only judged: 900 of 1280x720.
const JUDGED_STEP: usize = 4;

/// The share of a view's pixels, in percent, whose light is not known: what a sparse reference there would trace.
/// Estimated from a sixteenth of the tiles. Where they are is told too if a list is given.
pub fn open_percent(
    tracer: &Tracer,
    view: &View,
    known: &LookupSet<'_>,
    spots: Option<&mut Vec<OpenSpot>>,
) -> f64 {
    let lookup = ViewLookup::new(known, view, 1);
    let Some(spots) = spots else {
        let add =
            |a: JudgedTile, b: JudgedTile| JudgedTile { open: a.open + b.open, all: a.all + b.all, ..a };
        let none = JudgedTile::default();
        let row = |row| judged_tiles(tracer, view, &lookup, row).fold(none, add);
        return judged_rows(view).map(row).reduce(|| none, add).open_percent();
    };
    let tiles: Vec<JudgedTile> =
        judged_rows(view).flat_map_iter(|row| judged_tiles(tracer, view, &lookup, row)).collect();
    let [open, all] = tiles.iter().fold([0, 0], |[open, all], t| [open + t.open, all + t.all]);
    let middle = |tile: &JudgedTile| Vec2::from(tile.corner.map(|c| c as f32 + TILE_SIDE as f32 / 2.0));
    let percent = |tile: &JudgedTile| 100.0 * f64::from(tile.open) / f64::from(all.max(1));
    let is_open = |tile: &&JudgedTile| tile.open > 0;
    spots.extend(tiles.iter().filter(is_open).map(|t| OpenSpot { point: middle(t), percent: percent(t) }));
    JudgedTile { open, all, ..JudgedTile::default() }.open_percent()
}

/// How many of a tile's pixels are not known, or of several tiles' together.
#[derive(Clone, Copy, Default)]
struct JudgedTile {
    corner: [u32; 2],
    open: u32,
    all: u32,
}

impl JudgedTile {
    fn open_percent(&self) -> f64 {
        100.0 * f64::from(self.open) / f64::from(self.all.max(1))
    }
}

/// The first of the tiles that are looked at.
fn first_judged(count: u32) -> u32 {
    (JUDGED_STEP as u32 / 2).min(count.saturating_sub(1))
}

fn judged_rows(view: &View) -> impl IndexedParallelIterator<Item = u32> {
    let rows = view.size[1].div_ceil(TILE_SIDE as u32);
    (first_judged(rows)..rows).into_par_iter().step_by(JUDGED_STEP)
}

fn judged_tiles(
    tracer: &Tracer,
    view: &View,
    lookup: &ViewLookup<'_>,
    row: u32,
) -> impl Iterator<Item = JudgedTile> {
    let side = TILE_SIDE as u32;
    let columns = view.size[0].div_ceil(side);
    let (mut seen, mut light) = (TileSurfaces::new(view), TileLight::NONE);
    (first_judged(columns)..columns).step_by(JUDGED_STEP).map(move |column| {
        let corner = [column * side, row * side];
        seen.see_behind_glass(tracer, view, corner);
        lookup.gather(&seen.points, &mut light);
        JudgedTile {
            corner,
            open: (seen.points.wanted & !light.known).count_ones(),
            all: inside_mask(view, corner).count_ones(),
        }
    })
}

fn see_tiles(tracer: &Tracer, view: &View, known: &LookupSet<'_>) -> Vec<SeenTile> {
    let lookup = ViewLookup::new(known, view, 1);
    let side = TILE_SIDE as u32;
    let [columns, rows] = view.size.map(|s| s.div_ceil(side));
    (0..rows)
        .into_par_iter()
        .flat_map_iter(|row| {
            let (mut seen, mut light) = (TileSurfaces::new(view), TileLight::NONE);
            let lookup = &lookup;
            (0..columns).map(move |column| {
                let corner = [column * side, row * side];
                seen.see_behind_glass(tracer, view, corner);
                lookup.gather(&seen.points, &mut light);
                let bad = (0..TILE_RAYS).filter(|&i| light.smoothed[i] > MAX_SMOOTHED);
                let bad = bad.fold(0u64, |mask, i| mask | 1 << i);
                SeenTile {
                    corner,
                    t: seen.hits.t,
                    triangle: seen.hits.triangle,
                    wanted: seen.points.wanted,
                    open: seen.points.wanted & (!light.known | bad),
                }
            })
        })
        .collect()
}

/// Marks that go around a picture, so that no neighbour lies outside.
struct Marks {
    stride: usize,
    is_open: Vec<bool>,
}

/// The pixels to be lit, tile by tile: the open ones and those around them, so that a look-up between lit and unlit
/// pixels finds all its samples in one reference.
fn open_pixels(tiles: &[SeenTile], view: &View) -> Vec<u32> {
    let stride = view.size[0] as usize + 2;
    let mut marks = Marks { stride, is_open: vec![false; stride * (view.size[1] as usize + 2)] };
    for tile in tiles {
        for_each_bit(tile.open, |i| marks.mark_around(tile.pixel(i)));
    }
    let mut open = Vec::new();
    for tile in tiles {
        for_each_bit(tile.wanted, |i| {
            let [x, y] = tile.pixel(i);
            if marks.is_open[(y as usize + 1) * stride + x as usize + 1] {
                open.push(y * view.size[0] + x);
            }
        });
    }
    open
}

impl Marks {
    fn mark_around(&mut self, [x, y]: [u32; 2]) {
        for row in 0..3 {
            let at = (y as usize + row) * self.stride + x as usize;
            self.is_open[at..at + 3].fill(true);
        }
    }
}

fn for_each_bit(mut bits: u64, mut f: impl FnMut(u32)) {
    while bits != 0 {
        f(bits.trailing_zeros());
        bits &= bits - 1;
    }
}

impl SeenTile {
    fn pixel(&self, i: u32) -> [u32; 2] {
        [self.corner[0] + i % 8, self.corner[1] + i / 8]
    }

    fn store_hits(&self, frame: &mut ReferenceFrame, tracer: &Tracer) {
        let [width, height] = frame.view.size;
        for i in 0..TILE_RAYS {
            let (x, y) = (self.corner[0] + i as u32 % 8, self.corner[1] + i as u32 / 8);
            if x < width && y < height {
                let hit = (self.triangle[i] != u32::MAX).then_some((self.t[i], self.triangle[i]));
                let specular = hit.is_some_and(|(_, t)| tracer.scene().material_of(t).is_view_dependent());
                frame.store_hit((y * width + x) as usize, hit, u32::from(specular));
            }
        }
    }
}
