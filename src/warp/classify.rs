//! Step 3: what is known of each pixel decides its type.
//!
//! Source: the paper, section 3, step 3. Type 3 is split by what is done about it; the paper traces them all.

use crate::raster::pixel_types::PixelType;
use crate::reference::ReferenceFrame;
use crate::warp::WarpBuffer;

/// The type of one pixel, by the sample that landed on it.
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
