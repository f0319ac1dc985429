//! The radiance of a pixel: light straight from the sources, smooth light by paths, and what
//! mirrors and glass add.

mod bounces;
mod by_group;
mod cached_light;
mod diffuse;
mod dimension;
mod pixel;
mod rough_link;
mod specular;
mod tilt;

pub use bounces::MAX_PATH;
pub(crate) use bounces::{PathStop, SmoothSettings};
pub(crate) use by_group::{CachedGroups, GroupSettings};
pub use cached_light::{CachedLight, Reader};
pub use diffuse::{ArrivingLight, LightSettings};
pub use pixel::PixelTrace;
pub use specular::{MAX_BOUNCES, PathVertex, truncation_bound};
