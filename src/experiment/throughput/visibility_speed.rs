//! The first hits of a picture by rasterised candidates, against tiles of rays, on one core.

use super::ray_speed::trace_tiles;
use super::timing::{ROUNDS, median_secs};
use crate::camera::View;
use crate::experiment::statistics::median;
use crate::trace::{TILE_SIDE, TileHits, Tracer, VisibilityBuffer, primary_tile};
use rayon::{ThreadPoolBuilder, prelude::*};
use serde::Serialize;
use std::{hint::black_box, time::Instant};

/// The speed of finding the first hits of a picture. All have the bits of single rays.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct VisibilitySpeed {
    /// Time of rasterised candidates, settled, on all threads.
    pub visibility_ns_per_pixel: f64,
    /// The same on one core.
    pub visibility_ns_per_pixel_one_core: f64,
    /// Slow twin: the time of tiles of rays on one core, in turns with the above.
    pub primary_tile_ns_per_pixel_one_core: f64,
    /// Share of pixels whose surface a single ray had to find.
    pub visibility_fallback_percent: f64,
}

/// Measures a view.
pub(super) fn visibility_speed(tracer: &Tracer, view: &View) -> VisibilitySpeed {
    let one_core = ThreadPoolBuilder::new().num_threads(1).thread_name(|_| "afterimage-one-core".to_owned());
    let Ok(one_core) = one_core.build() else { return VisibilitySpeed::default() };
    let ns = 1e9 / view.pixel_count().max(1) as f64;
    let (mut visible, mut rays) = (VisibilityBuffer::default(), 0);
    let mut find = || rays = find_hits(tracer, view, &mut visible);
    let together = median_secs(&mut find);
    let (mut alone, mut tiles) = ([0.0; ROUNDS], [0.0; ROUNDS]);
    for round in 0..ROUNDS {
        alone[round] = secs(|| one_core.install(&mut find));
        tiles[round] = secs(|| one_core.install(|| _ = black_box(trace_tiles(tracer, view))));
    }
    VisibilitySpeed {
        visibility_ns_per_pixel: together * ns,
        visibility_ns_per_pixel_one_core: median(alone).unwrap_or(f64::NAN) * ns,
        primary_tile_ns_per_pixel_one_core: median(tiles).unwrap_or(f64::NAN) * ns,
        visibility_fallback_percent: 100.0 * f64::from(rays) / view.pixel_count().max(1) as f64,
    }
}

fn secs(task: impl FnOnce()) -> f64 {
    let start = Instant::now();
    task();
    start.elapsed().as_secs_f64()
}

/// Finds and settles the hits of a picture. Returns the number of single rays.
fn find_hits(tracer: &Tracer, view: &View, visible: &mut VisibilityBuffer) -> u32 {
    visible.find(tracer, view, false);
    let side = TILE_SIDE as u32;
    let [columns, rows] = view.size.map(|s| s.div_ceil(side));
    let row_of_tiles = |row: u32| {
        let (mut rays, mut hits) = (primary_tile(view, [0, 0]), TileHits::NONE);
        let corners = (0..columns).map(|column| [column * side, row * side]);
        let settle = |corner| visible.hits_of_tile(tracer, view, corner, &mut rays, &mut hits).count_ones();
        corners.map(settle).sum::<u32>()
    };
    (0..rows).into_par_iter().map(row_of_tiles).sum()
}
