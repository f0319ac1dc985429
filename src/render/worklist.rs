//! Lists of pixels that are still to be traced, and the order in which they are.

use super::{frame::Frame, request::Source};
use crate::lookup::{LightBetween, PictureSurfaces, round_of, rounds_of};
use crate::trace::TraceSettings;
use crate::trace::parallel::{Stop, trace_missing};
use glam::Vec3;
use std::ops::AddAssign;

/// The pass of each pixel of a square of four by four: Bayer's order for ordered dithering.
const DISPERSED: [usize; 16] = [0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5];

/// The pass, 0..16, of a pixel or tile in an order that spreads each pass over the whole picture.
pub(super) fn dispersed_pass(x: u32, y: u32) -> usize {
    DISPERSED[(4 * (y % 4) + x % 4) as usize]
}

/// Passes of a list: sixteen; the first is split into sixteen again, and all are there twice, for
/// pixels that come first and for those that may wait.
const PASSES: usize = 31;

/// Scratch memory that brings lists of pixels into dispersed order, reused between frames.
#[derive(Debug, Default)]
pub(super) struct Dispersal {
    passes: [[Vec<u32>; PASSES]; 2],
}

/// The pass of a pixel: those of the first sixteenth are dispersed over squares of sixteen pixels.
fn pass_of(pixel: u32, width: u32) -> usize {
    let (x, y) = (pixel % width, pixel / width);
    match dispersed_pass(x, y) {
        0 => dispersed_pass(x / 4, y / 4),
        pass => pass + 15,
    }
}

/// Where light was traced in a frame, and the surfaces between.
pub(super) struct Between<'a> {
    pub(super) light: &'a mut LightBetween,
    pub(super) surfaces: PictureSurfaces<'a>,
    /// Noise of the light relative to that of sixteen shadow rays.
    pub(super) noise: f32,
}

impl<'a> Between<'a> {
    /// The surfaces of a frame that looks light up, traced with these settings.
    pub(super) fn new(
        light: &'a mut LightBetween,
        frame: &'a Frame,
        source: &'a Source<'_>,
        trace: &TraceSettings,
    ) -> Self {
        let normals = source.normals();
        let (view, disparity, triangle) = (&frame.view, &frame.disparity[..], &frame.triangle[..]);
        let surfaces = PictureSurfaces { view, disparity, triangle, normals };
        Self { light, surfaces, noise: trace.relative_noise() }
    }
}

/// Pixels to be traced, each with its result once it is done. Keeps its memory between frames.
#[derive(Debug)]
pub(super) struct WorkList<R> {
    pixels: Vec<u32>,
    results: Vec<Option<R>>,
}

impl<R> Default for WorkList<R> {
    fn default() -> Self {
        Self { pixels: Vec::new(), results: Vec::new() }
    }
}

impl<R: Send> WorkList<R> {
    /// Starts a new list from parts, none of it done.
    pub(super) fn begin<'a>(&mut self, parts: impl Iterator<Item = &'a [u32]>) {
        self.pixels.clear();
        parts.for_each(|part| self.pixels.extend_from_slice(part));
        self.results.clear();
        self.results.resize_with(self.pixels.len(), || None);
    }

    /// Brings a list that was just begun into dispersed order, with the pixels that may wait last.
    /// Where none may, each round of [`round_of`] ends before the next begins.
    pub(super) fn disperse(&mut self, dispersal: &mut Dispersal, width: u32, may_wait: impl Fn(u32) -> bool) {
        self.sort_into(dispersal, |pixel| [usize::from(may_wait(pixel)), pass_of(pixel, width)]);
    }

    /// Brings a list that was just begun into the order of its rounds.
    pub(super) fn sort_by_round(&mut self, dispersal: &mut Dispersal, width: u32) {
        self.sort_into(dispersal, |pixel| [0, round_of(pixel, width)]);
    }

    fn sort_into(&mut self, dispersal: &mut Dispersal, pass: impl Fn(u32) -> [usize; 2]) {
        dispersal.passes.iter_mut().flatten().for_each(Vec::clear);
        for &pixel in &self.pixels {
            let [part, pass] = pass(pixel);
            dispersal.passes[part][pass].push(pixel);
        }
        self.pixels.clear();
        dispersal.passes.iter().flatten().for_each(|pass| self.pixels.extend_from_slice(pass));
    }

    /// Traces what is missing in the first `1 / part` of the list. Returns what `trace` adds up in
    /// addition to the results, and whether that part of the list is complete.
    pub(super) fn run<G: Default + Send + AddAssign>(
        &mut self,
        part: usize,
        stop: Stop<'_>,
        trace: impl Fn(u32, &mut G) -> R + Sync,
    ) -> (G, bool) {
        let due = self.pixels.len().div_ceil(part);
        trace_missing(&self.pixels[..due], &mut self.results[..due], stop, trace)
    }

    /// Like [`Self::run`] for all of a list that is in the order of its rounds. `trace` is given
    /// the light between earlier pixels, where it is known, and `light_of` returns that of a
    /// result.
    pub(super) fn run_in_rounds<G: Default + Send + AddAssign>(
        &mut self,
        stop: Stop<'_>,
        between: &mut Between<'_>,
        light_of: impl Fn(&R) -> Option<Vec3>,
        trace: impl Fn(u32, Option<Vec3>, &mut G) -> R + Sync,
    ) -> (G, bool) {
        let mut gathered = G::default();
        for round in rounds_of(&self.pixels, between.surfaces.view.size[0]) {
            let (pixels, results) = (&self.pixels[round.clone()], &mut self.results[round]);
            let Between { light, surfaces, noise } = between;
            let (added, is_complete) = trace_missing(pixels, results, stop, |pixel, gathered: &mut G| {
                trace(pixel, light.mean(pixel, surfaces, *noise), gathered)
            });
            gathered += added;
            if !is_complete {
                return (gathered, false);
            }
            for (&pixel, result) in pixels.iter().zip(results.iter().flatten()) {
                if let Some(known) = light_of(result) {
                    light.set(pixel, known);
                }
            }
        }
        (gathered, true)
    }

    /// All pixels, in order.
    pub(super) fn pixels(&self) -> &[u32] {
        &self.pixels
    }

    /// The results of all pixels, in the same order; `None` for those not done.
    pub(super) fn results(&self) -> &[Option<R>] {
        &self.results
    }

    /// The pixels that are done, by index in the picture, with their results.
    pub(super) fn done(&self) -> impl Iterator<Item = (usize, &R)> + Clone {
        let pairs = self.pixels.iter().zip(&self.results);
        pairs.filter_map(|(&pixel, result)| Some((pixel as usize, result.as_ref()?)))
    }

    /// The pixels that are not done, by index in the picture.
    pub(super) fn missing(&self) -> impl Iterator<Item = usize> {
        let pairs = self.pixels.iter().zip(&self.results);
        pairs.filter(|(_, result)| result.is_none()).map(|(&pixel, _)| pixel as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dispersed_order_keeps_the_order_of_rounds() {
        let mut pixels: Vec<u32> = (0..16 * 16).collect();
        pixels.sort_by_key(|&pixel| pass_of(pixel, 16));
        assert!(pixels.is_sorted_by_key(|&pixel| round_of(pixel, 16)));
    }
}
