//! Directions of the pixels of an equirectangular picture.

use crate::camera::{Camera, SceneFrame, View};
use glam::{DMat3, DVec3};
use std::f64::consts::{PI, TAU};

/// Equirectangular projection: columns are longitudes, rows are latitudes. The middle of the
/// picture looks horizontally along the camera's heading; its left and right edges meet behind the
/// viewer, its first row is above the viewer and its last row below.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Equirectangular {
    size: [u32; 2],
    yaw: f64,
}

impl Equirectangular {
    /// Creates the projection of a picture of `size` pixels, at least one, whose middle looks along
    /// the heading of a camera. Pitch and roll of the camera are ignored: the picture is level.
    pub fn new(camera: &Camera, size: [u32; 2]) -> Self {
        Self { size: size.map(|side| side.max(1)), yaw: camera.yaw }
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Angle between two neighbouring columns on the horizon, radians.
    pub fn column_angle(&self) -> f64 {
        TAU / f64::from(self.size[0])
    }

    /// Heading of a column position in pixels from the left edge, as [`Camera::yaw`], radians.
    pub fn yaw_of(&self, x: f64) -> f64 {
        self.yaw - (x / f64::from(self.size[0]) - 0.5) * TAU
    }

    /// Elevation of a row position in pixels from the top edge, radians.
    pub fn pitch_of(&self, y: f64) -> f64 {
        (0.5 - y / f64::from(self.size[1])) * PI
    }

    /// Unit direction of a point of the picture, in pixels from the top left corner. World and
    /// scene space have the same directions.
    pub fn direction(&self, [x, y]: [f64; 2]) -> DVec3 {
        let ((sin_yaw, cos_yaw), (sin, cos)) = (self.yaw_of(x).sin_cos(), self.pitch_of(y).sin_cos());
        DVec3::new(-sin_yaw * cos, sin, -cos_yaw * cos)
    }

    /// The point of the picture, in pixels, that shows a direction of any length: the inverse of
    /// [`Self::direction`]. Its x is from 0 to the width, without the latter.
    pub fn point(&self, direction: DVec3) -> [f64; 2] {
        let [width, height] = self.size.map(f64::from);
        let turn = (self.yaw - (-direction.x).atan2(-direction.z)) / TAU + 0.5;
        let pitch = direction.y.atan2(direction.x.hypot(direction.z));
        // The remainder of a tiny negative number is rounded to one.
        let part = turn.rem_euclid(1.0);
        [if part < 1.0 { part * width } else { 0.0 }, (0.5 - pitch / PI) * height]
    }

    /// A pinhole view whose ray through the centre of `pixel`, a row-major index, is that of the
    /// panorama, moved by `offset` pixels: the plane that touches the sphere there. Only this pixel
    /// of it means anything. Its random numbers are those of the pixel's place in the panorama.
    pub fn tangent_view(&self, camera: &Camera, frame: &SceneFrame, pixel: u32, offset: [f64; 2]) -> View {
        let [column, row] = [pixel % self.size[0], pixel / self.size[0]].map(f64::from);
        let (x, y) = (column + 0.5, row + 0.5);
        let forward = self.direction([x + offset[0], y + offset[1]]);
        let (sin_yaw, cos_yaw) = self.yaw_of(x + offset[0]).sin_cos();
        let right = DVec3::new(cos_yaw, 0.0, -sin_yaw);
        let down = forward.cross(right);
        // Near the poles columns are closer together; footprints are those of the rows everywhere.
        let step = PI / f64::from(self.size[1]);
        let eye_f64 = frame.scene_from_world_f64(camera.eye);
        let matrix = DMat3::from_cols(right * step, down * step, forward - (right * x + down * y) * step);
        View {
            size: self.size,
            eye: eye_f64.as_vec3(),
            eye_f64,
            scene_from_camera: DMat3::from_cols(right, down, forward).as_mat3(),
            scene_from_pixel: matrix.as_mat3(),
            scene_from_pixel_f64: matrix,
            tan_half_fov_y: (step * f64::from(self.size[1]) / 2.0) as f32,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn projection(yaw: f64) -> Equirectangular {
        Equirectangular::new(&Camera { yaw, ..Camera::look_at(DVec3::ZERO, DVec3::NEG_Z, 60.0) }, [64, 32])
    }

    #[test]
    fn points_and_directions_are_inverse_and_the_middle_is_the_heading() {
        for yaw in [0.0, 1.0, -2.5, 7.0] {
            let p = projection(yaw);
            let camera = Camera { yaw, ..Camera::look_at(DVec3::ZERO, DVec3::NEG_Z, 60.0) };
            assert!((p.direction([32.0, 16.0]) - camera.forward()).length() < 1e-12);
            // A quarter of the picture to the right is to the right of the camera.
            let right = p.direction([48.0, 16.0]);
            assert!((right - camera.world_from_camera().x_axis).length() < 1e-12);
            assert!((p.direction([10.0, 0.0]) - DVec3::Y).length() < 1e-12);
            assert!((p.direction([0.0, 16.0]) - p.direction([64.0, 16.0])).length() < 1e-12, "edges meet");
            for point in [[0.0, 0.5], [0.25, 16.0], [31.0, 1.0], [63.9, 31.5]] {
                let found = p.point(p.direction(point) * 3.0);
                assert!(
                    (found[0] - point[0]).abs() < 1e-9 && (found[1] - point[1]).abs() < 1e-9,
                    "{found:?}"
                );
            }
        }
    }

    #[test]
    fn a_tangent_view_has_the_direction_of_its_pixel_and_unit_depth() {
        let p = projection(0.7);
        let camera = Camera::look_at(DVec3::new(1.0, 2.0, 3.0), DVec3::ZERO, 60.0);
        let frame = SceneFrame { origin_in_world_m: DVec3::ZERO, units_per_metre: 64.0 };
        for pixel in [0, 31, 63, 64 * 15 + 20, 64 * 31, 64 * 32 - 1] {
            for offset in [[0.0, 0.0], [-0.5, 0.25]] {
                let view = p.tangent_view(&camera, &frame, pixel, offset);
                let (x, y) = (f64::from(pixel % 64) + 0.5, f64::from(pixel / 64) + 0.5);
                let right = p.direction([x + offset[0], y + offset[1]]);
                let found = view.direction_of_pixel(pixel);
                assert!((found.as_dvec3() - right).length() < 1e-5, "{found} {right}");
                let depth = view.scene_from_camera.z_axis.dot(found);
                assert!((depth - 1.0).abs() < 1e-5, "{depth}");
                let axes = view.scene_from_camera;
                assert!((axes.transpose() * axes - glam::Mat3::IDENTITY).x_axis.length() < 1e-5);
                assert!(axes.determinant() > 0.9, "right, down and forward");
            }
        }
    }
}
