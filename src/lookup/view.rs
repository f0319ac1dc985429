//! The look-up for the pixels of one view, tile by tile: chooses the references that are best for a
//! tile, and gathers their light.

use super::found::FoundLight;
use super::point::{LookupReference, LookupSet};
use super::point_cache::SurfaceKey;
use super::rows::ROWS_LOOKED_UP;
use super::tile::{Choice, TileLight, TilePoints};
use super::{
    gather::ReferenceProjection,
    policy::{MAX_AVERAGED_BEST, MAX_ROUNDS},
};
use crate::camera::{PixelWarp, View};
use crate::math::simd;
use crate::reference::directory::{ALIKE_COSINE, MAX_SLOTS, SlotMask};
use crate::trace::TILE_SIDE;
use arrayvec::ArrayVec;
use fearless_simd::{Simd, dispatch};
use glam::Vec3;

/// A look-up set prepared for the pixels of one view.
#[derive(Debug)]
pub struct ViewLookup<'a> {
    pub(super) set: &'a LookupSet<'a>,
    view: View,
    max_averaged: usize,
    /// Projections into the references, by slot.
    projections: Vec<Option<ReferenceProjection<'a>>>,
}

impl<'a> ViewLookup<'a> {
    /// Prepares a set for a view. A pixel is averaged over at most `max_averaged` references.
    pub fn new(set: &'a LookupSet<'a>, view: &View, max_averaged: usize) -> Self {
        let step = view.scene_from_pixel.x_axis.length();
        let projection = |reference: &'a LookupReference<'a>| ReferenceProjection {
            reference,
            warp: PixelWarp::new(view, &reference.frame.view),
            eye_offset: view.eye_relative_to(&reference.frame.view),
            density: (step / reference.step).powi(2),
        };
        let projections = set.references.iter().map(|r| r.as_ref().map(projection)).collect();
        Self { set, view: *view, max_averaged: max_averaged.clamp(1, MAX_AVERAGED_BEST), projections }
    }

    /// Finds the light of the wanted pixels of a tile. Where the tile shows one plane, four rows
    /// are looked up, and the others only where the rows around them differ.
    pub fn gather(&self, points: &TilePoints, found: &mut TileLight) {
        found.reset(self.set.noise);
        if self.set.usable == 0 || points.wanted == 0 {
            return;
        }
        let mut open = points.wanted;
        if open == u64::MAX && points.is_one_plane() {
            self.gather_pixels(points, ROWS_LOOKED_UP, found);
            found.interpolate_rows();
            open &= !(found.known | ROWS_LOOKED_UP);
        }
        self.gather_pixels(points, open, found);
        self.gather_leftovers(points, found);
    }

    /// Finds the light of some pixels of a tile, one bit each, in the references that are best for
    /// them.
    fn gather_pixels(&self, points: &TilePoints, pixels: u64, found: &mut TileLight) {
        let mut tried: SlotMask = 0;
        for round in 0..MAX_ROUNDS {
            let open = pixels & !found.covered;
            if open == 0 {
                break;
            }
            let pixel = middle_bit(open);
            let best = match round {
                0 => self.choice_near(points, pixel, &mut found.choice),
                _ => self.best_references(points, pixel, tried),
            };
            if best.is_empty() {
                break;
            }
            best.iter().for_each(|&slot| tried |= 1 << slot);
            dispatch!(simd::level(), simd => self.gather_from(simd, &best, points, open, found));
        }
        found.divide_by_weight(pixels);
    }

    /// The best references for a pixel, or those chosen for the previous tile where it showed a
    /// point in the same cell with nearly the same normal.
    fn choice_near(
        &self,
        points: &TilePoints,
        pixel: usize,
        choice: &mut Option<Choice>,
    ) -> ArrayVec<u8, MAX_AVERAGED_BEST> {
        let cell = self.set.directory.cell_of(self.position(points, pixel));
        let normal = points.normal_at(pixel);
        if let Some(last) = choice.as_ref()
            && last.cell == cell
            && last.normal.dot(normal) > ALIKE_COSINE
        {
            return last.best.clone();
        }
        let best = self.best_references(points, pixel, 0);
        *choice = Some(Choice { cell, normal, best: best.clone() });
        best
    }

    /// Looks up the pixels that the tile's references do not know in all references of their cell.
    fn gather_leftovers(&self, points: &TilePoints, found: &mut TileLight) {
        let mut open = points.wanted & !found.known;
        while open != 0 {
            let pixel = open.trailing_zeros() as usize;
            open &= open - 1;
            let key = self.key(points, pixel);
            if let Some(FoundLight { light, smooth, .. }) = self.set.light_at(&key, points.triangle[pixel]) {
                found.set(pixel, light, smooth);
            }
        }
    }

    /// The surface point that a pixel of a tile shows.
    pub(super) fn key(&self, points: &TilePoints, pixel: usize) -> SurfaceKey {
        SurfaceKey {
            position: self.position(points, pixel),
            normal: points.normal_at(pixel),
            footprint: self.view.scene_from_pixel.x_axis.length() / points.disparity[pixel],
        }
    }

    fn position(&self, points: &TilePoints, pixel: usize) -> Vec3 {
        let (x, y) = ((pixel % TILE_SIDE) as f32, (pixel / TILE_SIDE) as f32);
        let [x0, y0] = points.corner.map(|c| c as f32);
        self.view.eye + self.view.direction_of_point(x0 + x + 0.5, y0 + y + 0.5) / points.disparity[pixel]
    }

    /// The references that know a pixel's light, finest first; after them those that the point
    /// projects into. References already tried are left out.
    fn best_references(
        &self,
        points: &TilePoints,
        pixel: usize,
        tried: SlotMask,
    ) -> ArrayVec<u8, MAX_AVERAGED_BEST> {
        let directory = self.set.directory;
        let cell = directory.cell_of(self.position(points, pixel));
        let mut mask = directory.mask(cell) & self.set.usable & !tried;
        let mut best = ArrayVec::<(f32, u8), { MAX_AVERAGED_BEST + 1 }>::new();
        while mask != 0 {
            let slot = mask.trailing_zeros() as u8;
            mask &= mask - 1;
            let Some(projection) = &self.projections[slot as usize] else { continue };
            let rank = projection.rank(points, pixel);
            if rank > 0.0 {
                let at = best.iter().position(|b| b.0 < rank).unwrap_or(best.len());
                best.insert(at, (rank, slot));
                best.truncate(self.max_averaged);
            }
        }
        best.into_iter().map(|(_, slot)| slot).collect()
    }

    /// Adds the light of some references to the open pixels.
    #[inline(always)]
    fn gather_from<S: Simd>(
        &self,
        simd: S,
        slots: &[u8],
        points: &TilePoints,
        open: u64,
        found: &mut TileLight,
    ) {
        for row in (0..TILE_SIDE).filter(|row| open >> (8 * row) & 0xff != 0) {
            for &slot in slots {
                if let Some(projection) = &self.projections[slot as usize] {
                    projection.gather_row(simd, slot, row, points, open, found);
                }
            }
        }
        // With one reference per pixel, extrapolated light is taken as it is.
        found.cover(simd, open, self.max_averaged > 1);
    }
}

/// A set bit near the middle of the word: the highest of the lower 36 bits, or else the lowest.
fn middle_bit(bits: u64) -> usize {
    let low = bits & 0x0000_000f_ffff_ffff;
    if low != 0 { 63 - low.leading_zeros() as usize } else { bits.trailing_zeros() as usize }
}

const _: () = assert!(MAX_SLOTS <= 256, "a slot fits a byte");

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lookup::TileSurfaces;
    use crate::lookup::found::Sampled;
    use crate::reference::{ReferenceCache, ReferenceFrame};
    use crate::scene::builtin;
    use crate::trace::parallel::NEVER;
    use crate::trace::{TILE_RAYS, TraceSettings, Tracer, VisibilityBuffer};
    use std::sync::Arc;

    const SIZE: [u32; 2] = [80, 48];

    /// Counts pixels of a walk's view whose light is found in a reference of two frames before: by
    /// the look-up of single points, by rows of eight, and with different results.
    fn compare(name: &str) -> [u32; 3] {
        let tracer = Tracer::new(Arc::new(builtin::build(name).unwrap()));
        let [before, now] = [10, 12].map(|i| tracer.scene().walk.camera(i, 300).unwrap());
        let settings = TraceSettings { samples: 1, ..TraceSettings::default() };
        let mut cache = ReferenceCache::new(tracer.scene(), usize::MAX);
        cache.insert(Arc::new(ReferenceFrame::trace(&tracer, &before, SIZE, &settings, NEVER).unwrap()));
        let set = LookupSet::new(&cache, tracer.epoch());
        let view = View::new(&now, &tracer.scene().frame, SIZE);
        let lookup = ViewLookup::new(&set, &view, 1);
        let reference = set.references.iter().flatten().next().unwrap();
        let mut surfaces = TileSurfaces::new(&view);
        let mut visible = VisibilityBuffer::default();
        visible.find(&tracer, &view, false);
        let [mut found_alone, mut found_in_rows, mut differ] = [0; 3];
        for corner in (0..SIZE[1]).step_by(8).flat_map(|y| (0..SIZE[0]).step_by(8).map(move |x| [x, y])) {
            let mut found = TileLight::NONE;
            surfaces.settle(&tracer, &visible, &view, corner);
            let points = &surfaces.points;
            lookup.gather_pixels(points, points.wanted, &mut found);
            for pixel in (0..TILE_RAYS).filter(|pixel| points.wanted >> pixel & 1 == 1) {
                let position = lookup.position(points, pixel);
                let alone = reference.light_at::<false>(
                    position,
                    points.normal_at(pixel),
                    points.triangle[pixel],
                    |_| true,
                );
                let in_row = (found.known >> pixel & 1 == 1).then(|| found.at(pixel));
                found_alone += u32::from(alone.is_some());
                // Rows are not gathered where the tile's middle is not seen; such pixels are looked
                // up alone.
                let Some(in_row) = in_row else { continue };
                found_in_rows += 1;
                let is_same = alone.is_some_and(|Sampled { light, .. }| {
                    (light - in_row).abs().max_element() <= 1e-3 * light.max(in_row).max_element()
                });
                differ += u32::from(!is_same);
            }
        }
        [found_alone, found_in_rows, differ]
    }

    #[test]
    fn rows_of_eight_find_what_single_points_find() {
        for name in ["cornell", "gallery-bench"] {
            let [found_alone, found_in_rows, differ] = compare(name);
            assert!(
                found_in_rows > 1000 && found_in_rows * 10 >= found_alone * 9,
                "{name}: {found_in_rows} of {found_alone}"
            );
            // Positions are rounded differently, which decides for samples at the edge of the
            // tolerance.
            assert!(differ * 25 <= found_in_rows, "{name}: {differ} of {found_in_rows} pixels");
        }
    }
}
