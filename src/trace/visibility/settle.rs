//! Settles the candidates of a tile by the watertight test.

use super::bin::{CHECKED, NEEDS_RAY};
use crate::trace::bvh::{Bvh, NO_TRIANGLE, RayShear, RayTile, SeenTriangle, TILE_RAYS, TileHits};
use fearless_simd::{Simd, SimdBase, SimdMask, dispatch, f32x16, mask32x16, prelude::*, u32x16};

/// Number of rays tested at once: two rows of a tile.
const LANES: usize = 16;

/// A bit for each of them.
const ALL: u64 = (1 << LANES) - 1;

/// What is left to do for the rays of a tile, one bit each.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Open {
    /// Rays that must be traced.
    pub(super) missed: u64,
    /// Rays whose hit must be checked to lie on its triangle.
    pub(super) checked: u64,
}

/// Writes the hits of the rays of a tile with the triangles in the slots.
pub(super) fn settle(bvh: &Bvh, tile: &RayTile, slots: &[u32; TILE_RAYS], hits: &mut TileHits) -> Open {
    dispatch!(bvh.level, simd => settle_with(simd, bvh, tile, slots, hits))
}

#[inline(always)]
fn settle_with<S: Simd>(
    simd: S,
    bvh: &Bvh,
    tile: &RayTile,
    slots: &[u32; TILE_RAYS],
    hits: &mut TileHits,
) -> Open {
    let (mut open, mut seen) = (Open::default(), Seen::new(simd));
    let (rows, _) = slots.as_chunks::<LANES>();
    for (row, slots) in rows.iter().enumerate() {
        let at = row * LANES;
        let wide_slots = u32x16::load_array_ref(simd, slots);
        let mut hits_of_rows = RowHits::none(simd);
        let mut missed = wide_slots.simd_eq(u32x16::splat(simd, NEEDS_RAY)).to_bitmask();
        let is_sky = wide_slots.simd_eq(u32x16::splat(simd, NO_TRIANGLE)).to_bitmask();
        let candidates = !(missed | is_sky) & ALL;
        let axes = axes_of(simd, tile, at);
        for (axis, of_axis) in axes.into_iter().enumerate() {
            let mut left = of_axis & candidates;
            if left == 0 {
                continue;
            }
            let shear = shear(simd, tile, at, axis);
            while left != 0 {
                // Test all rays of the row that have the same candidate.
                let slot = slots[left.trailing_zeros() as usize & (LANES - 1)];
                let same = wide_slots.simd_eq(u32x16::splat(simd, slot)).to_bitmask() & left;
                left &= !same;
                seen.look_at(bvh, tile, slot, axis);
                missed |= hits_of_rows.meet(&seen, &shear, same);
                open.checked |= if slot & CHECKED == 0 { 0 } else { same << at };
            }
        }
        hits_of_rows.store(hits, at);
        open.missed |= missed << at;
    }
    open
}

/// The triangle that was tested last: the next row most likely shows it too.
struct Seen<S: Simd> {
    simd: S,
    slot: u32,
    axis: usize,
    index: u32,
    triangle: SeenTriangle<f32x16<S>>,
}

impl<S: Simd> Seen<S> {
    #[inline(always)]
    fn new(simd: S) -> Self {
        let triangle = SeenTriangle::new(simd, [[0.0; 3]; 3], 0);
        Self { simd, slot: NO_TRIANGLE, axis: 0, index: NO_TRIANGLE, triangle }
    }

    /// Loads the triangle in a slot.
    #[inline(always)]
    fn look_at(&mut self, bvh: &Bvh, tile: &RayTile, slot: u32, axis: usize) {
        if (self.slot, self.axis) == (slot, axis) {
            return;
        }
        let (packet, lane) = bvh.triangle_in_slot(slot & !CHECKED);
        let [a, b, c] = packet.triangle_corners(lane);
        let eye = tile.origin;
        let corners = [(a - eye).to_array(), (b - eye).to_array(), (c - eye).to_array()];
        self.triangle = SeenTriangle::new(self.simd, corners, axis);
        (self.slot, self.axis, self.index) = (slot, axis, packet.triangle(lane));
    }
}

/// Sixteen numbers from index `at` on.
#[inline(always)]
fn load<S: Simd>(simd: S, from: &[f32; TILE_RAYS], at: usize) -> f32x16<S> {
    f32x16::from_slice(simd, &from[at..][..LANES])
}

/// Bits of the rays of a row whose direction is largest along each axis, as
/// `bvh::packet` chooses it.
#[inline(always)]
fn axes_of<S: Simd>(simd: S, tile: &RayTile, at: usize) -> [u64; 3] {
    let [x, y, z] = &tile.directions;
    let (x, y, z) = (load(simd, x, at).abs(), load(simd, y, at).abs(), load(simd, z, at).abs());
    let is_x = x.simd_gt(y.max(z)).to_bitmask();
    let is_y = y.simd_gt(z).to_bitmask() & !is_x;
    [is_x, is_y, !(is_x | is_y) & ALL]
}

/// The shear of the rays of a row along an axis.
#[inline(always)]
fn shear<S: Simd>(simd: S, tile: &RayTile, at: usize, axis: usize) -> RayShear<f32x16<S>> {
    let d = &tile.directions;
    let inverse = f32x16::splat(simd, 1.0) / load(simd, &d[axis], at);
    let x = load(simd, &d[(axis + 1) % 3], at) * inverse;
    RayShear { x, y: load(simd, &d[(axis + 2) % 3], at) * inverse, z: inverse }
}

/// The hits of a row of rays.
struct RowHits<S: Simd> {
    t: f32x16<S>,
    triangle: u32x16<S>,
    b1: f32x16<S>,
    b2: f32x16<S>,
}

impl<S: Simd> RowHits<S> {
    #[inline(always)]
    fn none(simd: S) -> Self {
        let zero = f32x16::splat(simd, 0.0);
        let t = f32x16::splat(simd, f32::INFINITY);
        Self { t, triangle: u32x16::splat(simd, NO_TRIANGLE), b1: zero, b2: zero }
    }

    /// Enters the hits of some rays, one bit each, with a triangle. Returns those that miss it.
    #[inline(always)]
    fn meet(&mut self, seen: &Seen<S>, shear: &RayShear<f32x16<S>>, rays: u64) -> u64 {
        let simd = shear.x.simd;
        let Some(met) = seen.triangle.intersect(simd, shear) else { return rays };
        let ahead =
            met.t.simd_gt(f32x16::splat(simd, 0.0)) & met.t.simd_lt(f32x16::splat(simd, f32::INFINITY));
        let hit = met.inside & ahead & mask32x16::from_bitmask(simd, rays);
        let [b1, b2] = met.barycentrics();
        self.t = hit.select(met.t, self.t);
        self.triangle = hit.select(u32x16::splat(simd, seen.index), self.triangle);
        self.b1 = hit.select(b1, self.b1);
        self.b2 = hit.select(b2, self.b2);
        rays & !hit.to_bitmask()
    }

    #[inline(always)]
    fn store(&self, hits: &mut TileHits, at: usize) {
        self.t.store_slice(&mut hits.t[at..][..LANES]);
        self.triangle.store_slice(&mut hits.triangle[at..][..LANES]);
        self.b1.store_slice(&mut hits.b1[at..][..LANES]);
        self.b2.store_slice(&mut hits.b2[at..][..LANES]);
    }
}
