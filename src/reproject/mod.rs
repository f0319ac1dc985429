//! The paper's steps 1 to 3, and what is shown while step 3 is not done: pure functions of buffers. Nothing here traces
//! a ray.

mod band;
pub mod classify;
pub mod fill;
mod reach;
pub mod warp;

pub use classify::{PixelMap, PixelType, TypeCounts};
pub use warp::{SampleId, WarpBuffer};
