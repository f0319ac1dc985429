//! The places that references show, each with the doubt about its light.
//!
//! All pixels of one cell of the directory that face the same side share one estimate, in whatever
//! reference they are: the cost of an edit follows the size of the building that was seen, not the
//! number of references.

use super::elements::side_of;
use super::samples::{Difference, Doubt, DoubtSamples};
use crate::math::key::Key;
use crate::reference::{Directory, ReferenceFrame};
use crate::trace::{NO_TRIANGLE, Tracer, parallel::Stop};
use rayon::prelude::*;

/// No place.
const NOWHERE: u32 = u32::MAX;

/// A pixel of a reference at a place.
type Seen = (u32, u32, u32);

/// The doubt about the light of all places that some references show.
#[derive(Debug)]
pub(super) struct Places<'a> {
    directory: &'a Directory,
    /// Place by cell and side.
    index: Vec<u32>,
    doubts: Vec<Doubt>,
}

/// The cell and side of a pixel whose light was traced.
fn place_of(directory: &Directory, tracer: &Tracer, frame: &ReferenceFrame, pixel: u32) -> Option<u32> {
    let triangle = frame.triangle()[pixel as usize];
    let is_surface = frame.disparity()[pixel as usize] > 0.0 && triangle != NO_TRIANGLE;
    if !is_surface || !frame.was_lit(pixel) {
        return None;
    }
    let offset = frame.offset_from_eye(pixel);
    let [a, b, c] = tracer.scene().corners(triangle);
    let normal = (b - a).cross(c - a);
    let side = side_of(if normal.dot(offset) < 0.0 { normal } else { -normal });
    Some(directory.cell_of(frame.view.eye + offset) * 6 + side as u32)
}

impl<'a> Places<'a> {
    /// Estimates the doubt about the light of all places that some references show.
    pub(super) fn new<D: Difference>(
        difference: &D,
        (tracer, directory): (&Tracer, &'a Directory),
        frames: &[&ReferenceFrame],
        stop: Stop<'_>,
    ) -> Self {
        let seen = seen_in(tracer, directory, frames);
        let places: Vec<&[Seen]> = seen.chunk_by(|a, b| a.0 == b.0).collect();
        let mut index = vec![NOWHERE; directory.cells() * 6];
        for (number, place) in (0..).zip(&places) {
            index[place[0].0 as usize] = number;
        }
        let [least, most] = D::SAMPLES;
        let samples = (D::MAX_SAMPLES / places.len().max(1) as u32).clamp(least, most);
        let doubt = |place: &&[Seen]| {
            if stop() {
                return DoubtSamples::default();
            }
            let ends = [place[0], place[place.len() - 1]];
            let count = if place.len() > 1 { 2 } else { 1 };
            let doubts = ends[..count].iter().filter_map(|&(key, frame, pixel)| {
                let view = &frames[frame as usize].view;
                let ray = Tracer::primary_ray(view, pixel);
                let triangle = frames[frame as usize].triangle()[pixel as usize];
                let hit = tracer.hit_on_triangle(&ray, triangle)?;
                let point = tracer.surface(&ray, &hit).as_stored();
                Some(difference.at(&point, samples, Key::of_pixel(u64::from(key), pixel)))
            });
            doubts.fold(DoubtSamples::default(), DoubtSamples::and)
        };
        let samples: Vec<DoubtSamples> = places.par_iter().map(doubt).collect();
        let pooled = |place: &&[Seen]| pooled::<D>(directory, &index, &samples, place[0].0);
        let doubts = places.par_iter().map(pooled).collect();
        Self { directory, index, doubts }
    }

    /// The doubt about the light of a pixel.
    pub(super) fn doubt(&self, tracer: &Tracer, frame: &ReferenceFrame, pixel: u32) -> Option<Doubt> {
        let place = place_of(self.directory, tracer, frame, pixel)?;
        self.doubts.get(self.index[place as usize] as usize).copied()
    }

    /// Number of places.
    pub(super) fn len(&self) -> usize {
        self.doubts.len()
    }
}

/// The doubt about a place, by its own samples and those around it.
fn pooled<D: Difference>(
    directory: &Directory,
    index: &[u32],
    samples: &[DoubtSamples],
    place: u32,
) -> Doubt {
    let (cell, side) = (place / 6, place % 6);
    let own = samples[index[place as usize] as usize];
    let around = directory
        .cells_around(cell)
        .filter_map(|near| samples.get(index[(near * 6 + side) as usize] as usize))
        .fold(DoubtSamples::default(), |sum, near| sum.and(*near));
    D::doubt(&own, &around)
}

/// The places that some references show, ascending, each with its first and its last pixel in every
/// row.
fn seen_in(tracer: &Tracer, directory: &Directory, frames: &[&ReferenceFrame]) -> Vec<Seen> {
    let rows = (0..).zip(frames).flat_map(|(number, &frame)| {
        let rows = frame.view.size[1];
        (0..rows).map(move |row| (number, frame, row))
    });
    let rows: Vec<(u32, &ReferenceFrame, u32)> = rows.collect();
    let mut seen: Vec<Seen> = rows
        .into_par_iter()
        .flat_map_iter(|(number, frame, row)| {
            let width = frame.view.size[0];
            let mut seen: Vec<Seen> = (row * width..(row + 1) * width)
                .filter_map(|pixel| Some((place_of(directory, tracer, frame, pixel)?, number, pixel)))
                .collect();
            seen.sort_unstable();
            // Keep the first and the last of each.
            let ends = seen.chunk_by(|a, b| a.0 == b.0).map(|same| [same[0], same[same.len() - 1]]);
            ends.flat_map(|[a, b]| [a, b].into_iter().take(1 + usize::from(a != b))).collect::<Vec<_>>()
        })
        .collect();
    seen.par_sort_unstable();
    seen
}
