//! `[[lights]]` of a sidecar: groups of lamps, and how groups of lights are set.

use super::table::{Notes, Section};
use crate::scene::{LampGroup, LightSetting, LightSettings, SceneBuilder};
use glam::Vec3;
use toml_edit::{Array, ArrayOfTables, DocumentMut, Item, Table, value};

/// Keys that hold the setting of a group.
const SETTING_KEYS: [&str; 3] = ["on", "intensity", "color"];

/// The groups of lights, as far as a sidecar gives them.
#[derive(Debug, Default)]
pub(super) struct Lights {
    groups: Vec<LampGroup>,
    settings: LightSettings,
}

impl Lights {
    pub(super) fn read(top: &Section, notes: &mut Notes) -> Self {
        let mut lights = Self::default();
        let known = ["name", "materials", "on", "intensity", "color"];
        for s in top.sections("lights", "[[lights]]", &known, notes) {
            let Some(name) = s.text("name", notes).filter(|name| !name.is_empty()) else {
                notes.add(s.at(), "[[lights]] needs a name; it was ignored".to_owned());
                continue;
            };
            if let Some(materials) = s.texts("materials", notes) {
                lights.groups.push(LampGroup { name: name.to_owned(), materials });
            }
            let range = 0.0..=f64::from(LightSetting::MAX_INTENSITY);
            let setting = LightSetting {
                is_on: s.flag("on", notes).unwrap_or(true),
                intensity: s.number("intensity", range, notes).map_or(1.0, |n| n as f32),
                color: s.color("color", 1.0, notes).unwrap_or(Vec3::ONE),
            };
            lights.settings.set(name, setting);
        }
        lights
    }

    /// Sets the groups of the builder.
    pub(super) fn apply(self, builder: &mut SceneBuilder) {
        builder.lamp_groups.extend(self.groups);
        for (name, setting) in self.settings.iter() {
            builder.light_settings.set(name, *setting);
        }
    }
}

/// Writes the settings that differ from those of before. Groups that the file describes keep their
/// other keys. `None` where `lights` is something else than a list of tables.
pub(super) fn write(document: &mut DocumentMut, before: &LightSettings, now: &LightSettings) -> Option<()> {
    let mut names: Vec<&str> = before.iter().chain(now.iter()).map(|(name, _)| name).collect();
    names.sort_unstable();
    names.dedup();
    for name in names.into_iter().filter(|name| before.get(name) != now.get(name)) {
        let item = document.entry("lights").or_insert_with(|| Item::ArrayOfTables(ArrayOfTables::new()));
        write_group(item.as_array_of_tables_mut()?, name, &now.get(name));
    }
    if document.get("lights").and_then(Item::as_array_of_tables).is_some_and(ArrayOfTables::is_empty) {
        document.remove("lights");
    }
    Some(())
}

fn write_group(tables: &mut ArrayOfTables, name: &str, setting: &LightSetting) {
    let named = |t: &Table| t.get("name").and_then(Item::as_str) == Some(name);
    // The last of several tables with this name decides.
    let at = (0..tables.len()).rev().find(|&i| tables.get(i).is_some_and(named)).unwrap_or_else(|| {
        let mut table = Table::new();
        table["name"] = value(name);
        tables.push(table);
        tables.len() - 1
    });
    let Some(table) = tables.get_mut(at) else { return };
    let full = LightSetting::FULL;
    let values = [
        (setting.is_on != full.is_on).then(|| value(setting.is_on)),
        (setting.intensity != full.intensity).then(|| value(number(setting.intensity))),
        (setting.color != full.color)
            .then(|| value(setting.color.to_array().map(number).into_iter().collect::<Array>())),
    ];
    for (key, new) in SETTING_KEYS.into_iter().zip(values) {
        match new {
            Some(new) => drop(table.insert(key, new)),
            None => drop(table.remove(key)),
        }
    }
    if table.len() == 1 {
        tables.remove(at);
    }
}

/// Returns the number that is written as the shortest decimal of an `f32`.
fn number(v: f32) -> f64 {
    v.to_string().parse().unwrap_or(f64::from(v))
}
