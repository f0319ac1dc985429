//! The half of all directions that an eye sees, as luminances of equal solid angles.

use crate::camera::Camera;
use crate::math::{Ray, key::Key};
use crate::raster::color::luminance;
use crate::trace::{RayCounts, TraceSettings, Tracer, parallel::Stop};
use glam::{Vec2, Vec3};
use rayon::prelude::*;
use std::f32::consts::PI;

/// Luminances of the directions before an eye, in Lambert's equal-area projection: all pixels of the
/// disk have the same solid angle.
#[derive(Clone, Debug)]
pub struct Fisheye {
    /// Width and height in pixels.
    pub side: usize,
    /// Unit vector of the line of sight.
    pub ahead: Vec3,
    /// Unit vector upwards, at right angles to it.
    pub up: Vec3,
    /// Luminance of each pixel in cd/m2, row-major from the top; zero outside the disk.
    pub luminance: Vec<f32>,
}

/// The disk of the sun as an eye sees it. Rays of pictures do not meet it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenSun {
    /// Unit vector to its middle.
    pub direction: Vec3,
    /// Mean luminance of the part that is seen, cd/m2.
    pub luminance: f64,
    /// Solid angle of that part, steradians.
    pub solid_angle: f64,
}

/// Rays to the disk of the sun, along each side of a square.
const SUN_RAYS: u32 = 16;

impl Fisheye {
    /// A dark view.
    pub fn new(side: usize, ahead: Vec3, up: Vec3) -> Self {
        let up = (up - ahead * up.dot(ahead)).normalize_or(ahead.any_orthonormal_vector());
        Self { side, ahead, up, luminance: vec![0.0; side * side] }
    }

    /// The directions before a camera. The axes of world and scene are the same.
    pub fn of_camera(camera: &Camera, side: usize) -> Self {
        let world_from_camera = camera.world_from_camera();
        let ahead = -world_from_camera.z_axis.as_vec3();
        Self::new(side, ahead, world_from_camera.y_axis.as_vec3())
    }

    /// Solid angle of a pixel, steradians: the disk of radius sqrt(2) is the half sphere.
    pub fn pixel_solid_angle(&self) -> f64 {
        8.0 / (self.side * self.side) as f64
    }

    /// Unit vector to the middle of a pixel; `None` outside the disk.
    pub fn direction(&self, pixel: usize) -> Option<Vec3> {
        self.direction_at(pixel, Vec2::splat(0.5))
    }

    /// Unit vector to a point of a pixel, 0..1; `None` outside the disk.
    fn direction_at(&self, pixel: usize, point: Vec2) -> Option<Vec3> {
        let at = Vec2::new((pixel % self.side) as f32, (pixel / self.side) as f32) + point;
        let at = (at / self.side as f32 * 2.0 - 1.0) * std::f32::consts::SQRT_2;
        let square = at.length_squared();
        if square > 2.0 {
            return None;
        }
        // Lambert 1772: the distance from the middle is 2 sin (angle / 2).
        let across = at * (1.0 - square / 4.0).sqrt();
        let right = self.ahead.cross(self.up);
        Some(
            (self.ahead * (1.0 - square / 2.0) + right * across.x - self.up * across.y)
                .normalize_or(self.ahead),
        )
    }

    /// The pixels around a pixel.
    pub(super) fn neighbours(&self, pixel: usize) -> impl Iterator<Item = usize> + use<> {
        let (side, x, y) = (self.side as isize, (pixel % self.side) as isize, (pixel / self.side) as isize);
        (-1..=1).flat_map(move |dy| (-1..=1).map(move |dx| (x + dx, y + dy))).filter_map(move |(x, y)| {
            let is_inside = (0..side).contains(&x) && (0..side).contains(&y);
            is_inside.then_some((y * side + x) as usize)
        })
    }

    /// Illuminance of a surface at the eye that faces along the line of sight, lux, without a sun
    /// that pictures do not meet.
    pub fn illuminance(&self) -> f64 {
        let part = |(pixel, luminance): (usize, &f32)| {
            let cos = self.direction(pixel).map_or(0.0, |direction| direction.dot(self.ahead).max(0.0));
            f64::from(luminance * cos)
        };
        self.luminance.iter().enumerate().map(part).sum::<f64>() * self.pixel_solid_angle()
    }

    /// Traces one ray through a random point of each pixel, in full, from a point in scene space.
    /// Returns what pixels see in cd/m2, or `None` after a stop. `pass` numbers the random points.
    pub fn trace_pass(
        &self,
        tracer: &Tracer,
        eye: Vec3,
        settings: &TraceSettings,
        pass: u32,
        stop: Stop<'_>,
    ) -> Option<Vec<f32>> {
        let nits = tracer.scene().nits_per_unit();
        let see = |pixel: usize| {
            if pixel.is_multiple_of(self.side) && stop() {
                return None;
            }
            let key = Key::of_pixel(settings.seed, pixel as u32).with(pass);
            let Some(direction) = self.direction_at(pixel, Vec2::from(key.with(1).pair())) else {
                return Some(0.0);
            };
            let ray = Ray::new(eye, direction);
            let radiance =
                tracer.radiance_along(&ray, settings, key.with(2).into(), &mut RayCounts::default());
            Some(luminance(radiance) * nits)
        };
        (0..self.side * self.side).into_par_iter().map(see).collect()
    }
}

impl SeenSun {
    /// The sun of a scene as it is seen from a point in scene space; `None` where it is hidden, or
    /// has no size.
    pub fn of(tracer: &Tracer, eye: Vec3) -> Option<Self> {
        let sun = tracer.scene().sun.filter(|sun| sun.angular_radius > 0.0)?;
        let (right, up) = sun.direction.any_orthonormal_pair();
        let (mut passed, mut seen) = (0.0, 0u32);
        for (i, j) in (0..SUN_RAYS).flat_map(|i| (0..SUN_RAYS).map(move |j| (i, j))) {
            // Equal areas of the disk.
            let radius = ((i as f32 + 0.5) / SUN_RAYS as f32).sqrt() * sun.angular_radius.tan();
            let (sin, cos) = (2.0 * PI * (j as f32 + 0.5) / SUN_RAYS as f32).sin_cos();
            let direction = (sun.direction + (right * cos + up * sin) * radius).normalize_or(sun.direction);
            let part = luminance(tracer.transmittance_along(&Ray::new(eye, direction)) * sun.irradiance);
            passed += f64::from(part);
            seen += u32::from(part > 0.0);
        }
        let rays = f64::from(SUN_RAYS * SUN_RAYS);
        let disk = 2.0 * std::f64::consts::PI * (1.0 - f64::from(sun.angular_radius).cos());
        let solid_angle = disk * f64::from(seen) / rays;
        let illuminance = passed / rays * f64::from(tracer.scene().nits_per_unit());
        (seen > 0).then(|| Self {
            direction: sun.direction,
            luminance: illuminance / solid_angle,
            solid_angle,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_even_view_has_its_closed_forms() {
        let mut view = Fisheye::new(400, Vec3::new(0.6, 0.0, -0.8), Vec3::Y);
        view.luminance.fill(3.0);
        let expected = 3.0 * f64::from(PI);
        assert!((view.illuminance() / expected - 1.0).abs() < 2e-3, "{}", view.illuminance());
        assert!((view.mean_luminance() / 3.0 - 1.0).abs() < 2e-3);
        let seen = (0..160_000).filter(|p| view.direction(*p).is_some()).count() as f64;
        assert!((seen * view.pixel_solid_angle() / (2.0 * f64::from(PI)) - 1.0).abs() < 2e-3);
        let middle = view.direction(200 * 400 + 200).unwrap();
        assert!(middle.dot(view.ahead) > 0.999);
        let top = view.direction(5 * 400 + 200).unwrap();
        assert!(top.y > 0.9 && top.dot(view.ahead) > 0.0);
    }
}
