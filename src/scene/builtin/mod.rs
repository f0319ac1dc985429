//! The embedded scenes: a gallery to walk through, and small ones whose pictures are known.

mod cornell;
mod furnace;
#[cfg(feature = "pictures")]
mod gallery;
mod mirrors;
#[cfg_attr(
    not(feature = "pictures"),
    allow(dead_code, unused_imports, reason = "the gallery uses most of them")
)]
mod shapes;

#[cfg(feature = "pictures")]
pub use gallery::statue_hall;

use super::{NamedView, Scene, SceneBuilder, SceneError};
use crate::camera::Camera;
use crate::camera::{CameraKey, CameraPath};
use glam::DVec3;

/// Names of the embedded scenes; the first is the default. The gallery's textures are PNG files, so it is there only
/// with the feature `pictures`.
pub const NAMES: &[&str] = &[
    #[cfg(feature = "pictures")]
    "gallery",
    "cornell",
    "cornell-glass",
    "mirrors",
    "furnace",
];

/// Builds an embedded scene.
///
/// # Errors
/// [`SceneError::UnknownBuiltin`] where there is none of that name.
pub fn build(name: &str) -> Result<Scene, SceneError> {
    let mut b = SceneBuilder::new(&format!("builtin:{name}"));
    match name {
        #[cfg(feature = "pictures")]
        "gallery" => gallery::add_to(&mut b)?,
        "cornell" => cornell::add_to(&mut b, cornell::Contents::Boxes),
        "cornell-glass" => cornell::add_to(&mut b, cornell::Contents::Spheres),
        "mirrors" => mirrors::add_to(&mut b),
        "furnace" => furnace::add_to(&mut b),
        _ => {
            return Err(SceneError::UnknownBuiltin { name: name.to_owned(), known: NAMES.join(", ") });
        }
    }
    b.finish()
}

fn view(name: &str, eye: [f64; 3], at: [f64; 3], fov_y_deg: f64) -> NamedView {
    NamedView { name: name.to_owned(), camera: Camera::look_at(eye.into(), at.into(), fov_y_deg) }
}

/// A walk from pairs of eye and point looked at.
fn walk(keys: &[([f64; 3], [f64; 3])], frames: u32, fov_y_deg: f64) -> CameraPath {
    let key = |&(eye, at): &([f64; 3], [f64; 3])| CameraKey { eye: DVec3::from(eye), at: DVec3::from(at) };
    CameraPath { fov_y_deg, frames, keyframes: keys.iter().map(key).collect() }
}
