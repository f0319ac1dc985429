//! The speed of rays by kind, of shading, and of building the hierarchy, on all threads.

use super::timing::{ROUNDS, median_secs};
use crate::camera::View;
use crate::experiment::statistics::median;
use crate::math::{Ray, key::Key};
use crate::trace::parallel::{NEVER, trace_pixels};
use crate::trace::{
    Bvh, RayBundle, RayCounts, SurfacePoint, TILE_SIDE, TileHits, TraceSettings, Tracer, primary_tile,
};
use rayon::prelude::*;
use std::{hint::black_box, sync::Arc};

/// Number of rays a thread takes at a time.
const CHUNK: usize = 4096;

/// Million rays per second.
fn rate_of(rays: &[Ray], count_hits: impl Fn(&Ray) -> bool + Sync) -> f64 {
    if rays.is_empty() {
        return 0.0;
    }
    let secs = median_secs(|| {
        let hits = |chunk: &[Ray]| chunk.iter().filter(|r| count_hits(r)).count();
        black_box(rays.par_chunks(CHUNK).map(hits).sum::<usize>());
    });
    rays.len() as f64 / secs / 1e6
}

/// Million rays per second for the nearest hit. Cut-out texels and glass count as surfaces, as in
/// other libraries, so that the rates are comparable.
pub(super) fn closest_rate(bvh: &Bvh, rays: &[Ray]) -> f64 {
    rate_of(rays, |ray| bvh.closest(ray, |_| true).is_some())
}

/// Million rays per second for any hit.
pub(super) fn any_rate(bvh: &Bvh, rays: &[Ray]) -> f64 {
    rate_of(rays, |ray| bvh.any(ray, |_| true))
}

/// Million shadow rays per second in bundles.
pub(super) fn bundle_rate(bvh: &Bvh, bundles: &[RayBundle], rays: usize) -> f64 {
    let secs = median_secs(|| {
        let blocked = |chunk: &[RayBundle]| {
            chunk.iter().map(|bundle| bvh.any_at_all_in_bundle(bundle).count_ones()).sum::<u32>()
        };
        black_box(bundles.par_chunks(CHUNK / 16).map(blocked).sum::<u32>());
    });
    if rays == 0 { 0.0 } else { rays as f64 / secs / 1e6 }
}

/// Million primary rays per second in tiles. Cut-out texels are tested; rays beyond the edge of the
/// picture are not counted.
pub(super) fn tile_rate(tracer: &Tracer, view: &View) -> f64 {
    let secs = median_secs(|| {
        black_box(trace_tiles(tracer, view));
    });
    view.pixel_count() as f64 / secs / 1e6
}

/// Traces a picture in tiles. Returns the number of tiles whose first ray hits a surface.
pub(super) fn trace_tiles(tracer: &Tracer, view: &View) -> usize {
    let side = TILE_SIDE as u32;
    let [columns, rows] = view.size.map(|s| s.div_ceil(side));
    let hits = |row: u32| {
        let (mut rays, mut hits) = (primary_tile(view, [0, 0]), TileHits::NONE);
        (0..columns)
            .filter(|column| {
                tracer.closest_in_tile(view, [column * side, row * side], &mut rays, &mut hits);
                hits.hit(0).is_some()
            })
            .count()
    };
    (0..rows).into_par_iter().map(hits).sum()
}

/// Microseconds of shading the diffuse light of one point.
pub(super) fn shade_us(tracer: &Tracer, points: &[(u32, SurfacePoint)], trace: &TraceSettings) -> f64 {
    let indices: Vec<u32> = (0..points.len() as u32).collect();
    let mut shaded = Vec::new();
    let secs = median_secs(|| {
        trace_pixels(&indices, &mut shaded, NEVER, |i, rays: &mut RayCounts| {
            let (pixel, point) = &points[i as usize];
            tracer.diffuse_radiance(point, 1.0, &(*trace).into(), Key::of_pixel(trace.seed, *pixel), rays)
        });
        black_box(&shaded);
    });
    secs * 1e6 / points.len().max(1) as f64
}

/// Seconds of building the hierarchy.
pub(super) fn build_secs(tracer: &Tracer) -> f64 {
    let scene = tracer.scene();
    let builds = (0..ROUNDS).map(|_| Tracer::new(Arc::clone(scene)).build_secs());
    median(builds).unwrap_or(f64::NAN)
}
