//! Changes of a finished scene that leave its geometry alone: a material, the sun and the sky.

use super::builder::hash_of;
use super::{Light, Material, MaterialId, Needs, Scene, Sky, lights, mend, solids};
use glam::Vec3;

/// What lights a scene from outside.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Daylight {
    /// Unit direction towards the sun, angular radius in radians, irradiance on a surface that faces it.
    pub sun: Option<(Vec3, f32, Vec3)>,
    /// The sky.
    pub sky: Option<Sky>,
}

impl Scene {
    /// The same scene with another material in the place of one. The name stays.
    #[must_use]
    pub fn with_material(&self, id: MaterialId, material: Material) -> Self {
        let mut edited = self.clone();
        let place = &mut edited.materials[id.0 as usize];
        *place = Material { name: std::mem::take(&mut place.name), ..material };
        let (clamped, is_scaled) = mend::mend_material(place);
        edited.stiffness.mended.values_clamped += clamped;
        edited.stiffness.mended.materials_scaled += usize::from(is_scaled);
        edited.find_lights_anew(self.daylight());
        edited
    }

    /// The same scene under another sun and sky.
    #[must_use]
    pub fn with_daylight(&self, daylight: Daylight) -> Self {
        let mut edited = self.clone();
        edited.find_lights_anew(daylight);
        edited
    }

    /// What lights it from outside.
    pub fn daylight(&self) -> Daylight {
        let sun = self.lights.iter().find_map(|light| match *light {
            Light::Sun { direction, cos_angular_radius, irradiance } => {
                Some((direction, cos_angular_radius.acos(), irradiance))
            }
            _ => None,
        });
        Daylight { sun, sky: self.sky }
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
        if let Some((direction, radius, irradiance)) = daylight.sun {
            found.push(Light::Sun { direction, cos_angular_radius: radius.cos(), irradiance });
        }
        if daylight.sky.is_some() {
            found.push(Light::Sky);
        }
        (self.lights, self.sky) = (found, daylight.sky);
        self.needs = Needs::of(&self.materials, &self.lights, self.sky.as_ref());
        self.solids =
            solids::classify(&self.positions, &self.triangles, &self.triangle_materials, &self.materials);
        self.hash = hash_of(self);
        let mut stiffness = std::mem::take(&mut self.stiffness);
        stiffness.set_light(self);
        self.stiffness = stiffness;
    }
}
