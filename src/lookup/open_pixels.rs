//! What a reference in the making shows, and which of its pixels have to be lit.

use super::policy::MAX_SMOOTHED;
use super::{LookupSet, TileLight, TileSurfaces, ViewLookup, pixels_of_tile};
use crate::camera::View;
use crate::reference::ReferenceFrame;
use crate::trace::{NO_TRIANGLE, TILE_RAYS, TILE_SIDE, Tracer, VisibilityBuffer};
use rayon::prelude::*;

/// A tile of a reference in the making: its hits, and one bit per pixel that can be lit and that
/// has to be lit.
pub(super) struct HitTile {
    corner: [u32; 2],
    t: [f32; TILE_RAYS],
    triangle: [u32; TILE_RAYS],
    wanted: u64,
    open: u64,
}

pub(super) fn hit_tiles(tracer: &Tracer, view: &View, known: &LookupSet<'_>) -> Vec<HitTile> {
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
pub(super) fn open_pixels(tiles: &[HitTile], view: &View) -> Vec<u32> {
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
    /// Stores what the pixels show.
    pub(super) fn store_hits(&self, frame: &mut ReferenceFrame, tracer: &Tracer) {
        for (i, pixel) in pixels_of_tile(self.corner, frame.view.size) {
            let hit = (self.triangle[i] != NO_TRIANGLE).then_some((self.t[i], self.triangle[i]));
            store_hit(frame, tracer, pixel, hit);
        }
    }
}

pub(super) fn store_hit(frame: &mut ReferenceFrame, tracer: &Tracer, pixel: usize, hit: Option<(f32, u32)>) {
    let material = hit.map(|(_, triangle)| tracer.scene().material_of(triangle));
    frame.store_hit(pixel, hit, u32::from(material.is_some_and(|m| m.is_view_dependent())));
}
