//! Lighting analysis: the scales of false colours, and the work plane.

use crate::window::rendering::{FrameValues, Progress, Quantity};
use crate::work_plane::MeasuredPlane;
use afterimage::raster::false_color::round_up;
use std::sync::Arc;

/// An automatic scale is kept while the usual maximum is at least this share of it, so that it does
/// not change with every step.
const MIN_USED: f32 = 0.3;

/// The same for values above the scale.
const MAX_USED: f32 = 1.1;

/// Part of the floor that a work plane covers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Area {
    /// The room around the viewer.
    #[default]
    Room,
    /// The floor of the whole building that the viewer is on.
    Floor,
}

/// A work plane as the user sets it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneSettings {
    /// Height above the floor, metres.
    pub height_m: f64,
    /// Distance between points, metres.
    pub grid_m: f64,
    /// Part of the floor.
    pub area: Area,
    /// True for daylight factors in place of illuminances.
    pub is_factor: bool,
}

impl Default for PlaneSettings {
    fn default() -> Self {
        Self { height_m: 0.85, grid_m: 0.5, area: Area::Room, is_factor: false }
    }
}

/// A command about lighting analysis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightingCommand {
    /// Sets the end of the scale of a quantity; `None` for the automatic one.
    SetScale(Quantity, Option<f32>),
    /// Changes the work plane.
    SetPlane(PlaneSettings),
    /// Measures the work plane, or cancels that.
    Measure,
    /// Saves the points as a table.
    SaveTable,
    /// Saves statistics and points as JSON.
    SaveJson,
}

/// Lighting analysis.
#[derive(Clone, Debug, Default)]
pub struct Lighting {
    /// Ends of the scales that the user has set, in the order of [`Quantity::ALL`].
    chosen: [Option<f32>; Quantity::ALL.len()],
    /// Ends of the automatic scales.
    automatic: [Option<f32>; Quantity::ALL.len()],
    /// Place of the cursor in the viewport, 0..1 from the upper left; `None` elsewhere.
    pub cursor: Option<[f32; 2]>,
    /// The work plane.
    pub plane: PlaneSettings,
    /// Progress of measuring it; `None` while nothing is measured.
    pub measuring: Option<Progress>,
    /// What was measured last.
    pub measured: Option<Arc<MeasuredPlane>>,
}

impl Lighting {
    /// Returns the end of the scale of a quantity; `None` for quantities without values.
    pub fn max_of(&self, quantity: Quantity) -> Option<f32> {
        let at = quantity as usize;
        quantity.has_values().then(|| self.chosen[at].or(self.automatic[at]).unwrap_or(1.0))
    }

    /// Returns the end of the scale that the user has set; `None` where it is automatic.
    pub fn chosen(&self, quantity: Quantity) -> Option<f32> {
        self.chosen[quantity as usize]
    }

    /// Sets the end of a scale; `None` for the automatic one.
    pub fn set_scale(&mut self, quantity: Quantity, max: Option<f32>) {
        self.chosen[quantity as usize] = max.filter(|max| max.is_finite() && *max > 0.0);
    }

    /// Adapts the automatic scale to a frame.
    pub fn note(&mut self, values: &FrameValues) {
        let Some(usual) = values.usual_max.filter(|_| values.quantity.has_values()) else { return };
        let automatic = &mut self.automatic[values.quantity as usize];
        let is_used = |max: f32| (MIN_USED..=MAX_USED).contains(&(usual / max));
        if !automatic.is_some_and(is_used) {
            *automatic = Some(round_up(f64::from(usual)) as f32);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_automatic_scale_follows_only_large_changes() {
        let mut lighting = Lighting::default();
        let quantity = Quantity::Illuminance;
        for (usual, max) in
            [(730.0, 1000.0), (1050.0, 1000.0), (400.0, 1000.0), (1200.0, 2000.0), (90.0, 100.0)]
        {
            lighting.note(&FrameValues { quantity, usual_max: Some(usual), ..FrameValues::default() });
            assert_eq!(lighting.max_of(quantity), Some(max), "{usual}");
        }
        lighting.set_scale(quantity, Some(300.0));
        assert_eq!(lighting.max_of(quantity), Some(300.0));
        lighting.set_scale(quantity, None);
        assert_eq!(lighting.max_of(quantity), Some(100.0));
        assert_eq!(lighting.max_of(Quantity::Clay), None);
    }
}
