//! What was changed in the scene since it was opened, and the way back.

use super::scene::SavedView;
use afterimage::scene::{Daylight, Material, MaterialId, SceneEdit};
use std::time::{Duration, Instant};

/// Changes of one thing within so long are one: a slider that is dragged, a colour that is looked for.
const ONE_GESTURE: Duration = Duration::from_millis(800);

/// Something that can be changed, with a value for it.
#[derive(Clone, Debug, PartialEq)]
pub enum Change {
    /// A material.
    Material(MaterialId, Material),
    /// Sun and sky.
    Daylight(Daylight),
    /// The saved views, in the window only.
    Views(Vec<SavedView>),
}

impl Change {
    fn is_of_same(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Material(a, _), Self::Material(b, _)) => a == b,
            (Self::Daylight(_), Self::Daylight(_)) => true,
            _ => false,
        }
    }
}

/// All changes. A step of undoing holds the value that was there before, one of redoing the value that came after.
#[derive(Clone, Debug)]
pub struct Edits {
    saved: SceneEdit,
    now: SceneEdit,
    done: Vec<Change>,
    undone: Vec<Change>,
    changed: Option<Instant>,
    /// Kept, because a scene may have a million materials and every picture of the window asks.
    is_unsaved: bool,
}

impl Edits {
    /// Nothing is changed yet.
    pub fn new(look: SceneEdit) -> Self {
        let (done, undone) = (Vec::new(), Vec::new());
        Self { saved: look.clone(), now: look, done, undone, changed: None, is_unsaved: false }
    }

    /// What the scene should look like.
    pub fn now(&self) -> &SceneEdit {
        &self.now
    }

    /// What it looks like in its files.
    pub fn saved(&self) -> &SceneEdit {
        &self.saved
    }

    /// True where the scene's files say something else.
    pub fn is_unsaved(&self) -> bool {
        self.is_unsaved
    }

    /// To be called once a look is in the scene's files.
    pub fn set_saved(&mut self, look: SceneEdit) {
        self.saved = look;
        self.is_unsaved = self.now != self.saved;
        // What comes next is a step of its own.
        self.changed = None;
    }

    /// True where there is something to take back.
    pub fn can_undo(&self) -> bool {
        !self.done.is_empty()
    }

    /// True where something was taken back.
    pub fn can_redo(&self) -> bool {
        !self.undone.is_empty()
    }

    /// Changes something. What was taken back before cannot be redone any more.
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

    /// Takes the last change back; false where there is none.
    pub fn undo(&mut self, views: &mut Vec<SavedView>) -> bool {
        let Some(change) = self.done.pop() else { return false };
        let after = self.swap(change, views);
        self.undone.push(after);
        self.changed = None;
        true
    }

    /// Makes the change that was taken back last again; false where there is none.
    pub fn redo(&mut self, views: &mut Vec<SavedView>) -> bool {
        let Some(change) = self.undone.pop() else { return false };
        let before = self.swap(change, views);
        self.done.push(before);
        self.changed = None;
        true
    }

    /// The saved views were changed elsewhere.
    pub fn note_views(&mut self, before: Vec<SavedView>) {
        self.done.push(Change::Views(before));
        self.undone.clear();
    }

    /// The same changes, where they are not saved, on another state of the scene's files: materials by name.
    #[must_use]
    pub fn carried_to(&self, look: SceneEdit) -> Self {
        let mut carried = Self::new(look);
        let changed =
            self.now.materials.iter().zip(&self.saved.materials).filter(|(now, saved)| now != saved);
        for (material, _) in changed {
            if let Some(at) = carried.now.materials.iter().position(|m| m.name == material.name) {
                // Textures are counted anew with every import.
                let place = &carried.now.materials[at];
                let (diffuse_texture, alpha_texture) = (place.diffuse_texture, place.alpha_texture);
                let material = Material { diffuse_texture, alpha_texture, ..material.clone() };
                carried.change(Change::Material(MaterialId(at as u32), material), &mut Vec::new());
            }
        }
        if self.now.daylight != self.saved.daylight {
            carried.change(Change::Daylight(self.now.daylight), &mut Vec::new());
        }
        carried
    }

    /// Puts a value in its place; returns what was there.
    fn swap(&mut self, change: Change, views: &mut Vec<SavedView>) -> Change {
        let before = match change {
            Change::Material(id, material) => {
                let place = &mut self.now.materials[id.0 as usize];
                Change::Material(id, std::mem::replace(place, material))
            }
            Change::Daylight(daylight) => {
                Change::Daylight(std::mem::replace(&mut self.now.daylight, daylight))
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
    use glam::Vec3;

    fn look() -> SceneEdit {
        let materials = ["a", "b"].map(|name| Material::diffuse(name, Vec3::splat(0.5))).into();
        SceneEdit { materials, daylight: Daylight::default() }
    }

    fn red(id: u32, amount: f32) -> Change {
        let name = ["a", "b"][id as usize];
        Change::Material(MaterialId(id), Material::diffuse(name, Vec3::new(amount, 0.0, 0.0)))
    }

    #[test]
    fn every_change_can_be_taken_back_and_made_again() {
        let (mut edits, mut views) = (Edits::new(look()), Vec::new());
        let mut states = vec![edits.now().clone()];
        for change in [red(0, 0.1), red(1, 0.2), red(0, 0.3)] {
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
        assert!(!edits.can_redo(), "another way was taken");
    }

    #[test]
    fn a_dragged_slider_is_one_step() {
        let (mut edits, mut views) = (Edits::new(look()), Vec::new());
        for step in 1..=20 {
            edits.change(red(0, step as f32 / 20.0), &mut views);
        }
        assert!(edits.undo(&mut views) && !edits.can_undo());
        assert_eq!(*edits.now(), look());
    }

    #[test]
    fn unsaved_changes_survive_a_reload_by_name() {
        let (mut edits, mut views) = (Edits::new(look()), Vec::new());
        edits.change(red(1, 0.4), &mut views);
        let mut reloaded = look();
        reloaded.materials.reverse();
        reloaded.materials.push(Material::diffuse("new", Vec3::ONE));
        let carried = edits.carried_to(reloaded);
        assert_eq!(carried.now().materials[0].diffuse, Vec3::new(0.4, 0.0, 0.0));
        assert_eq!(carried.now().materials[1].diffuse, Vec3::splat(0.5));
        assert!(carried.is_unsaved() && carried.can_undo());
        edits.set_saved(edits.now().clone());
        assert!(!edits.carried_to(look()).is_unsaved());
    }
}
