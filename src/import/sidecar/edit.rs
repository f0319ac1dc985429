//! Saving edited materials, objects, daylight and lights in the sidecar of a model. Everything else
//! in the file stays: other keys, their order and comments.

use super::ground::GROUND_KEYS;
use super::light::{SKY_KEYS, SUN_KEYS};
use super::read::MAX_BYTES;
use crate::import::files::{self, unreadable};
use crate::import::text;
use crate::raster::atomic_file::write_atomically;
use crate::scene::{
    Daylight, Gradient, Ground, Material, MaterialKind, ObjectEdit, ObjectKey, SceneEdit, SceneError, Sky,
    Sun,
};
use glam::{DVec3, Vec3};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use toml_edit::{Array, ArrayOfTables, DocumentMut, Item, Table, value};

/// Saves the differences between `before` and `now` in the `.afterimage.toml` next to a model, and
/// returns its path. The next import of the model has the materials, objects, daylight and lights
/// of `now`.
///
/// # Errors
/// [`SceneError::Read`] where the existing file is not valid TOML, or where the file cannot be
/// written.
pub fn save_edit(model: &Path, before: &SceneEdit, now: &SceneEdit) -> Result<PathBuf, SceneError> {
    let path = model.with_extension("afterimage.toml");
    let mut document = read(&path)?;
    let sky = |file: &Path| name_beside(file, model);
    write_edit(&mut document, &sky, before, now)
        .and_then(|()| keep_daylight(&mut document, &sky, before, now))
        .map_err(|error| match error {
            EditError::Damaged(cause) => damaged(&path, cause),
            EditError::Sky(cause) => {
                unreadable(&path, cause, "nothing was written; copy it there and choose it again")
            }
        })?;
    write_atomically(&path, document.to_string().as_bytes()).map_err(|error| {
        let remedy = "nothing was changed; free some space or choose a folder that can be written to";
        unreadable(&path, error.to_string(), remedy)
    })?;
    Ok(path)
}

/// Writes the daylight where an edit makes the first lamp or removes the last one. The import gives
/// a sun and a sky to a model without any light, so that they would go or come with the lamp.
fn keep_daylight(
    document: &mut DocumentMut,
    sky: SkyName<'_>,
    before: &SceneEdit,
    now: &SceneEdit,
) -> Result<(), EditError> {
    let has_lamps = |edit: &SceneEdit| edit.materials.iter().any(Material::is_emissive);
    match has_lamps(before) == has_lamps(now) {
        true => Ok(()),
        false => write_daylight(document, sky, &now.daylight).map_err(EditError::Sky),
    }
}

/// Why an edit cannot be written.
#[derive(Debug, thiserror::Error)]
pub(super) enum EditError {
    /// The document holds something else where a list belongs.
    #[error("{0}")]
    Damaged(&'static str),
    /// The picture of the sky would not be found again.
    #[error("{0}")]
    Sky(String),
}

/// Returns the text by which the picture of a sky is found again, or why there is none.
pub(super) type SkyName<'a> = &'a dyn Fn(&Path) -> Result<String, String>;

/// Writes the differences between `before` and `now` into a document.
pub(super) fn write_edit(
    document: &mut DocumentMut,
    sky: SkyName<'_>,
    before: &SceneEdit,
    now: &SceneEdit,
) -> Result<(), EditError> {
    let numbers = numbers_of_names(&before.materials);
    for ((was, is), number) in before.materials.iter().zip(&now.materials).zip(numbers) {
        if was != is {
            write_material(document, was, is, number)
                .ok_or(EditError::Damaged("'material' is not written as [[material]]"))?;
        }
    }
    for key in before.objects.keys().chain(now.objects.keys()) {
        let [was, is] = [before, now].map(|edit| edit.objects.get(key).copied().unwrap_or_default());
        if was != is {
            write_object(document, key, &is)
                .ok_or(EditError::Damaged("'object' is not written as [[object]]"))?;
        }
    }
    if before.daylight != now.daylight {
        write_daylight(document, sky, &now.daylight).map_err(EditError::Sky)?;
    }
    if before.ground != now.ground {
        write_ground(document, now.ground);
    }
    super::lights::write(document, &before.lights, &now.lights)
        .ok_or(EditError::Damaged("'lights' is not written as [[lights]]"))
}

/// Reads the existing file; an empty document where there is none.
fn read(path: &Path) -> Result<DocumentMut, SceneError> {
    if path.symlink_metadata().is_err() {
        return Ok(DocumentMut::new());
    }
    let bytes = files::read_limited(path, MAX_BYTES).map_err(|e| unreadable(path, e.cause, e.remedy))?;
    let text = text::decode(bytes).text;
    text.parse().map_err(|error: toml_edit::TomlError| damaged(path, &error.message().replace('\n', ", ")))
}

fn damaged(path: &Path, cause: &str) -> SceneError {
    unreadable(path, cause, "nothing was written; correct the file or move it away, and save again")
}

/// Returns for each material which one of its name it is, counted from 1; `None` where no other has
/// its name.
fn numbers_of_names(materials: &[Material]) -> Vec<Option<i64>> {
    let mut counts: HashMap<&str, i64> = HashMap::new();
    for material in materials {
        *counts.entry(&material.name).or_default() += 1;
    }
    let mut passed: HashMap<&str, i64> = HashMap::new();
    let mut numbers = Vec::with_capacity(materials.len());
    for material in materials {
        let number = passed.entry(&material.name).or_default();
        *number += 1;
        numbers.push(Some(*number).filter(|_| counts[material.name.as_str()] > 1));
    }
    numbers
}

/// Changes the `[[material]]` of this name and number, or adds one. `None` where `material` is
/// something else than a list of tables.
fn write_material(
    document: &mut DocumentMut,
    was: &Material,
    is: &Material,
    number_of_name: Option<i64>,
) -> Option<()> {
    let item = document.entry("material").or_insert_with(|| Item::ArrayOfTables(ArrayOfTables::new()));
    let tables = item.as_array_of_tables_mut()?;
    let is_it = |t: &Table| {
        t.get("name").and_then(Item::as_str) == Some(&is.name)
            && t.get("number").and_then(Item::as_integer) == number_of_name
    };
    // The last of several tables of a material decides.
    let at = (0..tables.len()).rev().find(|&i| tables.get(i).is_some_and(is_it)).unwrap_or_else(|| {
        let mut table = Table::new();
        table["name"] = value(&is.name);
        if let Some(number) = number_of_name {
            table["number"] = value(number);
        }
        tables.push(table);
        tables.len() - 1
    });
    let table = tables.get_mut(at)?;
    for key in ["fresnel", "reflectance", "eta", "transmittance", "roughness"] {
        table.remove(key);
    }
    set(table, "diffuse", color(is.diffuse));
    if was.emission != is.emission {
        set(table, "emission", color(is.emission));
    }
    match is.kind {
        MaterialKind::Diffuse => set(table, "kind", value("diffuse")),
        MaterialKind::Mirror { reflectance, fresnel } => {
            set(table, "kind", value("mirror"));
            set(table, "reflectance", color(reflectance));
            set(table, "fresnel", value(fresnel));
        }
        MaterialKind::Glass { eta, transmittance } => {
            set(table, "kind", value("glass"));
            set(table, "eta", value(number(eta)));
            set(table, "transmittance", color(transmittance));
        }
        MaterialKind::Glossy { reflectance, roughness } => {
            set(table, "kind", value("glossy"));
            set(table, "reflectance", color(reflectance));
            set(table, "roughness", value(number(roughness)));
        }
        MaterialKind::Frosted { eta, transmittance, roughness } => {
            set(table, "kind", value("frosted"));
            set(table, "eta", value(number(eta)));
            set(table, "transmittance", color(transmittance));
            set(table, "roughness", value(number(roughness)));
        }
    }
    Some(())
}

/// Changes the `[[object]]` of this name and number, adds one, or removes it where nothing is
/// changed about it. `None` where `object` is something else than a list of tables.
fn write_object(document: &mut DocumentMut, key: &ObjectKey, edit: &ObjectEdit) -> Option<()> {
    let item = document.entry("object").or_insert_with(|| Item::ArrayOfTables(ArrayOfTables::new()));
    let tables = item.as_array_of_tables_mut()?;
    let number = |t: &Table| t.get("number").and_then(Item::as_integer).unwrap_or(1);
    let is_it = |t: &Table| {
        t.get("name").and_then(Item::as_str) == Some(&key.name) && number(t) == i64::from(key.number)
    };
    if edit.is_none() {
        tables.retain(|table| !is_it(table));
        if tables.is_empty() {
            document.remove("object");
        }
        return Some(());
    }
    // The last of several tables of an object decides.
    let at = (0..tables.len()).rev().find(|&i| tables.get(i).is_some_and(is_it)).unwrap_or_else(|| {
        let mut table = Table::new();
        table["name"] = value(&key.name);
        if key.number > 1 {
            table["number"] = value(i64::from(key.number));
        }
        tables.push(table);
        tables.len() - 1
    });
    let table = tables.get_mut(at)?;
    let mut put = |name: &str, item: Option<Item>| match item {
        Some(item) => set(table, name, item),
        None => drop(table.remove(name)),
    };
    let is_moved = edit.moved_m != DVec3::ZERO;
    put("move_m", is_moved.then(|| value(edit.moved_m.to_array().into_iter().collect::<Array>())));
    put("turn_deg", (edit.turned_deg != 0.0).then(|| value(edit.turned_deg)));
    put("hidden", edit.is_hidden.then(|| value(true)));
    put("deleted", edit.is_deleted.then(|| value(true)));
    Some(())
}

/// Writes sun and sky, or that they are off: a table that is left out stands for those of the
/// model, or for those that a model without any light is given. The error says why the sky would
/// not be found again.
fn write_daylight(document: &mut DocumentMut, name: SkyName<'_>, daylight: &Daylight) -> Result<(), String> {
    match daylight.sun {
        None => write_section(document, "sun", &SUN_KEYS, vec![("off", value(true))]),
        Some(Sun { direction, angular_radius, irradiance }) => write_section(
            document,
            "sun",
            &SUN_KEYS,
            vec![
                ("direction", color(direction)),
                ("irradiance", color(irradiance)),
                ("angular_radius_deg", value(number(angular_radius.to_degrees()))),
            ],
        ),
    }
    let sky = match &daylight.sky {
        None => vec![("off", value(true))],
        Some(sky) => sky_values(sky, name)?,
    };
    write_section(document, "sky", &SKY_KEYS, sky);
    Ok(())
}

/// Writes the ground, or that there is none.
fn write_ground(document: &mut DocumentMut, ground: Option<Ground>) {
    let values = match ground {
        None => vec![("off", value(true))],
        Some(Ground { height_m, albedo }) => {
            vec![("height_m", value(height_m)), ("albedo", value(number(albedo)))]
        }
    };
    write_section(document, "ground", &GROUND_KEYS, values);
}

/// Sets the values of a section, and removes those of `keys` that have none.
fn write_section(document: &mut DocumentMut, name: &str, keys: &[&str], values: Vec<(&str, Item)>) {
    let table = section(document, name);
    for key in keys.iter().filter(|key| !values.iter().any(|(written, _)| written == *key)) {
        table.remove(key);
    }
    for (key, item) in values {
        set(table, key, item);
    }
}

fn sky_values(sky: &Sky, name: SkyName<'_>) -> Result<Vec<(&'static str, Item)>, String> {
    let kind = ("kind", value(sky.kind().name()));
    Ok(match sky {
        Sky::Gradient(Gradient { zenith, horizon, ground }) => {
            vec![("zenith", color(*zenith)), ("horizon", color(*horizon)), ("ground", color(*ground))]
        }
        Sky::Cie(sky) => vec![
            kind,
            ("zenith", color(sky.zenith)),
            ("ground", color(sky.ground)),
            ("sun_direction", color(sky.sun_direction)),
        ],
        Sky::Physical(sky) => vec![
            kind,
            ("turbidity", value(number(sky.turbidity()))),
            ("albedo", value(number(sky.albedo()))),
            ("brightness", value(number(sky.brightness()))),
            ("ground", color(sky.ground())),
            ("sun_direction", color(sky.sun_direction())),
        ],
        Sky::Picture(sky) => vec![
            kind,
            ("picture", value(name(sky.image.file())?)),
            ("rotation_deg", value(number(sky.rotation_deg))),
            ("brightness", value(number(sky.brightness))),
        ],
        Sky::Dimmed(dimmed) => sky_values(&dimmed.sky, name)?,
    })
}

/// Returns the path of a file relative to the folder of the model, with `/` on all systems.
pub(super) fn name_beside(file: &Path, model: &Path) -> Result<String, String> {
    let relative = || {
        let (file, model) = (file.canonicalize().ok()?, model.canonicalize().ok()?);
        let parts = file.strip_prefix(model.parent()?).ok()?.iter();
        Some(parts.map(|part| part.to_str()).collect::<Option<Vec<_>>>()?.join("/"))
    };
    relative().ok_or_else(|| format!("the sky picture {} is not in the model's folder", file.display()))
}

fn section<'d>(document: &'d mut DocumentMut, name: &str) -> &'d mut dyn toml_edit::TableLike {
    let item = &mut document[name];
    if !item.is_table_like() {
        *item = Item::Table(Table::new());
    }
    item.as_table_like_mut().expect("a table was inserted above")
}

/// Sets a value and keeps the comment after the old one.
fn set<T: toml_edit::TableLike + ?Sized>(table: &mut T, key: &str, mut item: Item) {
    if let (Some(old), Some(new)) = (table.get(key).and_then(Item::as_value), item.as_value_mut()) {
        *new.decor_mut() = old.decor().clone();
    }
    match table.get_mut(key) {
        Some(place) => *place = item,
        None => drop(table.insert(key, item)),
    }
}

fn color(c: Vec3) -> Item {
    value(c.to_array().map(number).into_iter().collect::<Array>())
}

/// Returns the number that is written as the shortest decimal of an `f32`, rather than with the
/// digits of the equal `f64`.
fn number(v: f32) -> f64 {
    v.to_string().parse().unwrap_or(f64::from(v))
}
