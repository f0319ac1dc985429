//! Steps 1 and 2: every reference pixel is projected into the new view; of several on one pixel the nearest wins.
//!
//! Source: the paper, section 3, steps 1 and 2. We differ: ties go to the lower sample, so that the result does not
//! depend on the order of threads. The picture is cut into bands of rows and each thread takes one at a time, alone
//! (`band`); a tile of a reference is looked at for those bands only that it can reach (`reach`).

use crate::camera::View;
use crate::reference::ReferenceFrame;
use crate::warp::band::Band;
use crate::warp::reach::Source;
use fearless_simd::Level;
use rayon::prelude::*;

/// References a warp takes at most: their number shares 32 bits with the pixel's.
pub const MAX_REFERENCES: usize = 32;

const PIXEL_BITS: u32 = 27;

/// Pixels a reference may have: 16384 x 8192.
pub const MAX_REFERENCE_PIXELS: usize = 1 << PIXEL_BITS;

/// Keys of a band at most, 2 MB, so that several references are warped there one after the other from the caches: four
/// references to 1280x720 take 1.2 to 1.3 ns per pixel in four bands, 2.0 to 2.4 in one. Sixteen bands take 6 to 26 %
/// more than four, for tiles that reach two.
const MAX_KEYS_IN_BAND: usize = 1 << 18;

/// Bands for each thread: the parts of a view take unequal times.
const BANDS_PER_THREAD: usize = 3;

/// A pixel of one of the references of a warp.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SampleId(u32);

impl SampleId {
    /// Index into the references given to the warp.
    pub fn slot(self) -> usize {
        (self.0 >> PIXEL_BITS) as usize
    }

    /// Row-major pixel index in that reference.
    pub fn pixel(self) -> u32 {
        self.0 & (MAX_REFERENCE_PIXELS as u32 - 1)
    }
}

/// The nearest sample of each target pixel, 8 bytes each: disparity in the upper half, sample in the lower.
///
/// Disparities are not negative, so their bits order as they do and one integer maximum decides nearness and ties.
#[derive(Debug, Default)]
pub struct WarpBuffer {
    keys: Vec<u64>,
}

impl WarpBuffer {
    /// The winning sample of a pixel and its disparity in the new view; `None` where nothing landed.
    #[inline]
    pub fn sample(&self, pixel: usize) -> Option<(SampleId, f32)> {
        let key = self.keys[pixel];
        (key != 0).then(|| (SampleId(!(key as u32)), f32::from_bits((key >> 32) as u32)))
    }

    /// Takes references and a view; leaves the nearest sample per target pixel. Never traces a ray.
    ///
    /// # Panics
    /// With more than [`MAX_REFERENCES`] references or [`MAX_REFERENCE_PIXELS`] pixels in one.
    pub fn warp(&mut self, references: &[&ReferenceFrame], view: &View) {
        self.warp_at(Level::new(), references, view);
    }

    /// [`Self::warp`] with the instructions of a level, instead of the best there are: for the tests that compare them.
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
