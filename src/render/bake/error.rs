//! The error of a reference, without knowing the truth.
//!
//! The light `s` of a pixel is compared with `a` and `b`, the light of the same point traced twice
//! with other random numbers and without cells, neither of which is biased. The mean of
//! `(s - a) (s - b)` is then the mean square of the error of `s`, its noise and its bias, and that
//! of `a b` the mean square of the light: the noise of `a` and `b` cancels out.

use crate::math::key::Key;
use crate::math::sequence::PointSeed;
use crate::reference::ReferenceFrame;
use crate::trace::parallel::{Stop, trace_pixels};
use crate::trace::{RayCounts, TraceSettings, Tracer};
use glam::Vec3;

/// Pixels of a reference that are compared: a few thousand for a bake, for a hundredth of its time.
const PIXELS: u64 = 48;

/// Samples of each of the two, relative to those of the reference.
const SAMPLES: u32 = 4;

/// Keeps the random numbers apart from those of frames, references and audits.
const SEED: u64 = 0xba4e_0000_0000_0000;

/// The error of some references.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ErrorEstimate {
    error: f64,
    light: f64,
}

impl ErrorEstimate {
    /// Compares some pixels of a reference. After a stop nothing is added.
    pub(super) fn add(&mut self, tracer: &Tracer, reference: &ReferenceFrame, stop: Stop<'_>) {
        let settings = reference.settings;
        let key = |i: u64| Key::of_pixel(SEED ^ settings.seed, i as u32).bits();
        let count = reference.view.pixel_count().max(1) as u64;
        // Drawn from all pixels, of which a sparse reference lights few.
        let drawn = (0..PIXELS * 64).map(|i| (key(i) % count) as u32);
        let pixels: Vec<u32> =
            drawn.filter(|&pixel| reference.has_light(pixel)).take(PIXELS as usize).collect();
        let mut traced = Vec::new();
        let trace = |pixel, rays: &mut RayCounts| {
            [1, 2].map(|number| light_of(tracer, reference, pixel, SEED.wrapping_mul(number), rays))
        };
        if !trace_pixels(&pixels, &mut traced, stop, trace).1 {
            return;
        }
        for (&pixel, pair) in pixels.iter().zip(traced.iter().flatten()) {
            if let [Some(a), Some(b)] = *pair {
                let stored = reference.light(pixel);
                self.error += f64::from((stored - a).dot(stored - b));
                self.light += f64::from(a.dot(b));
            }
        }
    }

    /// Root of the mean square error relative to that of the light, 0..; `None` where nothing was
    /// compared.
    pub(super) fn relative(&self) -> Option<f64> {
        (self.light > 0.0).then(|| (self.error.max(0.0) / self.light).sqrt())
    }
}

/// Traces the light of a pixel of a reference again.
fn light_of(
    tracer: &Tracer,
    reference: &ReferenceFrame,
    pixel: u32,
    seed: u64,
    rays: &mut RayCounts,
) -> Option<Vec3> {
    let settings = TraceSettings {
        samples: reference.settings.samples.saturating_mul(SAMPLES),
        seed: reference.settings.seed ^ seed,
        ..reference.settings
    };
    let ray = Tracer::primary_ray(&reference.view, pixel);
    let hit = tracer.hit_on_triangle(&ray, reference.triangle()[pixel as usize])?;
    let point = tracer.surface(&ray, &hit).as_stored();
    let seed = PointSeed::of_pixel(settings.seed, pixel, reference.view.size[0], settings.samples);
    let light = tracer.arriving_light(&point, 1.0, &settings.into(), seed, rays).total();
    light.is_finite().then_some(light)
}
