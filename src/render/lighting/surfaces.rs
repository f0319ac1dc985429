//! The surfaces that the pixels of a picture see.

use crate::camera::View;
use crate::scene::Scene;
use crate::trace::NO_TRIANGLE;
use glam::Vec3;

/// Smallest cosine between the planes of two triangles of one surface: 25 degrees, so that curved
/// surfaces are one.
const MIN_COS: f32 = 0.9;

/// Largest sine by which the line between two points of one surface leaves its plane.
const MAX_SINE: f32 = 0.1;

/// The surfaces that the pixels of a picture see, row-major.
#[derive(Clone, Copy, Debug)]
pub struct SeenSurfaces<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// The view of the picture.
    pub view: &'a View,
    /// Triangle of each pixel; [`NO_TRIANGLE`] for the sky.
    pub triangle: &'a [u32],
    /// 1 / depth of each pixel along the viewing axis, scene units.
    pub disparity: &'a [f32],
}

impl SeenSurfaces<'_> {
    /// True where a pixel sees a surface that scatters arriving light: no sky, mirror or clear
    /// glass, which have no illuminance to show.
    pub fn scatters(&self, pixel: usize) -> bool {
        let triangle = self.triangle[pixel];
        triangle != NO_TRIANGLE && self.scene.material_of(triangle).has_base()
    }

    /// True where two neighbouring pixels see one surface, over which light changes evenly: not the
    /// two sides of an outline, an edge or a corner.
    pub fn are_one(&self, a: usize, b: usize) -> bool {
        let triangles = [a, b].map(|pixel| self.triangle[pixel]);
        if triangles[0] == triangles[1] {
            return true;
        }
        if triangles.contains(&NO_TRIANGLE) {
            return false;
        }
        let normals = triangles.map(|triangle| {
            let [a, b, c] = self.scene.corners(triangle);
            (b - a).cross(c - a).normalize_or_zero()
        });
        let way = self.position(b) - self.position(a);
        normals[0].dot(normals[1]).abs() > MIN_COS && normals[0].dot(way).abs() < MAX_SINE * way.length()
    }

    /// The point that a pixel sees, scene space.
    fn position(&self, pixel: usize) -> Vec3 {
        self.view.eye + self.view.direction_of_pixel(pixel as u32) / self.disparity[pixel]
    }
}
