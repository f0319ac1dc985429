//! Tests of the point cache.

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

#[test]
fn the_order_of_the_list_changes_nothing() {
    let epoch = epochs()[0];
    // Points of few cells and many levels, several for each pixel.
    let points: Vec<TracedPoint> = (0..600u32)
        .map(|i| {
            let at = [(i * 7 % 13) as f32 * 0.3, 0.2, (i * 5 % 11) as f32 * 0.3];
            let light = Vec3::splat((i * 31 % 17) as f32);
            TracedPoint { pixel: i, ..traced(place(at, 0.25 * (1 + i % 3) as f32), light, 4 + i % 5) }
        })
        .collect();
    let cached = |mut list: Vec<TracedPoint>| {
        let mut cache = PointCache::default();
        cache.insert(epoch, &mut list);
        points.iter().map(|p| cache.find(&p.key, 1)).collect::<Vec<_>>()
    };
    let in_order = cached(points.clone());
    assert!(in_order.iter().flatten().any(|found| found.is_at_edge));
    assert_eq!(in_order, cached(points.iter().rev().copied().collect()));
    let mut by_turns = points.clone();
    by_turns.sort_by_key(|p| p.pixel % 7);
    assert_eq!(in_order, cached(by_turns));
}
