//! Direct light that holds after an edit of the scene, where smooth light does not.

use super::exact::PixelResolver;
use super::point::{LookupReference, LookupSet};
use super::point_cache::SurfaceKey;
use crate::camera::NEAREST_DEPTH;
use crate::reference::light::UNLIT;
use crate::trace::SurfacePoint;
use glam::Vec3;
use std::f32::consts::PI;

impl PixelResolver<'_> {
    /// The irradiance straight from the lights at a point, at a distance along the path to it,
    /// where an edit of the scene left it as it was: references hold it, or an earlier frame traced
    /// it there.
    pub(super) fn held_irradiance(&self, point: &SurfacePoint, distance: f32, samples: u32) -> Option<Vec3> {
        // Without an edit there is nothing to look for.
        if !self.lookup.has_preview() {
            return None;
        }
        let near = self.key_at(point, distance);
        let traced = || Some(self.points.find(&near.exact(), samples)?.light * PI);
        self.lookup.held_irradiance(&near, point.triangle).or_else(traced)
    }
}

impl LookupSet<'_> {
    /// The irradiance straight from the lights at a point, where references know it for certain: a
    /// sample lies at the very point, or the look-up is no guess.
    pub(crate) fn held_irradiance(&self, point: &SurfaceKey, triangle: u32) -> Option<Vec3> {
        let held = self.held.as_ref()?;
        let light = held.light_of_sample(point, triangle).or_else(|| {
            let found = held.light_at(point, triangle)?;
            (!found.is_guess).then_some(found.light)
        });
        light.map(|light| light * PI)
    }

    /// The direct light of a sample at a point, as radiance of a white surface.
    fn light_of_sample(&self, point: &SurfaceKey, triangle: u32) -> Option<Vec3> {
        let mut mask = self.directory.mask(self.directory.cell_of(point.position)) & self.usable;
        while mask != 0 {
            let slot = mask.trailing_zeros() as usize;
            mask &= mask - 1;
            let reference = self.references[slot].as_ref();
            if let Some(light) = reference.and_then(|r| r.light_of_sample(&point.exact(), triangle)) {
                return Some(light);
            }
        }
        None
    }
}

impl LookupReference<'_> {
    /// The direct light of the sample that a point projects to, where that lies within its
    /// footprint.
    fn light_of_sample(&self, point: &SurfaceKey, triangle: u32) -> Option<Vec3> {
        let offset = point.position - self.eye;
        let q = self.pixel_from_scene * offset;
        let (x, y) = (q.x / q.z, q.y / q.z);
        let is_inside = x >= 0.0 && y >= 0.0 && x < self.size[0] && y < self.size[1];
        if !(q.z > NEAREST_DEPTH && point.normal.dot(offset) < 0.0 && is_inside) {
            return None;
        }
        let at = y as usize * self.size[0] as usize + x as usize;
        let centre = Vec3::new((x as u32) as f32 + 0.5, (y as u32) as f32 + 0.5, 1.0);
        let place = self.scene_from_pixel * centre / self.disparity[at];
        let is_same = place.distance(offset) <= point.footprint;
        let is_known = is_same && self.light[at] != UNLIT && self.is_alike(at, triangle);
        is_known.then(|| self.scale.unpack(self.light[at]))
    }
}
