//! `[[object]]` of a sidecar: objects that are moved, hidden or deleted.

use super::table::{Notes, Section, suggestion};
use crate::scene::{ObjectEdit, ObjectEdits, ObjectKey, Scene, Warning};
use glam::DVec3;

/// Keys of `[[object]]`.
const KEYS: [&str; 6] = ["name", "number", "move_m", "turn_deg", "hidden", "deleted"];

/// Number of unknown objects that are reported with a suggestion; others are only counted.
const MAX_UNKNOWN_SHOWN: usize = 20;

/// An edit of an object, and the line that begins it.
#[derive(Debug)]
pub(super) struct ObjectLine {
    key: ObjectKey,
    edit: ObjectEdit,
    line: u64,
}

impl ObjectLine {
    /// Returns the object and what is changed about it.
    pub(super) fn into_edit(self) -> (ObjectKey, ObjectEdit) {
        (self.key, self.edit)
    }
}

pub(super) fn read(top: &Section, notes: &mut Notes) -> Vec<ObjectLine> {
    let sections = top.sections("object", "[[object]]", &KEYS, notes);
    let object = |s: Section| {
        let Some(name) = s.text("name", notes) else {
            notes.add(s.at(), "[[object]] needs a name; it was ignored".to_owned());
            return None;
        };
        let number = s.number("number", 1.0..=f64::from(u32::MAX), notes).map_or(1, |n| n as u32);
        let edit = ObjectEdit {
            is_hidden: s.flag("hidden", notes).unwrap_or(false),
            is_deleted: s.flag("deleted", notes).unwrap_or(false),
            moved_m: s.point("move_m", notes).unwrap_or(DVec3::ZERO),
            turned_deg: s.number("turn_deg", -360.0..=360.0, notes).unwrap_or(0.0),
        };
        Some(ObjectLine { key: ObjectKey { name: name.to_owned(), number }, edit, line: notes.line(s.at()) })
    };
    sections.into_iter().filter_map(object).collect()
}

/// Moves, hides and deletes objects of a scene. What cannot be done is a warning, and the rest is
/// done.
pub(super) fn apply(lines: Vec<ObjectLine>, file_name: &str, mut scene: Scene) -> Scene {
    if lines.is_empty() {
        return scene;
    }
    let (mut edits, mut warnings, mut unknown) = (ObjectEdits::new(), Vec::new(), 0);
    for ObjectLine { key, edit, line } in lines {
        if !scene.all_objects().keys().contains(&key) {
            unknown += 1;
            if unknown <= MAX_UNKNOWN_SHOWN {
                let names: Vec<&str> = scene.all_objects().keys().iter().map(|k| k.name.as_str()).collect();
                warnings.push((
                    line,
                    format!("the model has no object '{key}'; {}", suggestion(&key.name, &names)),
                ));
            }
        } else if !edit.is_possible(scene.bounds_m) {
            let message = "is farther than ten thousand times the size of the model; it was ignored";
            warnings.push((line, format!("the way of object '{key}' {message}")));
        } else {
            edits.insert(key, edit);
        }
    }
    if unknown > MAX_UNKNOWN_SHOWN {
        warnings.push((0, format!("{unknown} objects in all are not in the model")));
    }
    if !edits.is_empty() {
        let edit = crate::scene::SceneEdit { objects: edits.clone(), ..scene.to_edit() };
        let edited = scene.with_edit(&edit);
        if edits.values().any(|edit| !edit.is_none()) && edited.object_edits().is_empty() {
            warnings.push((0, "nothing would be left of the model; all its objects are shown".to_owned()));
        }
        scene = edited;
    }
    let warning = |(line, message)| Warning { file: file_name.to_owned(), line, message };
    scene.warnings.extend(warnings.into_iter().map(warning));
    scene
}
