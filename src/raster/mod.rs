//! Pictures as flat buffers, and the way from linear radiance to what a screen or a file shows.

pub mod color;
pub mod fill;
pub mod load;
pub mod metrics;
pub mod pixel_types;
pub mod save;
pub mod stream;
