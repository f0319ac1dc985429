//! Named views, and the views and camera paths generated for models that have none.

use crate::camera::{Camera, CameraKey, CameraPath};
use glam::{DQuat, DVec3};

/// A view of the scene with a name.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedView {
    /// Name shown to the user.
    pub name: String,
    /// Pose and field of view.
    pub camera: Camera,
}

/// Returns a view of the whole model from outside, given its bounding box in world metres.
pub(super) fn overview([low, high]: [DVec3; 2]) -> Camera {
    let centre = low + (high - low) / 2.0;
    let distance = (high - low).length();
    Camera::look_at(centre + DVec3::new(0.5, 0.35, 0.8) * distance, centre, Camera::DEFAULT_FOV_Y_DEG)
}

/// Returns a path once around the model from outside, which begins at its [`overview`].
pub(super) fn orbit([low, high]: [DVec3; 2]) -> CameraPath {
    const KEYS: i32 = 16;
    let start = overview([low, high]);
    let centre = low + (high - low) / 2.0;
    let key = |i: i32| {
        let turn = DQuat::from_rotation_y(f64::from(i) * std::f64::consts::TAU / f64::from(KEYS));
        CameraKey { eye: centre + turn * (start.eye - centre), at: centre }
    };
    CameraPath { fov_y_deg: start.fov_y.to_degrees(), frames: 240, keyframes: (0..=KEYS).map(key).collect() }
}
