//! Changes of a complete scene that keep its geometry.

use super::{Daylight, Light, Material, Scene, sanitize};
use std::sync::Arc;

/// The parts of a scene that can be changed without touching its geometry: materials, sun and sky.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneEdit {
    /// All materials, by [`MaterialId`](super::MaterialId).
    pub materials: Vec<Material>,
    /// Sun and sky.
    pub daylight: Daylight,
}

impl Scene {
    /// Returns the edit that leads to this scene.
    pub fn to_edit(&self) -> SceneEdit {
        SceneEdit {
            materials: self.materials.clone(),
            daylight: Daylight { sun: self.sun, sky: self.sky.clone() },
        }
    }

    /// True if both are states of one model, which differ in materials, sun and sky only.
    pub fn has_same_geometry(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.triangles, &other.triangles) && Arc::ptr_eq(&self.positions, &other.positions)
    }

    /// Returns this scene with other materials, sun and sky. Lights, features, solids and hash are
    /// recomputed.
    ///
    /// # Panics
    /// If the edit has more or fewer materials than the scene, and so belongs to another one.
    #[must_use]
    pub fn with_edit(&self, edit: &SceneEdit) -> Self {
        assert_eq!(edit.materials.len(), self.materials.len(), "the edit belongs to another scene");
        let mut edited = self.clone();
        edited.materials.clone_from(&edit.materials);
        for material in &mut edited.materials {
            let (clamped, is_scaled) = sanitize::sanitize_material(material);
            edited.conditioning.repairs.values_clamped += clamped;
            edited.conditioning.repairs.materials_scaled += usize::from(is_scaled);
        }
        edited.with_daylight(edit.daylight.clone())
    }

    /// Returns this scene with another sun and sky. Lights, features, solids and hash are
    /// recomputed.
    #[must_use]
    pub fn with_daylight(mut self, daylight: Daylight) -> Self {
        (self.sun, self.sky) = (daylight.sun, daylight.sky);
        let is_point = |light: &&Light| matches!(light, Light::Point { .. });
        self.derive(self.lights.iter().filter(is_point).cloned().collect());
        self.update_light_numbers();
        self
    }
}
