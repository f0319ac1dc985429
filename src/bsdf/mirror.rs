//! A perfect mirror, with or without the rise of reflectance towards grazing angles.
//!
//! Source: Schlick, "An Inexpensive BRDF Model for Physically-based Rendering", Computer Graphics
//! Forum 13(3), 1994, for the rise.

use super::lobe::{Facing, Lobe};
use super::scatter::ScatterSet;
use glam::Vec3;

/// A mirror; see [`crate::scene::MaterialKind::Mirror`].
pub(super) struct Mirror {
    pub(super) reflectance: Vec3,
    pub(super) fresnel: bool,
}

impl Lobe for Mirror {
    #[inline]
    fn sample(&self, facing: &Facing, incident: Vec3, _random: [f32; 2]) -> ScatterSet {
        let cos = facing.cosine(incident);
        let rise = if self.fresnel { (1.0 - cos).powi(5) } else { 0.0 };
        let share = self.reflectance + (Vec3::ONE - self.reflectance) * rise;
        ScatterSet::reflected(facing.reflect(incident), share)
    }
}
