//! Merging a document with files that have changed. What the user has changed stays; the rest
//! follows the files. Materials, objects and views are matched by name.

use super::{Change, Document};
use crate::window::state::{SavedView, SunControls};
use afterimage::scene::{Daylight, LightSettings, Material, MaterialId, ObjectEdits, ObjectKey, SceneEdit};
use std::collections::HashMap;

/// What the files held before and hold now, with the materials of one matched to the other.
pub(super) struct Merge<'a> {
    before: &'a Document,
    after: &'a Document,
    /// For each material of `before`, the index of the same material in `after`.
    materials: Vec<Option<usize>>,
    has_object: &'a dyn Fn(&ObjectKey) -> bool,
}

impl<'a> Merge<'a> {
    /// Matches two states of the files of one model. `has_object` finds whether the new one has an
    /// object.
    pub(super) fn new(
        before: &'a Document,
        after: &'a Document,
        has_object: &'a dyn Fn(&ObjectKey) -> bool,
    ) -> Self {
        let materials = matched(&before.scene.materials, &after.scene.materials);
        Self { before, after, materials, has_object }
    }

    /// Returns what the user had made of the old files, made of the new ones.
    pub(super) fn document(&self, mine: &Document) -> Document {
        let scene = self.scene(&mine.scene);
        let sun = self.sun(&mine.sun, &mine.scene.daylight, &scene.daylight);
        let views = self.views(&mine.views);
        let (path, measures) = (mine.path.clone(), mine.measures.clone());
        Document { scene, sun, views, path, measures, section: mine.section }
    }

    /// Returns an undo step as it is for the new files; `None` where its material or object is
    /// gone.
    pub(super) fn change(&self, step: Change) -> Option<Change> {
        Some(match step {
            Change::Material(id, material) => {
                let at = (*self.materials.get(id.0 as usize)?)?;
                let merged = self.material(id.0 as usize, at, &material);
                Change::Material(MaterialId(at as u32), Box::new(merged))
            }
            Change::Daylight(daylight, sun) => {
                let merged = chosen(&self.before.scene.daylight, &daylight, &self.after.scene.daylight);
                let sun = self.sun(&sun, &daylight, merged);
                Change::Daylight(merged.clone(), Box::new(sun))
            }
            Change::Object(key, _) if !(self.has_object)(&key) => return None,
            Change::Scene(other) => {
                let scene = self.scene(&other.0);
                let sun = self.sun(&other.1, &other.0.daylight, &scene.daylight);
                Change::Scene(Box::new((scene, sun)))
            }
            Change::Views(views) => Change::Views(self.views(&views)),
            other => other,
        })
    }

    fn scene(&self, mine: &SceneEdit) -> SceneEdit {
        let (before, after) = (&self.before.scene, &self.after.scene);
        let mut materials = after.materials.clone();
        for (i, material) in mine.materials.iter().enumerate() {
            if let Some(at) = self.materials.get(i).copied().flatten() {
                materials[at] = self.material(i, at, material);
            }
        }
        SceneEdit {
            materials,
            daylight: chosen(&before.daylight, &mine.daylight, &after.daylight).clone(),
            lights: lights(&before.lights, &mine.lights, &after.lights),
            objects: objects(&before.objects, &mine.objects, &after.objects),
            ground: *chosen(&before.ground, &mine.ground, &after.ground),
        }
    }

    /// Returns material `i` of the old files in its new place `at`. Indices of textures change with
    /// every import.
    fn material(&self, i: usize, at: usize, mine: &Material) -> Material {
        let place = &self.after.scene.materials[at];
        if self.before.scene.materials.get(i) == Some(mine) {
            return place.clone();
        }
        let Material { diffuse_texture, alpha_texture, coverage_texture, emission_texture, detail, .. } =
            place.clone();
        Material {
            diffuse_texture,
            alpha_texture,
            coverage_texture,
            emission_texture,
            detail,
            ..mine.clone()
        }
    }

    /// Returns the controls of the sun for `now`, where they stood for `mine` before.
    fn sun(&self, sun: &SunControls, mine: &Daylight, now: &Daylight) -> SunControls {
        let mut merged = SunControls { nits_per_unit: self.after.sun.nits_per_unit, ..sun.clone() };
        if mine != now {
            merged.show(now);
        }
        merged
    }

    /// Returns the views: those that the user did not touch as the files have them, his own, and
    /// those that are new in the files.
    fn views(&self, mine: &[SavedView]) -> Vec<SavedView> {
        let (before, after) = (&self.before.views, &self.after.views);
        let named = |views: &'a [SavedView], name: &str| views.iter().find(|v| v.name == name);
        let mut merged: Vec<SavedView> = Vec::new();
        for view in mine {
            let is_untouched = named(before, &view.name).is_some_and(|v| v.camera == view.camera);
            match named(after, &view.name) {
                Some(new) if is_untouched => {
                    merged.push(SavedView { camera: new.camera, ..view.clone() });
                }
                None if is_untouched => {}
                _ => merged.push(view.clone()),
            }
        }
        for new in after {
            if named(before, &new.name).is_none() && !mine.iter().any(|v| v.name == new.name) {
                let is_taken = merged.iter().any(|v| v.key.is_some() && v.key == new.key);
                merged.push(SavedView { key: new.key.filter(|_| !is_taken), ..new.clone() });
            }
        }
        // One view must remain.
        if merged.is_empty() { after.clone() } else { merged }
    }
}

/// Returns the user's value where he has changed it, and that of the new files otherwise.
fn chosen<'v, T: PartialEq>(before: &T, mine: &'v T, after: &'v T) -> &'v T {
    if mine == before { after } else { mine }
}

/// Matches materials by name; of several with one name, the first to the first, and so on.
fn matched(before: &[Material], after: &[Material]) -> Vec<Option<usize>> {
    let mut by_name: HashMap<&str, std::collections::VecDeque<usize>> = HashMap::new();
    for (i, material) in after.iter().enumerate() {
        by_name.entry(&material.name).or_default().push_back(i);
    }
    before.iter().map(|m| by_name.get_mut(m.name.as_str())?.pop_front()).collect()
}

fn objects(before: &ObjectEdits, mine: &ObjectEdits, after: &ObjectEdits) -> ObjectEdits {
    let mut merged = after.clone();
    for key in before.keys().chain(mine.keys()) {
        match mine.get(key) {
            now if now == before.get(key) => {}
            Some(edit) => drop(merged.insert(key.clone(), *edit)),
            None => drop(merged.remove(key)),
        }
    }
    merged
}

fn lights(before: &LightSettings, mine: &LightSettings, after: &LightSettings) -> LightSettings {
    let mut merged = after.clone();
    for (name, _) in before.iter().chain(mine.iter()) {
        if mine.get(name) != before.get(name) {
            merged.set(name, mine.get(name));
        }
    }
    merged
}
