//! Changes of a finished scene that leave its geometry alone: materials, the sun and the sky.

use super::builder::hash_of;
use super::{Light, Material, Scene, Sky, Sun, lights, solids};
use crate::scene::{SceneFeatures, sanitize};

/// What lights a scene from outside.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Daylight {
    /// The sun.
    pub sun: Option<Sun>,
    /// The sky.
    pub sky: Option<Sky>,
}

/// What of a scene can be changed without touching its geometry.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneEdit {
    /// By [`MaterialId`](super::MaterialId).
    pub materials: Vec<Material>,
    /// Sun and sky.
    pub daylight: Daylight,
}

impl Scene {
    /// What can be changed, as it is.
    pub fn to_edit(&self) -> SceneEdit {
        SceneEdit { materials: self.materials.clone(), daylight: Daylight { sun: self.sun, sky: self.sky } }
    }

    /// The same geometry with another look. Lights, needs, solids and hash are found anew.
    ///
    /// # Panics
    /// Where the look is another scene's: it has more or fewer materials.
    #[must_use]
    pub fn with_edit(&self, look: &SceneEdit) -> Self {
        assert_eq!(look.materials.len(), self.materials.len(), "a look of another scene");
        let mut edited = self.clone();
        edited.materials.clone_from(&look.materials);
        for material in &mut edited.materials {
            let (clamped, is_scaled) = sanitize::mend_material(material);
            edited.conditioning.repairs.values_clamped += clamped;
            edited.conditioning.repairs.materials_scaled += usize::from(is_scaled);
        }
        edited.find_lights_anew(look.daylight);
        edited
    }

    /// Everything that follows from materials and daylight, in the order in which the builder makes it.
    fn find_lights_anew(&mut self, daylight: Daylight) {
        let points = self.lights.iter().filter(|l| matches!(l, Light::Point { .. })).cloned();
        let mut found = lights::from_emissive_triangles(
            &self.positions,
            &self.triangles,
            &self.triangle_materials,
            &self.materials,
        );
        found.extend(points);
        found.extend(daylight.sun.map(Light::from));
        if daylight.sky.is_some() {
            found.push(Light::Sky);
        }
        (self.lights, self.sun, self.sky) = (found, daylight.sun, daylight.sky);
        self.features =
            SceneFeatures::of(&self.materials, &self.lights, self.sky.as_ref(), self.features.needles);
        self.solids =
            solids::classify(&self.positions, &self.triangles, &self.triangle_materials, &self.materials);
        self.hash = hash_of(self);
        let mut conditioning = std::mem::take(&mut self.conditioning);
        conditioning.set_light(self);
        self.conditioning = conditioning;
    }
}

#[cfg(test)]
mod tests {
    use super::super::builtin;
    use super::*;
    use glam::Vec3;

    #[test]
    fn a_scene_with_its_own_look_is_the_same_scene() {
        for name in builtin::NAMES {
            let scene = builtin::build(name).unwrap();
            let same = scene.with_edit(&scene.to_edit());
            assert_eq!((&same.hash, &same.lights), (&scene.hash, &scene.lights), "{name}");
            assert_eq!((same.features, &same.solids), (scene.features, &scene.solids), "{name}");
        }
    }

    #[test]
    fn another_look_changes_what_follows_from_it_and_can_be_undone() {
        let scene = builtin::build("cornell").unwrap();
        let mut look = scene.to_edit();
        look.materials.iter_mut().for_each(|m| m.emission = Vec3::ZERO);
        look.materials[0].kind = crate::scene::MaterialKind::Glass { eta: 1.5, transmittance: Vec3::ONE };
        look.daylight.sky = Some(Sky { zenith: Vec3::ONE, horizon: Vec3::ONE, ground: Vec3::ONE });
        let edited = scene.with_edit(&look);
        assert_eq!(edited.lights, [Light::Sky]);
        assert!(edited.features.glass && edited.features.sky && !edited.features.area_lights);
        assert_eq!(edited.solids.len(), edited.triangles.len());
        assert_ne!(edited.hash, scene.hash);
        assert_eq!(edited.with_edit(&scene.to_edit()).hash, scene.hash);
    }
}
