//! Groups of lights that are dimmed, switched and coloured together, and how they are set.

use glam::Vec3;
use std::collections::BTreeMap;

/// Largest number of groups of lamps. Where there are more, the weakest share the last.
pub const MAX_LAMP_GROUPS: usize = 8;

/// Largest number of groups of a scene: those of lamps, the sun, and the sky.
pub const MAX_LIGHT_GROUPS: usize = MAX_LAMP_GROUPS + 2;

/// Group of a light or material that belongs to none.
pub const NO_LIGHT_GROUP: u8 = u8::MAX;

/// What gives the light of a group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightGroupKind {
    /// The sky, with the suns of its picture.
    Sky,
    /// The sun.
    Sun,
    /// Surfaces that emit, or point lights.
    Lamps,
}

/// A group of lights.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LightGroup {
    /// Name, by which the settings of the group are kept. No two groups of a scene have the same.
    pub name: String,
    /// What gives its light.
    pub kind: LightGroupKind,
}

/// A group of lamps that the user has put together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LampGroup {
    /// Name of the group.
    pub name: String,
    /// Names of the materials that emit its light.
    pub materials: Vec<String>,
}

/// The groups of the lights of a scene.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LightGroups {
    /// The groups: sky, sun, then lamps, the strongest first.
    pub list: Vec<LightGroup>,
    /// Group of each light of the scene, an index into `list`.
    pub of_light: Vec<u8>,
    /// Group of each material, [`NO_LIGHT_GROUP`] for those that belong to no light.
    pub of_material: Vec<u8>,
}

impl LightGroups {
    /// The group of a kind that has one group at most: sky or sun.
    pub fn of_kind(&self, kind: LightGroupKind) -> Option<usize> {
        self.list.iter().position(|group| group.kind == kind)
    }

    /// The factor of the light of each group.
    pub fn factors(&self, settings: &LightSettings) -> Vec<Vec3> {
        self.list.iter().map(|group| settings.get(&group.name).factor()).collect()
    }
}

/// How a group of lights is set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSetting {
    /// False where the group is switched off.
    pub is_on: bool,
    /// Factor of its light, 0 to [`Self::MAX_INTENSITY`].
    pub intensity: f32,
    /// Colour that its light is multiplied with, linear Rec. 709, each channel 0 to 1.
    pub color: Vec3,
}

impl LightSetting {
    /// The light as the scene's files have it.
    pub const FULL: Self = Self { is_on: true, intensity: 1.0, color: Vec3::ONE };

    /// Largest factor: ten stops.
    pub const MAX_INTENSITY: f32 = 1024.0;

    /// The factor of each channel of the group's light; finite and not negative.
    pub fn factor(&self) -> Vec3 {
        if !self.is_on || self.intensity.is_nan() || self.color.is_nan() {
            return Vec3::ZERO;
        }
        self.color.clamp(Vec3::ZERO, Vec3::ONE) * self.intensity.clamp(0.0, Self::MAX_INTENSITY)
    }
}

impl Default for LightSetting {
    fn default() -> Self {
        Self::FULL
    }
}

/// The settings of the groups of a scene, by name. Groups that are not listed give their light as
/// the scene's files have it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LightSettings(BTreeMap<String, LightSetting>);

impl LightSettings {
    /// The setting of a group.
    pub fn get(&self, name: &str) -> LightSetting {
        self.0.get(name).copied().unwrap_or_default()
    }

    /// Sets a group.
    pub fn set(&mut self, name: &str, setting: LightSetting) {
        if setting == LightSetting::FULL {
            self.0.remove(name);
        } else {
            self.0.insert(name.to_owned(), setting);
        }
    }

    /// True where all groups give their light as the scene's files have it.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Names and settings of the groups that are listed, by name.
    pub fn iter(&self) -> impl Iterator<Item = (&str, &LightSetting)> {
        self.0.iter().map(|(name, setting)| (name.as_str(), setting))
    }
}
