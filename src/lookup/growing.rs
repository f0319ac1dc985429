//! References whose pixels are being lit, and that can be lit further at any time.

use super::between::{LightBetween, PictureSurfaces, round_of, rounds_of};
use super::open_pixels::{hit_tiles, open_pixels};
use super::{LookupSet, SurfaceKey};
use crate::camera::{Camera, View};
use crate::math::sequence::PointSeed;
use crate::reference::{ReferenceFrame, SampleSums, SmoothFilter, SmoothSamples};
use crate::trace::parallel::{Stop, trace_open};
use crate::trace::{ArrivingLight, LightSettings, RayCounts, TraceSettings, Tracer};
use std::{f32::consts::PI, ops::Range, time::Instant};

/// A reference whose pixels get more and more samples. Their sums are kept, so that samples are
/// added to those of before, and each pixel has a whole number of passes wherever the work was
/// interrupted.
#[derive(Debug)]
pub(crate) struct GrowingReference {
    /// What the pixels show. None has light.
    surfaces: ReferenceFrame,
    /// The pixels that are lit, tile by tile; without bounces in the order of their rounds.
    open: Vec<u32>,
    /// Without bounces, the light of the pixels that are lit, for those between.
    between: Option<LightBetween>,
    sums: Vec<SampleSums>,
    /// How the pixels share smooth light; `None` without any.
    filter: Option<SmoothFilter>,
    /// Samples that the pixels are to have.
    goal: u32,
    rays: RayCounts,
    secs: f64,
}

impl GrowingReference {
    /// Finds the surfaces of a reference, and its pixels whose light `known` does not know well.
    pub(crate) fn begin(
        tracer: &Tracer,
        camera: &Camera,
        size: [u32; 2],
        settings: &TraceSettings,
        known: &LookupSet<'_>,
    ) -> Self {
        Self::begin_where(tracer, camera, size, settings, known, |_| true)
    }

    /// Like [`Self::begin`], where only pixels are lit for which `is_wanted` holds.
    pub(super) fn begin_where(
        tracer: &Tracer,
        camera: &Camera,
        size: [u32; 2],
        settings: &TraceSettings,
        known: &LookupSet<'_>,
        is_wanted: impl Fn(u32) -> bool,
    ) -> Self {
        let start = Instant::now();
        let view = View::new(camera, &tracer.scene().frame, size);
        let tiles = hit_tiles(tracer, &view, known);
        let mut open = open_pixels(&tiles, &view);
        open.retain(|&pixel| is_wanted(pixel));
        let between = (settings.bounces == 0).then(|| LightBetween::new(size));
        if between.is_some() {
            open.sort_by_key(|&pixel| round_of(pixel, size[0]));
        }
        let mut surfaces = ReferenceFrame::empty(tracer, camera, view, settings);
        tiles.iter().for_each(|tile| tile.store_hits(&mut surfaces, tracer));
        surfaces.forget_ill_conditioned(tracer);
        let is_filtered = settings.bounces > 0 && !open.is_empty();
        let filter = is_filtered.then(|| SmoothFilter::new(&surfaces, tracer, &open));
        let rays = RayCounts { primary: view.pixel_count() as u64, ..RayCounts::default() };
        let sums = vec![SampleSums::default(); open.len()];
        Self { surfaces, open, between, sums, filter, goal: 0, rays, secs: start.elapsed().as_secs_f64() }
    }

    /// Size of the reference in pixels.
    pub(crate) fn size(&self) -> [u32; 2] {
        self.surfaces.view.size
    }

    /// Lights the pixels that have fewer samples until they have this many. Returns true where none
    /// is left.
    pub(crate) fn light(
        &mut self,
        tracer: &Tracer,
        known: &LookupSet<'_>,
        samples: u32,
        stop: Stop<'_>,
    ) -> bool {
        let start = Instant::now();
        self.goal = samples;
        let rounds = match &self.between {
            Some(_) => Vec::from(rounds_of(&self.open, self.size()[0])),
            None => std::iter::once(0..self.open.len()).collect(),
        };
        let is_complete = rounds.into_iter().all(|round| self.light_round(round, tracer, known, stop));
        self.secs += start.elapsed().as_secs_f64();
        is_complete
    }

    /// Lights some pixels up to the goal. Without bounces, pixels between others of earlier rounds
    /// that agree take their light.
    fn light_round(
        &mut self,
        round: Range<usize>,
        tracer: &Tracer,
        known: &LookupSet<'_>,
        stop: Stop<'_>,
    ) -> bool {
        let (surfaces, view, samples) = (&self.surfaces, &self.surfaces.view, self.goal);
        let settings = TraceSettings { samples, ..surfaces.settings };
        let (disparity, triangle) = (surfaces.disparity(), surfaces.triangle());
        let shown = PictureSurfaces { view, disparity, triangle, normals: known.normals() };
        let between = &self.between;
        let is_open = |sums: &SampleSums| sums.samples < samples;
        let (open, sums) = (&self.open[round.clone()], &mut self.sums[round]);
        let (rays, is_complete): (RayCounts, bool) =
            trace_open(open, sums, stop, is_open, |pixel, sums, rays| {
                let between = between.as_ref().filter(|_| sums.samples == 0);
                if let Some(light) = between.and_then(|b| b.mean(pixel, &shown, settings.relative_noise())) {
                    let direct_irradiance = light * PI;
                    return sums
                        .add(&ArrivingLight { direct_irradiance, ..ArrivingLight::default() }, samples);
                }
                let ray = Tracer::primary_ray(view, pixel);
                let Some(hit) = tracer.hit_on_triangle(&ray, surfaces.triangle()[pixel as usize]) else {
                    sums.samples = samples;
                    return;
                };
                let seed = PointSeed::of_growing_pixel(settings.seed, pixel, view.size[0]);
                let lighting = known.light_settings(&settings, view.footprint(ray.direction, hit.t));
                let (point, more) = (tracer.surface(&ray, &hit).as_stored(), sums.samples..samples);
                let direct = known.has_preview().then(|| {
                    let (position, normal) = (point.position, point.geometric_normal);
                    let key = SurfaceKey { position, normal, footprint: lighting.footprint };
                    known.held_irradiance(&key, point.triangle)
                });
                let lighting = LightSettings { direct: direct.flatten(), ..lighting };
                let light = tracer.light_of_samples(&point, more, &lighting, seed, rays);
                sums.add(&light, samples - sums.samples);
            });
        if let Some(between) = self.between.as_mut().filter(|_| is_complete) {
            open.iter().zip(sums).for_each(|(&pixel, sums)| between.set(pixel, sums.direct()));
        }
        self.rays += rays;
        is_complete
    }

    /// The number of samples to aim at next: 1, 2, 4, then 2 or a quarter more each time, so that
    /// pixels have similar numbers whenever the time is over.
    pub(crate) fn next_goal(&self) -> u32 {
        match self.goal {
            0 => 1,
            goal if self.sums.iter().any(|sums| sums.samples < goal) => goal,
            goal => goal.saturating_add((goal / 4).max(2).min(goal)),
        }
    }

    /// Samples of a pixel so far: their mean over the pixels that are lit.
    pub(crate) fn samples(&self) -> u32 {
        let lit = self.sums.iter().map(|sums| u64::from(sums.samples)).filter(|&samples| samples > 0);
        let (sum, count) = lit.fold((0, 0), |(sum, count), samples| (sum + samples, count + 1));
        (sum + count / 2).checked_div(count).map_or(0, |mean| u32::try_from(mean).unwrap_or(u32::MAX))
    }

    /// The reference with the light that its pixels have had so far. Pixels without any are unlit.
    pub(crate) fn finish(&self) -> ReferenceFrame {
        let start = Instant::now();
        let mut frame = self.surfaces.clone();
        frame.settings.samples = self.samples().max(1);
        let lit = self.open.iter().zip(&self.sums).filter(|(_, sums)| sums.samples > 0);
        let (pixels, sums): (Vec<u32>, Vec<&SampleSums>) = lit.unzip();
        frame.store_lights(&pixels, sums.iter().map(|sums| sums.direct()));
        if let Some(filter) = &self.filter {
            let smooth: Vec<SmoothSamples> = sums.iter().map(|sums| sums.smooth).collect();
            frame.store_smooth(&pixels, filter.light(&pixels, &smooth).iter().copied());
        }
        frame.rays = self.rays;
        frame.secs = self.secs + start.elapsed().as_secs_f64();
        frame
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::ReferenceCache;
    use crate::scene::builtin;
    use crate::trace::parallel::NEVER;
    use std::sync::Arc;
    use std::sync::atomic::{AtomicU32, Ordering};

    const SIZE: [u32; 2] = [33, 25];

    /// A box lit by a lamp, traced without cells, and nothing known about it.
    fn with_box<R>(run: impl FnOnce(&Tracer, &LookupSet<'_>) -> R) -> R {
        let tracer = Tracer::new(Arc::new(builtin::build("cornell").unwrap()));
        let cache = ReferenceCache::new(tracer.scene(), 1 << 30);
        run(&tracer, &LookupSet::without_references(&cache, tracer.epoch()))
    }

    fn begin(tracer: &Tracer, known: &LookupSet<'_>, seed: u64) -> GrowingReference {
        let settings = TraceSettings { samples: 1, bounces: 3, seed };
        GrowingReference::begin(tracer, tracer.scene().start(), SIZE, &settings, known)
    }

    /// Lights a reference to each of these numbers of samples, one after the other.
    fn lit(tracer: &Tracer, known: &LookupSet<'_>, samples: &[u32]) -> GrowingReference {
        let mut reference = begin(tracer, known, 5);
        samples.iter().for_each(|&samples| assert!(reference.light(tracer, known, samples, NEVER)));
        reference
    }

    #[test]
    fn paths_that_are_added_later_continue_those_of_one_pass() {
        with_box(|tracer, known| {
            let (at_once, later) = (lit(tracer, known, &[10]), lit(tracer, known, &[3, 4, 10]));
            for (a, b) in at_once.sums.iter().zip(&later.sums) {
                assert_eq!((a.samples, a.smooth.count), (b.samples, b.smooth.count));
                for (a, b) in a.smooth.sums.iter().zip(b.smooth.sums) {
                    assert!((*a - b).length() <= 1e-5 * a.length(), "{a} and {b}");
                }
            }
            // Samples of lights that are added later have places of their own on the lamp.
            let direct = |reference: &GrowingReference| {
                let lights = reference.sums.iter().map(|sums| f64::from(sums.direct().element_sum()));
                lights.sum::<f64>()
            };
            let (a, b) = (direct(&at_once), direct(&later));
            assert!(a != b && (a / b - 1.0).abs() < 0.02, "{a} and {b}");
        });
    }

    #[test]
    fn the_error_falls_from_pass_to_pass() {
        with_box(|tracer, known| {
            let light = |reference: &GrowingReference| -> Vec<glam::Vec3> {
                let frame = reference.finish();
                (0..SIZE[0] * SIZE[1]).filter(|&at| frame.has_light(at)).map(|at| frame.light(at)).collect()
            };
            let mut right = begin(tracer, known, 77);
            assert!(right.light(tracer, known, 512, NEVER));
            let (right, mut reference) = (light(&right), begin(tracer, known, 5));
            let mut last = f32::INFINITY;
            for samples in [1, 2, 4, 8, 16, 32] {
                assert!(reference.light(tracer, known, samples, NEVER));
                assert_eq!(reference.samples(), samples);
                let found = light(&reference);
                let error = found.iter().zip(&right).map(|(a, b)| (*a - *b).length_squared()).sum::<f32>();
                assert!(error < last, "{samples} samples: {error}, before {last}");
                last = error;
            }
        });
    }

    #[test]
    fn independent_references_of_a_view_merge_to_their_weighted_mean() {
        with_box(|tracer, known| {
            let lit = |seed, samples| {
                let mut reference = begin(tracer, known, seed);
                assert!(reference.light(tracer, known, samples, NEVER));
                reference.finish()
            };
            let (right, a, b) = (lit(77, 512), lit(5, 12), lit(6, 4));
            assert!(a.can_merge(&b));
            let merged = b.merged(&a);
            assert_eq!((merged.settings.samples, merged.lit()), (16, a.lit()));
            let pixels = (0..SIZE[0] * SIZE[1]).filter(|&pixel| a.has_light(pixel));
            let mut errors = [0.0; 3];
            for pixel in pixels {
                let mean = a.light(pixel).lerp(b.light(pixel), 0.25);
                let found = merged.light(pixel);
                assert!((found - mean).length() <= 0.01 * mean.max_element(), "{found} {mean}");
                for (error, frame) in errors.iter_mut().zip([&a, &b, &merged]) {
                    *error += (frame.light(pixel) - right.light(pixel)).length_squared();
                }
            }
            // Light that one of them has not lit is that of the other.
            let mut dark = b.clone();
            let side = SIZE[0].max(SIZE[1]);
            dark.forget_light([0, 0], side);
            assert_eq!(dark.merged(&a).packed_light().0.len(), a.packed_light().0.len());
            assert_eq!(dark.merged(&a).lit(), a.lit());
            // The squared error of a weighted mean is at most the weighted mean of theirs.
            assert!(errors[2] <= 1.01 * (0.75 * errors[0] + 0.25 * errors[1]), "{errors:?}");
        });
    }

    #[test]
    fn light_has_the_same_bits_at_any_number_of_threads_and_wherever_it_was_interrupted() {
        with_box(|tracer, known| {
            let words = |reference: &GrowingReference| {
                let frame = reference.finish();
                (frame.packed_light().0.to_vec(), frame.packed_smooth().0.to_vec())
            };
            let right = words(&lit(tracer, known, &[2, 4]));
            for threads in [1, 3] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                let found = pool.install(|| {
                    let (mut reference, mut stops) = (begin(tracer, known, 5), 0);
                    for samples in [2, 4] {
                        let asked = AtomicU32::new(0);
                        let stop = || asked.fetch_add(1, Ordering::Relaxed) % 100 == 99;
                        while !reference.light(tracer, known, samples, &stop) {
                            stops += 1;
                        }
                    }
                    assert!(stops > 0);
                    words(&reference)
                });
                assert!(found == right, "{threads} threads");
            }
        });
    }

    #[test]
    fn pixels_that_have_no_sample_yet_are_unlit() {
        with_box(|tracer, known| {
            let mut reference = begin(tracer, known, 5);
            assert_eq!((reference.finish().lit(), reference.samples()), (0, 0));
            let asked = AtomicU32::new(0);
            assert!(!reference.light(tracer, known, 1, &|| asked.fetch_add(1, Ordering::Relaxed) >= 100));
            let frame = reference.finish();
            assert!(frame.lit() > 0 && frame.lit() <= 100, "{}", frame.lit());
        });
    }
}
