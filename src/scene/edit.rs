//! Changes of a complete scene that keep its geometry.

use super::{Daylight, Light, Material, Scene, sanitize};

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
        SceneEdit { materials: self.materials.clone(), daylight: Daylight { sun: self.sun, sky: self.sky } }
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
        (edited.sun, edited.sky) = (edit.daylight.sun, edit.daylight.sky);
        let is_point = |light: &&Light| matches!(light, Light::Point { .. });
        edited.derive(self.lights.iter().filter(is_point).cloned().collect());
        edited.update_light_numbers();
        edited
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{MaterialKind, Sky, Sun, builtin};
    use glam::Vec3;

    #[test]
    fn a_scene_edited_to_itself_is_the_same_scene() {
        for name in builtin::NAMES {
            let scene = builtin::build(name).unwrap();
            let same = scene.with_edit(&scene.to_edit());
            assert_eq!((&same.hash, &same.lights), (&scene.hash, &scene.lights), "{name}");
            assert_eq!((same.features, &same.solids), (scene.features, &scene.solids), "{name}");
        }
    }

    #[test]
    fn an_edit_changes_what_depends_on_it_and_can_be_undone() {
        let scene = builtin::build("cornell").unwrap();
        let mut edit = scene.to_edit();
        edit.materials.iter_mut().for_each(|m| m.emission = Vec3::ZERO);
        edit.materials[0].kind = MaterialKind::Glass { eta: 1.5, transmittance: Vec3::ONE };
        edit.daylight.sky = Some(Sky { zenith: Vec3::ONE, horizon: Vec3::ONE, ground: Vec3::ONE });
        let edited = scene.with_edit(&edit);
        assert_eq!(edited.lights, [Light::Sky]);
        assert!(edited.features.glass && edited.features.sky && !edited.features.area_lights);
        assert_eq!(edited.solids.len(), edited.triangles.len());
        assert_ne!(edited.hash, scene.hash);
        assert_eq!(edited.with_edit(&scene.to_edit()).hash, scene.hash);
    }

    #[test]
    fn the_sun_keeps_its_angular_radius_in_an_edit() {
        let scene = builtin::build("cornell").unwrap();
        let mut edit = scene.to_edit();
        edit.daylight.sun = Some(Sun::clear_day());
        assert_eq!(scene.with_edit(&edit).to_edit(), edit);
    }
}
