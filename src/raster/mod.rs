//! Pictures as flat buffers, and the way from linear radiance to what a screen or a file shows.

pub mod buffer;
pub mod color;

pub use buffer::Buffer2d;
