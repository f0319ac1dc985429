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
    BLOCK, BLOCK_BUCKETS, BORDER, BUCKETS, CELL_EDGE, LEVELS, LEVELS_READ, PLANE_SHARE, WAYS,
};
use crate::math::{key::Key, rounding::floor};
use crate::raster::rgbe;
use crate::reference::directory::PackedNormal;
use crate::trace::SceneEpoch;
use glam::Vec3;

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
        // A frame that was stopped and resumed lists them in another order.
        points.sort_by_key(|p| p.pixel);
        for point in points.drain(..).filter(|p| p.light.is_finite() && p.smooth.is_none_or(Vec3::is_finite))
        {
            self.insert_one(&point);
        }
    }

    /// Forgets all light but keeps the memory.
    pub fn clear(&mut self) {
        self.tags.fill([NO_TAG; WAYS]);
    }

    fn insert_one(&mut self, point: &TracedPoint) {
        let key = &point.key;
        let cell = cell_of(key, level_of(key));
        let mark = if point.is_exact { 0 } else { self.mark_edge(point, &cell) };
        let entry = Entry {
            position: key.position,
            light: point.light,
            smooth: point.smooth.map_or(rgbe::NONE, rgbe::pack),
            normal: PackedNormal::of_unit(key.normal),
            samples: packed_samples(point.samples)
                | mark
                | if point.replaced_guess { REPLACED_GUESS } else { 0 },
        };
        let mut ways = self.ways_of(&cell);
        let (tags, entries) = (&mut self.tags[cell.bucket], &mut self.entries[cell.bucket]);
        match ways.find(|&way| entries[way].serves(key, &cell)).map(|way| &mut entries[way]) {
            Some(known) if known.count() >= entry.count() && known.knows_as_much_as(&entry) => {
                known.samples |= mark;
            }
            Some(known) => *known = Entry { samples: entry.samples | known.samples & AT_EDGE, ..entry },
            None => {
                tags.rotate_right(1);
                entries.rotate_right(1);
                (tags[0], entries[0]) = (cell.tag, entry);
            }
        }
    }

    /// The ways of a cell's bucket that have its tag.
    #[inline(always)]
    fn ways_of(&self, cell: &Cell) -> impl Iterator<Item = usize> + use<> {
        let (tags, tag) = (self.tags[cell.bucket], cell.tag);
        (0..WAYS).filter(move |&way| tags[way] == tag)
    }

    /// Marks the neighbours that a new point differs from. Returns the mark of the point itself.
    fn mark_edge(&mut self, point: &TracedPoint, cell: &Cell) -> u8 {
        let key = &point.key;
        let (u, v) = key.normal.any_orthonormal_pair();
        let mut mark = 0;
        for side in [u, -u, v, -v] {
            let neighbour = SurfaceKey { position: key.position + side * cell.side, ..*key };
            let there = cell_of(&neighbour, level_of(key));
            for way in self.ways_of(&there) {
                let entry = &mut self.entries[there.bucket][way];
                if !entry.serves(&neighbour, &there) {
                    continue;
                }
                let step = (entry.light - point.light).abs().max_element();
                let edge = CELL_EDGE * point.noise.max((16.0 / f32::from(entry.count())).sqrt());
                if step > edge * entry.light.max(point.light).max_element() {
                    entry.samples |= AT_EDGE;
                    mark = AT_EDGE;
                }
            }
        }
        mark
    }

    /// The light of a point, if it was traced with at least `samples` shadow rays per light, in the
    /// epoch of the last insertion.
    #[inline]
    pub fn find(&self, key: &SurfaceKey, samples: u32) -> Option<CachedLight> {
        if self.tags.is_empty() {
            return None;
        }
        let level = level_of(key);
        let samples = packed_samples(samples).max(1);
        (0..LEVELS_READ).find_map(|finer| {
            let cell = cell_of(key, level - finer);
            let entries = &self.entries[cell.bucket];
            let mut held = self.ways_of(&cell).map(|way| &entries[way]);
            let entry = held.find(|e| e.count() >= samples && e.serves(key, &cell))?;
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

fn packed_samples(samples: u32) -> u8 {
    samples.min(u32::from(COUNT)) as u8
}

impl Entry {
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
mod tests {
    use super::*;
    use crate::scene::builtin;
    use crate::trace::Tracer;
    use std::sync::Arc;

    fn place(position: [f32; 3], footprint: f32) -> SurfaceKey {
        SurfaceKey { position: Vec3::from(position), normal: Vec3::Y, footprint }
    }

    fn traced(key: SurfaceKey, light: Vec3, samples: u32) -> TracedPoint {
        let (noise, pixel, smooth) = (1.0, 0, Some(Vec3::ZERO));
        TracedPoint { key, light, smooth, samples, noise, pixel, is_exact: false, replaced_guess: false }
    }

    fn found(cache: &PointCache, key: &SurfaceKey, samples: u32) -> Option<Vec3> {
        cache.find(key, samples).map(|cached| cached.light)
    }

    fn epochs() -> [SceneEpoch; 2] {
        let scene = Arc::new(builtin::build("furnace").unwrap());
        [0; 2].map(|_| Tracer::new(scene.clone()).epoch())
    }

    #[test]
    fn light_is_reused_within_a_footprint_on_the_same_side_of_the_same_plane_and_nowhere_else() {
        let at = place([3.3, 2.0, -7.2], 0.25);
        let mut cache = PointCache::default();
        let light = Vec3::new(1.0, 2.0, 3.0);
        let [epoch, other] = epochs();
        cache.insert(epoch, &mut vec![traced(at, light, 4)]);
        assert_eq!(found(&cache, &at, 4), Some(light));
        assert_eq!(
            found(&cache, &SurfaceKey { footprint: 0.49, ..at }, 4),
            Some(light),
            "half of an octave farther"
        );
        assert_eq!(found(&cache, &at, 5), None, "too few samples");
        assert_eq!(found(&cache, &SurfaceKey { normal: -Vec3::Y, ..at }, 4), None, "the other side");
        assert_eq!(found(&cache, &SurfaceKey { normal: Vec3::X, ..at }, 4), None, "a wall");
        let above = SurfaceKey { position: at.position + Vec3::Y * 0.07, ..at };
        assert_eq!(found(&cache, &above, 4), None, "a step of more than a quarter of the cell");
        let mut reused = 0;
        for i in 0..40 * 40 {
            let off = Vec3::new((i % 40) as f32 - 20.0, 0.0, (i / 40) as f32 - 20.0) * 0.025;
            let found = found(&cache, &SurfaceKey { position: at.position + off, ..at }, 4);
            assert!(found.is_none() || off.abs().max_element() <= 0.25, "reused at {off}");
            reused += u32::from(found.is_some());
        }
        assert!((80..=121).contains(&reused), "one cell of 10 by 10 points: {reused}");
        cache.insert(other, &mut vec![traced(at, light, 4)]);
        assert_eq!(found(&cache, &at, 4), None, "another state of the scene");
    }

    #[test]
    fn cells_of_a_block_are_adjacent_each_in_its_own_bucket() {
        for corner in [[0.0, 0.0, 0.0], [-4.0, 8.0, -512.0]] {
            let cell = |x: usize, y: usize, z: usize| {
                let at = Vec3::from(corner) + Vec3::new(x as f32, y as f32, z as f32) + 0.5 - BORDER;
                cell_of(&place(at.to_array(), 1.0), 0)
            };
            let cells: Vec<Cell> =
                (0..BLOCK_BUCKETS).map(|i| cell(i % BLOCK, i / BLOCK % BLOCK, i / BLOCK / BLOCK)).collect();
            let mut buckets: Vec<usize> = cells.iter().map(|c| c.bucket).collect();
            buckets.sort_unstable();
            let first = buckets[0];
            assert_eq!(buckets, (first..first + BLOCK_BUCKETS).collect::<Vec<_>>());
            assert!(first.is_multiple_of(BLOCK_BUCKETS) && cells.iter().all(|c| c.tag == cells[0].tag));
            let next = cell(BLOCK, 0, 0);
            assert!(next.tag != cells[0].tag && next.bucket / BLOCK_BUCKETS != first / BLOCK_BUCKETS);
        }
    }

    #[test]
    fn more_samples_replace_fewer_and_never_the_other_way_round() {
        let at = place([0.1, 0.2, 0.3], 0.5);
        let mut cache = PointCache::default();
        let epoch = epochs()[0];
        for (samples, brightness) in [(4, 1.0), (16, 2.0), (16, 3.0), (1, 4.0)] {
            cache.insert(epoch, &mut vec![traced(at, Vec3::splat(brightness), samples)]);
        }
        assert_eq!(found(&cache, &at, 16), Some(Vec3::splat(2.0)));
        let unknown = traced(place([9.0; 3], 0.5), Vec3::NAN, 16);
        cache.insert(epoch, &mut vec![unknown]);
        assert_eq!(found(&cache, &unknown.key, 1), None, "not a number");
    }

    #[test]
    fn points_on_both_sides_of_a_shadows_edge_are_marked_and_no_others() {
        let epoch = epochs()[0];
        let marks = |brightness: [f32; 3]| {
            let mut cache = PointCache::default();
            for (i, brightness) in brightness.into_iter().enumerate() {
                let place = place([0.1 + 0.5 * i as f32, 0.2, 0.3], 0.5);
                cache.insert(epoch, &mut vec![traced(place, Vec3::splat(brightness), 16)]);
            }
            [0.1, 0.6, 1.1].map(|x| cache.find(&place([x, 0.2, 0.3], 0.5), 16).unwrap().is_at_edge)
        };
        assert_eq!(marks([1.0, 0.9, 0.1]), [false, true, true]);
        assert_eq!(marks([0.0, 1.0, 0.0]), [true, true, true]);
        assert_eq!(marks([1.0, 0.8, 0.6]), [false, false, false], "noise");
        assert_eq!(marks([0.0, 0.0, 0.0]), [false, false, false], "dark");
    }

    #[test]
    fn a_mark_stays_where_a_point_yields_to_one_of_more_samples_and_where_it_does_not() {
        let epoch = epochs()[0];
        let [dark, bright] = [[0.1, 0.2, 0.3], [0.6, 0.2, 0.3]].map(|at| place(at, 0.5));
        let mut cache = PointCache::default();
        let mut insert = |place, brightness, samples| {
            cache.insert(epoch, &mut vec![traced(place, Vec3::splat(brightness), samples)]);
            [dark, bright].map(|at| cache.find(&at, 1).map(|cached| cached.is_at_edge))
        };
        assert_eq!(insert(dark, 0.1, 8), [Some(false), None]);
        assert_eq!(insert(bright, 1.0, 8), [Some(true), Some(true)]);
        assert_eq!(insert(dark, 0.1, 16), [Some(true), Some(true)], "it replaces one that was marked");
        let neighbour = place([1.1, 0.2, 0.3], 0.5);
        let mut cache = PointCache::default();
        for (at, brightness) in [(neighbour, 0.9), (dark, 0.8), (bright, 0.85), (dark, 0.1)] {
            cache.insert(epoch, &mut vec![traced(at, Vec3::splat(brightness), 16)]);
        }
        assert!(cache.find(&dark, 1).unwrap().is_at_edge, "it found an edge and then stayed out");
    }
}
