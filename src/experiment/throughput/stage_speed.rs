//! The stages of a frame in mode `exact`, each against its lower bound.

use super::lookup_speed::one_core_ns_per_pixel;
use super::settings::{ThroughputSettings, moved};
use super::timing::{ROUNDS, median_secs};
use crate::camera::{Camera, View};
use crate::experiment::statistics::median;
use crate::lookup::{LookupQuality, LookupSet, open_percent};
use crate::reference::{ReferenceCache, ReferenceFrame};
use crate::render::{FrameRequest, FrameStats, Mode, RenderSettings, Renderer};
use crate::trace::{Tracer, parallel::NEVER};
use serde::Serialize;
use std::{hint::black_box, sync::Arc, time::Instant};

/// Number of references that the look-up is timed with: as many as `exact` averages.
const REFERENCES: usize = 2;

/// Bytes of a reference pixel that a look-up reads: disparity, triangle, light.
const LOOKED_UP_BYTES: f64 = 12.0;

/// Bytes of a reference pixel that inserting it into the directory reads: disparity, light.
const ENTERED_BYTES: f64 = 8.0;

/// The stages of a frame in mode `exact`, on all threads. The view is a hundredth of the scene's
/// diagonal ahead of one reference and the same distance behind the other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct StageSpeed {
    /// Time of first hits, their look-ups, and writing the pixels.
    pub resolve_ns_per_pixel: f64,
    /// Time of look-ups and writing the pixels.
    pub lookup_ns_per_pixel: f64,
    /// Time of a look-up in up to two references, the plane test and the texture, as mode `exact`
    /// does it, on one core.
    pub lookup_ns_per_pixel_one_core: f64,
    /// The same in one reference, as mode `fast` does it.
    pub lookup_fast_ns_per_pixel_one_core: f64,
    /// Lower bound: the time that the memory bandwidth takes to read each sample of two references
    /// once.
    pub lookup_floor_ns_per_pixel: f64,
    /// Number of pixels whose light was uncertain.
    pub checked_pixels: usize,
    /// Mean time of a pixel of Type 3, unseen or checked, in a first frame, which traces every
    /// check.
    pub check_new_us_per_pixel: f64,
    /// Mean time of a pixel of Type 3, unseen or checked, in later frames, which find the light of
    /// checks in the point cache.
    pub check_known_us_per_pixel: f64,
    /// Number of pixels with mirrors or glass.
    pub secondary_pixels: usize,
    /// Time of a pixel with mirrors or glass whose light no earlier frame has traced.
    pub secondary_new_us_per_pixel: f64,
    /// Time of a pixel with mirrors or glass whose light an earlier frame has traced.
    pub secondary_known_us_per_pixel: f64,
    /// Lower bound: the time of the secondary rays of such a pixel at the rate of single primary
    /// rays.
    pub secondary_floor_us_per_pixel: f64,
    /// Time of estimating the share of pixels that a look-up leaves open at a pose.
    pub foresight_ms: f64,
    /// Lower bound: the time of the rays of that estimate alone, in a sixteenth of the tiles.
    pub foresight_floor_ms: f64,
    /// Time of inserting a fully lit reference into the directory.
    pub directory_ms: f64,
    /// Lower bound: the time that the memory bandwidth takes to read what the insertion reads.
    pub directory_floor_ms: f64,
}

/// Rates from which the lower bounds are computed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Floors {
    pub(crate) primary_mrays_per_sec: f64,
    pub(crate) primary_tile_mrays_per_sec: f64,
    pub(crate) visibility_ns_per_pixel: f64,
    pub(crate) memory_gb_per_sec: f64,
}

pub(crate) fn stage_speed(tracer: &Tracer, settings: &ThroughputSettings, floors: &Floors) -> StageSpeed {
    let mut cache = ReferenceCache::new(tracer.scene(), usize::MAX);
    let behind = settings.camera;
    let camera = moved(tracer, &behind);
    let mut directory_secs = Vec::new();
    for pose in [behind, moved(tracer, &camera)] {
        let Some(frame) = ReferenceFrame::trace(tracer, &pose, settings.size, &settings.trace, NEVER) else {
            return StageSpeed::default();
        };
        let frame = Arc::new(frame);
        let start = Instant::now();
        cache.insert(frame);
        directory_secs.push(start.elapsed().as_secs_f64());
    }
    let frames = frames(tracer, &camera, settings, &cache);
    let view = View::new(&camera, &tracer.scene().frame, settings.size);
    let lookup = LookupSet::new(&cache, tracer.epoch());
    let prediction_secs = median_secs(|| {
        black_box(open_percent(tracer, &view, &lookup, None));
    });
    let [exact, fast] = [LookupQuality::EXACT, LookupQuality::FAST]
        .map(|quality| one_core_ns_per_pixel(tracer, &view, &lookup, quality));
    let pixels = view.pixel_count().max(1) as f64;
    let tile_ns = 1e3 / floors.primary_tile_mrays_per_sec;
    let read_ns = |bytes: f64| bytes / floors.memory_gb_per_sec;
    StageSpeed {
        lookup_ns_per_pixel_one_core: exact,
        lookup_fast_ns_per_pixel_one_core: fast,
        lookup_floor_ns_per_pixel: read_ns(LOOKED_UP_BYTES * REFERENCES as f64),
        foresight_ms: prediction_secs * 1e3,
        foresight_floor_ms: tile_ns * pixels / 16.0 / 1e6,
        directory_ms: median(directory_secs).unwrap_or(f64::NAN) * 1e3,
        directory_floor_ms: read_ns(ENTERED_BYTES) * pixels / 1e6,
        ..of_frames(&frames, pixels, floors)
    }
}

/// Renders a first frame, which traces all unknown light, and [`ROUNDS`] frames that reuse it.
fn frames(
    tracer: &Tracer,
    camera: &Camera,
    settings: &ThroughputSettings,
    cache: &ReferenceCache,
) -> Vec<FrameStats> {
    let render = RenderSettings { mode: Mode::Exact, trace: settings.trace };
    let mut renderer = Renderer::default();
    (0..=ROUNDS)
        .map(|_| {
            renderer.render(&FrameRequest::new(tracer, camera, settings.size, &render).reusing(cache)).stats
        })
        .collect()
}

fn of_frames(frames: &[FrameStats], pixels: f64, floors: &Floors) -> StageSpeed {
    let [first, later @ ..] = frames else { return StageSpeed::default() };
    let known = |secs: fn(&FrameStats) -> f64| median(later.iter().map(secs)).unwrap_or(f64::NAN);
    let types = first.types;
    let (checked, secondary) = (types.uncertain, types.secondary);
    let us = |secs: f64, count: usize| if count == 0 { 0.0 } else { secs * 1e6 / count as f64 };
    let resolve_ns = known(|f| f.secs.visibility_and_lookup) * 1e9 / pixels;
    let rays = first.rays.secondary as f64 / 1e6;
    StageSpeed {
        resolve_ns_per_pixel: resolve_ns,
        lookup_ns_per_pixel: resolve_ns - floors.visibility_ns_per_pixel,
        checked_pixels: checked,
        check_new_us_per_pixel: us(first.secs.trace, checked + types.unseen),
        check_known_us_per_pixel: us(known(|f| f.secs.trace), checked + types.unseen),
        secondary_pixels: secondary,
        secondary_new_us_per_pixel: us(first.secs.secondary, secondary),
        secondary_known_us_per_pixel: us(known(|f| f.secs.secondary), secondary),
        secondary_floor_us_per_pixel: us(rays / floors.primary_mrays_per_sec, secondary),
        ..StageSpeed::default()
    }
}
