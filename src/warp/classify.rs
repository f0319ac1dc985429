//! The paper's step 3: the type of each pixel, by the sample that landed on it.
//!
//! Source: the paper, section 3, step 3. We differ: pixels of the sky have information (a direction
//! instead of a point).

use crate::raster::pixel_types::PixelType;
use crate::reference::ReferenceFrame;
use crate::warp::WarpBuffer;

/// Returns Type 1 for a sample without reflections, Type 2 for one with reflections, and Type 3
/// where no sample landed.
#[inline]
pub fn classify(warped: &WarpBuffer, references: &[&ReferenceFrame], pixel: usize) -> PixelType {
    match warped.sample(pixel) {
        None => PixelType::Unseen,
        Some((sample, _)) => match references[sample.slot()].reflections(sample.pixel()) {
            0 => PixelType::Reused,
            _ => PixelType::Secondary,
        },
    }
}
