//! The speed of the warp against the bound of memory bandwidth.

use super::settings::{ThroughputSettings, moved};
use super::timing::{median_secs, median_secs_after};
use crate::camera::View;
use crate::reference::ReferenceFrame;
use crate::trace::{TraceSettings, Tracer, parallel::NEVER};
use crate::warp::WarpBuffer;
use rayon::{ThreadPoolBuilder, prelude::*};
use serde::Serialize;
use std::hint::black_box;

/// The speed of steps 1 and 2 of the paper, from one reference to a view of its size.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct WarpSpeed {
    /// Nanoseconds on all threads, one warp after the other.
    pub warp_ns_per_reference_pixel: f64,
    /// Nanoseconds on one core.
    pub warp_ns_per_reference_pixel_one_core: f64,
    /// Nanoseconds on one core with cold caches, as in a frame, where tracing comes between two
    /// warps.
    pub warp_from_memory_ns_per_reference_pixel_one_core: f64,
    /// The time with cold caches over the time of a stream on one core.
    pub warp_over_memory_floor: f64,
    /// Memory bandwidth of a stream on all threads, bytes read and written together.
    pub memory_gb_per_sec: f64,
    /// Memory bandwidth of a stream on one core.
    pub memory_gb_per_sec_one_core: f64,
}

/// Number of pixels streamed to measure memory bandwidth: 400 MB in total, more than any cache.
const STREAMED_PIXELS: usize = 32 << 20;

/// Bytes that a warp must move per pixel: a disparity read and a key written. A processor also
/// fetches a line before it writes to it; the measured bandwidth includes this.
const MIN_BYTES_PER_PIXEL: usize = size_of::<f32>() + size_of::<u64>();

/// Times the warp of a reference at the view to the view of [`moved`].
pub(crate) fn warp_speed(tracer: &Tracer, settings: &ThroughputSettings) -> WarpSpeed {
    let few = TraceSettings { samples: 1, bounces: 0, ..settings.trace };
    let reference = ReferenceFrame::trace(tracer, &settings.camera, settings.size, &few, NEVER);
    let one_core = ThreadPoolBuilder::new().num_threads(1).thread_name(|_| "afterimage-one-core".to_owned());
    let (Some(reference), Ok(one_core)) = (reference, one_core.build()) else { return WarpSpeed::default() };
    let view = View::new(&moved(tracer, &settings.camera), &tracer.scene().frame, settings.size);
    let mut memory = (vec![1f32; STREAMED_PIXELS], vec![0u64; STREAMED_PIXELS]);
    let bytes = (STREAMED_PIXELS * MIN_BYTES_PER_PIXEL) as f64;
    let mut warped = WarpBuffer::default();
    let mut warp = || warped.warp(&[&reference], &view);
    let ns = 1e9 / reference.view.pixel_count().max(1) as f64;
    let streamed = median_secs(|| stream(&mut memory));
    let on_all = median_secs(&mut warp);
    let (streamed_alone, alone, from_memory) = one_core.install(|| {
        let streamed = median_secs(|| stream(&mut memory));
        (streamed, median_secs(&mut warp), median_secs_after(|| stream(&mut memory), &mut warp))
    });
    WarpSpeed {
        warp_ns_per_reference_pixel: on_all * ns,
        warp_ns_per_reference_pixel_one_core: alone * ns,
        warp_from_memory_ns_per_reference_pixel_one_core: from_memory * ns,
        warp_over_memory_floor: from_memory * ns / (streamed_alone * 1e9 / STREAMED_PIXELS as f64),
        memory_gb_per_sec: bytes / streamed / 1e9,
        memory_gb_per_sec_one_core: bytes / streamed_alone / 1e9,
    }
}

/// Does the minimum work of a warp: reads disparities in order and writes keys in order.
fn stream((disparities, keys): &mut (Vec<f32>, Vec<u64>)) {
    /// Number of pixels a thread takes at a time.
    const PIXELS: usize = 1 << 16;
    disparities.par_chunks(PIXELS).zip(keys.par_chunks_mut(PIXELS)).for_each(|(disparities, keys)| {
        for (key, disparity) in keys.iter_mut().zip(disparities) {
            *key = u64::from(disparity.to_bits()) << 32;
        }
    });
    black_box(keys);
}
