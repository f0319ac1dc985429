//! Smooth light of a reference, shared between neighbours: first on the same surface, then among
//! places near each other, for surfaces of many small facets.
//!
//! Samples are filtered with ever wider kernels, and each pixel takes the width whose result is
//! nearest to samples that took no part in it. Two halves of the samples make that possible: one is
//! filtered, the other judges, and the other way round. So the width follows the noise, shrinks as
//! samples rise, and stays small where light changes from place to place; in the limit nothing is
//! filtered.
//!
//! Sources: an edge-avoiding à-trous wavelet (Dammertz et al., "Edge-Avoiding À-Trous Wavelet
//! Transform for fast Global Illumination Filtering", HPG 2010); the choice of width by two halves
//! (Rousselle, Knaus and Zwicker, "Adaptive Rendering with Non-Local Means Filtering", 2012). We
//! differ: irradiance on surfaces is filtered, never the picture; light weighs only where it
//! differs by far more than its noise, as on both sides of a thin wall, so that noise hardly guides
//! the filter. The noise is that of the samples, pooled over the surface; from kernel to kernel it
//! follows from the weights, as in Schied et al., "Spatiotemporal Variance-Guided Filtering", HPG
//! 2017, section 4.2.
//!
//! | file | contents |
//! |---|---|
//! | `surfaces` | what the pixels show, and how alike neighbours are |
//! | `walls` | what stands between them |
//! | `kernel` | one step of the wavelet |
//! | `near` | shared light where another frame of the view shows a place nearby |

mod kernel;
mod near;
mod surfaces;
mod walls;

use super::ReferenceFrame;
use super::smooth_samples::SmoothSamples;
use crate::trace::Tracer;
use glam::Vec3;
use kernel::{Halves, Kernel, Light};
use rayon::prelude::*;
use surfaces::{Kind, Likenesses, Surfaces};
use walls::Walls;

/// Widths tried on surfaces besides no filter: kernels reach up to one, two, four .. pixels further
/// each time.
const LEVELS: usize = 6;

/// Steps of the kernels that average the error of a width over a surface, as powers of two. In a
/// daylit room, with four and sixteen samples, three steps lost 0.9 and 0.5 dB against five, which
/// came within 0.8 and 0.3 dB of the best width for the whole picture and had less error in FLIP.
const ERROR_STEPS: usize = 5;

/// Widths tried among places near each other. With five, and the reach below, the variance of a
/// reference of two samples was 20 % less than with three and half the reach in a daylit room, 12 %
/// less in a gallery and 3 % less in a staircase.
const PLACE_LEVELS: usize = 5;

/// Distance between places that share light, relative to that of neighbouring pixels on a surface
/// that faces the viewer: a moulding's faces are seen at a slant.
const PLACE_REACH: f32 = 8.0;

/// Distance between places that share light at most, relative to that from the eye. Without this
/// limit, blocks of a furnished room of 48 x 32 pixels were off by up to 13.7 %; with any limit
/// from 0.12 to 0.25, by less than 13 %.
const FARTHEST_PLACE: f32 = 0.18;

/// The filter of a picture: which of its pixels share light, whatever samples they have.
#[derive(Debug)]
pub(crate) struct SmoothFilter {
    surfaces: Surfaces,
    /// On surfaces, pixels whose distance is 1, 2, 4 .. pixels.
    on_surfaces: Vec<Likenesses>,
    /// Among places near each other.
    near: Vec<Likenesses>,
}

impl SmoothFilter {
    /// The filter of the listed pixels of a reference, whose hits are stored.
    pub(crate) fn new(frame: &ReferenceFrame, tracer: &Tracer, pixels: &[u32]) -> Self {
        let surfaces = Surfaces::of(frame, tracer, pixels);
        let reach = PLACE_REACH * frame.view.scene_from_pixel.x_axis.length();
        let mut on_surfaces = likenesses(&surfaces, LEVELS, |_| Kind::Surface);
        let places = |step: f32| Kind::Place { reach: (reach * step).min(FARTHEST_PLACE) };
        let mut near = likenesses(&surfaces, PLACE_LEVELS, places);
        let walls = Walls::between(&surfaces, &on_surfaces[0], frame.view.eye, tracer);
        on_surfaces.iter_mut().chain(&mut near).for_each(|likenesses| walls.end(likenesses));
        drop(walls);
        Self { surfaces, on_surfaces, near }
    }

    /// Filters samples of listed pixels, which the filter must know. Returns the smooth light of
    /// each, not a number where its samples are not finite: such light may not be reused.
    pub(crate) fn light(&self, pixels: &[u32], samples: &[SmoothSamples]) -> Vec<Vec3> {
        let raw = layer_of(self.surfaces.size, pixels, samples);
        let filter = |likenesses: &[Likenesses], error_steps: usize, start: Vec<Halves>| {
            Filter { surfaces: &self.surfaces, likenesses, error_steps }.run(&raw, start)
        };
        let filtered = filter(&self.on_surfaces, ERROR_STEPS, raw.clone());
        let filtered = filter(&self.near, PLACE_LEVELS, filtered);
        let light = |(&pixel, samples): (&u32, &SmoothSamples)| {
            if samples.is_finite() { light_of(&filtered[pixel as usize]) } else { Vec3::NAN }
        };
        pixels.iter().zip(samples).map(light).collect()
    }
}

fn likenesses(surfaces: &Surfaces, levels: usize, kind: impl Fn(f32) -> Kind) -> Vec<Likenesses> {
    let steps = (0..levels).map(|level| 1 << level);
    steps.map(|step: usize| surfaces.likenesses(step, kind(step as f32))).collect()
}

impl ReferenceFrame {
    /// Memory per pixel while smooth light is filtered, in bytes: surfaces, likenesses, steps
    /// across walls, four layers, light and noise, errors.
    pub(super) const FILTER_BYTES_PER_PIXEL: usize = 6 * size_of::<f32>()
        + (LEVELS + PLACE_LEVELS) * 4
        + 4 * size_of::<u32>()
        + 4 * size_of::<Halves>()
        + 5 * size_of::<f32>()
        + 3 * size_of::<f32>();

    /// Filters the samples of the listed pixels and stores the result as their smooth light.
    pub(crate) fn store_filtered(&mut self, tracer: &Tracer, pixels: &[u32], samples: &[SmoothSamples]) {
        if self.settings.bounces > 0 && !pixels.is_empty() {
            profiling::scope!("filter of smooth light");
            let light = SmoothFilter::new(self, tracer, pixels).light(pixels, samples);
            self.store_smooth(pixels, light.iter().copied());
        }
    }
}

/// Chooses, for each pixel, the best of several widths.
struct Filter<'a> {
    surfaces: &'a Surfaces,
    /// Of the kernels whose steps are 1, 2, 4 .. pixels.
    likenesses: &'a [Likenesses],
    /// Kernels that average errors.
    error_steps: usize,
}

impl Filter<'_> {
    /// Filters `start`, and returns the width that agrees best with the samples in `raw`.
    fn run(&self, raw: &[Halves], start: Vec<Halves>) -> Vec<Halves> {
        let mut best = start.clone();
        let mut least = self.errors(&start, raw);
        let mut noise = self.noise(&start);
        let (mut layer, mut next) = (start.clone(), start);
        for level in 0..self.likenesses.len() {
            let light = planes_of(&layer, noise);
            noise = vec![0.0; layer.len()];
            self.kernel(level).widen(&layer, &light, &mut next, &mut noise);
            std::mem::swap(&mut layer, &mut next);
            let errors = self.errors(&layer, raw);
            keep_better(&mut best, &mut least, &layer, &errors);
        }
        best
    }

    fn kernel(&self, level: usize) -> Kernel<'_> {
        Kernel { surfaces: self.surfaces, likenesses: &self.likenesses[level] }
    }

    /// The error of each pixel in a layer, by samples that took no part in it, averaged over the
    /// surface.
    fn errors(&self, layer: &[Halves], raw: &[Halves]) -> Vec<f32> {
        let pixels = layer.par_iter().zip(raw);
        self.averaged(pixels.map(|(layer, raw)| disagreement(layer, raw)).collect())
    }

    /// The variance of the light of each pixel, by how much the halves differ: around the pixel, or
    /// over its surface where that is more. Where few paths find light, most pixels around one that
    /// has found it twice have found none, and would call that an edge.
    fn noise(&self, layer: &[Halves]) -> Vec<f32> {
        let variances: Vec<f32> = layer.par_iter().map(variance).collect();
        let mut around = vec![0.0; layer.len()];
        self.kernel(0).average(&variances, &mut around);
        let over_surface = self.averaged(variances);
        around.par_iter_mut().zip(over_surface).for_each(|(noise, more)| *noise = noise.max(more));
        around
    }

    /// Values averaged over the surface of each pixel.
    fn averaged(&self, mut values: Vec<f32>) -> Vec<f32> {
        let mut averaged = vec![0.0; values.len()];
        for step in 0..self.error_steps {
            self.kernel(step).average(&values, &mut averaged);
            std::mem::swap(&mut values, &mut averaged);
        }
        values
    }
}

/// The light of a layer in planes, with its variance.
fn planes_of(layer: &[Halves], noise: Vec<f32>) -> Light {
    let [mut r, mut g, mut b] = [const { Vec::new() }; 3];
    for plane in [&mut r, &mut g, &mut b] {
        plane.resize(layer.len(), 0.0);
    }
    let pixels = (&mut r, &mut g, &mut b).into_par_iter().zip(layer);
    pixels.for_each(|((r, g, b), halves)| [*r, *g, *b] = light_of(halves).to_array());
    [r, g, b, noise]
}

/// The samples of the listed pixels in an array of all pixels. The halves change places on every
/// other pixel, so that each has as many samples where the number is odd.
fn layer_of([width, height]: [usize; 2], pixels: &[u32], samples: &[SmoothSamples]) -> Vec<Halves> {
    let mut layer = vec![Halves::default(); width * height];
    // Samples that are not finite are left out, so that they spoil no neighbour.
    for (&pixel, samples) in pixels.iter().zip(samples).filter(|(_, samples)| samples.is_finite()) {
        let counts = [samples.count.div_ceil(2), samples.count / 2];
        let [a, b] = [0, 1].map(|half| samples.sums[half].extend(counts[half] as f32).to_array());
        let (x, y) = (pixel as usize % width, pixel as usize / width);
        let [a, b] = if (x + y) % 2 == 1 { [b, a] } else { [a, b] };
        layer[pixel as usize] = [a[0], a[1], a[2], a[3], b[0], b[1], b[2], b[3]];
    }
    layer
}

/// Replaces what is best so far where a layer has less error.
fn keep_better(best: &mut [Halves], least: &mut [f32], layer: &[Halves], errors: &[f32]) {
    let pixels = best.par_iter_mut().zip(least).zip(layer).zip(errors);
    pixels.for_each(|(((best, least), layer), error)| {
        if error < least {
            (*best, *least) = (*layer, *error);
        }
    });
}

/// The mean light of both halves.
#[inline(always)]
fn means(&[r, g, b, n, s, h, c, m]: &Halves) -> [Vec3; 2] {
    [Vec3::new(r, g, b) / n.max(f32::MIN_POSITIVE), Vec3::new(s, h, c) / m.max(f32::MIN_POSITIVE)]
}

/// The light of a pixel, by all samples.
#[inline(always)]
fn light_of(&[r, g, b, n, s, h, c, m]: &Halves) -> Vec3 {
    Vec3::new(r + s, g + h, b + c) / (n + m).max(f32::MIN_POSITIVE)
}

/// The variance of the light of a pixel, by how much its halves differ.
#[inline(always)]
fn variance(halves: &Halves) -> f32 {
    if halves[3] > 0.0 && halves[7] > 0.0 {
        let [a, b] = means(halves);
        0.25 * (a - b).length_squared()
    } else {
        light_of(halves).length_squared()
    }
}

/// Squared distance between each half of filtered light and the other half of the samples, times
/// the number of those samples.
#[inline(always)]
fn disagreement(filtered: &Halves, raw: &Halves) -> f32 {
    let ([a, b], [right_a, right_b]) = (means(filtered), means(raw));
    raw[7] * (a - right_b).length_squared() + raw[3] * (b - right_a).length_squared()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::key::Key;
    use crate::scene::builtin;
    use crate::trace::{TraceSettings, parallel::NEVER};
    use std::sync::Arc;

    /// Samples of which few paths find light, but all of it: one in twenty, with a radiance of 20.
    fn rare_light(pixels: &[u32], count: u32) -> Vec<SmoothSamples> {
        let path = |pixel: u32, sample: u32| {
            let [random, _] = Key::of_pixel(3, pixel).with(sample).pair();
            Vec3::splat(if random < 0.05 { 20.0 } else { 0.0 })
        };
        let half = |pixel: u32, odd: u32| (0..count / 2).map(|i| path(pixel, 2 * i + odd)).sum();
        pixels.iter().map(|&pixel| SmoothSamples { sums: [half(pixel, 0), half(pixel, 1)], count }).collect()
    }

    #[test]
    fn light_that_few_paths_find_leaves_no_dots_on_a_surface() {
        let tracer = Tracer::new(Arc::new(builtin::build("furnace").unwrap()));
        let settings = TraceSettings { samples: 4, bounces: 1, seed: 1 };
        let size = [160, 120];
        let mut frame =
            ReferenceFrame::trace(&tracer, tracer.scene().start(), size, &settings, NEVER).unwrap();
        let pixels: Vec<u32> = (0..size[0] * size[1]).collect();
        frame.store_filtered(&tracer, &pixels, &rare_light(&pixels, 4));
        let (words, scale) = frame.packed_smooth();
        let light = |pixel: u32| scale.unpack(words[pixel as usize]).x;
        let dots = pixels.iter().filter(|&&pixel| light(pixel) > 3.0).count();
        let mean = pixels.iter().map(|&pixel| light(pixel)).sum::<f32>() / pixels.len() as f32;
        assert!((mean - 1.0).abs() < 0.1, "the mean of the light is {mean}");
        // Without pooled noise, 7 in a thousand.
        assert!(dots * 500 < pixels.len(), "{dots} of {} pixels are dots", pixels.len());
    }

    #[test]
    fn a_pixel_without_finite_samples_has_no_light_and_spoils_no_neighbour() {
        let tracer = Tracer::new(Arc::new(builtin::build("furnace").unwrap()));
        let (size, bad) = ([40, 30], 15 * 40 + 20);
        let settings = TraceSettings { samples: 2, bounces: 1, seed: 1 };
        let mut frame =
            ReferenceFrame::trace(&tracer, tracer.scene().start(), size, &settings, NEVER).unwrap();
        let pixels: Vec<u32> = (0..size[0] * size[1]).collect();
        let noise = |half: u64, pixel: u32| Key::of_pixel(half, pixel).pair()[0] - 0.5;
        let samples: Vec<SmoothSamples> = pixels
            .iter()
            .map(|&pixel| {
                let sums = [1, 2].map(|half| Vec3::splat(1.0 + noise(half, pixel)));
                SmoothSamples { sums: if pixel == bad { [Vec3::INFINITY, sums[1]] } else { sums }, count: 2 }
            })
            .collect();
        frame.store_filtered(&tracer, &pixels, &samples);
        assert!(frame.disparity()[bad as usize].is_nan());
        let (words, scale) = frame.packed_smooth();
        let off = |pixel: u32| (scale.unpack(words[pixel as usize]).x - 1.0).abs();
        let near: Vec<u32> =
            (1..=5).flat_map(|d| [bad - d, bad + d, bad - d * size[0], bad + d * size[0]]).collect();
        let mean = near.iter().map(|&pixel| off(pixel)).sum::<f32>() / near.len() as f32;
        // The mean of two samples is off by a sixth.
        assert!(mean < 0.08, "light near the pixel is off by {mean}");
    }
}
