//! Light traced at single surface points, found again by position: what mirrors and glass show, and
//! what was traced because the light of the references was a guess. No reference stores these
//! points, so without this cache every frame would shade them again.
//!
//! Source: a hash table of cells whose size follows the path's footprint, Binder, Fricke, Keller,
//! "Massively Parallel Path Space Filtering" (2019). We differ: a cell stores one traced point
//! instead of a sum, and its light is reused only at points on its plane with nearly its normal;
//! and points are inserted between frames in pixel order, so that the bits do not depend on
//! threads.

use super::policy::{
    BLOCK, BLOCK_BUCKETS, BORDER, BUCKETS, CELL_EDGE, CONFIRMED_WITHIN, LEVELS, LEVELS_READ, PLANE_SHARE,
    WAYS,
};
use crate::math::{key::Key, rounding::floor};
use crate::raster::rgbe;
use crate::reference::directory::PackedNormal;
use crate::trace::SceneEpoch;
use arrayvec::ArrayVec;
use glam::Vec3;
use rayon::prelude::*;

/// A surface point whose light is cached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceKey {
    /// Position in scene space.
    pub position: Vec3,
    /// Unit normal of the triangle, on the side that is viewed.
    pub normal: Vec3,
    /// Distance to the point of the neighbouring pixel if the surface faced the viewer: pixel size
    /// times path length, scene units.
    pub footprint: f32,
}

impl SurfaceKey {
    /// A key that matches within [`CONFIRMED_WITHIN`] footprints, where traced light may confirm a
    /// guess.
    pub(super) fn around(self) -> Self {
        Self { footprint: self.footprint * CONFIRMED_WITHIN, ..self }
    }

    /// A key that matches only within an eighth of the footprint, which counts as the same point.
    pub fn exact(self) -> Self {
        Self { footprint: self.footprint * 0.125, ..self }
    }
}

/// Light traced at a surface point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TracedPoint {
    /// The point.
    pub key: SurfaceKey,
    /// Light straight from the lights, as the radiance of a white surface.
    pub light: Vec3,
    /// Smooth light in the same units; `None` where only direct light was traced.
    pub smooth: Option<Vec3>,
    /// Shadow rays per light that it was traced with.
    pub samples: u32,
    /// Noise relative to that of sixteen shadow rays, at least one.
    pub noise: f32,
    /// The pixel that it was traced for.
    pub pixel: u32,
    /// True where the key is [`SurfaceKey::exact`]. Such points take no part in finding the edges
    /// of shadows.
    pub is_exact: bool,
    /// True where the light replaced a guess that was too far off.
    pub replaced_guess: bool,
}

#[derive(Clone, Copy, Debug)]
struct Entry {
    position: Vec3,
    light: Vec3,
    /// Smooth light as RGBE, [`rgbe::NONE`] where it is not known.
    smooth: u32,
    normal: PackedNormal,
    /// Shadow rays per light, with the flags [`AT_EDGE`] where a neighbour differs and
    /// [`REPLACED_GUESS`] where a guess did.
    samples: u8,
}

/// Flags and mask of [`Entry::samples`]; the count is at most 63.
const AT_EDGE: u8 = 0x80;
const REPLACED_GUESS: u8 = 0x40;
const COUNT: u8 = 0x3f;

impl Entry {
    const NONE: Self = Self {
        position: Vec3::ZERO,
        light: Vec3::ZERO,
        smooth: rgbe::NONE,
        normal: PackedNormal::ZERO,
        samples: 0,
    };
}

/// The tags of a bucket. A tag holds upper hash bits of the cell of each point in the bucket, to
/// tell apart cells that share the bucket. Tags are stored apart from the entries, four buckets to
/// a cache line, because most look-ups read no more.
type Tags = [u32; WAYS];

/// Buckets that one task fills.
const PART: usize = BUCKETS / 32;

/// The tag of an empty way, which is a slot of a bucket.
const NO_TAG: u32 = 0;

/// Light found in the cache.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CachedLight {
    /// Light straight from the lights, as the radiance of a white surface.
    pub light: Vec3,
    /// Smooth light in the same units; `None` where it was not traced.
    pub smooth: Option<Vec3>,
    /// True where a shadow's edge is near, so that the light of another point of the cell may be
    /// far off.
    pub is_at_edge: bool,
    /// True where the light replaced a guess when it was traced.
    pub replaced_guess: bool,
}

/// The cell of a point: its bucket, tag, and side in scene units.
#[derive(Clone, Copy, Debug)]
struct Cell {
    bucket: usize,
    tag: u32,
    side: f32,
}

/// The cells in which the light of a point may be held, widest first, and the tags of their
/// buckets. All tags are read before any is compared, and those of several points before the first
/// is searched for: each is a cache miss, and so they overlap.
#[derive(Clone, Copy, Debug)]
pub(super) struct Probe {
    cells: [Cell; LEVELS_READ as usize],
    tags: [Tags; LEVELS_READ as usize],
}

/// Where a point comes in the order of storing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Place {
    bucket: u32,
    pixel: u32,
    /// Index in the list of points.
    point: u32,
}

/// Cached light by surface point, for one epoch of the scene.
#[derive(Debug, Default)]
pub struct PointCache {
    tags: Vec<Tags>,
    entries: Vec<[Entry; WAYS]>,
    epoch: Option<SceneEpoch>,
}

impl PointCache {
    /// Inserts the points traced since the last call, in pixel order, and empties the list. Where
    /// the last call was for another epoch, so is the list, and it is dropped with the whole cache.
    /// Of several points of a cell the first stays, unless a later one has more samples. Light that
    /// is not finite is left out.
    pub fn insert(&mut self, epoch: SceneEpoch, points: &mut Vec<TracedPoint>) {
        if self.epoch.replace(epoch).is_some_and(|last| last != epoch) {
            (self.tags, self.entries) = (Vec::new(), Vec::new());
            points.clear();
        }
        if !points.is_empty() && self.tags.is_empty() {
            self.tags = vec![[NO_TAG; WAYS]; BUCKETS];
            self.entries = vec![[Entry::NONE; WAYS]; BUCKETS];
        }
        points.retain(|p| p.light.is_finite() && p.smooth.is_none_or(Vec3::is_finite));
        let cells: Vec<Cell> = points.par_iter().map(|p| cell_of(&p.key, level_of(&p.key))).collect();
        let order = order_of(points, &cells);
        self.store(points, &cells, &order);
        for [bucket, way] in self.edges(points, &cells, &order) {
            self.entries[bucket][way].samples |= AT_EDGE;
        }
        points.clear();
    }

    /// Stores points in their cells, in this order. Each part of the table has a task of its own.
    fn store(&mut self, points: &[TracedPoint], cells: &[Cell], order: &[Place]) {
        let parts = self.tags.par_chunks_mut(PART).zip(self.entries.par_chunks_mut(PART)).enumerate();
        parts.for_each(|(part, (tags, entries))| {
            let begin = |part: usize| order.partition_point(|place| (place.bucket as usize) < part * PART);
            for place in &order[begin(part)..begin(part + 1)] {
                let (bucket, point) = (place.bucket as usize % PART, place.point as usize);
                store_one(&mut tags[bucket], &mut entries[bucket], &points[point], &cells[point]);
            }
        });
    }

    /// The bucket and way of each point whose light differs from that of a cell next to it, as on
    /// both sides of the edge of a shadow.
    fn edges(&self, points: &[TracedPoint], cells: &[Cell], order: &[Place]) -> Vec<[usize; 2]> {
        let pairs = order.par_iter().map(|place| place.point as usize).map(|i| (&points[i], &cells[i]));
        let pairs = pairs.filter(|(point, _)| !point.is_exact);
        pairs.flat_map_iter(|(point, cell)| self.edges_near(point, cell)).collect()
    }

    /// Takes over the points of an earlier epoch of which direct light is the same. Smooth light
    /// may not be, and is forgotten.
    pub(crate) fn take_direct(&mut self, before: Self, epoch: SceneEpoch) {
        *self = Self { epoch: Some(epoch), ..before };
        self.entries.par_iter_mut().flatten().for_each(|entry| entry.smooth = rgbe::NONE);
    }

    /// Forgets all light but keeps the memory.
    pub fn clear(&mut self) {
        self.tags.fill([NO_TAG; WAYS]);
    }

    /// The ways of a cell's bucket that have its tag.
    #[inline(always)]
    fn ways_of(&self, cell: &Cell) -> impl Iterator<Item = usize> + use<> {
        ways_with(self.tags[cell.bucket], cell.tag)
    }

    /// The entries next to a point that it differs from, and its own if there are any.
    fn edges_near(&self, point: &TracedPoint, cell: &Cell) -> ArrayVec<[usize; 2], { 5 * WAYS }> {
        let key = &point.key;
        let (u, v) = key.normal.any_orthonormal_pair();
        let mut edges = ArrayVec::new();
        for side in [u, -u, v, -v] {
            let neighbour = SurfaceKey { position: key.position + side * cell.side, ..*key };
            let there = cell_of(&neighbour, level_of(key));
            for way in self.ways_of(&there) {
                let entry = &self.entries[there.bucket][way];
                if entry.serves(&neighbour, &there) && entry.differs(point) {
                    edges.push([there.bucket, way]);
                }
            }
        }
        if !edges.is_empty() {
            let serves = |way: &usize| self.entries[cell.bucket][*way].serves(key, cell);
            edges.extend(self.ways_of(cell).find(serves).map(|way| [cell.bucket, way]));
        }
        edges
    }

    /// The light of a point, if it was traced with at least `samples` shadow rays per light, in the
    /// epoch of the last insertion.
    #[inline]
    pub fn find(&self, key: &SurfaceKey, samples: u32) -> Option<CachedLight> {
        self.find_in(&self.probe(key)?, key, samples)
    }

    /// Where light of a point may be held; `None` in an empty cache.
    #[inline]
    pub(super) fn probe(&self, key: &SurfaceKey) -> Option<Probe> {
        if self.tags.is_empty() {
            return None;
        }
        let level = level_of(key);
        let cells = std::array::from_fn(|finer| cell_of(key, level - finer as i32));
        Some(Probe { cells, tags: cells.map(|cell| self.tags[cell.bucket]) })
    }

    /// [`Self::find`] where the probe of the key found its cells.
    #[inline]
    pub(super) fn find_in(&self, probe: &Probe, key: &SurfaceKey, samples: u32) -> Option<CachedLight> {
        let samples = packed_samples(samples).max(1);
        probe.cells.iter().zip(&probe.tags).find_map(|(cell, tags)| {
            let entries = &self.entries[cell.bucket];
            let mut held = ways_with(*tags, cell.tag).map(|way| &entries[way]);
            let entry = held.find(|e| e.count() >= samples && e.serves(key, cell))?;
            let has = |bit: u8| entry.samples & bit != 0;
            Some(CachedLight {
                light: entry.light,
                smooth: rgbe::unpack(entry.smooth),
                is_at_edge: has(AT_EDGE),
                replaced_guess: has(REPLACED_GUESS),
            })
        })
    }
}

/// The ways of a bucket that have a tag.
#[inline(always)]
fn ways_with(tags: Tags, tag: u32) -> impl Iterator<Item = usize> {
    (0..WAYS).filter(move |&way| tags[way] == tag)
}

/// The order in which points are stored: by bucket, so that memory is read as it lies, and in each
/// by pixel, because a frame that was stopped and resumed lists them in another order.
fn order_of(points: &[TracedPoint], cells: &[Cell]) -> Vec<Place> {
    let places = points.par_iter().zip(cells).enumerate().map(|(point, (traced, cell))| Place {
        bucket: cell.bucket as u32,
        pixel: traced.pixel,
        point: point as u32,
    });
    let mut order: Vec<Place> = places.collect();
    order.par_sort_unstable();
    order
}

/// Stores a point in the bucket of its cell. The point that the cell holds stays, unless the new
/// one has more samples.
fn store_one(tags: &mut Tags, entries: &mut [Entry; WAYS], point: &TracedPoint, cell: &Cell) {
    let entry = Entry::of(point);
    let held = (0..WAYS).find(|&way| tags[way] == cell.tag && entries[way].serves(&point.key, cell));
    match held.map(|way| &mut entries[way]) {
        Some(known) if known.count() >= entry.count() && known.knows_as_much_as(&entry) => {}
        Some(known) => *known = Entry { samples: entry.samples | known.samples & AT_EDGE, ..entry },
        None => {
            tags.rotate_right(1);
            entries.rotate_right(1);
            (tags[0], entries[0]) = (cell.tag, entry);
        }
    }
}

fn packed_samples(samples: u32) -> u8 {
    samples.min(u32::from(COUNT)) as u8
}

impl Entry {
    fn of(point: &TracedPoint) -> Self {
        let replaced = if point.replaced_guess { REPLACED_GUESS } else { 0 };
        Self {
            position: point.key.position,
            light: point.light,
            smooth: point.smooth.map_or(rgbe::NONE, rgbe::pack),
            normal: PackedNormal::of_unit(point.key.normal),
            samples: packed_samples(point.samples) | replaced,
        }
    }

    /// True where the light differs so much from that of a point next to it that the edge of a
    /// shadow lies between.
    fn differs(&self, point: &TracedPoint) -> bool {
        let step = (self.light - point.light).abs().max_element();
        let edge = CELL_EDGE * point.noise.max((16.0 / f32::from(self.count())).sqrt());
        step > edge * self.light.max(point.light).max_element()
    }

    /// Shadow rays per light.
    #[inline(always)]
    fn count(&self) -> u8 {
        self.samples & COUNT
    }

    /// True where smooth light is known, or is not known of the other either.
    fn knows_as_much_as(&self, other: &Self) -> bool {
        self.smooth != rgbe::NONE || other.smooth == rgbe::NONE
    }

    /// True where the light is reused at a point: on the same plane, with nearly the same normal.
    #[inline(always)]
    fn serves(&self, key: &SurfaceKey, cell: &Cell) -> bool {
        self.normal.faces_like(PackedNormal::of_unit(key.normal))
            && key.normal.dot(key.position - self.position).abs() <= PLANE_SHARE * cell.side
    }
}

/// The level of the largest cells that are no wider than the footprint.
#[inline(always)]
fn level_of(key: &SurfaceKey) -> i32 {
    let exponent = (key.footprint.to_bits() >> 23 & 0xff) as i32 - 127;
    exponent.clamp(LEVELS[0] + LEVELS_READ - 1, LEVELS[1])
}

#[inline(always)]
fn cell_of(key: &SurfaceKey, level: i32) -> Cell {
    let power = |exponent: i32| f32::from_bits(((exponent + 127) as u32) << 23);
    let [x, y, z] = (key.position * power(-level) + BORDER).to_array().map(floor);
    let [bx, by, bz] = [x, y, z].map(|i| i.div_euclid(BLOCK as i32) as u32);
    let hash = Key::of_pixel(u64::from(bx) << 32 | u64::from(by), bz).with(level as u32).bits();
    let [x, y, z] = [x, y, z].map(|i| i.rem_euclid(BLOCK as i32) as usize);
    // A wall occupies one layer of cells in its blocks; bits of the hash place that layer
    // differently in each block.
    let within = (x + BLOCK * (y + BLOCK * z)) ^ ((hash >> 26) as usize % BLOCK_BUCKETS);
    let first = hash as usize % (BUCKETS / BLOCK_BUCKETS) * BLOCK_BUCKETS;
    Cell { bucket: first + within, tag: ((hash >> 32) as u32).max(NO_TAG + 1), side: power(level) }
}

#[cfg(test)]
mod tests;
