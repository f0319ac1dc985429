//! The parts of a scene that follow from its geometry, materials and light sources.

use super::{Light, MaterialId, Scene, SceneFeatures, Sky, emissive, group_lights, hash, solids};

impl Scene {
    /// Recomputes lights and their groups, features, solids and hash. Geometry, materials,
    /// textures, sun and sky must be final.
    pub(super) fn derive(&mut self, point_lights: Vec<Light>) {
        let lamps = emissive::lights(self);
        let of_lamp = |(light, lamp): (u32, &emissive::Lamp)| -> Vec<[u32; 2]> {
            lamp.triangles.iter().map(|&triangle| [triangle, light]).collect()
        };
        self.lamp_triangles = (0..).zip(&lamps).flat_map(of_lamp).collect();
        self.lamp_triangles.sort_unstable();
        let (mut materials, surfaces): (Vec<Option<MaterialId>>, Vec<Light>) =
            lamps.into_iter().map(|lamp| (Some(lamp.material), lamp.light)).unzip();
        self.lights = surfaces;
        self.lights.extend(point_lights);
        self.lights.extend(self.sun.map(Light::from));
        self.lights.extend(self.sky.as_ref().map(|_| Light::Sky));
        self.lights.extend(self.sky.as_ref().and_then(Sky::with_suns).map(|_| Light::SkySuns));
        materials.resize(self.lights.len(), None);
        self.light_groups = group_lights::group(self, &materials);
        let of_triangles = [self.features.needles, !self.coincident.is_empty()];
        self.features = SceneFeatures::of(&self.materials, &self.lights, self.sky.is_some(), of_triangles);
        // Neither needs the other.
        (self.solids, self.hash) = rayon::join(|| solids::classify(self), || hash::of(self));
    }
}
