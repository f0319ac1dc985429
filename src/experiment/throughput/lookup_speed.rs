//! The speed of the look-up on one core, apart from the visibility of its points.

use crate::camera::View;
use crate::experiment::statistics::median;
use crate::experiment::throughput::timing::ROUNDS;
use crate::lookup::{LookupQuality, LookupSet, TileLight, TileSurfaces, ViewLookup};
use crate::trace::{TILE_RAYS, TILE_SIDE, Tracer, VisibilityBuffer};
use glam::Vec3;
use std::hint::black_box;
use std::time::{Duration, Instant};

/// Returns the median time of the look-up of a view's pixels, with plane test and texture, in
/// nanoseconds a pixel. Each tile is looked up right after its hits are settled, as in a frame;
/// only the look-up is timed.
pub(super) fn one_core_ns_per_pixel(
    tracer: &Tracer,
    view: &View,
    set: &LookupSet<'_>,
    quality: LookupQuality,
) -> f64 {
    let lookup = ViewLookup::new(set, view, quality.max_averaged);
    let pixels = view.pixel_count().max(1) as f64;
    let round = || look_up_all(tracer, view, &lookup).as_secs_f64() * 1e9 / pixels;
    median((0..ROUNDS).map(|_| round())).unwrap_or(f64::NAN)
}

/// Looks up all tiles of a view. Returns the time of the look-ups, without that of the clock.
fn look_up_all(tracer: &Tracer, view: &View, lookup: &ViewLookup<'_>) -> Duration {
    let (mut surfaces, mut light) = (TileSurfaces::new(view), TileLight::NONE);
    let (mut total, mut clock) = (Duration::ZERO, Duration::ZERO);
    let mut visible = VisibilityBuffer::default();
    visible.find(tracer, view, false);
    for y in (0..view.size[1]).step_by(TILE_SIDE) {
        for x in (0..view.size[0]).step_by(TILE_SIDE) {
            surfaces.settle(tracer, &visible, view, [x, y]);
            let start = Instant::now();
            lookup.gather(&surfaces.points, &mut light);
            black_box(reflected(tracer, &surfaces, &light));
            total += start.elapsed();
            let start = Instant::now();
            clock += start.elapsed();
        }
    }
    total.saturating_sub(clock)
}

/// Returns the sum of the light that the known pixels of a tile reflect.
fn reflected(tracer: &Tracer, surfaces: &TileSurfaces, light: &TileLight) -> Vec3 {
    let known = (0..TILE_RAYS).filter(|ray| light.known >> ray & 1 == 1);
    known
        .map(|ray| {
            tracer.albedo(&surfaces.hit(ray), surfaces.direction(ray))
                * (light.at(ray) + light.smooth_at(ray))
        })
        .sum()
}
