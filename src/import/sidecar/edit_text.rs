//! An edit of a scene as text in the format of sidecars, for files that are not sidecars: sessions
//! and notes of pictures.

use super::edit::{name_beside, write_edit};
use super::read::Sidecar;
use super::table::Notes;
use crate::import::{files::Jail, search::Finder};
use crate::scene::{ObjectEdit, ObjectKey, Scene, SceneBuilder, SceneEdit, Sky, SkyKind};
use std::path::Path;
use toml::{Table, Value, de::DeTable};

/// Maximum size of the text of an edit in bytes.
const MAX_BYTES: usize = super::read::MAX_BYTES as usize;

/// Key of older texts that lists what the model's files have and the edit removes: `sun`, `sky`.
const WITHOUT: &str = "without";

/// Where the pictures that an edit names may lie.
#[derive(Clone, Copy, Debug)]
pub struct EditFolder<'a> {
    /// The model, whose folder names are relative to; `None` where it has no file.
    pub model: Option<&'a Path>,
    /// Allows a picture of the sky anywhere, given by its absolute path.
    pub allow_outside: bool,
}

/// What a text of [`edit_text`] makes of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct AppliedEdit {
    /// The edit of the scene.
    pub edit: SceneEdit,
    /// What the text has wrong, which is ignored.
    pub messages: Vec<String>,
    /// Name of the picture of the sky where it lies in a folder from which nothing may be read. The
    /// sky is as it was then.
    pub outside: Option<String>,
}

/// Returns the differences between `before` and `now` as TOML, with the tables of a sidecar.
/// [`apply_edit_text`] makes `now` of them and `before`.
///
/// # Errors
/// A message for the user, where the picture of the sky lies in another folder than is allowed.
pub fn edit_text(folder: EditFolder<'_>, before: &SceneEdit, now: &SceneEdit) -> Result<String, String> {
    let mut document = toml_edit::DocumentMut::new();
    let model = folder.model.unwrap_or(Path::new(""));
    let sky = |file: &Path| match name_beside(file, model) {
        Err(_) if folder.allow_outside => absolute(file),
        name => name,
    };
    write_edit(&mut document, &sky, before, now).map_err(|error| error.to_string())?;
    let mut table: Table =
        document.to_string().parse().map_err(|error: toml::de::Error| error.to_string())?;
    add_resets(&mut table, before, now);
    Ok(table.to_string())
}

fn absolute(file: &Path) -> Result<String, String> {
    let full = std::path::absolute(file).map_err(|error| error.to_string())?;
    full.to_str().map(str::to_owned).ok_or_else(|| "its path is not valid Unicode".to_owned())
}

/// Adds what a sidecar expresses by leaving it out: objects and lights as the model has them.
fn add_resets(table: &mut Table, before: &SceneEdit, now: &SceneEdit) {
    for key in before.objects.keys().filter(|key| !now.objects.contains_key(key)) {
        let number = Value::Integer(key.number.into());
        let object = [("name".to_owned(), Value::String(key.name.clone())), ("number".to_owned(), number)];
        push(table, "object", Table::from_iter(object));
    }
    for (name, _) in before.lights.iter().filter(|(name, _)| now.lights.iter().all(|(n, _)| n != *name)) {
        push(table, "lights", Table::from_iter([("name".to_owned(), Value::String(name.to_owned()))]));
    }
}

fn push(table: &mut Table, name: &str, entry: Table) {
    let list = table.entry(name).or_insert_with(|| Value::Array(Vec::new()));
    if let Value::Array(list) = list {
        list.push(Value::Table(entry));
    }
}

/// Applies a text of [`edit_text`] to `before`, an edit of `scene`. Reads the picture of the sky,
/// where it names one.
///
/// # Errors
/// A message for the user, where the text is no TOML or too long.
pub fn apply_edit_text(
    text: &str,
    folder: EditFolder<'_>,
    scene: &Scene,
    before: &SceneEdit,
) -> Result<AppliedEdit, String> {
    if text.len() > MAX_BYTES {
        return Err(format!(
            "the changes of the scene take {} bytes; at most {MAX_BYTES} are read",
            text.len()
        ));
    }
    let mut table: Table = text.parse().map_err(|error: toml::de::Error| error.message().to_owned())?;
    let mut builder = SceneBuilder::new("");
    builder.materials.clone_from(&before.materials);
    (builder.sun, builder.sky) = (before.daylight.sun, before.daylight.sky.clone());
    builder.light_settings = before.lights.clone();
    builder.is_photometric = scene.is_photometric;
    reset(&mut builder, &mut table);
    let mut finder = jail(folder).map(Finder::new);
    let outside = picture_of(&table).filter(|name| is_outside(finder.as_mut(), name));
    if outside.is_some() {
        table.remove("sky");
    }
    let text = table.to_string();
    let parsed = DeTable::parse(&text).map_err(|error| error.message().to_owned())?;
    let mut notes = Notes::new(&text);
    let mut sidecar = Sidecar::of(parsed.get_ref(), &mut notes);
    let mut messages: Vec<String> = notes.messages.into_iter().map(|(_, message)| message).collect();
    sidecar.override_materials(&[], &mut builder);
    let mut edit = before.clone();
    for (key, object) in sidecar.take_objects() {
        messages.extend(set_object(&mut edit, scene, key, object));
    }
    if let Some(ground) = sidecar.ground {
        edit.ground = ground.ground(scene);
    }
    let nowhere = || Finder::new(Jail { folder: Path::new("").to_owned(), allow_outside: false });
    sidecar.apply_light(&mut finder.unwrap_or_else(nowhere), &mut builder);
    messages.extend(builder.warnings.into_iter().map(|warning| warning.message));
    (edit.materials, edit.lights) = (builder.materials, builder.light_settings);
    (edit.daylight.sun, edit.daylight.sky) = (builder.sun, builder.sky);
    Ok(AppliedEdit { edit, messages, outside })
}

/// Returns where pictures are looked for; `None` where there is no such folder.
fn jail(folder: EditFolder<'_>) -> Option<Jail> {
    let model = folder.model.and_then(|model| model.canonicalize().ok());
    let parent = model.as_deref().and_then(Path::parent).map(Path::to_owned);
    let parent = parent.or_else(|| folder.allow_outside.then(Default::default))?;
    Some(Jail { folder: parent, allow_outside: folder.allow_outside })
}

/// Returns the name of the picture of the sky that a text asks for.
fn picture_of(table: &Table) -> Option<String> {
    let sky = table.get("sky")?;
    let is_picture = sky.get("kind").is_none_or(|kind| kind.as_str() == Some(SkyKind::Picture.name()));
    sky.get("picture").and_then(Value::as_str).filter(|_| is_picture).map(str::to_owned)
}

/// True for a file in a folder from which nothing may be read, without looking at it.
fn is_outside(finder: Option<&mut Finder>, name: &str) -> bool {
    finder.is_none_or(|finder| {
        let found = finder.library(name);
        found.file.is_none() && found.outside
    })
}

/// Applies what a sidecar cannot express, and removes its key.
fn reset(builder: &mut SceneBuilder, table: &mut Table) {
    if let Some(Value::Array(gone)) = table.remove(WITHOUT) {
        let is_gone = |name: &str| gone.iter().any(|value| value.as_str() == Some(name));
        builder.sun = builder.sun.filter(|_| !is_gone("sun"));
        builder.sky = builder.sky.take().filter(|_: &Sky| !is_gone("sky"));
    }
    let lights = table.get("lights").and_then(Value::as_array);
    for name in lights.into_iter().flatten().filter_map(|light| light.get("name")?.as_str()) {
        builder.light_settings.set(name, Default::default());
    }
}

/// Sets what is changed about an object. Returns a message where it cannot be done.
fn set_object(edit: &mut SceneEdit, scene: &Scene, key: ObjectKey, object: ObjectEdit) -> Option<String> {
    if !scene.all_objects().keys().contains(&key) {
        return Some(format!("the model has no object '{key}'"));
    }
    if !object.is_possible(scene.bounds_m) {
        return Some(format!("the way of object '{key}' is too far; it was ignored"));
    }
    match object.is_none() {
        true => drop(edit.objects.remove(&key)),
        false => drop(edit.objects.insert(key, object)),
    }
    None
}
