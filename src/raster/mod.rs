//! Pictures as flat buffers, and the way from linear radiance to what a screen or a file shows.

#[cfg(any(feature = "import", feature = "pictures"))]
pub mod atomic_file;
pub mod color;
pub mod fill;
#[cfg(feature = "pictures")]
pub mod load;
#[cfg(feature = "pictures")]
pub mod metrics;
pub mod pixel_types;
#[cfg(feature = "pictures")]
pub mod save;
#[cfg(feature = "pictures")]
pub mod stream;
