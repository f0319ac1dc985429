//! First hits of whole pictures: rasterised candidates, settled by the watertight test.
//!
//! A picture is cut into bins of 64 x 64 pixels. For each, the hierarchy is traversed once, nearest
//! nodes first; the triangles of its leaves are projected and filled. A bin keeps, of each pixel,
//! the two nearest candidates and a bound of all else. Where one candidate is certainly the nearest
//! surface, its slot in the hierarchy is kept (4 bytes a pixel); where two tie, the ray-triangle
//! test chooses; elsewhere the pixel is marked for a single ray. Later, tile by tile, the test of
//! [`super::bvh`] runs on the one triangle of each pixel and gives distance and barycentrics. So
//! every hit has the bits of [`Tracer::closest`].
//!
//! | files | contents |
//! |---|---|
//! | `lens` | a view and its bins, and the factors of the error bounds |
//! | `facet` | a packet of triangles, prepared for filling |
//! | `bin` | the candidates of a bin, and filling |
//! | `walk` | the traversal, and the choice between two candidates |
//! | `settle` | the watertight test of 16 rays at a time |
//!
//! Sources: edge functions without clipping as in Olano and Greer, "Triangle Scan Conversion using
//! 2D Homogeneous Coordinates", 1997; through the eye and the edge as in Davidovic, Engelhardt,
//! Georgiev, Slusallek, Dachsbacher, "3D Rasterization", GI 2012; the test by Woop, Benthin, Wald,
//! JCGT 2013; hidden triangles are skipped by the depth of whole tiles, as in Hasselgren,
//! Andersson, Akenine-Moeller, "Masked Software Occlusion Culling", HPG 2016. We differ: the result
//! is that of the rays, bit for bit, because errors are bounded.
//!
//! # When a candidate is certain
//! Let `A`, `B`, `C` be the corners relative to the eye, rounded as both computations round them,
//! and `d` the direction of a ray. `M` is the largest coordinate of the corners, `L` that of the
//! edges, `u` = 2^-24. Norms are maximum norms, `|x|1` is the sum of magnitudes. The edge function
//! `d . (A x (B - A))` is linear in the pixel; so are the others, and their sum is `d . N` with
//! `N = (B - A) x (C - A)`. With the volume `V = A . N`, the disparity of the plane is
//! `1 / t = d . N / V`, linear too.
//!
//! **The test.** It shears the corners along the ray's largest axis and asks whether the origin
//! lies in the triangle `a`, `b`, `c` of the plane. The signs of its products are exact, because
//! rounding is monotonic and zeros are decided in f64. So it errs only by the rounding of `a`, `b`
//! and `c`, at most `e = 6 u M` a coordinate. A sheared edge is at most `2 L` long. Where the
//! origin lies in the triangle, exact or rounded, its corners are no farther than `2 L + 3 e`, so
//! an edge function differs by at most `2 e (|a| + |b|) + 2 e^2 <= 50 u M L` if `L >= 400 u M`;
//! times the largest component of `d`, that is its error in our scale.
//!
//! **Our edge functions.** The cross product errs by `6 u M L` a component, the dot product by
//! `6 u M L |d|1`, and evaluating it at a pixel, fifteen roundings, by `30 u M L |d|1`. The
//! direction itself errs by `3 u D`, where `D` sums the magnitudes of which it is made. Together:
//! `u M L (44 |d|1 + 6 D)`. With the test's share this is the bound `B`. If all edge functions,
//! oriented by the sign of `V`, exceed `B`, the test hits. If one is below `-B`, it misses: either
//! the signs differ, or all are negative, and then the hit would be behind the eye. The latter
//! needs `|V| >= 8 M B`, since `V d` is the sum of the corners, each times the opposite edge
//! function.
//!
//! **Distance.** The test's `t` is the mean of the corners' coordinates along the axis, weighted by
//! its edge functions. Moving the sheared corners by `e` moves it by `e` times the slope of the
//! plane, relative to `t` by `6 u M |N|1 / |V|`, whatever the triangle's shape. Rounded products
//! change the weights by `24 u L^2` and so `t` by `24 u L^3 / |V|`; the final sums add
//! `8 u M |N|1 / |V|` where corners lie on both sides of the eye. Our disparity errs likewise:
//! `24 u L^3 / |V|` by `N`, `u M |N|1 (3 + 32 |d|1 + 5.3 D) / |V|` by the sums and the direction (a
//! point of the triangle has `t <= sqrt(3) M`). A tenth more covers products of errors. Both
//! distances lie between the bounds that a bin keeps; a triangle whose error exceeds a sixteenth
//! settles nothing.
//!
//! **What a ray may see.** Let `s` be the least disparity of a pixel's nearest candidate, and let
//! every other triangle be certainly missed or have a disparity below `s`. Then the test finds the
//! candidate nearest. The traversal of a single ray reaches it: the ray passes through its boxes,
//! and no triangle can end the ray before them. With two candidates above all else the test is run
//! on both; the nearer, or at one distance the one with the lower index, is the ray's hit if the
//! ray enters its box before that distance. Edge-on and tiny triangles have no useful bounds: they
//! count as nearer than everything wherever they may be met, at the least distance that a mean of
//! their corners' coordinates can give. For the same reason boxes are skipped by that distance and
//! not by their depth. A cut-out texel, or a hit that lies off its needle, is found out when the
//! pixel is settled, and traced.

mod bin;
mod facet;
mod lens;
mod settle;
mod walk;

use super::bvh::{NO_TRIANGLE, RayTile, TILE_RAYS, TILE_SIDE, TileHits};
use super::{Hit, Tracer, primary_tile};
use crate::camera::View;
use crate::math::Ray;
use bin::{Bin, CHECKED, NEEDS_RAY};
use lens::{BIN_PIXELS, BIN_SIDE, BIN_TILES, Lens};
use rayon::prelude::*;
use settle::Open;

/// The triangle that each pixel of a picture shows, where it is certain: a visibility buffer
/// (Burns, Hunt, JCGT 2013) of slots in the hierarchy.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
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
        profiling::scope!("first hits");
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
    /// `corner`. The hits are those of [`Tracer::closest_seen`]. Returns a bit for each ray that was
    /// traced alone.
    pub fn hits_of_tile(
        &self,
        tracer: &Tracer,
        view: &View,
        corner: [u32; 2],
        tile: &mut RayTile,
        hits: &mut TileHits,
    ) -> u64 {
        primary_tile::aim(view, corner, tile);
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
        if features.coincident {
            let known = !open;
            for ray in (0..TILE_RAYS).filter(|ray| known >> ray & 1 == 1) {
                let is_seen = hits.hit(ray).is_none_or(|hit| tracer.is_seen_first(&tile.ray(ray), &hit));
                open |= u64::from(!is_seen) << ray;
            }
        }
        if tracer.section().is_some() {
            let known = !open;
            for ray in (0..TILE_RAYS).filter(|ray| known >> ray & 1 == 1) {
                let is_seen = hits.hit(ray).is_none_or(|hit| tracer.is_seen(&tile.ray(ray), &hit));
                open |= u64::from(!is_seen) << ray;
            }
        }
        for ray in (0..TILE_RAYS).filter(|ray| open >> ray & 1 == 1) {
            hits.set(ray, self.closest(tracer, &tile.ray(ray)));
        }
        open
    }

    /// The nearest hit through the centre of a pixel: that of [`Tracer::closest_seen`].
    pub fn hit_of_pixel(&self, tracer: &Tracer, view: &View, pixel: u32) -> Option<Hit> {
        let ray = Tracer::primary_ray(view, pixel);
        let (x, y) = (pixel % view.size[0], pixel / view.size[0]);
        let slot = self.slots_of([x, y])[y as usize % TILE_SIDE * TILE_SIDE + x as usize % TILE_SIDE];
        match slot {
            NO_TRIANGLE => None,
            NEEDS_RAY => self.closest(tracer, &ray),
            _ => {
                let hit = tracer.bvh().hit_in_slot(&ray, slot & !CHECKED);
                hit.filter(|hit| tracer.stands(&ray, hit) && tracer.is_seen(&ray, hit))
                    .or_else(|| self.closest(tracer, &ray))
            }
        }
    }

    fn closest(&self, tracer: &Tracer, ray: &Ray) -> Option<Hit> {
        if self.behind_glass {
            tracer.closest_seen_where(ray, |hit| !tracer.is_clear_glass(hit.triangle))
        } else {
            tracer.closest_seen(ray)
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
