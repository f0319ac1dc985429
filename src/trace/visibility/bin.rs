//! The pixels of a bin: the nearest candidate of each, and what may lie in front of it.

use super::facet::Facet;
use super::lens::{BIN_PIXELS, BIN_SIDE, BIN_TILES};
use crate::trace::bvh::{Bits, NO_TRIANGLE, TILE_RAYS, TILE_SIDE};
use fearless_simd::{Simd, SimdBase, SimdMask, f32x4, f32x8, f32x16, mask32x16, prelude::*, u32x16};

/// Slot of a pixel whose surface only a ray can find.
pub(super) const NEEDS_RAY: u32 = u32::MAX - 1;

/// Bit of a slot whose hits must be checked to lie on the triangle, where the scene has needles.
pub(super) const CHECKED: u32 = 1 << 31;

/// Number of pixels filled at a time: two rows of a tile.
const LANES: usize = 16;

const LANE_X: [f32; LANES] = [0., 1., 2., 3., 4., 5., 6., 7., 0., 1., 2., 3., 4., 5., 6., 7.];
/// [`from_middle`] by tile.
const TILE_X: [f32; BIN_TILES] = [-31.5, -23.5, -15.5, -7.5, 0.5, 8.5, 16.5, 24.5];

const LANE_Y: [f32; LANES] = [0., 0., 0., 0., 0., 0., 0., 0., 1., 1., 1., 1., 1., 1., 1., 1.];

/// The pixels of a bin, tile by tile.
#[derive(Debug)]
pub(super) struct Bin {
    /// Upper bound of the disparity of each pixel's candidate; zero without one.
    best: [f32; BIN_PIXELS],
    /// Lower bound of the disparity of each pixel's candidate; zero without one.
    sure: [f32; BIN_PIXELS],
    /// Upper bound of the disparity of each pixel's second candidate; zero without one.
    next: [f32; BIN_PIXELS],
    /// Upper bound of the disparity of everything else that the pixel's ray may meet.
    other: [f32; BIN_PIXELS],
    /// Slot of each pixel's candidate.
    slot: [u32; BIN_PIXELS],
    /// Slot of each pixel's second candidate.
    next_slot: [u32; BIN_PIXELS],
    /// By tile, a disparity at which all its pixels are covered.
    covered: [f32; BIN_TILES * BIN_TILES],
    /// Tiles whose `covered` may have grown.
    changed: u64,
}

impl Bin {
    pub(super) fn new() -> Box<Self> {
        Box::new(Self {
            best: [0.0; BIN_PIXELS],
            sure: [0.0; BIN_PIXELS],
            next: [0.0; BIN_PIXELS],
            other: [0.0; BIN_PIXELS],
            slot: [NO_TRIANGLE; BIN_PIXELS],
            next_slot: [NO_TRIANGLE; BIN_PIXELS],
            covered: [0.0; BIN_TILES * BIN_TILES],
            changed: 0,
        })
    }

    /// Forgets all candidates.
    pub(super) fn clear(&mut self) {
        self.best.fill(0.0);
        self.sure.fill(0.0);
        self.next.fill(0.0);
        self.other.fill(0.0);
        self.slot.fill(NO_TRIANGLE);
        self.covered.fill(0.0);
        self.changed = 0;
    }

    /// Updates the distance at which every pixel of the bin is covered, where it may have changed.
    #[inline(always)]
    pub(super) fn update_farthest<S: Simd>(&mut self, simd: S, farthest: &mut f32) {
        if self.changed == 0 {
            return;
        }
        while self.changed != 0 {
            let tile = self.changed.trailing_zeros() as usize;
            self.changed &= self.changed - 1;
            let (at, _) = self.sure[tile * TILE_RAYS..][..TILE_RAYS].as_chunks::<LANES>();
            let of = |k: usize| f32x16::load_array_ref(simd, &at[k]);
            let least = of(0).min(of(1)).min(of(2).min(of(3))).reduce_min();
            self.covered[tile] = least;
        }
        let (rows, _) = self.covered.as_chunks::<LANES>();
        let mut least = f32x16::load_array_ref(simd, &rows[0]);
        for row in &rows[1..] {
            least = least.min(f32x16::load_array_ref(simd, row));
        }
        *farthest = 1.0 / least.reduce_min();
    }

    /// True where every tile of some columns and rows is covered at more than a disparity.
    #[inline(always)]
    pub(super) fn hides(&self, [x, y]: [[usize; 2]; 2], disparity: f32) -> bool {
        for row in y[0] / TILE_SIDE..=y[1] / TILE_SIDE {
            for tile in row * BIN_TILES + x[0] / TILE_SIDE..=row * BIN_TILES + x[1] / TILE_SIDE {
                if self.covered[tile & (BIN_TILES * BIN_TILES - 1)] <= disparity {
                    return false;
                }
            }
        }
        true
    }

    /// Enters a triangle in the columns and rows that it may cover. One that is not `CERTAIN`
    /// becomes no pixel's candidate.
    #[inline(always)]
    pub(super) fn fill<S: Simd, const CERTAIN: bool>(
        &mut self,
        simd: S,
        facet: &Facet,
        [x, y]: [[usize; 2]; 2],
        slot: u32,
    ) {
        let middle = f32x4::load_array(simd, facet.middle);
        let (dx, dy) = (f32x4::load_array(simd, facet.dx), f32x4::load_array(simd, facet.dy));
        // Bound how far the functions rise within a tile.
        let zero = f32x4::splat(simd, 0.0);
        let last = f32x4::splat(simd, (TILE_SIDE - 1) as f32);
        let rise = (dx * last).max(zero) + (dy * last).max(zero);
        let columns = Columns::new(simd, facet, x);
        let lanes = Lanes::new(simd, facet);
        for tile_y in y[0] / TILE_SIDE..=y[1] / TILE_SIDE {
            let from = middle + dy * f32x4::splat(simd, from_middle(tile_y));
            let rows = [y[0].max(tile_y * TILE_SIDE), y[1].min(tile_y * TILE_SIDE + TILE_SIDE - 1)];
            let pairs = rows.map(|row| (row - tile_y * TILE_SIDE) / 2);
            let covered = f32x8::from_slice(simd, &self.covered[tile_y * BIN_TILES..][..BIN_TILES]);
            for tile_x in Bits(columns.met::<CERTAIN>((from + rise).to_array(), covered)) {
                let tile = tile_y * BIN_TILES + tile_x;
                let mut base = from + dx * f32x4::splat(simd, from_middle(tile_x));
                base += dy * f32x4::splat(simd, (2 * pairs[0]) as f32);
                let columns = x.map(|x| x as f32 - (tile_x * TILE_SIDE) as f32);
                let mut values = lanes.values(base.to_array());
                let mut has_won = false;
                for pair in pairs[0]..=pairs[1] {
                    let at = tile * TILE_RAYS + pair * LANES;
                    has_won |= self.fill_rows::<S, CERTAIN>(at, &values, &lanes, columns, slot);
                    lanes.step(&mut values);
                }
                self.changed |= u64::from(has_won) << tile;
            }
        }
    }

    /// Enters a triangle in two rows of a tile. Returns whether it is a pixel's new candidate.
    #[inline(always)]
    fn fill_rows<S: Simd, const CERTAIN: bool>(
        &mut self,
        at: usize,
        values: &[f32x16<S>; 4],
        lanes: &Lanes<S>,
        columns: [f32; 2],
        slot: u32,
    ) -> bool {
        let simd = lanes.lowest.simd;
        let [e0, e1, e2, disparity] = *values;
        let least = e0.min(e1).min(e2);
        let touched = if CERTAIN {
            least.simd_ge(lanes.lowest)
        } else {
            lanes.doubtful(least, e0.max(e1).max(e2), columns)
        };
        if !touched.any_true() {
            return false;
        }
        // Skip what lies behind the candidates: they are in the way of whatever replaces them, too.
        let sure = f32x16::from_slice(simd, &self.sure[at..][..LANES]);
        let live = touched & !disparity.simd_lt(sure);
        if !live.any_true() {
            return false;
        }
        let other = f32x16::from_slice(simd, &self.other[at..][..LANES]);
        if !CERTAIN {
            live.select(other.max(disparity), other).store_slice(&mut self.other[at..][..LANES]);
            return false;
        }
        // Sort the triangle into the two nearest, and note what is neither.
        let best = f32x16::from_slice(simd, &self.best[at..][..LANES]);
        let next = f32x16::from_slice(simd, &self.next[at..][..LANES]);
        let inside = live & least.simd_gt(f32x16::splat(simd, 0.0));
        let wins = inside & disparity.simd_gt(best);
        let is_next = inside & !wins & disparity.simd_gt(next);
        let rest = (wins | is_next).select(next, disparity);
        live.select(other.max(rest), other).store_slice(&mut self.other[at..][..LANES]);
        let slot = u32x16::splat(simd, slot);
        let best_slot = u32x16::from_slice(simd, &self.slot[at..][..LANES]);
        let next_slot = u32x16::from_slice(simd, &self.next_slot[at..][..LANES]);
        wins.select(best, is_next.select(disparity, next)).store_slice(&mut self.next[at..][..LANES]);
        let next_slot = wins.select(best_slot, is_next.select(slot, next_slot));
        next_slot.store_slice(&mut self.next_slot[at..][..LANES]);
        wins.select(disparity, best).store_slice(&mut self.best[at..][..LANES]);
        wins.select(disparity * lanes.surely, sure).store_slice(&mut self.sure[at..][..LANES]);
        wins.select(slot, best_slot).store_slice(&mut self.slot[at..][..LANES]);
        wins.any_true()
    }

    /// Writes the slot of each pixel: that of its surface where it is certain. `nearer(pixel,
    /// slots)` returns that of the nearer of two candidates, of which either may be the surface.
    #[inline(always)]
    pub(super) fn finish<S: Simd>(
        &self,
        simd: S,
        slots: &mut [u32],
        nearer: impl Fn(usize, [u32; 2]) -> Option<u32>,
    ) {
        let zero = f32x16::splat(simd, 0.0);
        for at in (0..BIN_PIXELS).step_by(LANES) {
            let sure = f32x16::from_slice(simd, &self.sure[at..][..LANES]);
            let next = f32x16::from_slice(simd, &self.next[at..][..LANES]);
            let other = f32x16::from_slice(simd, &self.other[at..][..LANES]);
            let slot = u32x16::from_slice(simd, &self.slot[at..][..LANES]);
            let is_sky = sure.simd_eq(zero) & other.simd_eq(zero);
            let is_alone = other.simd_lt(sure) | is_sky;
            let is_certain = is_alone & (next.simd_lt(sure) | is_sky);
            let of_pixels = &mut slots[at..][..LANES];
            is_certain.select(slot, u32x16::splat(simd, NEEDS_RAY)).store_slice(of_pixels);
            for lane in Bits((is_alone & !is_certain).to_bitmask() as u32) {
                let both = [self.slot[at + lane], self.next_slot[at + lane]];
                of_pixels[lane] = nearer(at + lane, both).unwrap_or(NEEDS_RAY);
            }
        }
    }
}

/// Distance from the middle of a bin to the first pixel's centre of a tile, along one axis.
#[inline(always)]
fn from_middle(tile: usize) -> f32 {
    (tile * TILE_SIDE) as f32 - ((BIN_SIDE / 2) as f32 - 0.5)
}

/// How the functions of a triangle change along a row of tiles.
struct Columns<S: Simd> {
    /// By tile, the change from the middle of the bin.
    offset: [f32x8<S>; 4],
    lowest: f32x8<S>,
    /// Bit per tile that the triangle's columns reach.
    reached: u32,
}

impl<S: Simd> Columns<S> {
    #[inline(always)]
    fn new(simd: S, facet: &Facet, x: [usize; 2]) -> Self {
        let at = f32x8::load_array(simd, TILE_X);
        let [a, b, c, d] = facet.dx.map(|dx| f32x8::splat(simd, dx));
        let [first, last] = x.map(|x| x / TILE_SIDE);
        Self {
            offset: [a * at, b * at, c * at, d * at],
            lowest: f32x8::splat(simd, facet.lowest),
            reached: (2 << last) - (1 << first),
        }
    }

    /// Bits of the tiles of a row that may be met: not those outside an edge, and not those whose
    /// candidates are all nearer. `most` are the functions' largest values in a tile of the middle.
    #[inline(always)]
    fn met<const CERTAIN: bool>(&self, most: [f32; 4], covered: f32x8<S>) -> u32 {
        let simd = covered.simd;
        let disparity = self.offset[3] + f32x8::splat(simd, most[3]);
        let mut outside = disparity.simd_lt(covered);
        if CERTAIN {
            let a = self.offset[0] + f32x8::splat(simd, most[0]);
            let b = self.offset[1] + f32x8::splat(simd, most[1]);
            let c = self.offset[2] + f32x8::splat(simd, most[2]);
            outside |= a.min(b).min(c).simd_lt(self.lowest);
        }
        !outside.to_bitmask() as u32 & self.reached
    }
}

/// How the functions of a triangle change within two rows of a tile.
struct Lanes<S: Simd> {
    offset: [f32x16<S>; 4],
    /// Change from two rows to the next two.
    step: [f32x16<S>; 4],
    lowest: f32x16<S>,
    surely: f32x16<S>,
}

impl<S: Simd> Lanes<S> {
    #[inline(always)]
    fn new(simd: S, facet: &Facet) -> Self {
        let (x, y) = (f32x16::load_array(simd, LANE_X), f32x16::load_array(simd, LANE_Y));
        let lowest = f32x16::splat(simd, facet.lowest);
        let surely = f32x16::splat(simd, facet.surely);
        let [a, b, c, d] = facet.dx.map(|dx| f32x16::splat(simd, dx));
        let [e, f, g, h] = facet.dy.map(|dy| f32x16::splat(simd, dy));
        let offset = [x * a + y * e, x * b + y * f, x * c + y * g, x * d + y * h];
        Self { offset, step: [e + e, f + f, g + g, h + h], lowest, surely }
    }

    /// The functions in two rows of a tile, from their values at the first pixel.
    #[inline(always)]
    fn values(&self, [a, b, c, d]: [f32; 4]) -> [f32x16<S>; 4] {
        let simd = self.lowest.simd;
        [
            self.offset[0] + f32x16::splat(simd, a),
            self.offset[1] + f32x16::splat(simd, b),
            self.offset[2] + f32x16::splat(simd, c),
            self.offset[3] + f32x16::splat(simd, d),
        ]
    }

    /// Moves on to the next two rows.
    #[inline(always)]
    fn step(&self, values: &mut [f32x16<S>; 4]) {
        for (value, step) in values.iter_mut().zip(self.step) {
            *value += step;
        }
    }

    /// Pixels that an uncertain triangle may cover, whichever way it faces.
    #[inline(always)]
    fn doubtful(&self, least: f32x16<S>, most: f32x16<S>, columns: [f32; 2]) -> mask32x16<S> {
        let simd = least.simd;
        let x = f32x16::load_array(simd, LANE_X);
        let inside = x.simd_ge(f32x16::splat(simd, columns[0])) & x.simd_le(f32x16::splat(simd, columns[1]));
        let missed = least.simd_lt(self.lowest) & most.simd_gt(f32x16::splat(simd, 0.0));
        inside & !missed
    }
}
