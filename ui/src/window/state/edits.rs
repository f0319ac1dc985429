//! Edits of the scene since it was opened, with undo and redo.

use super::SavedView;
use afterimage::scene::{
    Daylight, Ground, LightSetting, Material, MaterialId, ObjectEdit, ObjectKey, SceneEdit,
};
use std::time::{Duration, Instant};

/// Changes of one thing within this time are one step: a slider is being dragged, or a colour
/// chosen.
const ONE_GESTURE: Duration = Duration::from_millis(800);

/// A change: what is changed, and its value.
#[derive(Clone, Debug, PartialEq)]
pub enum Change {
    /// A material has other properties.
    Material(MaterialId, Box<Material>),
    /// An object is moved, hidden, deleted, or shown again.
    Object(ObjectKey, ObjectEdit),
    /// Sun and sky have other values.
    Daylight(Daylight),
    /// There is another ground, or none.
    Ground(Option<Ground>),
    /// A group of lights, given by its name, is set differently.
    Light(String, LightSetting),
    /// The saved views. They are not part of the scene's files.
    Views(Vec<SavedView>),
}

impl Change {
    fn is_of_same(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Material(a, _), Self::Material(b, _)) => a == b,
            (Self::Object(a, before), Self::Object(b, now)) => a == b && before.is_gone() == now.is_gone(),
            (Self::Daylight(_), Self::Daylight(_)) => true,
            (Self::Ground(a), Self::Ground(b)) => a.is_some() == b.is_some(),
            (Self::Light(a, _), Self::Light(b, _)) => a == b,
            _ => false,
        }
    }
}

/// The edits of a scene. An undo step holds the value from before a change, a redo step the value
/// from after it.
#[derive(Clone, Debug)]
pub struct Edits {
    saved: SceneEdit,
    now: SceneEdit,
    done: Vec<Change>,
    undone: Vec<Change>,
    changed: Option<Instant>,
    /// Stored, because a scene may have a million materials, and every update of the window reads
    /// it.
    is_unsaved: bool,
}

impl Edits {
    /// Begins the edits of a scene whose files hold `saved`.
    pub fn new(saved: SceneEdit) -> Self {
        let (done, undone) = (Vec::new(), Vec::new());
        Self { now: saved.clone(), saved, done, undone, changed: None, is_unsaved: false }
    }

    /// Returns materials, daylight and lights with all edits.
    pub fn now(&self) -> &SceneEdit {
        &self.now
    }

    /// Returns materials, daylight and lights as the scene's files hold them.
    pub fn saved(&self) -> &SceneEdit {
        &self.saved
    }

    /// Returns what is changed about an object.
    pub fn object(&self, key: &ObjectKey) -> ObjectEdit {
        self.now.objects.get(key).copied().unwrap_or_default()
    }

    /// True where the scene's files hold other values.
    pub fn is_unsaved(&self) -> bool {
        self.is_unsaved
    }

    /// Notes that the scene's files hold `saved` now.
    pub fn set_saved(&mut self, saved: SceneEdit) {
        self.saved = saved;
        self.is_unsaved = self.now != self.saved;
        // The next change is a step of its own.
        self.changed = None;
    }

    /// True where there is a step to undo.
    pub fn can_undo(&self) -> bool {
        !self.done.is_empty()
    }

    /// True where there is a step to redo.
    pub fn can_redo(&self) -> bool {
        !self.undone.is_empty()
    }

    /// Applies a change. Steps that were undone can no longer be redone.
    pub fn change(&mut self, change: Change, views: &mut Vec<SavedView>) {
        let goes_on = self.changed.is_some_and(|at| at.elapsed() < ONE_GESTURE)
            && self.done.last().is_some_and(|last| last.is_of_same(&change));
        let before = self.swap(change, views);
        if !goes_on {
            self.done.push(before);
        }
        self.undone.clear();
        self.changed = Some(Instant::now());
    }

    /// Undoes the last step; false where there is none.
    pub fn undo(&mut self, views: &mut Vec<SavedView>) -> bool {
        let Some(change) = self.done.pop() else { return false };
        let after = self.swap(change, views);
        self.undone.push(after);
        self.changed = None;
        true
    }

    /// Redoes the last step that was undone; false where there is none.
    pub fn redo(&mut self, views: &mut Vec<SavedView>) -> bool {
        let Some(change) = self.undone.pop() else { return false };
        let before = self.swap(change, views);
        self.done.push(before);
        self.changed = None;
        true
    }

    /// Notes a change of the saved views, so that it can be undone. `before` holds the old views.
    pub fn note_views(&mut self, before: Vec<SavedView>) {
        self.done.push(Change::Views(before));
        self.undone.clear();
    }

    /// Applies the unsaved edits to a scene that was loaded again; materials and objects are
    /// matched by name.
    #[must_use]
    pub fn carried_to(&self, saved: SceneEdit) -> Self {
        let mut carried = Self::new(saved);
        let changed =
            self.now.materials.iter().zip(&self.saved.materials).filter(|(now, saved)| now != saved);
        for (material, _) in changed {
            if let Some(at) = carried.now.materials.iter().position(|m| m.name == material.name) {
                // Indices of textures change with every import.
                let place = &carried.now.materials[at];
                let Material { diffuse_texture, alpha_texture, coverage_texture, emission_texture, .. } =
                    *place;
                let mut material = Material { diffuse_texture, alpha_texture, ..material.clone() };
                (material.coverage_texture, material.emission_texture) = (coverage_texture, emission_texture);
                material.detail = place.detail;
                carried.change(Change::Material(MaterialId(at as u32), Box::new(material)), &mut Vec::new());
            }
        }
        for key in self.now.objects.keys().chain(self.saved.objects.keys()) {
            let [now, saved] = [&self.now, &self.saved].map(|edit| edit.objects.get(key));
            if now != saved && carried.object(key) != self.object(key) {
                carried.change(Change::Object(key.clone(), self.object(key)), &mut Vec::new());
            }
        }
        if self.now.daylight != self.saved.daylight {
            carried.change(Change::Daylight(self.now.daylight.clone()), &mut Vec::new());
        }
        if self.now.ground != self.saved.ground {
            carried.change(Change::Ground(self.now.ground), &mut Vec::new());
        }
        for (name, _) in self.now.lights.iter().chain(self.saved.lights.iter()) {
            let setting = self.now.lights.get(name);
            if setting != self.saved.lights.get(name) {
                carried.change(Change::Light(name.to_owned(), setting), &mut Vec::new());
            }
        }
        carried
    }

    /// Stores the value of a change, and returns the change back to the old value.
    fn swap(&mut self, change: Change, views: &mut Vec<SavedView>) -> Change {
        let before = match change {
            Change::Material(id, material) => {
                let place = &mut self.now.materials[id.0 as usize];
                Change::Material(id, Box::new(std::mem::replace(place, *material)))
            }
            Change::Object(key, edit) => {
                let objects = &mut self.now.objects;
                let before = match edit.is_none() {
                    true => objects.remove(&key),
                    false => objects.insert(key.clone(), edit),
                };
                Change::Object(key, before.unwrap_or_default())
            }
            Change::Daylight(daylight) => {
                Change::Daylight(std::mem::replace(&mut self.now.daylight, daylight))
            }
            Change::Ground(ground) => Change::Ground(std::mem::replace(&mut self.now.ground, ground)),
            Change::Light(name, setting) => {
                let before = self.now.lights.get(&name);
                self.now.lights.set(&name, setting);
                Change::Light(name, before)
            }
            Change::Views(new) => Change::Views(std::mem::replace(views, new)),
        };
        self.is_unsaved = self.now != self.saved;
        before
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use afterimage::scene::LightSettings;
    use glam::Vec3;

    fn edit() -> SceneEdit {
        let materials = ["a", "b"].map(|name| Material::diffuse(name, Vec3::splat(0.5))).into();
        SceneEdit {
            materials,
            daylight: Daylight::default(),
            lights: LightSettings::default(),
            objects: Default::default(),
            ground: None,
        }
    }

    fn red(id: u32, amount: f32) -> Change {
        let name = ["a", "b"][id as usize];
        Change::Material(MaterialId(id), Box::new(Material::diffuse(name, Vec3::new(amount, 0.0, 0.0))))
    }

    #[test]
    fn every_change_can_be_taken_back_and_made_again() {
        let (mut edits, mut views) = (Edits::new(edit()), Vec::new());
        let mut states = vec![edits.now().clone()];
        let dim = |intensity| Change::Light("lamp".into(), LightSetting { intensity, ..LightSetting::FULL });
        for change in [red(0, 0.1), dim(0.5), red(1, 0.2), dim(0.0), red(0, 0.3)] {
            edits.change(change, &mut views);
            states.push(edits.now().clone());
        }
        for state in states.iter().rev().skip(1) {
            assert!(edits.undo(&mut views));
            assert_eq!(edits.now(), state);
        }
        assert!(!edits.undo(&mut views) && !edits.is_unsaved());
        for state in &states[1..] {
            assert!(edits.redo(&mut views));
            assert_eq!(edits.now(), state);
        }
        assert!(!edits.redo(&mut views) && edits.is_unsaved());
        edits.undo(&mut views);
        edits.change(red(1, 0.9), &mut views);
        assert!(!edits.can_redo(), "another change was made");
    }

    #[test]
    fn an_object_goes_and_comes_back_and_leaves_no_trace() {
        let (mut edits, mut views) = (Edits::new(edit()), Vec::new());
        let key = ObjectKey::first("chair");
        let moved = |x: f64| ObjectEdit { moved_m: glam::DVec3::X * x, ..ObjectEdit::default() };
        let hidden = ObjectEdit { is_hidden: true, ..moved(2.0) };
        for change in [moved(1.0), moved(2.0), hidden] {
            edits.change(Change::Object(key.clone(), change), &mut views);
        }
        assert_eq!(edits.object(&key), hidden);
        // The drag is one step, hiding is another.
        assert!(edits.undo(&mut views));
        assert_eq!(edits.object(&key), moved(2.0));
        assert!(edits.undo(&mut views) && !edits.can_undo() && !edits.is_unsaved());
        assert!(edits.now().objects.is_empty());
        assert!(edits.redo(&mut views) && edits.redo(&mut views));
        assert_eq!(edits.carried_to(edit()).object(&key), hidden);
    }

    #[test]
    fn a_dragged_slider_is_one_step() {
        let (mut edits, mut views) = (Edits::new(edit()), Vec::new());
        for step in 1..=20 {
            edits.change(red(0, step as f32 / 20.0), &mut views);
        }
        assert!(edits.undo(&mut views) && !edits.can_undo());
        assert_eq!(*edits.now(), edit());
    }

    #[test]
    fn unsaved_changes_survive_a_reload_by_name() {
        let (mut edits, mut views) = (Edits::new(edit()), Vec::new());
        edits.change(red(1, 0.4), &mut views);
        let off = LightSetting { is_on: false, ..LightSetting::FULL };
        edits.change(Change::Light("lamp".into(), off), &mut views);
        let mut reloaded = edit();
        reloaded.materials.reverse();
        reloaded.materials.push(Material::diffuse("new", Vec3::ONE));
        let carried = edits.carried_to(reloaded);
        assert_eq!(carried.now().materials[0].diffuse, Vec3::new(0.4, 0.0, 0.0));
        assert_eq!(carried.now().materials[1].diffuse, Vec3::splat(0.5));
        assert!(carried.is_unsaved() && carried.can_undo() && !carried.now().lights.get("lamp").is_on);
        edits.set_saved(edits.now().clone());
        assert!(!edits.carried_to(edit()).is_unsaved());
    }
}
