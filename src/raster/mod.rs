//! Pictures as flat buffers: colour, pixel types, comparison, and reading and writing files.

#[cfg(feature = "films")]
pub mod animation;
#[cfg(any(feature = "import", feature = "pictures"))]
pub mod atomic_file;
pub mod color;
pub mod exposure;
pub mod false_color;
pub mod fill;
#[cfg(feature = "films")]
pub mod film;
#[cfg(feature = "pictures")]
pub mod jpeg;
pub mod legend;
#[cfg(feature = "pictures")]
pub mod load;
#[cfg(feature = "pictures")]
pub mod metrics;
pub mod pixel_types;
pub mod rgb9e5;
pub mod rgbe;
#[cfg(feature = "pictures")]
pub mod save;
#[cfg(feature = "pictures")]
pub mod stream;
