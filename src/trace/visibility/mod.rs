//! First hits of whole pictures: rasterised candidates, settled by the watertight test.

mod bin;
mod facet;
mod lens;
mod settle;
mod walk;

use super::bvh::{NO_TRIANGLE, RayTile, TILE_RAYS, TILE_SIDE, TileHits};
use super::{Hit, Tracer, primary_tile};
use crate::camera::View;
use bin::{BIN_PIXELS, BIN_SIDE, BIN_TILES, Bin, NEEDS_RAY};
use lens::Lens;
use settle::Open;
use rayon::prelude::*;

/// The surface that each pixel of a picture shows, where it is certain.
#[derive(Clone, Debug, Default)]
pub struct VisibilityBuffer {
    /// Bin by bin, tile by tile: the slot of a triangle in the hierarchy.
    slots: Vec<u32>,
    columns: usize,
    behind_glass: bool,
}

impl VisibilityBuffer {
    /// Finds the surfaces of all pixels of a view, on all threads. `behind_glass` leaves out
    /// surfaces of glass that have no diffuse part.
    pub fn find(&mut self, tracer: &Tracer, view: &View, behind_glass: bool) {
        let [columns, rows] = view.size.map(|s| (s as usize).div_ceil(BIN_SIDE));
        self.columns = columns;
        self.behind_glass = behind_glass && tracer.scene().features.glass;
        self.slots.resize(columns * rows * BIN_PIXELS, NEEDS_RAY);
        let Some(lens) = Lens::new(view) else { return self.slots.fill(NEEDS_RAY) };
        let behind_glass = self.behind_glass;
        self.slots.par_chunks_mut(BIN_PIXELS).enumerate().for_each_init(Bin::new, |bin, (i, slots)| {
            let corner = [i % columns, i / columns].map(|k| (k * BIN_SIDE) as u32);
            let bin_view = lens.bin(corner);
            if behind_glass {
                walk::find(tracer.bvh(), &bin_view, bin, |t| !tracer.is_clear_glass(t), slots);
            } else {
                walk::find(tracer.bvh(), &bin_view, bin, |_| true, slots);
            }
        });
    }

    /// Writes the nearest hits through the pixel centres of the tile whose top left pixel is
    /// `corner`. The hits are those of [`Tracer::closest`]. Returns a bit for each ray that was traced alone.
    pub fn hits_of_tile(
        &self,
        tracer: &Tracer,
        view: &View,
        corner: [u32; 2],
        tile: &mut RayTile,
        hits: &mut TileHits,
    ) -> u64 {
        *tile = primary_tile(view, corner);
        let Open { missed, checked } = settle::settle(tracer.bvh(), tile, self.slots_of(corner), hits);
        let features = tracer.scene().features;
        let mut open = missed;
        if features.alpha {
            open |= cut_out(tracer, hits);
        }
        if features.needles {
            let unsure = checked & !open;
            for ray in (0..TILE_RAYS).filter(|ray| unsure >> ray & 1 == 1) {
                let stands = hits.hit(ray).is_none_or(|hit| tracer.stands(&tile.ray(ray), &hit));
                open |= u64::from(!stands) << ray;
            }
        }
        for ray in (0..TILE_RAYS).filter(|ray| open >> ray & 1 == 1) {
            hits.set(ray, self.closest(tracer, &tile.ray(ray)));
        }
        open
    }

    fn closest(&self, tracer: &Tracer, ray: &crate::math::Ray) -> Option<Hit> {
        if self.behind_glass {
            let is_there = |hit: &Hit| !tracer.is_clear_glass(hit.triangle) && tracer.stands(ray, hit);
            tracer.bvh().closest(ray, is_there)
        } else {
            tracer.closest(ray)
        }
    }

    fn slots_of(&self, [x, y]: [u32; 2]) -> &[u32; TILE_RAYS] {
        let [x, y] = [x as usize / TILE_SIDE, y as usize / TILE_SIDE];
        let bin = y / BIN_TILES * self.columns + x / BIN_TILES;
        let tile = y % BIN_TILES * BIN_TILES + x % BIN_TILES;
        &self.slots.as_chunks().0[bin * BIN_TILES * BIN_TILES + tile]
    }
}

/// Bits of the hits that are cut out.
fn cut_out(tracer: &Tracer, hits: &TileHits) -> u64 {
    let (mut last, mut has_alpha, mut bits) = (NO_TRIANGLE, false, 0);
    for ray in 0..TILE_RAYS {
        let triangle = hits.triangle[ray];
        if triangle != last {
            last = triangle;
            let material = (triangle != NO_TRIANGLE).then(|| tracer.scene().material_of(triangle));
            has_alpha = material.is_some_and(|m| m.alpha_texture.is_some());
        }
        if has_alpha {
            let covered = hits.hit(ray).is_none_or(|hit| tracer.is_covered(&hit));
            bits |= u64::from(!covered) << ray;
        }
    }
    bits
}
