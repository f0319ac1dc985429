//! Tracing many pixels on all threads of the current pool. The results have the same bits at any
//! number of threads.

use super::RayCounts;
use rayon::prelude::*;
use std::ops::AddAssign;
use std::sync::atomic::{AtomicBool, Ordering};

/// Number of pixels that a thread takes at a time.
const CHUNK: usize = 64;

/// Side of the square tiles in which a picture is traced, pixels: neighbouring rays meet the same
/// nodes.
const TILE: u32 = 8;

/// Returns whether to stop. Called before every pixel: nanoseconds against the microseconds of
/// shading.
pub type Stop<'a> = &'a (dyn Fn() -> bool + Sync);

/// A [`Stop`] that never stops.
pub const NEVER: Stop<'static> = &|| false;

/// Returns the indices of all pixels of a picture, tile by tile.
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

/// Calls `trace` for every pixel of the list and writes the results to `traced`, in the list's
/// order.
///
/// Returns the rays traced, and whether the list was completed. After a stop the remaining entries
/// are `None`.
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

/// Resumes a list that was stopped: [`trace_pixels`] for the pixels without a result. The values
/// that `trace` adds to its second argument are summed in the list's order.
pub fn trace_missing<R: Send, G: Default + Send + AddAssign>(
    pixels: &[u32],
    traced: &mut [Option<R>],
    stop: Stop<'_>,
    trace: impl Fn(u32, &mut G) -> R + Sync,
) -> (G, bool) {
    trace_open(pixels, traced, stop, Option::is_none, |pixel, result, gathered| {
        *result = Some(trace(pixel, gathered));
    })
}

/// Calls `trace` for the pixels of the list whose state `is_open`. The values that it adds to its
/// last argument are summed in the list's order. Returns the sum, and whether no stop ended the
/// work.
pub fn trace_open<R: Send, G: Default + Send + AddAssign>(
    pixels: &[u32],
    states: &mut [R],
    stop: Stop<'_>,
    is_open: impl Fn(&R) -> bool + Sync,
    trace: impl Fn(u32, &mut R, &mut G) + Sync,
) -> (G, bool) {
    let stopped = AtomicBool::new(false);
    let gathered = pixels
        .par_chunks(CHUNK)
        .zip(states.par_chunks_mut(CHUNK))
        .map(|(pixels, states)| {
            let mut gathered = G::default();
            let open = states.iter_mut().zip(pixels).filter(|(state, _)| is_open(state));
            for (state, &pixel) in open {
                if stopped.load(Ordering::Relaxed) || stop() {
                    stopped.store(true, Ordering::Relaxed);
                    break;
                }
                trace(pixel, state, &mut gathered);
            }
            gathered
        })
        .reduce(G::default, |mut a, b| {
            a += b;
            a
        });
    (gathered, !stopped.into_inner())
}
