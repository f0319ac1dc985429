//! The document of the scene that is shown, with undo and redo.

use super::merge::Merge;
use super::{Change, Document};
use crate::window::state::Quality;
use afterimage::raster::exposure::Exposure;
use afterimage::scene::{ObjectEdit, ObjectKey, SceneEdit};
use std::time::{Duration, Instant};

/// Changes of one thing within this time are one step: a slider is being dragged, or a colour
/// chosen.
const ONE_GESTURE: Duration = Duration::from_millis(800);

/// The document of the scene that is shown. An undo step holds the value from before a change, a
/// redo step the value from after it.
#[derive(Clone, Debug)]
pub struct OpenDocument {
    /// What the files of the model hold.
    files: Document,
    saved: Document,
    saved_quality: Quality,
    now: Document,
    done: Vec<Change>,
    undone: Vec<Change>,
    changed: Option<Instant>,
    /// Stored, because a scene may have a million materials, and every update of the window reads
    /// it.
    differs: bool,
    /// Number of changes so far.
    revision: u64,
}

/// A document that was applied to files that have changed.
#[derive(Debug)]
pub struct Carried {
    /// The document of the new files.
    pub document: OpenDocument,
    /// Number of steps that can no longer be undone or redone: what they changed is gone.
    pub dropped_steps: usize,
}

impl OpenDocument {
    /// Begins the document of a model whose files hold `files`.
    pub fn new(files: Document, quality: Quality) -> Self {
        Self {
            saved: files.clone(),
            now: files.clone(),
            files,
            saved_quality: quality,
            done: Vec::new(),
            undone: Vec::new(),
            changed: None,
            differs: false,
            revision: 0,
        }
    }

    /// Returns the document with all changes.
    pub fn now(&self) -> &Document {
        &self.now
    }

    /// Returns the document as it was saved last, or as the model's files hold it.
    pub fn saved(&self) -> &Document {
        &self.saved
    }

    /// Returns what the files of the model hold.
    pub fn files(&self) -> &Document {
        &self.files
    }

    /// Returns materials, objects, daylight and lights with all changes.
    pub fn scene(&self) -> &SceneEdit {
        &self.now.scene
    }

    /// Returns what is changed about an object.
    pub fn object(&self, key: &ObjectKey) -> ObjectEdit {
        self.now.scene.objects.get(key).copied().unwrap_or_default()
    }

    /// True where the document or the settings of quality differ from what was saved.
    pub fn is_unsaved(&self, quality: &Quality) -> bool {
        self.differs || self.saved_quality != *quality
    }

    /// Returns a number that every change of the document raises.
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// True where the model's files hold another scene: what can be saved in the sidecar.
    pub fn differs_from_files(&self) -> bool {
        self.now.scene != self.files.scene
    }

    /// Notes that a session holds this document and these settings.
    pub fn set_saved(&mut self, saved: Document, quality: Quality) {
        (self.saved, self.saved_quality) = (saved, quality);
        self.note_saved();
    }

    /// Notes that the files of the model hold a scene, with the sun as its controls show it.
    pub fn set_saved_in_files(&mut self, saved: Document) {
        self.files.scene.clone_from(&saved.scene);
        (self.saved.scene, self.saved.sun) = (saved.scene, saved.sun);
        self.note_saved();
    }

    /// Notes that the exposure follows a view. It counts as saved where that of before did.
    pub fn follow_exposure(&mut self, before: Exposure, now: Exposure) {
        if self.saved_quality.exposure == before {
            self.saved_quality.exposure = now;
        }
    }

    fn note_saved(&mut self) {
        self.differs = self.now != self.saved;
        // The next change is a step of its own.
        self.changed = None;
    }

    /// Replaces the whole document by a restored one, which is not a step.
    pub fn restore(&mut self, document: Document) {
        self.now = document;
        (self.done, self.undone) = (Vec::new(), Vec::new());
        self.revision += 1;
        self.note_saved();
    }

    /// True where there is a step to undo.
    pub fn can_undo(&self) -> bool {
        !self.done.is_empty()
    }

    pub(super) fn last_done(&self) -> Option<&Change> {
        self.done.last()
    }

    pub(super) fn last_undone(&self) -> Option<&Change> {
        self.undone.last()
    }

    /// True where there is a step to redo.
    pub fn can_redo(&self) -> bool {
        !self.undone.is_empty()
    }

    /// Applies a change. Steps that were undone can no longer be redone.
    pub fn change(&mut self, change: Change) {
        let goes_on = self.changed.is_some_and(|at| at.elapsed() < ONE_GESTURE)
            && self.done.last().is_some_and(|last| last.is_of_same(&change));
        let before = self.swap(change);
        if !goes_on {
            self.done.push(before);
        }
        self.undone.clear();
        self.changed = Some(Instant::now());
    }

    /// Undoes the last step; false where there is none.
    pub fn undo(&mut self) -> bool {
        let Some(change) = self.done.pop() else { return false };
        let after = self.swap(change);
        self.undone.push(after);
        self.changed = None;
        true
    }

    /// Redoes the last step that was undone; false where there is none.
    pub fn redo(&mut self) -> bool {
        let Some(change) = self.undone.pop() else { return false };
        let before = self.swap(change);
        self.done.push(before);
        self.changed = None;
        true
    }

    fn swap(&mut self, change: Change) -> Change {
        let before = change.swap(&mut self.now);
        self.differs = self.now != self.saved;
        self.revision += 1;
        before
    }

    /// Applies the document to the files of the model as they are after a reload. What the user has
    /// changed stays, the rest follows the files. `has_object` finds whether they have an object.
    #[must_use]
    pub fn carried_to(&self, files: Document, has_object: &dyn Fn(&ObjectKey) -> bool) -> Carried {
        let merge = Merge::new(&self.files, &files, has_object);
        let carry = |steps: &[Change]| -> Vec<Change> {
            steps.iter().filter_map(|step| merge.change(step.clone())).collect()
        };
        let (done, undone) = (carry(&self.done), carry(&self.undone));
        let dropped_steps = self.done.len() + self.undone.len() - done.len() - undone.len();
        let (saved, now) = (merge.document(&self.saved), merge.document(&self.now));
        let differs = now != saved;
        let (saved_quality, revision) = (self.saved_quality, self.revision + 1);
        let changed = None;
        let document = Self { files, saved, saved_quality, now, done, undone, changed, differs, revision };
        Carried { document, dropped_steps }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::state::SavedView;
    use afterimage::Camera;
    use afterimage::scene::{LightSetting, Material, MaterialId};
    use glam::{DVec3, Vec3};

    fn file() -> Document {
        let mut document = Document::default();
        document.scene.materials = ["a", "b"].map(|name| Material::diffuse(name, Vec3::splat(0.5))).into();
        document
    }

    fn open() -> OpenDocument {
        OpenDocument::new(file(), Quality::default())
    }

    fn is_unsaved(document: &OpenDocument) -> bool {
        document.is_unsaved(&Quality::default())
    }

    fn view(name: &str, x: f64) -> SavedView {
        let camera = Camera::look_at(DVec3::new(x, 1.6, 0.0), DVec3::NEG_Z, 60.0);
        SavedView { name: name.to_owned(), camera, key: None }
    }

    fn red(id: u32, amount: f32) -> Change {
        let name = ["a", "b"][id as usize];
        Change::Material(MaterialId(id), Box::new(Material::diffuse(name, Vec3::new(amount, 0.0, 0.0))))
    }

    #[test]
    fn every_change_can_be_taken_back_and_made_again() {
        let mut document = open();
        let mut states = vec![document.now().clone()];
        let dim = |intensity| Change::Light("lamp".into(), LightSetting { intensity, ..LightSetting::FULL });
        for change in [red(0, 0.1), dim(0.5), red(1, 0.2), dim(0.0), red(0, 0.3)] {
            document.change(change);
            states.push(document.now().clone());
        }
        for state in states.iter().rev().skip(1) {
            assert!(document.undo());
            assert_eq!(document.now(), state);
        }
        assert!(!document.undo() && !is_unsaved(&document));
        for state in &states[1..] {
            assert!(document.redo());
            assert_eq!(document.now(), state);
        }
        assert!(!document.redo() && is_unsaved(&document));
        document.undo();
        document.change(red(1, 0.9));
        assert!(!document.can_redo(), "another change was made");
    }

    #[test]
    fn an_object_goes_and_comes_back_and_leaves_no_trace() {
        let mut document = open();
        let key = ObjectKey::first("chair");
        let moved = |x: f64| ObjectEdit { moved_m: glam::DVec3::X * x, ..ObjectEdit::default() };
        let hidden = ObjectEdit { is_hidden: true, ..moved(2.0) };
        for change in [moved(1.0), moved(2.0), hidden] {
            document.change(Change::Object(key.clone(), change));
        }
        assert_eq!(document.object(&key), hidden);
        // The drag is one step, hiding is another.
        assert!(document.undo());
        assert_eq!(document.object(&key), moved(2.0));
        assert!(document.undo() && !document.can_undo() && !is_unsaved(&document));
        assert!(document.scene().objects.is_empty());
        assert!(document.redo() && document.redo());
        assert_eq!(document.carried_to(file(), &|_| true).document.object(&key), hidden);
    }

    #[test]
    fn a_dragged_slider_is_one_step() {
        let mut document = open();
        for step in 1..=20 {
            document.change(red(0, step as f32 / 20.0));
        }
        assert!(document.undo() && !document.can_undo());
        assert_eq!(*document.now(), file());
    }

    #[test]
    fn unsaved_changes_survive_a_reload_by_name() {
        let mut document = open();
        document.change(red(1, 0.4));
        let off = LightSetting { is_on: false, ..LightSetting::FULL };
        document.change(Change::Light("lamp".into(), off));
        let mut reloaded = file();
        reloaded.scene.materials.reverse();
        reloaded.scene.materials.push(Material::diffuse("new", Vec3::ONE));
        let mut carried = document.carried_to(reloaded.clone(), &|_| true).document;
        assert_eq!(carried.scene().materials[0].diffuse, Vec3::new(0.4, 0.0, 0.0));
        assert_eq!(carried.scene().materials[1].diffuse, Vec3::splat(0.5));
        assert!(is_unsaved(&carried) && !carried.scene().lights.get("lamp").is_on);
        assert!(carried.undo() && carried.undo() && !carried.undo(), "every step is there");
        assert_eq!(*carried.now(), reloaded);
        document.set_saved(document.now().clone(), Quality::default());
        assert!(!is_unsaved(&document.carried_to(file(), &|_| true).document));
    }

    #[test]
    fn a_reload_merges_views_and_keeps_path_and_measures() {
        let files = |views: &[SavedView]| Document { views: views.to_vec(), ..file() };
        let was = files(&[view("start", 0.0), view("hall", 1.0), view("gone", 2.0)]);
        let mut document = OpenDocument::new(was, Quality::default());
        let mine = vec![view("start", 0.0), view("hall", 9.0), view("gone", 2.0), view("mine", 5.0)];
        document.change(Change::Views(mine));
        document.change(Change::Measures(vec![[DVec3::ZERO, DVec3::X]]));
        let new = files(&[view("start", 0.5), view("hall", 1.0), view("new", 3.0)]);
        let mut carried = document.carried_to(new.clone(), &|_| true).document;
        let expected = [view("start", 0.5), view("hall", 9.0), view("mine", 5.0), view("new", 3.0)];
        assert_eq!(carried.now().views, expected);
        assert_eq!(carried.now().measures.len(), 1);
        assert!(carried.undo() && carried.undo() && !carried.can_undo());
        assert_eq!(carried.now().views, new.views);
    }

    #[test]
    fn steps_of_materials_that_are_gone_are_dropped() {
        let mut document = open();
        document.change(red(0, 0.4));
        document.change(red(1, 0.4));
        let mut reloaded = file();
        reloaded.scene.materials.remove(0);
        let carried = document.carried_to(reloaded, &|_| true);
        assert_eq!(carried.dropped_steps, 1);
        let mut carried = carried.document;
        assert!(carried.undo() && !carried.undo());
    }
}
