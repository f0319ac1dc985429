//! The building from above: walls cut at eye height, the walk, and the references coloured by how
//! much they supplied.

use super::reference_usage::{ReferenceUsage, UsedReference};
use crate::camera::Camera;
use crate::raster::metrics::error_picture;
use crate::trace::Tracer;
use glam::{DVec2, DVec3};

/// Maximum width of the picture in pixels.
const WIDTH: u32 = 960;

/// Maximum height of the picture in pixels.
const MAX_HEIGHT: u32 = 960;

/// Margin around the building, the walk and the references, as a share of the longer side.
const MARGIN: f64 = 0.05;

/// Radius of the wedge of a reference as a share of the sheet's longer side, and half its angle in
/// radians.
const WEDGE: f64 = 0.04;
const WEDGE_HALF_ANGLE: f64 = 0.35;

/// Share of all pixels of the walk from which on a reference has the brightest colour.
const BRIGHTEST_SHARE: f64 = 0.2;

const PAPER: [u8; 3] = [250, 250, 247];
const WALL: [u8; 3] = [90, 90, 90];
const WALK: [u8; 3] = [0, 114, 178];

/// Returns the file name of a plan.
pub(super) fn file_name(mode: &str, walk: &str, rule: &str) -> String {
    format!("plan-{mode}-{walk}-{rule}.png")
}

/// Draws the plan and returns its size and pixels.
pub(super) fn draw(tracer: &Tracer, cameras: &[Camera], usage: &ReferenceUsage) -> ([u32; 2], Vec<[u8; 3]>) {
    let poses = cameras.iter().chain(usage.references.iter().map(|r| &r.camera));
    let mut sheet = Sheet::around(tracer.scene().building_m, poses.map(|camera| camera.eye));
    let mut wedges: Vec<&UsedReference> = usage.references.iter().collect();
    wedges.sort_by(|a, b| a.supplied.total_cmp(&b.supplied));
    for reference in wedges {
        sheet.wedge(
            &reference.camera,
            color(reference.supplied / (BRIGHTEST_SHARE * cameras.len().max(1) as f64)),
        );
    }
    let height = cameras.iter().map(|c| c.eye.y).sum::<f64>() / cameras.len().max(1) as f64;
    for [a, b] in cut(tracer, height) {
        sheet.line(a, b, WALL);
    }
    for pair in cameras.windows(2) {
        sheet.line(from_above(pair[0].eye), from_above(pair[1].eye), WALK);
    }
    (sheet.size, sheet.pixels)
}

/// Colour of a supplied share: dark for nothing, bright for [`BRIGHTEST_SHARE`].
fn color(share: f64) -> [u8; 3] {
    // The darkest tenth is not used, so that references that supplied nothing differ from the
    // walls.
    error_picture(&[(0.1 + 0.8 * share.min(1.0)) as f32])[0]
}

fn from_above(point: DVec3) -> DVec2 {
    DVec2::new(point.x, point.z)
}

/// Returns the segments in which triangles intersect the horizontal plane at a height.
fn cut(tracer: &Tracer, height_m: f64) -> Vec<[DVec2; 2]> {
    let scene = tracer.scene();
    let of_triangle = |t: u32| {
        let corners = scene.corners(t).map(|c| scene.frame.world_from_scene(c));
        let crossing = |a: DVec3, b: DVec3| {
            let is_crossing = (a.y > height_m) != (b.y > height_m);
            is_crossing.then(|| from_above(a.lerp(b, (height_m - a.y) / (b.y - a.y))))
        };
        let [a, b, c] = corners;
        let mut ends = [crossing(a, b), crossing(b, c), crossing(c, a)].into_iter().flatten();
        Some([ends.next()?, ends.next()?])
    };
    (0..scene.triangles.len() as u32).filter_map(of_triangle).collect()
}

/// A picture with a map scale.
struct Sheet {
    size: [u32; 2],
    low: DVec2,
    pixels_per_m: f64,
    pixels: Vec<[u8; 3]>,
}

impl Sheet {
    /// An empty sheet that shows a building and some points, world metres.
    fn around(building_m: [DVec3; 2], points: impl Iterator<Item = DVec3>) -> Self {
        let grow = |[low, high]: [DVec2; 2], p: DVec3| [low.min(from_above(p)), high.max(from_above(p))];
        let [low, high] = points.fold(building_m.map(from_above), grow);
        let margin = ((high - low).max_element() * MARGIN).max(f64::MIN_POSITIVE);
        let (low, high) = (low - margin, high + margin);
        let extent = high - low;
        let pixels_per_m = (f64::from(WIDTH) / extent.x).min(f64::from(MAX_HEIGHT) / extent.y);
        let size = [extent.x, extent.y].map(|e| (e * pixels_per_m).ceil() as u32);
        Self { size, low, pixels_per_m, pixels: vec![PAPER; size[0] as usize * size[1] as usize] }
    }

    fn to_pixels(&self, point: DVec2) -> DVec2 {
        (point - self.low) * self.pixels_per_m
    }

    fn set(&mut self, at: DVec2, color: [u8; 3]) {
        let inside = at.x >= 0.0 && at.y >= 0.0 && at.x < self.size[0].into() && at.y < self.size[1].into();
        if inside {
            self.pixels[at.y as usize * self.size[0] as usize + at.x as usize] = color;
        }
    }

    fn line(&mut self, a: DVec2, b: DVec2, color: [u8; 3]) {
        let (a, b) = (self.to_pixels(a), self.to_pixels(b));
        let size = DVec2::new(self.size[0].into(), self.size[1].into());
        if a.max(b).min_element() < 0.0 || (a.min(b) - size).max_element() >= 0.0 {
            return;
        }
        let steps = (b - a).abs().max_element().ceil().clamp(1.0, 1e5);
        for i in 0..=steps as u32 {
            self.set(a.lerp(b, f64::from(i) / steps), color);
        }
    }

    /// Draws a sector around the eye in the direction of view.
    fn wedge(&mut self, camera: &Camera, color: [u8; 3]) {
        let eye = self.to_pixels(from_above(camera.eye));
        let forward = from_above(camera.forward()).normalize_or(DVec2::NEG_Y);
        let radius = WEDGE * f64::from(self.size[0].max(self.size[1]));
        let reach = radius.ceil() as i32;
        for y in -reach..=reach {
            for x in -reach..=reach {
                let way = DVec2::new(x.into(), y.into());
                let is_inside =
                    way.length() <= radius && way.dot(forward) >= way.length() * WEDGE_HALF_ANGLE.cos();
                if is_inside {
                    self.set(eye + way, color);
                }
            }
        }
    }
}
