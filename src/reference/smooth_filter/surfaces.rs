//! The surfaces that the pixels of a reference show, and how much light two of them can share.

use crate::math::simd;
use crate::reference::ReferenceFrame;
use crate::trace::{NO_TRIANGLE, SurfacePoint, Tracer};
use fearless_simd::dispatch;
use glam::Vec3;
use rayon::prelude::*;
use std::ops::Range;

/// Sine of the angle between a surface and the line to a neighbour beyond which they are not the
/// same surface.
const MAX_SINE: f32 = 0.3;

/// Cosine of the angle between the normals of neighbours beyond which they share no light: 37
/// degrees.
const MIN_COSINE: f32 = 0.8;

/// Pixels of a row that are left out together where none of them has samples.
const BLOCK: usize = 32;

/// The surface of a pixel; its normal is zero where the pixel has no samples.
#[derive(Clone, Copy)]
pub(super) struct Facet {
    /// Position relative to the eye, scene units.
    pub(super) position: Vec3,
    pub(super) normal: Vec3,
}

/// The surfaces of a picture, row-major: six planes of numbers, so that a row is compared with
/// another in vectors.
#[derive(Debug)]
pub(super) struct Surfaces {
    pub(super) size: [usize; 2],
    /// Runs of columns of each row outside of which no pixel has samples.
    spans: Vec<Vec<Range<usize>>>,
    /// x, y and z of positions, then of normals.
    planes: [Vec<f32>; 6],
}

/// How much light the pixels of one step of a kernel share with their neighbours.
#[derive(Debug)]
pub(super) struct Likenesses {
    /// Pixels from one to the next, along a row or column.
    pub(super) step: usize,
    /// For each of [`DIRECTIONS`], the likeness of each pixel and its neighbour there, in 255ths; 0
    /// beyond the edge of the picture.
    pub(super) shares: [Vec<u8>; 4],
}

/// How pixels must be alike to share light.
#[derive(Clone, Copy)]
pub(super) enum Kind {
    /// They show one smooth surface.
    Surface,
    /// They show places whose distance is at most this share of that from the eye.
    Place { reach: f32 },
}

/// Where neighbours are, as columns and rows in units of the step; the other four are opposite.
pub(super) const DIRECTIONS: [(isize, usize); 4] = [(1, 0), (-1, 1), (0, 1), (1, 1)];

impl Surfaces {
    /// The surfaces of the listed pixels of a reference.
    pub(super) fn of(frame: &ReferenceFrame, tracer: &Tracer, pixels: &[u32]) -> Self {
        let found: Vec<Option<Facet>> = pixels.par_iter().map(|&pixel| facet(frame, tracer, pixel)).collect();
        Self::new(frame.view.size.map(|side| side as usize), pixels, &found)
    }

    /// The surfaces of the listed pixels of a picture.
    pub(super) fn new(size: [usize; 2], pixels: &[u32], found: &[Option<Facet>]) -> Self {
        let mut planes = [const { Vec::new() }; 6];
        planes.par_iter_mut().enumerate().for_each(|(axis, plane)| {
            *plane = vec![0.0; size[0] * size[1]];
            for (&pixel, facet) in pixels.iter().zip(found) {
                if let Some(Facet { position, normal }) = facet {
                    plane[pixel as usize] = if axis < 3 { position[axis] } else { normal[axis - 3] };
                }
            }
        });
        Self { size, spans: spans_of(size, pixels), planes }
    }

    /// Runs of columns of a row outside of which no pixel has samples.
    pub(super) fn spans(&self, y: usize) -> impl Iterator<Item = Range<usize>> {
        self.spans[y].iter().cloned()
    }

    /// The parts of a row's spans that lie in some columns.
    pub(super) fn spans_in(&self, y: usize, columns: Range<usize>) -> impl Iterator<Item = Range<usize>> {
        let within = move |span: Range<usize>| span.start.max(columns.start)..span.end.min(columns.end);
        self.spans(y).map(within).filter(|span| !span.is_empty())
    }

    pub(super) fn len(&self) -> usize {
        self.planes[0].len()
    }

    #[inline(always)]
    pub(super) fn facet(&self, at: usize) -> Facet {
        let [px, py, pz, nx, ny, nz] = self.planes.each_ref().map(|plane| plane[at]);
        Facet { position: Vec3::new(px, py, pz), normal: Vec3::new(nx, ny, nz) }
    }

    /// Compares all pixels with their neighbours `step` pixels away, as parts of one surface or
    /// of one place.
    pub(super) fn likenesses(&self, step: usize, kind: Kind) -> Likenesses {
        let [width, height] = self.size;
        let plane = |(dx, dy): (isize, usize)| {
            let mut shares = vec![0; self.len()];
            let (shift, down) = (dx.unsigned_abs() * step, dy * step);
            let rows = shares.par_chunks_mut(width.max(1)).take(height.saturating_sub(down)).enumerate();
            rows.filter(|_| shift < width).for_each(|(y, row)| {
                let (left, right) = (y * width, (y + down) * width);
                // A neighbour to the left exists from column `shift` on, one to the right up to it.
                let (a, b) = if dx < 0 { (left + shift, right) } else { (left, right + shift) };
                let from = if dx < 0 { shift } else { 0 };
                for span in self.spans_in(y, from..from + width - shift) {
                    let first = span.start - from;
                    self.compare(a + first, b + first, kind, &mut row[span]);
                }
            });
            shares
        };
        Likenesses { step, shares: DIRECTIONS.map(plane) }
    }

    /// Compares as many pixels from `a` on with those from `b` on as there are shares.
    fn compare(&self, a: usize, b: usize, kind: Kind, shares: &mut [u8]) {
        let run = |first: usize| self.planes.each_ref().map(|plane| &plane[first..first + shares.len()]);
        let (a, b) = (run(a), run(b));
        match kind {
            Kind::Surface => {
                dispatch!(simd::level(), _simd => compare_runs(&a, &b, shares, surface_likeness));
            }
            Kind::Place { reach } => {
                let likeness = |a: &Facet, b: &Facet| place_likeness(a, b, reach);
                dispatch!(simd::level(), _simd => compare_runs(&a, &b, shares, likeness));
            }
        }
    }
}

/// For each row of a picture, the runs of its columns that hold listed pixels, in whole blocks.
fn spans_of([width, height]: [usize; 2], pixels: &[u32]) -> Vec<Vec<Range<usize>>> {
    let in_row = width.div_ceil(BLOCK);
    let mut is_used = vec![false; in_row * height];
    for pixel in pixels.iter().map(|&pixel| pixel as usize) {
        is_used[pixel / width * in_row + pixel % width / BLOCK] = true;
    }
    let spans = |row: &[bool]| {
        let runs = row.chunk_by(|a, b| a == b).scan(0, |next, run| {
            let first = std::mem::replace(next, *next + run.len());
            Some((run[0], first * BLOCK..(*next * BLOCK).min(width)))
        });
        runs.filter_map(|(is_used, span)| is_used.then_some(span)).collect()
    };
    is_used.chunks(in_row.max(1)).map(spans).collect()
}

/// The surface of a pixel of a reference; `None` for the sky and for pixels that must not be used.
fn facet(frame: &ReferenceFrame, tracer: &Tracer, pixel: u32) -> Option<Facet> {
    let (triangle, position) = (frame.triangle()[pixel as usize], frame.offset_from_eye(pixel));
    (triangle != NO_TRIANGLE && position.is_finite()).then(|| {
        let point =
            SurfacePoint::from_position(tracer.scene(), triangle, frame.view.eye + position, position);
        Facet { position, normal: point.plain_normal }
    })
}

/// The shares, in 255ths, of pairs of surfaces given as runs of the six planes.
#[inline(always)]
fn compare_runs(
    a: &[&[f32]; 6],
    b: &[&[f32]; 6],
    shares: &mut [u8],
    likeness: impl Fn(&Facet, &Facet) -> f32,
) {
    /// Pixels compared at a time, so that the numbers stay in registers.
    const LANES: usize = 16;
    /// The last bits of this number are whole numbers, so a sum with it is rounded to one. The
    /// conversion of Rust is not done in vectors.
    const ROUNDING: f32 = 8_388_608.0;
    let mut first = 0;
    while first < shares.len() {
        let count = LANES.min(shares.len() - first);
        let mut found = [0.0f32; LANES];
        for (lane, found) in found[..count].iter_mut().enumerate() {
            let facet = |planes: &[&[f32]; 6]| {
                let [px, py, pz, nx, ny, nz] = planes.map(|plane| plane[first + lane]);
                Facet { position: Vec3::new(px, py, pz), normal: Vec3::new(nx, ny, nz) }
            };
            *found = likeness(&facet(a), &facet(b));
        }
        for (share, found) in shares[first..first + count].iter_mut().zip(found) {
            *share = (found * 255.0 + ROUNDING).to_bits() as u8;
        }
        first += count;
    }
}

/// How much light two places share, 0..1, by the distance between them, of which `reach` is the
/// most relative to that from the eye, and by their normals. Zero where one has no normal.
#[inline(always)]
fn place_likeness(a: &Facet, b: &Facet, reach: f32) -> f32 {
    let apart = (b.position - a.position).length_squared();
    let most = reach * reach * a.position.length_squared().min(b.position.length_squared());
    let near = (1.0 - apart / most.max(f32::MIN_POSITIVE)).max(0.0);
    // Zero for no normal, and where normals are at right angles or more apart.
    near * a.normal.dot(b.normal).max(0.0)
}

/// How much light two surfaces share, 0..1, by their normals and by how far each lies off the
/// other. Zero where one has no normal.
#[inline(always)]
pub(super) fn surface_likeness(a: &Facet, b: &Facet) -> f32 {
    let cosine = a.normal.dot(b.normal);
    let line = b.position - a.position;
    let off = a.normal.dot(line).abs().max(b.normal.dot(line).abs());
    let sine2 = off * off / line.length_squared().max(f32::MIN_POSITIVE);
    let flat = (1.0 - sine2 * (1.0 / (MAX_SINE * MAX_SINE))).max(0.0);
    let alike = ((cosine - MIN_COSINE) * (1.0 / (1.0 - MIN_COSINE))).max(0.0);
    flat * flat * alike
}
