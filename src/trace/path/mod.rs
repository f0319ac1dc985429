//! The radiance of a pixel: its diffuse light, the bounces of that light, and what mirrors and
//! glass add.

mod bounces;
mod diffuse;
mod dimension;
mod pixel;
mod specular;

pub use pixel::PixelTrace;
pub use specular::{MAX_BOUNCES, PathVertex, truncation_bound};
