//! Changes of a complete scene: of its materials, its sun and sky, and its objects.

use super::light_groups::LightSettings;
use super::{Daylight, Ground, Light, Material, ObjectEdits, Scene, Sky, coincident, sanitize};
use glam::Vec3;
use std::sync::Arc;

/// The parts of a scene that can be changed: materials, sun, sky, where its objects are, and how
/// the groups of lights are set.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneEdit {
    /// All materials of the model, by [`MaterialId`](super::MaterialId), with their lamps at full
    /// light.
    pub materials: Vec<Material>,
    /// Sun and sky at full light.
    pub daylight: Daylight,
    /// How the groups of lights are set.
    pub lights: LightSettings,
    /// Objects that are moved, hidden or deleted.
    pub objects: ObjectEdits,
    /// The ground below the model; `None` for that of the model, if it has one.
    pub ground: Option<Ground>,
}

impl Scene {
    /// Returns the edit that leads to this scene.
    pub fn to_edit(&self) -> SceneEdit {
        let full = self.at_full();
        SceneEdit {
            materials: full.model_materials().to_vec(),
            daylight: full.daylight(),
            lights: self.light_settings.clone(),
            objects: self.object_edits(),
            ground: self.ground(),
        }
    }

    fn daylight(&self) -> Daylight {
        Daylight { sun: self.sun, sky: self.sky.clone() }
    }

    /// True if both are states of one model, which differ in materials, sun and sky only.
    pub fn has_same_geometry(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.triangles, &other.triangles) && Arc::ptr_eq(&self.positions, &other.positions)
    }

    /// Returns this scene with other materials, sun and sky, its objects elsewhere, another ground,
    /// and other settings of its lights. Lights, features, solids and hash are recomputed; where
    /// only settings of lights change, this takes no time that grows with the geometry. Where no
    /// object is edited, the geometry is the one that was loaded, to the bit. Edits of objects that
    /// the scene does not have, and of ways that are not finite or too long, are left out; so are
    /// all where no triangle would be left.
    ///
    /// # Panics
    /// If the edit has more or fewer materials than the scene, and so belongs to another one.
    #[must_use]
    pub fn with_edit(&self, edit: &SceneEdit) -> Self {
        assert_eq!(edit.materials.len(), self.model_materials().len(), "the edit belongs to another scene");
        let full = self.at_full();
        let is_same = edit.materials == full.model_materials()
            && edit.daylight == full.daylight()
            && edit.objects == full.object_edits()
            && edit.ground == full.ground();
        let full = if is_same { full } else { Arc::new(full.with_surfaces(edit)) };
        let mut edited = full.with_light_settings(&edit.lights);
        // Views may have been chosen since.
        (edited.views, edited.walk) = (self.views.clone(), self.walk.clone());
        edited.warnings.clone_from(&self.warnings);
        edited
    }

    /// Returns this scene at full light with the materials, objects, ground, sun and sky of an
    /// edit.
    fn with_surfaces(&self, edit: &SceneEdit) -> Self {
        let bare = self.without_ground();
        let mut edited = bare.with_objects(&edit.objects);
        edited.materials.clone_from(&edit.materials);
        for material in &mut edited.materials {
            let (clamped, is_scaled) = sanitize::sanitize_material(material);
            edited.conditioning.repairs.values_clamped += clamped;
            edited.conditioning.repairs.materials_scaled += usize::from(is_scaled);
        }
        let opaque = |scene: &Self| scene.materials.iter().map(Material::is_opaque).collect::<Vec<_>>();
        let is_moved_back = bare.edited_objects.is_some() && edited.edited_objects.is_none();
        if is_moved_back || opaque(&edited) != opaque(&bare) {
            edited.coincident = Arc::new(coincident::find(&edited));
        }
        edited.on_ground(edit.ground, self).with_daylight(edit.daylight.clone())
    }

    /// Returns this scene lit by nothing but a sky: without its sun, its lamps, and how its lights
    /// are set. The geometry is the same.
    #[must_use]
    pub fn lit_by_sky_alone(&self, sky: Sky) -> Self {
        let mut lit = (*self.at_full()).clone();
        lit.materials.iter_mut().for_each(|material| material.emission = Vec3::ZERO);
        (lit.sun, lit.sky, lit.light_settings) = (None, Some(sky), LightSettings::default());
        lit.derive(Vec::new());
        lit.update_light_numbers();
        lit
    }

    /// Returns this scene, whose lights are as the files have them, with another sun and sky.
    /// Lights, features, solids and hash are recomputed.
    #[must_use]
    pub(crate) fn with_daylight(mut self, daylight: Daylight) -> Self {
        (self.sun, self.sky) = (daylight.sun, daylight.sky);
        let is_point = |light: &&Light| matches!(light, Light::Point { .. });
        self.derive(self.lights.iter().filter(is_point).cloned().collect());
        self.update_light_numbers();
        self
    }
}
