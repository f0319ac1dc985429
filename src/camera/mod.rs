//! The pinhole camera: [`Camera`] is a pose in the world, [`View`] the same pose in scene space
//! with a picture size.
//!
//! # Other projections
//! Panoramas (`render/panorama/`) and orthographic pictures (`render/orthographic.rs`) are no
//! [`View`]: they are made from views, or have one for each pixel. Code outside this module relies
//! on three properties of a view:
//!
//! - A ray starts at `eye` and its direction is a linear function of the picture point:
//!   `scene_from_pixel * (x, y, 1)`.
//! - Camera-space z of a direction is one, so that `t` along a ray is a depth, and a disparity is
//!   `1 / t`. The warp equation ([`PixelWarp`]) needs this.
//! - The rays of a rectangle of pixels lie in a frustum with flat sides, against which
//!   `trace/bvh/tile.rs` tests nodes.

pub mod path;
pub mod pixel_warp;

#[cfg(feature = "import")]
pub use path::CameraPathError;
pub use path::{CameraKey, CameraPath};
pub use pixel_warp::{PixelWarp, RowWarp};

use glam::{DMat3, DVec3, Mat3, Vec3};
use serde::{Deserialize, Serialize};

/// Minimum depth of a stored hit in scene units, a millionth of the scene's diagonal. At smaller
/// depths a pixel's footprint is below the rounding of positions.
pub const NEAREST_DEPTH: f32 = 1.0 / 1024.0;

/// A viewer's pose in world space: metres, +Y up. In f64, so that it is precise far from the
/// origin.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Camera {
    /// Position of the eye, world metres.
    pub eye: DVec3,
    /// Heading about +Y in radians. 0 looks along -Z; positive values turn left.
    pub yaw: f64,
    /// Elevation in radians, -pi/2..pi/2.
    pub pitch: f64,
    /// Vertical field of view in radians.
    pub fov_y: f64,
    /// Rotation about the viewing direction in radians. Positive values lean the viewer's head to
    /// the right. Only cameras of models, and views made from them, have a roll; levelling the view
    /// removes it.
    #[serde(default, skip_serializing_if = "is_level")]
    pub roll: f64,
}

fn is_level(roll: &f64) -> bool {
    *roll == 0.0
}

impl Camera {
    /// Range of valid vertical fields of view in degrees. Beyond it a picture plane makes no sense.
    pub const FOV_Y_DEGREES: std::ops::RangeInclusive<f64> = 1.0..=170.0;

    /// Default vertical field of view in degrees. At this angle rooms look neither flat nor
    /// stretched.
    pub const DEFAULT_FOV_Y_DEG: f64 = 60.0;

    /// Height of a standing viewer's eye above the floor, metres.
    pub const EYE_HEIGHT_M: f64 = 1.6;

    /// Creates a camera at `eye` that looks at `target`, or along -Z if the two are the same point.
    /// The field of view is clamped to [`Self::FOV_Y_DEGREES`].
    pub fn look_at(eye: DVec3, target: DVec3, fov_y_degrees: f64) -> Self {
        let d = (target - eye).try_normalize().unwrap_or(DVec3::NEG_Z);
        let range = Self::FOV_Y_DEGREES;
        Self {
            eye,
            yaw: (-d.x).atan2(-d.z),
            pitch: d.y.clamp(-1.0, 1.0).asin(),
            fov_y: fov_y_degrees.clamp(*range.start(), *range.end()).to_radians(),
            roll: 0.0,
        }
    }

    /// Returns this camera with the roll with which its upward axis is closest to `up`.
    #[must_use]
    pub fn with_up(self, up: DVec3) -> Self {
        let level = Self { roll: 0.0, ..self };
        let axes = level.world_from_camera();
        Self { roll: up.dot(axes.x_axis).atan2(up.dot(axes.y_axis)), ..self }
    }

    /// Rotation with the columns right, up and backward in world space. Built from sines and
    /// cosines, so that it is orthonormal even when looking straight up.
    pub fn world_from_camera(&self) -> DMat3 {
        let (sy, cy) = self.yaw.sin_cos();
        let (sp, cp) = self.pitch.sin_cos();
        let (right, up) = (DVec3::new(cy, 0.0, -sy), DVec3::new(sy * sp, cp, cy * sp));
        let backward = DVec3::new(sy * cp, -sp, cy * cp);
        if self.roll == 0.0 {
            return DMat3::from_cols(right, up, backward);
        }
        let (sr, cr) = self.roll.sin_cos();
        DMat3::from_cols(right * cr - up * sr, up * cr + right * sr, backward)
    }

    /// Unit viewing direction in world space.
    pub fn forward(&self) -> DVec3 {
        -self.world_from_camera().z_axis
    }

    /// True if every number is finite and the field of view is within [`Self::FOV_Y_DEGREES`].
    pub fn is_valid(&self) -> bool {
        let angles = [self.yaw, self.pitch, self.roll];
        let finite = self.eye.is_finite() && angles.iter().all(|angle| angle.is_finite());
        // Allow for the rounding between degrees and radians.
        finite && (0.99..170.01).contains(&self.fov_y.to_degrees())
    }
}

/// Transform between world metres and scene units.
///
/// World space has the model's own coordinates, in metres. Scene space has its origin near the
/// model's centre, and its diagonal is scaled to 512..1024 by a power of two. The same model at
/// another place or another power-of-two size therefore has the same bits in scene space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneFrame {
    /// World position of the scene-space origin, metres.
    pub origin_in_world_m: DVec3,
    /// Scene units per metre, a power of two.
    pub units_per_metre: f64,
}

impl SceneFrame {
    /// Scene-space position of a world position in metres, before rounding to f32.
    pub fn scene_from_world_f64(&self, world_m: DVec3) -> DVec3 {
        (world_m - self.origin_in_world_m) * self.units_per_metre
    }

    /// World position, in metres, of a scene-space position.
    pub fn world_from_scene(&self, scene: Vec3) -> DVec3 {
        scene.as_dvec3() / self.units_per_metre + self.origin_in_world_m
    }
}

/// A camera in scene space, in f32, together with the size of its picture.
///
/// Camera space is +X right, +Y down, +Z forward, so that a pixel's column and row grow with x and
/// y. The direction through the picture point (x, y), in pixels, is `scene_from_pixel * (x, y, 1)`.
/// Its camera-space z is one, so a distance along it is a depth. The module lists what another
/// projection would have to change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Eye in scene space.
    pub eye: Vec3,
    /// Eye in scene space before rounding, for differences between two eyes.
    pub eye_f64: DVec3,
    /// Rotation with the columns right, down and forward in scene space; orthonormal.
    pub scene_from_camera: Mat3,
    /// Scene-space direction of the picture point (x, y, 1), x and y in pixels.
    pub scene_from_pixel: Mat3,
    /// [`Self::scene_from_pixel`] before rounding, for the product with another view's inverse.
    pub scene_from_pixel_f64: DMat3,
    /// Half the height of the picture on the plane at depth one.
    pub tan_half_fov_y: f32,
}

impl View {
    /// Creates the view of a camera in a scene, for a picture of `size` pixels.
    pub fn new(camera: &Camera, frame: &SceneFrame, size: [u32; 2]) -> Self {
        let m = camera.world_from_camera();
        let axes = DMat3::from_cols(m.x_axis, -m.y_axis, -m.z_axis);
        let tan = (camera.fov_y / 2.0).tan();
        let (w, h) = (f64::from(size[0].max(1)), f64::from(size[1].max(1)));
        let step = 2.0 * tan / h;
        let camera_from_pixel = DMat3::from_cols(
            DVec3::new(step, 0.0, 0.0),
            DVec3::new(0.0, step, 0.0),
            DVec3::new(-step * w / 2.0, -tan, 1.0),
        );
        let eye_f64 = frame.scene_from_world_f64(camera.eye);
        Self {
            size,
            eye: eye_f64.as_vec3(),
            eye_f64,
            scene_from_camera: axes.as_mat3(),
            scene_from_pixel: (axes * camera_from_pixel).as_mat3(),
            scene_from_pixel_f64: axes * camera_from_pixel,
            tan_half_fov_y: tan as f32,
        }
    }

    /// Returns the view with the ray of every pixel moved by a number of pixels right and down, for
    /// sub-pixel offsets.
    #[must_use]
    pub fn shifted(&self, [right, down]: [f64; 2]) -> Self {
        if [right, down] == [0.0; 2] {
            return *self;
        }
        let mut m = self.scene_from_pixel_f64;
        m.z_axis += m.x_axis * right + m.y_axis * down;
        Self { scene_from_pixel: m.as_mat3(), scene_from_pixel_f64: m, ..*self }
    }

    /// Number of pixels.
    pub fn pixel_count(&self) -> usize {
        self.size[0] as usize * self.size[1] as usize
    }

    /// Scene-space direction through the centre of a pixel, given by its row-major index. Its
    /// camera-space z is one.
    pub fn direction_of_pixel(&self, pixel: u32) -> Vec3 {
        let (x, y) = (pixel % self.size[0], pixel / self.size[0]);
        self.direction_of_point(x as f32 + 0.5, y as f32 + 0.5)
    }

    /// Scene-space direction through a point of the picture, in pixels from the top left corner.
    pub fn direction_of_point(&self, x: f32, y: f32) -> Vec3 {
        self.scene_from_pixel * Vec3::new(x, y, 1.0)
    }

    /// Distance between neighbouring pixels on a surface that faces the viewer, scene units, at `t`
    /// along a primary ray of this direction.
    pub fn footprint(&self, direction: Vec3, t: f32) -> f32 {
        self.scene_from_pixel.x_axis.length() * t * direction.length()
    }

    /// Returns `self.eye - other.eye` in scene space, rounded only once.
    pub fn eye_relative_to(&self, other: &View) -> Vec3 {
        (self.eye_f64 - other.eye_f64).as_vec3()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A roll turns right and up about the viewing direction; none keeps the bits.
    #[test]
    fn a_camera_with_an_upward_axis_has_it() {
        for (pitch, roll) in [(0.0, 0.3), (-1.2, -2.0), (0.7, 3.0), (std::f64::consts::FRAC_PI_2, 0.5)] {
            let level = Camera { yaw: 0.9, pitch, ..Camera::look_at(DVec3::ONE, DVec3::ZERO, 60.0) };
            let axes = Camera { roll, ..level }.world_from_camera();
            assert!(
                (axes.transpose() * axes - DMat3::IDENTITY).to_cols_array().iter().all(|n| n.abs() < 1e-14)
            );
            assert_eq!(axes.z_axis, level.world_from_camera().z_axis);
            let found = level.with_up(axes.y_axis);
            assert!((found.roll - roll).abs() < 1e-14, "{}", found.roll);
            assert!(roll < 0.0 || axes.y_axis.dot(level.world_from_camera().x_axis) > 0.0, "to the right");
        }
    }
}
