//! Tracing many pixels on all threads of the current pool, with the same bits at any number of them.

use super::RayCounts;
use rayon::prelude::*;
use std::ops::AddAssign;
use std::sync::atomic::{AtomicBool, Ordering};

/// Pixels a thread takes at a time.
const CHUNK: usize = 64;

/// Side of the square tiles in which a picture is traced: neighbouring rays meet the same nodes.
const TILE: u32 = 8;

/// Asked before every pixel whether to stop: nanoseconds against the microseconds of shading.
pub type Stop<'a> = &'a (dyn Fn() -> bool + Sync);

/// Never stops.
pub const NEVER: Stop<'static> = &|| false;

/// All pixels of a picture, tile by tile.
pub fn tile_order([width, height]: [u32; 2]) -> Vec<u32> {
    let mut order = Vec::with_capacity(width as usize * height as usize);
    for y0 in (0..height).step_by(TILE as usize) {
        for x0 in (0..width).step_by(TILE as usize) {
            for y in y0..(y0 + TILE).min(height) {
                order.extend((x0..(x0 + TILE).min(width)).map(|x| y * width + x));
            }
        }
    }
    order
}

/// Calls `trace` for every pixel of the list and keeps the results in the list's order in `traced`.
///
/// Returns the rays spent and whether the whole list was done. After a stop the entries not reached are `None`.
pub fn trace_pixels<R: Clone + Send>(
    pixels: &[u32],
    traced: &mut Vec<Option<R>>,
    stop: Stop<'_>,
    trace: impl Fn(u32, &mut RayCounts) -> R + Sync,
) -> (RayCounts, bool) {
    traced.clear();
    traced.resize(pixels.len(), None);
    trace_missing(pixels, traced, stop, trace)
}

/// [`trace_pixels`] for the pixels that have no result yet: goes on with a list that was stopped. What `trace` gathers
/// beside the results is added up in the list's order.
pub fn trace_missing<R: Send, G: Default + Send + AddAssign>(
    pixels: &[u32],
    traced: &mut [Option<R>],
    stop: Stop<'_>,
    trace: impl Fn(u32, &mut G) -> R + Sync,
) -> (G, bool) {
    let stopped = AtomicBool::new(false);
    let gathered = pixels
        .par_chunks(CHUNK)
        .zip(traced.par_chunks_mut(CHUNK))
        .map(|(pixels, traced)| {
            let mut gathered = G::default();
            let missing = traced.iter_mut().zip(pixels).filter(|(result, _)| result.is_none());
            for (result, &pixel) in missing {
                if stopped.load(Ordering::Relaxed) || stop() {
                    stopped.store(true, Ordering::Relaxed);
                    break;
                }
                *result = Some(trace(pixel, &mut gathered));
            }
            gathered
        })
        .reduce(G::default, |mut a, b| {
            a += b;
            a
        });
    (gathered, !stopped.into_inner())
}
