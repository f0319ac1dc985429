//! Lists of pixels that are still to be traced, and the order in which they are.

use crate::trace::parallel::{Stop, trace_missing};
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
    pub(super) fn disperse(&mut self, dispersal: &mut Dispersal, width: u32, may_wait: impl Fn(u32) -> bool) {
        dispersal.passes.iter_mut().flatten().for_each(Vec::clear);
        for &pixel in &self.pixels {
            dispersal.passes[usize::from(may_wait(pixel))][pass_of(pixel, width)].push(pixel);
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
