//! Pictures of the cases, and what must hold for every picture.

use super::case::{Measured, Outcome};
use super::rooms::tracer;
use crate::camera::{Camera, View};
use crate::lookup::LookupSet;
use crate::raster::{color::ToneMap, pixel_types::PixelType};
use crate::reference::{ReferenceCache, ReferenceFrame};
use crate::render::{Frame, FrameRequest, Mode, RenderSettings, Renderer, aov::display_rows};
use crate::scene::{SceneBuilder, Sky};
use crate::trace::{TraceSettings, Tracer, parallel::NEVER};
use glam::Vec3;
use std::{sync::Arc, time::Instant};

pub(super) const SIZE: [u32; 2] = [72, 48];
pub(super) const TRACE: TraceSettings = TraceSettings { samples: 2, bounces: 0, seed: 5 };

pub(super) fn view(tracer: &Tracer, camera: &Camera) -> View {
    View::new(camera, &tracer.scene().frame, SIZE)
}

/// Traces a dense reference.
pub(super) fn reference(tracer: &Tracer, camera: &Camera, size: [u32; 2]) -> ReferenceFrame {
    ReferenceFrame::trace(tracer, camera, size, &TRACE, NEVER)
        .unwrap_or_else(|| unreachable!("tracing is never stopped here"))
}

pub(super) fn full(tracer: &Tracer, camera: &Camera) -> Frame {
    picture(tracer, camera, SIZE, Mode::Full, &[])
}

pub(super) fn paper(tracer: &Tracer, camera: &Camera, references: &[&ReferenceFrame]) -> Frame {
    picture(tracer, camera, SIZE, Mode::Paper, references)
}

pub(super) fn picture(
    tracer: &Tracer,
    camera: &Camera,
    size: [u32; 2],
    mode: Mode,
    references: &[&ReferenceFrame],
) -> Frame {
    let mut renderer = Renderer::default();
    let settings = RenderSettings { mode, trace: TRACE };
    renderer.render(&FrameRequest::new(tracer, camera, size, &settings).warping(references));
    renderer.into_frame()
}

/// Renders in mode `exact` with one sparse reference at `from`, in which a share of the bits is
/// flipped.
pub(super) fn exact(tracer: &Tracer, from: &Camera, camera: &Camera, flipped_share: f32) -> Frame {
    let mut cache = ReferenceCache::new(tracer.scene(), 1 << 30);
    let known = cache.snapshot();
    let lookup = LookupSet::of_snapshot(&known, tracer.epoch());
    let traced = ReferenceFrame::trace_sparse(tracer, from, SIZE, &TRACE, &lookup, NEVER);
    if let Some(mut reference) = traced {
        reference.flip_bits(flipped_share, 78);
        cache.insert(Arc::new(reference));
    }
    let mut renderer = Renderer::default();
    let settings = RenderSettings { mode: Mode::Exact, trace: TRACE };
    renderer.render(&FrameRequest::new(tracer, camera, SIZE, &settings).reusing(&cache));
    renderer.into_frame()
}

/// Returns the least time of the first task over the least time of the second. The least times are
/// those with the least disturbance by other programs.
pub(super) fn fastest_ratio(rounds: u32, mut both: impl FnMut() -> [f64; 2]) -> f64 {
    let [a, b] = (0..rounds)
        .map(|_| both())
        .fold([f64::INFINITY; 2], |least, now| [least[0].min(now[0]), least[1].min(now[1])]);
    a / b
}

/// Returns the time of mode `paper` from a reference over the time of mode `full`.
pub(super) fn paper_over_full_secs(
    tracer: &Tracer,
    [from, camera]: [&Camera; 2],
    size: [u32; 2],
    rounds: u32,
) -> Outcome {
    let reference = reference(tracer, from, size);
    let mut renderer = Renderer::default();
    let mut secs = |mode, references: &[&ReferenceFrame]| {
        let settings = RenderSettings { mode, trace: TRACE };
        let start = Instant::now();
        renderer.render(&FrameRequest::new(tracer, camera, size, &settings).warping(references));
        start.elapsed().as_secs_f64()
    };
    Ok(fastest_ratio(rounds, || [secs(Mode::Paper, &[&reference]), secs(Mode::Full, &[])]).into())
}

/// Counts values that no picture may hold: negative, infinite or NaN.
pub(super) fn bad_values(frame: &Frame) -> usize {
    frame.radiance.iter().filter(|r| !(r.is_finite() && r.min_element() >= 0.0)).count()
}

/// Counts the pairs of equal index that differ.
pub(super) fn unequal<T: PartialEq>(a: &[T], b: &[T]) -> usize {
    a.iter().zip(b).filter(|(a, b)| a != b).count()
}

/// Counts pixels whose radiance differs in a bit, and bad values of either frame.
pub(super) fn differing(a: &Frame, b: &Frame) -> usize {
    let differ = unequal(&a.radiance, &b.radiance) + a.radiance.len().abs_diff(b.radiance.len());
    differ + bad_values(a) + bad_values(b)
}

pub(super) fn count_type(frame: &Frame, wanted: PixelType) -> usize {
    frame.types.iter().filter(|t| **t == wanted).count()
}

/// Returns the share of pixels, in percent, that see different triangles.
pub(super) fn other_triangles_percent(a: &Frame, b: &Frame) -> f64 {
    percent(unequal(&a.triangle, &b.triangle), a.triangle.len())
}

/// Returns the share of pixels, in percent, whose display values differ by more than 1/255.
pub(super) fn off_percent(a: &Frame, b: &Frame) -> f64 {
    let [a, b] = [a, b].map(srgb);
    percent(a.iter().zip(&b).filter(|(a, b)| is_off(a, b)).count(), a.len())
}

/// Returns true if a channel differs by more than 1/255.
pub(super) fn is_off(a: &[u8; 3], b: &[u8; 3]) -> bool {
    a.iter().zip(b).any(|(a, b)| a.abs_diff(*b) > 1)
}

pub(super) fn percent(part: usize, whole: usize) -> f64 {
    100.0 * part as f64 / whole.max(1) as f64
}

pub(super) fn srgb(frame: &Frame) -> Vec<[u8; 3]> {
    display_rows(&frame.radiance, 0.0, ToneMap::Aces)
}

/// Renders a clear object in uniform white light, where it must be invisible, and returns the share
/// of pixels, in percent, that are off by more than 2 %. Cutting weak branches may cost that much.
pub(super) fn seen_in_white(mut b: SceneBuilder, camera: &Camera) -> Outcome {
    b.sky = Some(Sky::even(Vec3::ONE));
    let frame = full(&tracer(b)?, camera);
    let off = |r: &Vec3| (*r - Vec3::ONE).abs().max_element();
    let seen = frame.radiance.iter().filter(|r| off(r) > 0.02).count() + bad_values(&frame);
    let worst = frame.radiance.iter().map(off).fold(0.0, f32::max);
    let note = format!("the worst pixel is off by {:.1} %", 100.0 * worst);
    Ok(Measured::from(percent(seen, frame.radiance.len())).with_note(note).with_picture(&frame))
}
