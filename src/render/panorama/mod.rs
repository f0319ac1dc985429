//! Panoramas: pictures of all directions around an eye, in equirectangular projection.
//!
//! [`crate::camera::View`] is a pinhole, on which first hits and look-ups rely. A panorama is
//! therefore not a view of its own. Mode `full` traces the ray of each pixel ([`TracedPanorama`]).
//! Modes `exact` and `fast` light references of the six faces of a cube around the eye
//! ([`LitPanorama`]), look their light up in pinhole pictures that cover the sphere patch by patch,
//! and interpolate the pixels of the panorama between theirs. All patches look up the same light,
//! so they agree where they meet.
//!
//! Both render bands of rows, from the top, so that memory does not grow with the picture.

mod lit;
mod patches;
mod picture;
mod projection;
mod resample;
mod run;
#[cfg(test)]
mod tests;
pub(super) mod traced;

pub use lit::LitPanorama;
pub use picture::{Panorama, PanoramaBand, PanoramaError};
pub use projection::Equirectangular;
pub use run::PanoramaStats;
pub use traced::TracedPanorama;
