//! Light traced at single surface points, found again by place: what mirrors and panes show, and what was traced
//! because the references' light was a guess. No picture holds these points, and without this every frame would shade
//! them anew.
//!
//! Source: a hash table of cells whose size follows the path's footprint, Binder, Fricke, Keller, "Massively Parallel
//! Path Space Filtering" (2019). We differ: a cell holds one traced point and no sum, and lends its light only to points
//! on its plane, turned alike; and points are entered between frames in the order of the pixels, so that the bits do not
//! depend on threads.

use crate::math::key::Key;
use crate::math::whole::floor;
use crate::reference::directory::PackedNormal;
use crate::trace::SceneEpoch;
use glam::Vec3;

/// Buckets of the table: 64 MB, taken when the first point is entered. A picture of 1280x720 that is a third mirror
/// fills a sixth of it.
const BUCKETS: usize = 1 << 19;

/// Points in a bucket. The oldest yields.
const WAYS: usize = 4;

/// Cells along each side of a block. A block's cells lie side by side in memory, for those who ask about one ask about its neighbours next, and to
/// wait for memory that is not in a cache takes about a fifth of a microsecond. A power of two.
const BLOCK: usize = 4;

/// Buckets of a block.
const BLOCK_BUCKETS: usize = BLOCK * BLOCK * BLOCK;

/// Levels of cells that are asked, from the size of the footprint down: what was seen from nearby serves from afar.
const LEVELS_ASKED: i32 = 2;

/// Cells are no smaller than 2^-12 scene units, four steps of an f32 at the scene's border, and no larger than the scene.
const LEVELS: [i32; 2] = [-12, 10];

/// A point lends its light to places off its plane by less than this share of the cell.
const PLANE_SHARE: f32 = 0.25;

/// Light of neighbouring cells that differs by more than this share is parted by the edge of a shadow. Two points of sixteen
/// shadow rays each differ so rarely by noise alone, and where they do more points are traced, no fewer.
const EDGE: f32 = 0.5;

/// Moves the borders of cells off the round coordinates that walls like to have, where rounding would decide.
const BORDER: Vec3 = Vec3::new(0.371, 0.619, 0.453);

/// A place whose light is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceKey {
    /// In scene space.
    pub position: Vec3,
    /// Unit, of the triangle, on the side that is asked for.
    pub normal: Vec3,
    /// Distance to the next place that a picture shows, were the surface faced: pixel size times path length.
    pub footprint: f32,
}

impl SurfaceKey {
    /// The same place to within an eighth of the footprint: as good as the very point.
    pub fn exact(self) -> Self {
        Self { footprint: self.footprint * 0.125, ..self }
    }
}

/// Light traced at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TracedPoint {
    /// Where.
    pub place: SurfaceKey,
    /// Arriving there, as the radiance of a white surface.
    pub light: Vec3,
    /// Shadow rays per light it was traced with.
    pub samples: u32,
    /// Its noise over that of sixteen shadow rays, at least one.
    pub noise: f32,
    /// That it was traced for.
    pub pixel: u32,
    /// Kept for the very place ([`SurfaceKey::here`]), where nobody asks whether a shadow's edge is near.
    pub is_very_place: bool,
    /// It took the place of a guess that was too far off.
    pub took_over: bool,
}

#[derive(Clone, Copy, Debug)]
struct Entry {
    position: Vec3,
    light: Vec3,
    normal: PackedNormal,
    /// Shadow rays per light; [`AT_EDGE`] is set where a neighbour differs, [`TOOK_OVER`] where a guess did.
    samples: u8,
}

/// Bits of [`Entry::samples`]; what is left counts up to 63.
const AT_EDGE: u8 = 0x80;
const TOOK_OVER: u8 = 0x40;
const COUNT: u8 = 0x3f;

impl Entry {
    const NONE: Self =
        Self { position: Vec3::ZERO, light: Vec3::ZERO, normal: PackedNormal::ZERO, samples: 0 };
}

/// The tags of a bucket. They lie apart from what they stand for: four buckets to a line of the processor's cache, and most questions need no more.
type Tags = [u32; WAYS];

/// Of a way that holds nothing.
const NO_TAG: u32 = 0;

/// Light that is held for a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeptLight {
    /// Arriving, as the radiance of a white surface.
    pub light: Vec3,
    /// True where a shadow's edge passes nearby, so that light of another point of the cell may be far off.
    pub is_at_edge: bool,
    /// True where it took the place of a guess when it was traced.
    pub took_over: bool,
}

/// The cell of a place: its bucket, its tag, its size.
#[derive(Clone, Copy, Debug)]
struct Cell {
    bucket: usize,
    tag: u32,
    side: f32,
}

/// Light by place, of one state of the scene.
#[derive(Debug, Default)]
pub struct PointCache {
    tags: Vec<Tags>,
    entries: Vec<[Entry; WAYS]>,
    epoch: Option<SceneEpoch>,
}

impl PointCache {
    /// Enters what was traced since the last call, in the order of the pixels, and empties the list. Where that call was for
    /// another epoch, the list is of that one too: it is forgotten with all that is held. Of several points of a cell the
    /// first stays, unless a later one has more samples. Light that is not finite is left out.
    pub fn enter(&mut self, epoch: SceneEpoch, points: &mut Vec<TracedPoint>) {
        if self.epoch.replace(epoch).is_some_and(|last| last != epoch) {
            (self.tags, self.entries) = (Vec::new(), Vec::new());
            points.clear();
        }
        if !points.is_empty() && self.tags.is_empty() {
            self.tags = vec![[NO_TAG; WAYS]; BUCKETS];
            self.entries = vec![[Entry::NONE; WAYS]; BUCKETS];
        }
        // A frame that was stopped has them in another order.
        points.sort_by_key(|p| p.pixel);
        for point in points.drain(..).filter(|p| p.light.is_finite()) {
            self.enter_one(&point);
        }
    }

    /// Forgets all light; the memory stays.
    pub fn clear(&mut self) {
        self.tags.fill([NO_TAG; WAYS]);
    }

    fn enter_one(&mut self, point: &TracedPoint) {
        let place = &point.place;
        let cell = cell_of(place, level_of(place));
        let mark = if point.is_very_place { 0 } else { self.mark_edge(point, &cell) };
        let entry = Entry {
            position: place.position,
            light: point.light,
            normal: PackedNormal::of_unit(place.normal),
            samples: packed_samples(point.samples) | mark | if point.took_over { TOOK_OVER } else { 0 },
        };
        let mut ways = self.ways_of(&cell);
        let (tags, entries) = (&mut self.tags[cell.bucket], &mut self.entries[cell.bucket]);
        match ways.find(|&way| entries[way].serves(place, &cell)).map(|way| &mut entries[way]) {
            Some(known) if known.count() >= entry.count() => known.samples |= mark,
            Some(known) => *known = Entry { samples: entry.samples | known.samples & AT_EDGE, ..entry },
            None => {
                tags.rotate_right(1);
                entries.rotate_right(1);
                (tags[0], entries[0]) = (cell.tag, entry);
            }
        }
    }

    /// The ways of a cell's bucket that carry its tag.
    #[inline(always)]
    fn ways_of(&self, cell: &Cell) -> impl Iterator<Item = usize> + use<> {
        let (tags, tag) = (self.tags[cell.bucket], cell.tag);
        (0..WAYS).filter(move |&way| tags[way] == tag)
    }

    /// Marks the neighbours that a new point differs from. Told is the mark that it gets itself.
    fn mark_edge(&mut self, point: &TracedPoint, cell: &Cell) -> u8 {
        let place = &point.place;
        let (u, v) = place.normal.any_orthonormal_pair();
        let mut mark = 0;
        for side in [u, -u, v, -v] {
            let beside = SurfaceKey { position: place.position + side * cell.side, ..*place };
            let there = cell_of(&beside, level_of(place));
            for way in self.ways_of(&there) {
                let entry = &mut self.entries[there.bucket][way];
                if !entry.serves(&beside, &there) {
                    continue;
                }
                let step = (entry.light - point.light).abs().max_element();
                let edge = EDGE * point.noise.max((16.0 / f32::from(entry.count())).sqrt());
                if step > edge * entry.light.max(point.light).max_element() {
                    entry.samples |= AT_EDGE;
                    mark = AT_EDGE;
                }
            }
        }
        mark
    }

    /// The light of a place, where it was traced with at least so many samples. Only of the epoch last entered for.
    #[inline]
    pub fn find(&self, place: &SurfaceKey, samples: u32) -> Option<KeptLight> {
        if self.tags.is_empty() {
            return None;
        }
        let level = level_of(place);
        let samples = packed_samples(samples).max(1);
        (0..LEVELS_ASKED).find_map(|finer| {
            let cell = cell_of(place, level - finer);
            let entries = &self.entries[cell.bucket];
            let mut held = self.ways_of(&cell).map(|way| &entries[way]);
            let entry = held.find(|e| e.count() >= samples && e.serves(place, &cell))?;
            let has = |bit: u8| entry.samples & bit != 0;
            Some(KeptLight { light: entry.light, is_at_edge: has(AT_EDGE), took_over: has(TOOK_OVER) })
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

    #[inline(always)]
    fn serves(&self, place: &SurfaceKey, cell: &Cell) -> bool {
        self.normal.faces_like(PackedNormal::of_unit(place.normal))
            && place.normal.dot(place.position - self.position).abs() <= PLANE_SHARE * cell.side
    }
}

/// The largest cells that are no wider than the footprint.
#[inline(always)]
fn level_of(place: &SurfaceKey) -> i32 {
    let exponent = (place.footprint.to_bits() >> 23 & 0xff) as i32 - 127;
    exponent.clamp(LEVELS[0] + LEVELS_ASKED - 1, LEVELS[1])
}

#[inline(always)]
fn cell_of(place: &SurfaceKey, level: i32) -> Cell {
    let power = |exponent: i32| f32::from_bits(((exponent + 127) as u32) << 23);
    let [x, y, z] = (place.position * power(-level) + BORDER).to_array().map(floor);
    let [bx, by, bz] = [x, y, z].map(|i| i.div_euclid(BLOCK as i32) as u32);
    let name = Key::of_pixel(u64::from(bx) << 32 | u64::from(by), bz).with(level as u32).bits();
    let [x, y, z] = [x, y, z].map(|i| i.rem_euclid(BLOCK as i32) as usize);
    // A wall has cells in one layer of its blocks: bits of the name put that layer elsewhere in each of them.
    let within = (x + BLOCK * (y + BLOCK * z)) ^ ((name >> 26) as usize % BLOCK_BUCKETS);
    let first = name as usize % (BUCKETS / BLOCK_BUCKETS) * BLOCK_BUCKETS;
    Cell { bucket: first + within, tag: ((name >> 32) as u32).max(NO_TAG + 1), side: power(level) }
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

    fn traced(place: SurfaceKey, light: Vec3, samples: u32) -> TracedPoint {
        TracedPoint { place, light, samples, noise: 1.0, pixel: 0, is_very_place: false, took_over: false }
    }

    fn found(cache: &PointCache, place: &SurfaceKey, samples: u32) -> Option<Vec3> {
        cache.find(place, samples).map(|kept| kept.light)
    }

    fn epochs() -> [SceneEpoch; 2] {
        let scene = Arc::new(builtin::build("furnace").unwrap());
        [0; 2].map(|_| Tracer::new(scene.clone()).epoch())
    }

    #[test]
    fn light_is_lent_within_a_footprint_on_the_same_side_of_the_same_plane_and_nowhere_else() {
        let at = place([3.3, 2.0, -7.2], 0.25);
        let mut cache = PointCache::default();
        let light = Vec3::new(1.0, 2.0, 3.0);
        let [epoch, other] = epochs();
        cache.enter(epoch, &mut vec![traced(at, light, 4)]);
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
        let mut lent = 0;
        for i in 0..40 * 40 {
            let off = Vec3::new((i % 40) as f32 - 20.0, 0.0, (i / 40) as f32 - 20.0) * 0.025;
            let found = found(&cache, &SurfaceKey { position: at.position + off, ..at }, 4);
            assert!(found.is_none() || off.abs().max_element() <= 0.25, "lent to {off}");
            lent += u32::from(found.is_some());
        }
        assert!((80..=121).contains(&lent), "one cell of 10 by 10 places: {lent}");
        cache.enter(other, &mut vec![traced(at, light, 4)]);
        assert_eq!(found(&cache, &at, 4), None, "another state of the scene");
    }

    #[test]
    fn cells_of_a_block_lie_side_by_side_each_in_a_bucket_of_its_own() {
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
            cache.enter(epoch, &mut vec![traced(at, Vec3::splat(brightness), samples)]);
        }
        assert_eq!(found(&cache, &at, 16), Some(Vec3::splat(2.0)));
        let unknown = traced(place([9.0; 3], 0.5), Vec3::NAN, 16);
        cache.enter(epoch, &mut vec![unknown]);
        assert_eq!(found(&cache, &unknown.place, 1), None, "not a number");
    }

    #[test]
    fn points_on_both_sides_of_a_shadows_edge_are_marked_and_no_others() {
        let epoch = epochs()[0];
        let kept = |brightness: [f32; 3]| {
            let mut cache = PointCache::default();
            for (i, brightness) in brightness.into_iter().enumerate() {
                let place = place([0.1 + 0.5 * i as f32, 0.2, 0.3], 0.5);
                cache.enter(epoch, &mut vec![traced(place, Vec3::splat(brightness), 16)]);
            }
            [0.1, 0.6, 1.1].map(|x| cache.find(&place([x, 0.2, 0.3], 0.5), 16).unwrap().is_at_edge)
        };
        assert_eq!(kept([1.0, 0.9, 0.1]), [false, true, true]);
        assert_eq!(kept([0.0, 1.0, 0.0]), [true, true, true]);
        assert_eq!(kept([1.0, 0.8, 0.6]), [false, false, false], "noise");
        assert_eq!(kept([0.0, 0.0, 0.0]), [false, false, false], "dark");
    }

    #[test]
    fn a_mark_stays_where_a_point_yields_to_one_of_more_samples_and_where_it_does_not() {
        let epoch = epochs()[0];
        let [dark, bright] = [[0.1, 0.2, 0.3], [0.6, 0.2, 0.3]].map(|at| place(at, 0.5));
        let mut cache = PointCache::default();
        let mut enter = |place, brightness, samples| {
            cache.enter(epoch, &mut vec![traced(place, Vec3::splat(brightness), samples)]);
            [dark, bright].map(|at| cache.find(&at, 1).map(|kept| kept.is_at_edge))
        };
        assert_eq!(enter(dark, 0.1, 8), [Some(false), None]);
        assert_eq!(enter(bright, 1.0, 8), [Some(true), Some(true)]);
        assert_eq!(enter(dark, 0.1, 16), [Some(true), Some(true)], "it replaces one that was marked");
        let beside = place([1.1, 0.2, 0.3], 0.5);
        let mut cache = PointCache::default();
        for (at, brightness) in [(beside, 0.9), (dark, 0.8), (bright, 0.85), (dark, 0.1)] {
            cache.enter(epoch, &mut vec![traced(at, Vec3::splat(brightness), 16)]);
        }
        assert!(cache.find(&dark, 1).unwrap().is_at_edge, "it found an edge and then stayed out");
    }
}
