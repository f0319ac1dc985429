//! A scene whose groups of lights are dimmed, switched off or coloured.

use super::light_groups::{LightSettings, NO_LIGHT_GROUP};
use super::{Light, Scene, Sky};
use glam::Vec3;
use sha2::{Digest, Sha256};
use std::sync::Arc;

/// Version of the hash of a dimmed scene. A change of what is hashed needs a new number.
const VERSION: &[u8] = b"afterimage dimmed 1";

impl Scene {
    /// The same scene with all lights as the files have them.
    pub fn at_full(&self) -> Arc<Self> {
        self.full.clone().unwrap_or_else(|| Arc::new(self.clone()))
    }

    /// Hash of the same scene with all lights as the files have them.
    pub fn full_hash(&self) -> &str {
        self.full.as_ref().map_or(&self.hash, |full| &full.hash)
    }

    /// The factor of the light of each group.
    pub fn light_factors(&self) -> Vec<Vec3> {
        self.light_groups.factors(&self.light_settings)
    }

    /// True where a light, given by its index, belongs to a group that is switched off. No ray is
    /// traced towards it.
    pub(crate) fn is_switched_off(&self, light: usize) -> bool {
        let group = || self.light_groups.list.get(usize::from(*self.light_groups.of_light.get(light)?));
        self.full.is_some()
            && group().is_some_and(|group| self.light_settings.get(&group.name).factor() == Vec3::ZERO)
    }

    /// Returns this scene, all of whose lights are as the files have them, with other settings of
    /// their groups. Lights keep their numbers, also where they are off, so that the others keep
    /// their random numbers.
    #[must_use]
    pub fn with_light_settings(self: &Arc<Self>, settings: &LightSettings) -> Self {
        let factors = self.light_groups.factors(settings);
        let mut dimmed = (**self).clone();
        dimmed.light_settings = settings.clone();
        if factors.iter().all(|factor| *factor == Vec3::ONE) {
            return dimmed;
        }
        let factor_of = |group: &u8| factors.get(usize::from(*group)).copied().unwrap_or(Vec3::ONE);
        let groups = &self.light_groups;
        for (material, group) in dimmed.materials.iter_mut().zip(&groups.of_material) {
            if *group != NO_LIGHT_GROUP {
                material.emission *= factor_of(group);
            }
        }
        let mut hasher = Sha256::new();
        [VERSION, self.hash.as_bytes()].into_iter().for_each(|part| hasher.update(part));
        for (light, group) in dimmed.lights.iter_mut().zip(&groups.of_light) {
            let factor = factor_of(group);
            hasher.update(bytemuck::bytes_of(&factor));
            match light {
                Light::Sun { irradiance, .. } => {
                    *irradiance *= factor;
                    dimmed.sun.iter_mut().for_each(|sun| sun.irradiance *= factor);
                }
                Light::Sky => dimmed.sky = dimmed.sky.take().map(|sky| sky.dimmed(factor)),
                Light::SkySuns => {}
                Light::Quad { radiance: light, .. }
                | Light::Triangles { radiance: light, .. }
                | Light::Point { intensity: light, .. } => *light *= factor,
            }
        }
        dimmed.hash = hasher.finalize().iter().map(|byte| format!("{byte:02x}")).collect();
        dimmed.full = Some(self.clone());
        dimmed
    }
}

impl Sky {
    /// This sky with its light multiplied by a factor per channel.
    #[must_use]
    pub(super) fn dimmed(self, factor: Vec3) -> Self {
        if factor == Vec3::ONE {
            self
        } else {
            Self::Dimmed(Box::new(super::DimmedSky { sky: self, factor }))
        }
    }
}
