//! The paper's steps 1 and 2: every reference pixel is projected into the new view; where several
//! land on one pixel, the nearest wins.
//!
//! Source: the paper, section 3, steps 1 and 2. We differ: ties go to the lower sample, so that the
//! result does not depend on the order of threads. The picture is divided into bands of rows, each
//! filled by one thread (`band`). A tile of a reference is processed only for those bands that it
//! can reach (`source`).

use crate::camera::View;
use crate::reference::ReferenceFrame;
use crate::warp::{band::Band, source::Source};
use fearless_simd::Level;
use rayon::prelude::*;

/// Maximum number of references in a warp: the reference's number shares 32 bits with the pixel's.
pub const MAX_REFERENCES: usize = 32;

const PIXEL_BITS: u32 = 27;

/// Maximum number of pixels of a reference: 16384 x 8192.
pub const MAX_REFERENCE_PIXELS: usize = 1 << PIXEL_BITS;

/// Maximum number of keys in a band: 2 MB, so that the band stays in the caches while several
/// references are warped into it. Four references into 1280x720 take 1.2 to 1.3 ns per pixel in
/// four bands, 2.0 to 2.4 ns in one. Sixteen bands take 6 to 26 % longer than four, because of
/// tiles that reach two bands.
const MAX_KEYS_IN_BAND: usize = 1 << 18;

/// Number of bands per thread. More than one, because the parts of a view take unequal times.
const BANDS_PER_THREAD: usize = 3;

/// A pixel of one of the references in a warp.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SampleId(u32);

impl SampleId {
    /// Index of the reference, in the order given to the warp.
    pub fn slot(self) -> usize {
        (self.0 >> PIXEL_BITS) as usize
    }

    /// Row-major pixel index in that reference.
    pub fn pixel(self) -> u32 {
        self.0 & (MAX_REFERENCE_PIXELS as u32 - 1)
    }
}

/// Nearest sample of each target pixel, in 8 bytes: disparity in the upper half, sample in the
/// lower half.
///
/// Disparities are not negative, so they have the order of their bits. One integer maximum decides
/// both the nearest sample and ties.
#[derive(Debug, Default)]
pub struct WarpBuffer {
    keys: Vec<u64>,
}

impl WarpBuffer {
    /// Nearest sample of a pixel and its disparity in the new view; `None` where no sample landed.
    #[inline]
    pub fn sample(&self, pixel: usize) -> Option<(SampleId, f32)> {
        let key = self.keys[pixel];
        (key != 0).then(|| (SampleId(!(key as u32)), f32::from_bits((key >> 32) as u32)))
    }

    /// Warps references into a view and keeps the nearest sample of each pixel. Traces no rays.
    ///
    /// # Panics
    /// If there are more than [`MAX_REFERENCES`] references, or one has more than
    /// [`MAX_REFERENCE_PIXELS`] pixels.
    pub fn warp(&mut self, references: &[&ReferenceFrame], view: &View) {
        self.warp_at(crate::math::simd::level(), references, view);
    }

    /// [`Self::warp`] with the SIMD instructions of a given level, for tests that compare the
    /// levels.
    ///
    /// # Panics
    /// As [`Self::warp`].
    pub fn warp_at(&mut self, level: Level, references: &[&ReferenceFrame], view: &View) {
        assert!(references.len() <= MAX_REFERENCES, "a warp takes at most {MAX_REFERENCES} references");
        let largest = references.iter().map(|r| r.view.pixel_count()).max();
        assert!(largest.is_none_or(|pixels| pixels <= MAX_REFERENCE_PIXELS), "reference too large");
        let sources: Vec<Source<'_>> =
            references.iter().zip(0..).map(|(r, slot)| Source::new(r, view, slot << PIXEL_BITS)).collect();
        let count = view.pixel_count();
        self.keys.resize(count, 0);
        let [width, height] = view.size;
        let bands = count.div_ceil(MAX_KEYS_IN_BAND).max(BANDS_PER_THREAD * rayon::current_num_threads());
        let rows = height.div_ceil(bands as u32).max(1);
        let keys = (rows as usize * width as usize).max(1);
        self.keys.par_chunks_mut(keys).zip(0..u32::MAX).for_each(|(keys, band)| {
            let rows = band * rows..height.min((band + 1) * rows);
            Band { keys, rows, width }.fill(level, &sources);
        });
    }
}
