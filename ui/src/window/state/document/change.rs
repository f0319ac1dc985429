//! A change of the document.

use super::Document;
use crate::window::state::{SavedView, SectionView, SunControls};
use afterimage::camera::CameraPath;
use afterimage::scene::{
    Daylight, Ground, LightSetting, Material, MaterialId, ObjectEdit, ObjectKey, SceneEdit,
};
use glam::DVec3;
use std::mem::replace;

/// A change: what is changed, and its value.
#[derive(Clone, Debug, PartialEq)]
pub enum Change {
    /// A material has other properties.
    Material(MaterialId, Box<Material>),
    /// An object is moved, hidden, deleted, or shown again.
    Object(ObjectKey, ObjectEdit),
    /// Sun and sky have other values, and their controls show these.
    Daylight(Daylight, Box<SunControls>),
    /// There is another ground, or none.
    Ground(Option<Ground>),
    /// The whole scene has other values, and the controls of the sun show these.
    Scene(Box<(SceneEdit, SunControls)>),
    /// A group of lights, given by its name, is set differently.
    Light(String, LightSetting),
    /// The saved views.
    Views(Vec<SavedView>),
    /// The user's camera path.
    Path(Option<CameraPath>),
    /// The distances that were measured.
    Measures(Vec<[DVec3; 2]>),
    /// The section.
    Section(Option<SectionView>),
}

impl Change {
    /// True where two changes of this kind, one soon after the other, are one step.
    pub(super) fn is_of_same(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Material(a, _), Self::Material(b, _)) => a == b,
            (Self::Object(a, before), Self::Object(b, now)) => a == b && before.is_gone() == now.is_gone(),
            (Self::Daylight(..), Self::Daylight(..)) => true,
            (Self::Ground(a), Self::Ground(b)) => a.is_some() == b.is_some(),
            (Self::Light(a, _), Self::Light(b, _)) => a == b,
            (Self::Section(Some(a)), Self::Section(Some(b))) => {
                (a.is_on, a.plane.axis) == (b.is_on, b.plane.axis)
            }
            _ => false,
        }
    }

    /// Stores the value in a document, and returns the change back to the old value.
    pub(super) fn swap(self, document: &mut Document) -> Self {
        let scene = &mut document.scene;
        match self {
            Self::Material(id, material) => {
                let place = &mut scene.materials[id.0 as usize];
                Self::Material(id, Box::new(replace(place, *material)))
            }
            Self::Object(key, edit) => {
                let before = match edit.is_none() {
                    true => scene.objects.remove(&key),
                    false => scene.objects.insert(key.clone(), edit),
                };
                Self::Object(key, before.unwrap_or_default())
            }
            Self::Daylight(daylight, sun) => {
                let before = replace(&mut scene.daylight, daylight);
                Self::Daylight(before, Box::new(replace(&mut document.sun, *sun)))
            }
            Self::Ground(ground) => Self::Ground(replace(&mut scene.ground, ground)),
            Self::Scene(other) => {
                let (edit, sun) = *other;
                let before = replace(scene, edit);
                Self::Scene(Box::new((before, replace(&mut document.sun, sun))))
            }
            Self::Light(name, setting) => {
                let before = scene.lights.get(&name);
                scene.lights.set(&name, setting);
                Self::Light(name, before)
            }
            Self::Views(views) => Self::Views(replace(&mut document.views, views)),
            Self::Path(path) => Self::Path(replace(&mut document.path, path)),
            Self::Measures(measures) => Self::Measures(replace(&mut document.measures, measures)),
            Self::Section(section) => Self::Section(replace(&mut document.section, section)),
        }
    }
}
