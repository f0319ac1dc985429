//! Smooth light of a reference, shared between neighbours on the same surface.
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
//! differs by far more than its noise, as on both sides of a thin wall, so that noise cannot guide
//! the filter.

use super::ReferenceFrame;
use super::smooth_samples::SmoothSamples;
use crate::math::Ray;
use crate::trace::{NO_TRIANGLE, SurfacePoint, Tracer, bvh::Occluder};
use glam::{Vec3, Vec4};
use rayon::prelude::*;
use std::ops::{Add, Mul};

/// Widths tried: kernels reach up to one, two, four .. pixels further each time.
const LEVELS: u32 = 6;

/// Steps of the kernels that average the error of a width over a surface. In a daylit room, with
/// four and sixteen samples, three steps lost 0.9 and 0.5 dB against five, which came within 0.8
/// and 0.3 dB of the best width for the whole picture and had less error in FLIP.
const ERROR_STEPS: [usize; 5] = [1, 2, 4, 8, 16];

/// Sine of the angle between a surface and the line to a neighbour beyond which they are not the
/// same surface.
const MAX_SINE: f32 = 0.3;

/// Cosine of the angle between the normals of neighbours beyond which they share no light: 37
/// degrees.
const MIN_COSINE: f32 = 0.8;

/// The surface of a pixel; its normal is zero where the pixel has no samples.
#[derive(Clone, Copy)]
struct Facet {
    /// Position relative to the eye, scene units.
    position: Vec3,
    normal: Vec3,
}

/// Light of each half of the samples: the sum of radiance, and the number of samples, both divided
/// by the same weight.
#[derive(Clone, Copy, Default)]
struct Halves([Vec4; 2]);

impl Mul<f32> for Halves {
    type Output = Self;

    #[inline(always)]
    fn mul(self, factor: f32) -> Self {
        Self(self.0.map(|half| half * factor))
    }
}

impl Add for Halves {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self([self.0[0] + other.0[0], self.0[1] + other.0[1]])
    }
}

impl ReferenceFrame {
    /// Filters the samples of the listed pixels and stores the result as their smooth light.
    pub(crate) fn store_filtered(&mut self, tracer: &Tracer, pixels: &[u32], samples: &[SmoothSamples]) {
        if self.settings.bounces == 0 || pixels.is_empty() {
            return;
        }
        let width = self.view.size[0] as usize;
        let facets = facets(self, tracer, pixels);
        let walls = Walls::between(&facets, width, self.view.eye, tracer);
        let filter = Filter { width, facets: &facets, walls };
        let filtered = filter.run(pixels, samples);
        self.store_smooth(pixels, pixels.iter().map(|&pixel| filtered[pixel as usize]));
    }
}

/// The surfaces of the listed pixels, in an array of all pixels.
fn facets(frame: &ReferenceFrame, tracer: &Tracer, pixels: &[u32]) -> Vec<Facet> {
    let mut facets = vec![Facet { position: Vec3::ZERO, normal: Vec3::ZERO }; frame.view.pixel_count()];
    let found: Vec<Facet> = pixels
        .par_iter()
        .map(|&pixel| {
            let (triangle, offset) = (frame.triangle()[pixel as usize], frame.offset_from_eye(pixel));
            if triangle == NO_TRIANGLE || !offset.is_finite() {
                return Facet { position: Vec3::ZERO, normal: Vec3::ZERO };
            }
            let position = frame.view.eye + offset;
            let point = SurfacePoint::from_position(tracer.scene(), triangle, position, offset);
            Facet { position: offset, normal: point.shading_normal }
        })
        .collect();
    for (&pixel, facet) in pixels.iter().zip(found) {
        facets[pixel as usize] = facet;
    }
    facets
}

/// The surfaces of a picture, row-major, and the walls between them.
struct Filter<'a> {
    width: usize,
    facets: &'a [Facet],
    walls: Walls<'a>,
}

impl Filter<'_> {
    /// The filtered light of all pixels.
    fn run(&self, pixels: &[u32], samples: &[SmoothSamples]) -> Vec<Vec3> {
        let raw = self.layer_of(pixels, samples);
        let mut best: Vec<(f32, Vec3)> = vec![(f32::INFINITY, Vec3::ZERO); raw.len()];
        let mut layer = raw.clone();
        for level in 0..=LEVELS {
            if level > 0 {
                let light = self.light_and_noise(&layer);
                layer =
                    self.widened(&layer, 1 << (level - 1), |a, b| match agreement(&light[a], &light[b]) {
                        share if share > 0.0 && self.walls.are_absent(a, b) => share,
                        _ => 0.0,
                    });
            }
            let mut error: Vec<f32> =
                layer.par_iter().zip(&raw).map(|(layer, raw)| disagreement(layer, raw)).collect();
            for step in ERROR_STEPS {
                error = self.widened(&error, step, |_, _| 1.0);
            }
            best.par_iter_mut().zip(&error).zip(&layer).for_each(|((best, &error), layer)| {
                if error < best.0 || best.0 == f32::INFINITY {
                    *best = (error, mean(layer.0[0] + layer.0[1]));
                }
            });
        }
        best.into_iter().map(|(_, light)| light).collect()
    }

    /// The samples of the listed pixels in an array of all pixels. The halves change places on
    /// every other pixel, so that each has as many samples where the number is odd.
    fn layer_of(&self, pixels: &[u32], samples: &[SmoothSamples]) -> Vec<Halves> {
        let mut layer = vec![Halves::default(); self.facets.len()];
        for (&pixel, samples) in pixels.iter().zip(samples) {
            let counts = [samples.count.div_ceil(2), samples.count / 2];
            let halves = [0, 1].map(|half| samples.sums[half].extend(counts[half] as f32));
            let (x, y) = (pixel as usize % self.width, pixel as usize / self.width);
            let is_odd = (x + y) % 2 == 1;
            layer[pixel as usize] = Halves(if is_odd { [halves[1], halves[0]] } else { halves });
        }
        layer
    }

    /// The light of each pixel in a layer, and the variance of that light around it, by how much
    /// the halves differ.
    fn light_and_noise(&self, layer: &[Halves]) -> Vec<(Vec3, f32)> {
        let apart = |halves: &Halves| {
            let [a, b] = halves.0;
            let is_known = a.w > 0.0 && b.w > 0.0;
            if is_known { 0.25 * (mean(a) - mean(b)).length_squared() } else { mean(a + b).length_squared() }
        };
        let noise: Vec<f32> = layer.par_iter().map(apart).collect();
        let noise = self.widened(&noise, 1, |_, _| 1.0);
        layer.par_iter().zip(noise).map(|(halves, noise)| (mean(halves.0[0] + halves.0[1]), noise)).collect()
    }

    /// One step of the wavelet: each pixel becomes the mean of the nine around it, `step` apart, as
    /// far as their surfaces are alike and `agreement` (0..1) lets them.
    fn widened<V: Value>(
        &self,
        values: &[V],
        step: usize,
        agreement: impl Fn(usize, usize) -> f32 + Sync,
    ) -> Vec<V> {
        let (width, height) = (self.width, self.facets.len() / self.width.max(1));
        let agreement = &agreement;
        let row = |y: usize| {
            (0..width).map(move |x| {
                let at = y * width + x;
                let centre = &self.facets[at];
                if centre.normal == Vec3::ZERO {
                    return V::default();
                }
                let (mut sum, mut total) = (values[at] * 4.0, 4.0);
                for (dx, dy, share) in NEIGHBOURS {
                    let (nx, ny) = (x as i64 + dx * step as i64, y as i64 + dy * step as i64);
                    if nx < 0 || ny < 0 || nx >= width as i64 || ny >= height as i64 {
                        continue;
                    }
                    let other = ny as usize * width + nx as usize;
                    let likeness = share * likeness(centre, &self.facets[other]);
                    if likeness > 0.0 {
                        let weight = likeness * agreement(at, other);
                        sum = sum + values[other] * weight;
                        total += weight;
                    }
                }
                sum * (1.0 / total)
            })
        };
        (0..height).into_par_iter().flat_map_iter(row).collect()
    }
}

/// Height above the surfaces, as a share of the distance between two neighbours, at which they must
/// see each other to share light.
const LIFT: f32 = 0.25;

/// What stands between the pixels of a surface.
struct Walls<'a> {
    facets: &'a [Facet],
    eye: Vec3,
    tracer: &'a Tracer,
    /// Walls between neighbours on one surface, so thin that no pixel shows them.
    thin: Steps,
    /// Borders between neighbours on different surfaces, or of which one has no samples.
    borders: Steps,
}

/// Counts of steps from one pixel to the next that cross something, summed up along each row and
/// each column, so that the number between any two pixels of a line is a difference.
struct Steps {
    width: usize,
    along_rows: Vec<u32>,
    along_columns: Vec<u32>,
}

impl Steps {
    /// Counts the steps, between a pixel and its left or upper neighbour, for which `crosses`
    /// holds.
    fn count(len: usize, width: usize, crosses: impl Fn(usize, usize) -> bool + Sync) -> Self {
        let rows = (0..len).into_par_iter().map(|at| u32::from(at % width != 0 && crosses(at - 1, at)));
        let mut along_rows: Vec<u32> = rows.collect();
        let columns = (0..len).into_par_iter().map(|at| u32::from(at >= width && crosses(at - width, at)));
        let mut along_columns: Vec<u32> = columns.collect();
        for at in (0..len).filter(|at| at % width != 0) {
            along_rows[at] += along_rows[at - 1];
        }
        for at in width..len {
            along_columns[at] += along_columns[at - width];
        }
        Self { width, along_rows, along_columns }
    }

    /// True where no step crosses anything from one pixel to another, along the row of the first
    /// and the column of the second.
    #[inline(always)]
    fn are_clear(&self, at: usize, other: usize) -> bool {
        let corner = at - at % self.width + other % self.width;
        self.along_rows[at] == self.along_rows[corner]
            && self.along_columns[corner] == self.along_columns[other]
    }
}

impl<'a> Walls<'a> {
    fn between(facets: &'a [Facet], width: usize, eye: Vec3, tracer: &'a Tracer) -> Self {
        let is_lit = |at: usize| facets[at].normal != Vec3::ZERO;
        let is_one = |a: usize, b: usize| likeness(&facets[a], &facets[b]) > 0.0;
        let borders = Steps::count(facets.len(), width, |a, b| !is_lit(a) || !is_lit(b) || !is_one(a, b));
        let mut walls = Self { facets, eye, tracer, thin: Steps::count(0, 1, |_, _| false), borders };
        walls.thin = Steps::count(facets.len(), width, |a, b| {
            is_lit(a) && is_lit(b) && is_one(a, b) && !walls.see_each_other(a, b)
        });
        walls
    }

    /// True where two pixels see each other from a little above their surfaces.
    fn see_each_other(&self, a: usize, b: usize) -> bool {
        let (a, b) = (&self.facets[a], &self.facets[b]);
        let lift = LIFT * a.position.distance(b.position);
        let [from, to] = [a, b].map(|f| self.eye + f.position + f.normal * lift);
        let ray = Ray { t_max: 1.0, ..Ray::new(from, to - from) };
        self.tracer.transmittance(&ray, &mut Occluder::default()) != Vec3::ZERO
    }

    /// True where light may be shared: no wall is between two pixels of a surface. Behind the
    /// border of another surface, a ray decides.
    fn are_absent(&self, at: usize, other: usize) -> bool {
        self.thin.are_clear(at, other)
            && (self.borders.are_clear(at, other) || self.see_each_other(at.min(other), at.max(other)))
    }
}

/// A value per pixel that the kernels of the filter average.
trait Value: Copy + Default + Send + Sync + Mul<f32, Output = Self> + Add<Output = Self> {}

impl Value for f32 {}

impl Value for Halves {}

/// Offsets and weights of the binomial kernel of nine, without its centre of weight four.
const NEIGHBOURS: [(i64, i64, f32); 8] = [
    (-1, -1, 1.0),
    (0, -1, 2.0),
    (1, -1, 1.0),
    (-1, 0, 2.0),
    (1, 0, 2.0),
    (-1, 1, 1.0),
    (0, 1, 2.0),
    (1, 1, 1.0),
];

/// How much light two surfaces share, 0..1, by their normals and by how far each lies off the
/// other.
#[inline(always)]
fn likeness(a: &Facet, b: &Facet) -> f32 {
    let cosine = a.normal.dot(b.normal);
    if cosine <= MIN_COSINE {
        return 0.0;
    }
    let line = b.position - a.position;
    let off = a.normal.dot(line).abs().max(b.normal.dot(line).abs());
    let sine2 = off * off / line.length_squared().max(f32::MIN_POSITIVE);
    let flat = (1.0 - sine2 * (1.0 / (MAX_SINE * MAX_SINE))).max(0.0);
    let alike = (cosine - MIN_COSINE) * (1.0 / (1.0 - MIN_COSINE));
    flat * flat * alike
}

/// Differences of light, in standard deviations, beyond which neighbours share none: the edge of a
/// wall, not noise.
const MAX_DEVIATIONS: f32 = 4.0;

/// How much of the light of two pixels is the same but for noise, 0..1.
#[inline(always)]
fn agreement(a: &(Vec3, f32), b: &(Vec3, f32)) -> f32 {
    let apart = (a.0 - b.0).length_squared();
    let most = MAX_DEVIATIONS * MAX_DEVIATIONS * (a.1 + b.1);
    if apart <= 0.0 { 1.0 } else { (1.0 - apart / most.max(f32::MIN_POSITIVE)).max(0.0) }
}

/// The mean of sums with their count.
#[inline(always)]
fn mean(sums: Vec4) -> Vec3 {
    sums.truncate() / sums.w.max(f32::MIN_POSITIVE)
}

/// Squared distance between each half of filtered light and the other half of the samples, times
/// the number of those samples.
#[inline(always)]
fn disagreement(filtered: &Halves, raw: &Halves) -> f32 {
    let against = |half: usize| {
        let (filtered, raw) = (&filtered.0[half], &raw.0[1 - half]);
        if raw.w <= 0.0 { 0.0 } else { raw.w * (mean(*filtered) - mean(*raw)).length_squared() }
    };
    against(0) + against(1)
}
