//! The parts of a scene that follow from its geometry, materials and light sources.

use super::{Light, Scene, SceneFeatures, Sky, emissive, hash, solids};

impl Scene {
    /// Recomputes lights, features, solids and hash. Geometry, materials, textures, sun and sky
    /// must be final.
    pub(super) fn derive(&mut self, point_lights: Vec<Light>) {
        self.lights = emissive::lights(self);
        self.lights.extend(point_lights);
        self.lights.extend(self.sun.map(Light::from));
        self.lights.extend(self.sky.as_ref().map(|_| Light::Sky));
        self.lights.extend(self.sky.as_ref().and_then(Sky::with_suns).map(|_| Light::SkySuns));
        self.features =
            SceneFeatures::of(&self.materials, &self.lights, self.sky.is_some(), self.features.needles);
        self.solids = solids::classify(self);
        self.hash = hash::of(self);
    }
}
