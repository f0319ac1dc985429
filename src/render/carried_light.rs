//! The light of the frame before, found again in the next: while the view moves, light that was
//! traced once is shown for as long as its surface stays in the picture.
//!
//! Source: Nehab et al., "Accelerating Real-Time Shading with Reverse Reprojection Caching",
//! Graphics Hardware 2007. We differ: the light that arrives is carried on, not the colour, and
//! only until a reference knows it.

use super::frame::Frame;
use crate::camera::{PixelWarp, View};
use crate::lookup::{LookupSet, SurfaceKey};
use crate::scene::Scene;
use crate::trace::{NO_TRIANGLE, SceneEpoch, Tracer};
use glam::Vec3;
use rayon::prelude::*;

/// Two pixels show one surface where their disparities differ by at most this share: surfaces seen
/// at a grazing angle change by that much within a pixel.
const SAME_DEPTH: f32 = 0.02;

/// The cosine of the angle between two facets of one surface is at least this: 37 degrees.
const SAME_NORMAL: f32 = 0.8;

/// The light of a frame's pixels, and that of the frame before.
#[derive(Debug, Default)]
pub(super) struct CarriedLight {
    /// Radiance that a white surface in each pixel's place would have; NaN where it is not known.
    pub(super) light: Vec<Vec3>,
    epoch: Option<SceneEpoch>,
    before: Option<Before>,
    /// Scratch memory: what was found of the pixels that were looked for.
    found: Vec<Option<Vec3>>,
}

/// The frame before.
#[derive(Debug)]
struct Before {
    view: View,
    epoch: SceneEpoch,
    light: Vec<Vec3>,
    disparity: Vec<f32>,
    triangle: Vec<u32>,
}

impl CarriedLight {
    /// Memory per pixel.
    pub(super) const BYTES_PER_PIXEL: usize =
        2 * size_of::<Vec3>() + size_of::<Option<Vec3>>() + size_of::<f32>() + size_of::<u32>();

    /// Takes over the surfaces of the last frame, which is about to be overwritten, and forgets the
    /// light of all pixels of the next, of `count` pixels. Light is kept where `is_kept`.
    pub(super) fn begin(&mut self, last: &mut Frame, epoch: SceneEpoch, is_kept: bool, count: usize) {
        let old = self.before.take();
        let mut buffers = old.map_or_else(Default::default, |b| (b.light, b.disparity, b.triangle));
        let is_known = !self.light.is_empty() && self.light.len() == last.triangle.len();
        if let Some(epoch) = self.epoch.replace(epoch).filter(|_| is_known) {
            std::mem::swap(&mut self.light, &mut buffers.0);
            std::mem::swap(&mut last.disparity, &mut buffers.1);
            std::mem::swap(&mut last.triangle, &mut buffers.2);
            let (light, disparity, triangle) = buffers;
            self.before = Some(Before { view: last.view, epoch, light, disparity, triangle });
        }
        self.light.clear();
        self.light.resize(if is_kept { count } else { 0 }, Vec3::NAN);
    }

    /// Forgets all light.
    pub(super) fn clear(&mut self) {
        *self = Self::default();
    }

    /// Finds the light of some pixels of a frame in the frame before.
    pub(super) fn find(&mut self, tracer: &Tracer, frame: &Frame, pixels: &[u32]) {
        let Some(before) = self.before.as_ref().filter(|before| before.epoch == tracer.epoch()) else {
            return;
        };
        let warp = PixelWarp::new(&frame.view, &before.view);
        let find = |&pixel: &u32| before.light_of(tracer.scene(), &warp, frame, pixel as usize);
        pixels.par_iter().map(find).collect_into_vec(&mut self.found);
        for (&pixel, light) in pixels.iter().zip(&self.found) {
            self.light[pixel as usize] = light.unwrap_or(Vec3::NAN);
        }
    }

    /// Takes the light of before the scene changed for those of some pixels whose light is not
    /// known, until there is other.
    pub(super) fn fill(
        &mut self,
        (tracer, lookup): (&Tracer, Option<&LookupSet<'_>>),
        frame: &Frame,
        pixels: &[u32],
    ) {
        let Some(lookup) = lookup.filter(|lookup| lookup.has_preview()) else { return };
        let light_of = |pixel: u32| {
            let ray = Tracer::primary_ray(&frame.view, pixel);
            let hit = tracer.hit_on_triangle(&ray, frame.triangle[pixel as usize])?;
            let point = tracer.surface(&ray, &hit);
            let footprint = frame.view.footprint(ray.direction, hit.t);
            let key = SurfaceKey { position: point.position, normal: point.geometric_normal, footprint };
            lookup.preview_at(&key, point.triangle)
        };
        let open: Vec<u32> = pixels.iter().copied().filter(|&pixel| !self.is_known(pixel)).collect();
        open.par_iter().map(|&pixel| light_of(pixel)).collect_into_vec(&mut self.found);
        for (&pixel, light) in open.iter().zip(&self.found) {
            self.light[pixel as usize] = light.unwrap_or(Vec3::NAN);
        }
    }

    /// Takes over light that was traced for a frame of `count` pixels.
    pub(super) fn take(&mut self, traced: impl Iterator<Item = (usize, Vec3)>, count: usize) {
        self.light.resize(count, Vec3::NAN);
        traced.for_each(|(pixel, light)| self.light[pixel] = light);
    }

    /// True where no light is known.
    pub(super) fn is_dark(&self) -> bool {
        self.light.iter().all(|light| light.is_nan())
    }

    /// True where the light of a pixel is known.
    pub(super) fn is_known(&self, pixel: u32) -> bool {
        self.light.get(pixel as usize).is_some_and(|light| !light.is_nan())
    }
}

impl Before {
    /// The light of the pixel that showed the same place.
    fn light_of(&self, scene: &Scene, warp: &PixelWarp, frame: &Frame, pixel: usize) -> Option<Vec3> {
        let (disparity, triangle) = (frame.disparity[pixel], frame.triangle[pixel]);
        let width = frame.view.size[0] as usize;
        let (x, y) = ((pixel % width) as u32, (pixel / width) as u32);
        let (x, y, there) = warp.target(x, y, disparity)?;
        let at = y as usize * self.view.size[0] as usize + x as usize;
        let (light, other) = (*self.light.get(at)?, self.triangle[at]);
        if light.is_nan() || triangle == NO_TRIANGLE || other == NO_TRIANGLE {
            return None;
        }
        let is_near = (self.disparity[at] - there).abs() <= SAME_DEPTH * there;
        let is_same = other == triangle || is_near && faces_alike(scene, [triangle, other]);
        is_same.then_some(light)
    }
}

fn faces_alike(scene: &Scene, triangles: [u32; 2]) -> bool {
    let [a, b] = triangles.map(|triangle| normal_of(scene, triangle));
    a.dot(b).abs() >= SAME_NORMAL * (a.length_squared() * b.length_squared()).sqrt()
}

/// A normal of a triangle, of any length, on either side.
pub(super) fn normal_of(scene: &Scene, triangle: u32) -> Vec3 {
    let [a, b, c] = scene.corners(triangle);
    (b - a).cross(c - a)
}
