//! Names of the steps that can be undone and redone, such as "mirror on WoodFloor".

use super::{Change, Document, OpenDocument};
use afterimage::scene::{Material, MaterialKind, ObjectEdit, ObjectKey};

impl OpenDocument {
    /// Returns the name of the step that [`Self::undo`] takes back.
    pub fn undo_name(&self) -> Option<String> {
        self.last_done().map(|change| name_of_done(change, self.now()))
    }

    /// Returns the name of the step that [`Self::redo`] makes again.
    pub fn redo_name(&self) -> Option<String> {
        self.last_undone().map(|change| name_of_undone(change, self.now()))
    }
}

/// Names a step that was done: the change holds the old value, the document the new one.
fn name_of_done(change: &Change, now: &Document) -> String {
    match change {
        Change::Material(id, before) => match now.scene.materials.get(id.0 as usize) {
            Some(material) => material_name(before, material),
            None => "material".to_owned(),
        },
        Change::Object(key, _) => object_name(key, now.scene.objects.get(key).copied().unwrap_or_default()),
        other => plain_name(other),
    }
}

/// Names a step that was undone: the change holds the new value, the document the old one.
fn name_of_undone(change: &Change, now: &Document) -> String {
    match change {
        Change::Material(id, after) => match now.scene.materials.get(id.0 as usize) {
            Some(before) => material_name(before, after),
            None => "material".to_owned(),
        },
        Change::Object(key, after) => object_name(key, *after),
        other => plain_name(other),
    }
}

fn material_name(before: &Material, after: &Material) -> String {
    let kind = match after.kind {
        MaterialKind::Diffuse => "matte",
        MaterialKind::Mirror { .. } => "mirror",
        MaterialKind::Glass { .. } => "glass",
        MaterialKind::Glossy { .. } => "glossy",
        MaterialKind::Frosted { .. } => "frosted glass",
    };
    let is_other = std::mem::discriminant(&before.kind) != std::mem::discriminant(&after.kind);
    format!("{} on {}", if is_other { kind } else { "values" }, after.name)
}

fn object_name(key: &ObjectKey, after: ObjectEdit) -> String {
    match (after.is_deleted, after.is_hidden) {
        (true, _) => format!("deleting {key}"),
        (_, true) => format!("hiding {key}"),
        _ => format!("place of {key}"),
    }
}

fn plain_name(change: &Change) -> String {
    match change {
        Change::Light(name, _) => format!("light {name}"),
        Change::Daylight(..) => "sun and sky".to_owned(),
        Change::Ground(_) => "ground".to_owned(),
        Change::Views(_) => "views".to_owned(),
        Change::Path(_) => "camera path".to_owned(),
        Change::Measures(_) => "distances".to_owned(),
        Change::Section(_) => "section".to_owned(),
        Change::Scene(_) => "several changes".to_owned(),
        Change::Material(..) | Change::Object(..) => "change".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::state::Quality;
    use afterimage::scene::MaterialId;
    use glam::Vec3;

    #[test]
    fn steps_are_named_by_what_they_change() {
        let floor = Material::diffuse("WoodFloor", Vec3::splat(0.5));
        let mut document = Document::default();
        document.scene.materials = vec![floor];
        let mut open = OpenDocument::new(document, Quality::default());
        assert_eq!((open.undo_name(), open.redo_name()), (None, None));
        let mirror = Material::mirror("WoodFloor", Vec3::splat(0.9));
        open.change(Change::Material(MaterialId(0), Box::new(mirror)));
        assert_eq!(open.undo_name().as_deref(), Some("mirror on WoodFloor"));
        let hidden = ObjectEdit { is_hidden: true, ..ObjectEdit::default() };
        open.change(Change::Object(ObjectKey::first("chair"), hidden));
        assert_eq!(open.undo_name().as_deref(), Some("hiding chair"));
        assert!(open.undo());
        assert_eq!(open.redo_name().as_deref(), Some("hiding chair"));
        assert!(open.undo());
        assert_eq!(open.redo_name().as_deref(), Some("mirror on WoodFloor"));
    }
}
