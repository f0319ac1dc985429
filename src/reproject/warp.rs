//! Steps 1 and 2: every reference pixel is projected into the new view; of several on one pixel the nearest wins.
//!
//! Source: the paper, section 3, steps 1 and 2. We differ: ties go to the lower sample, so that the result does not
//! depend on the order of threads.

use crate::camera::View;
use crate::reference::{PixelWarp, ReferenceFrame};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};

/// References a warp takes at most: their number shares 32 bits with the pixel's.
pub const MAX_REFERENCES: usize = 32;

const PIXEL_BITS: u32 = 27;

/// Pixels a reference may have: 16384 x 8192.
pub const MAX_REFERENCE_PIXELS: usize = 1 << PIXEL_BITS;

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
    keys: Vec<AtomicU64>,
}

impl WarpBuffer {
    /// The winning sample of a pixel and its disparity in the new view; `None` where nothing landed.
    #[inline]
    pub fn sample(&self, pixel: usize) -> Option<(SampleId, f32)> {
        let key = self.keys[pixel].load(Ordering::Relaxed);
        (key != 0).then(|| (SampleId(!(key as u32)), f32::from_bits((key >> 32) as u32)))
    }

    /// Takes references and a view; leaves the nearest sample per target pixel. Never traces a ray.
    ///
    /// # Panics
    /// With more than [`MAX_REFERENCES`] references or [`MAX_REFERENCE_PIXELS`] pixels in one.
    pub fn warp(&mut self, references: &[&ReferenceFrame], view: &View) {
        assert!(references.len() <= MAX_REFERENCES, "a warp takes at most {MAX_REFERENCES} references");
        self.keys.resize_with(view.pixel_count(), AtomicU64::default);
        self.keys.par_iter_mut().with_min_len(1 << 14).for_each(|k| *k.get_mut() = 0);
        for (slot, reference) in references.iter().enumerate() {
            assert!(reference.view.pixel_count() <= MAX_REFERENCE_PIXELS, "reference too large");
            splat(reference, (slot as u32) << PIXEL_BITS, view, &self.keys);
        }
    }
}

fn splat(reference: &ReferenceFrame, first_id: u32, view: &View, keys: &[AtomicU64]) {
    let warp = PixelWarp::new(&reference.view, view);
    let (width, target_width) = (reference.view.size[0] as usize, view.size[0]);
    reference.disparity().par_chunks(width).enumerate().with_min_len(8).for_each(|(y, row)| {
        for (x, &disparity) in row.iter().enumerate() {
            let Some((tx, ty, disparity)) = warp.target(x as u32, y as u32, disparity) else { continue };
            let id = first_id + (y * width + x) as u32;
            let key = u64::from(disparity.to_bits()) << 32 | u64::from(!id);
            let cell = &keys[(ty * target_width + tx) as usize];
            // Most samples lose or are alone; the plain load spares them a locked instruction.
            if cell.load(Ordering::Relaxed) < key {
                cell.fetch_max(key, Ordering::Relaxed);
            }
        }
    });
}
