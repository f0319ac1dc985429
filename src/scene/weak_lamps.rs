//! Daylight for a model whose own lamps leave it black, such as a house whose only light is that of
//! the door bell.

use super::SceneBuilder;
use crate::raster::color::luminance;
use glam::Vec3;
use std::f64::consts::PI;

/// Mean illumination of all surfaces, as radiance of the lamps, below which a model is black: 13
/// stops below that of a lit room. A candle in a hall brings a hundred times as much.
const BLACK: f64 = 1e-4;

/// The same in lux: less than the light of the full moon.
const BLACK_LUX: f64 = 0.05;

impl SceneBuilder {
    /// Adds a sun and a sky, with a warning, to a model without daylight whose lamps light it by
    /// less than can be seen.
    pub(crate) fn add_daylight_to_weak_lamps(&mut self) {
        if self.sun.is_some() || self.sky.is_some() {
            return;
        }
        let (flux, area_m2) = self.flux_and_area();
        let black = if self.is_photometric { BLACK_LUX } else { BLACK };
        // Without any lamp, `finish` adds daylight.
        if flux > 0.0 && area_m2 > 0.0 && flux / area_m2 < black {
            let Some(added) = self.add_clear_day() else { return };
            // The units of daylight here are those of models without photometric units.
            self.is_photometric = false;
            self.warn_of_scene(format!(
                "the model's own lamps are too weak to see it by; {added}. Remove them with --sky none"
            ));
        }
    }

    /// Returns the light that all lamps emit, and the area of all surfaces in square metres.
    fn flux_and_area(&self) -> (f64, f64) {
        let points = self.point_lights.iter().map(|(_, intensity)| *intensity);
        let spots = self.spot_lights.iter().map(|spot| spot.intensity);
        let bright = |light: Vec3| f64::from(luminance(light));
        let profiled = self.profile_lights.iter().map(|lamp| lamp.intensity);
        let lamps = points.chain(spots).chain(profiled);
        let mut flux: f64 = lamps.map(|intensity| 4.0 * PI * bright(intensity)).sum();
        let mut area_m2 = 0.0;
        for (triangle, material) in self.triangles.iter().zip(&self.triangle_materials) {
            let corners = triangle.map(|v| self.positions.get(v as usize).copied());
            let [Some(a), Some(b), Some(c)] = corners else { continue };
            let area = (b - a).cross(c - a).length() / 2.0;
            if area.is_finite() {
                area_m2 += area;
                let Some(material) = self.materials.get(material.0 as usize) else { continue };
                let sides = if material.emits_from_front { 1.0 } else { 2.0 };
                flux += sides * PI * area * bright(material.emission);
            }
        }
        (flux, area_m2)
    }
}
