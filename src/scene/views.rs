//! Named views, and the views and camera paths generated for models that have none.

use crate::camera::{Camera, CameraKey, CameraPath};
use glam::{DQuat, DVec3};
use std::f64::consts::TAU;

/// A view of the scene with a name.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedView {
    /// Name shown to the user.
    pub name: String,
    /// Pose and field of view.
    pub camera: Camera,
}

/// Tangent of the elevation from which a model is usually seen: 20 degrees, which shows walls and
/// roofs.
pub(crate) const USUAL_RISE: f64 = 0.37;

/// Share of the height of a picture, or of the width of one of 4:3, that the model may fill.
const FILLED: f64 = 0.92;

/// Returns a view from outside of a whole box in world metres, from in front and to the right:
/// `turn` radians further about +Y, from an elevation whose tangent is `rise`.
pub(crate) fn overview(building_m: [DVec3; 2], turn: f64, rise: f64) -> Camera {
    let azimuth = 0.5f64.atan2(0.8) + turn;
    let direction = DVec3::new(azimuth.sin(), rise, azimuth.cos());
    let [low, high] = building_m;
    let centre = low + (high - low) / 2.0;
    let camera = Camera::look_at(direction, DVec3::ZERO, Camera::DEFAULT_FOV_Y_DEG);
    let distance = fitting_distance(&camera, (high - low) / 2.0);
    Camera { eye: centre - camera.forward() * distance, ..camera }
}

/// Returns the distance from which a camera that looks at the centre of a box shows all of it.
fn fitting_distance(camera: &Camera, half: DVec3) -> f64 {
    let axes = camera.world_from_camera();
    let tan = (camera.fov_y / 2.0).tan() * FILLED;
    let sign = |i: u32, bit: u32| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
    let corners = (0..8).map(|i| half * DVec3::new(sign(i, 0), sign(i, 1), sign(i, 2)));
    let distance = |corner: DVec3| {
        let [right, up, back] = [axes.x_axis, axes.y_axis, axes.z_axis].map(|axis| axis.dot(corner));
        back + (right.abs() * 0.75).max(up.abs()) / tan
    };
    corners.map(distance).fold(0.0, f64::max)
}

/// Returns a path once around a box in world metres from outside, which begins at a view of its
/// centre.
pub(crate) fn orbit([low, high]: [DVec3; 2], start: &Camera) -> CameraPath {
    const KEYS: i32 = 16;
    let centre = low + (high - low) / 2.0;
    let key = |i: i32| {
        let turn = DQuat::from_rotation_y(f64::from(i) * TAU / f64::from(KEYS));
        CameraKey::new(centre + turn * (start.eye - centre), centre)
    };
    CameraPath { fov_y_deg: start.fov_y.to_degrees(), frames: 240, keyframes: (0..=KEYS).map(key).collect() }
}
