//! Views and camera paths of the embedded scenes.

use crate::camera::{Camera, CameraKey, CameraPath};
use crate::scene::NamedView;
use glam::DVec3;

pub(super) fn view(name: &str, eye: [f64; 3], at: [f64; 3], fov_y_deg: f64) -> NamedView {
    NamedView { name: name.to_owned(), camera: Camera::look_at(eye.into(), at.into(), fov_y_deg) }
}

/// Returns a camera path through pairs of the eye and the point it looks at.
pub(super) fn walk(keys: &[([f64; 3], [f64; 3])], frames: u32, fov_y_deg: f64) -> CameraPath {
    let key = |&(eye, at): &([f64; 3], [f64; 3])| CameraKey::new(DVec3::from(eye), DVec3::from(at));
    CameraPath { fov_y_deg, frames, keyframes: keys.iter().map(key).collect() }
}
