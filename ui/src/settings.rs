//! Settings that the command line and the window share.
//!
//! The layers, from the weakest to the strongest: the program's defaults, the user's file,
//! `[settings]` in the scene's `.afterimage.toml`, the environment (`AFTERIMAGE_*`), flags. Invalid
//! settings are reported with a suggestion and ignored; they never stop the program.

use afterimage::Mode;
use afterimage::raster::load::{LoadError, read_bounded};
use afterimage::raster::{color::ToneMap, exposure::Exposure, save::write_atomically};
use afterimage::trace::BounceLimit;
use anyhow::{Context, anyhow};
use clap::ValueEnum;
use serde::Deserialize;
use serde::de::value::Error as NameError;
use serde::de::{DeserializeOwned, Deserializer, Error, IntoDeserializer};
use std::path::{Path, PathBuf};
use toml::{Table, Value};

/// Limit of bounces where no layer and no flag gives one, in the window and on the command line.
pub(crate) const DEFAULT_BOUNCES: BounceLimit = BounceLimit::ALL;

/// Colour theme of the window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Theme {
    /// The theme of the desktop.
    #[default]
    System,
    /// Light text on a dark background.
    Dark,
    /// Dark text on a light background.
    Light,
}

impl Theme {
    /// Name of the theme in `settings.toml`, in sidecars and in the window.
    pub fn name(self) -> &'static str {
        ["system", "dark", "light"][self as usize]
    }
}

/// Tab of the window's side panel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[allow(missing_docs, reason = "the panel names each")]
pub enum Tab {
    #[default]
    Scene,
    Look,
    Camera,
    Method,
    Numbers,
}

impl Tab {
    /// Name of the tab in `settings.toml`.
    pub fn name(self) -> &'static str {
        ["scene", "look", "camera", "method", "numbers"][self as usize]
    }
}

/// The settings of all layers together; `None` leaves the program's default. A setting with the
/// name of a flag is the default of that flag.
///
/// To add a setting, add a field here and its row to `RULES`.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// How frames are rendered.
    pub mode: Option<Mode>,
    /// Light samples per pixel, as [`afterimage::trace::TraceSettings::samples`].
    pub samples: Option<u32>,
    /// Maximum number of diffuse bounces.
    pub bounces: Option<BounceLimit>,
    /// Seed of all random numbers.
    #[serde(deserialize_with = "seed")]
    pub seed: Option<u64>,
    /// Number of threads that trace rays.
    pub threads: Option<usize>,
    /// Picture size in pixels, as `1280x720`.
    pub size: Option<String>,
    /// Exposure in stops, or `auto`.
    pub exposure: Option<Exposure>,
    /// Tone map from radiance to display.
    pub tone_map: Option<ToneMap>,
    /// True to improve the window's picture until the camera moves.
    pub keep_improving: Option<bool>,
    /// Folder in which the window saves pictures.
    pub pictures: Option<PathBuf>,
    /// Colour theme of the window.
    pub theme: Option<Theme>,
    /// Size of the window's text and controls, as a factor.
    pub ui_scale: Option<f32>,
    /// True to change views without animation.
    pub reduced_motion: Option<bool>,
    /// Tab of the side panel that is shown.
    pub tab: Option<Tab>,
    /// The section `[keys]`: names of actions and their keys.
    pub keys: Option<Table>,
}

/// Name of a setting, the values it takes in words, and a check of what its type does not say.
type Rule = (&'static str, &'static str, fn(&Settings) -> Option<bool>);

/// All settings in the order of the documentation.
const RULES: [Rule; 15] = [
    ("mode", "'full', 'paper', 'fast' or 'exact'", any),
    ("samples", "a whole number from 1 to 1048576", |s| Some((1..=1 << 20).contains(&s.samples?))),
    ("bounces", BounceLimit::EXPECTED, any),
    ("seed", "a whole number from 0", any),
    ("threads", "a whole number from 1 to 1024", |s| Some((1..=1024).contains(&s.threads?))),
    ("size", "a size like '1280x720'", |s| Some(picture_size(s.size.as_deref()?).is_ok())),
    ("exposure", "'auto' or a number of stops from -64 to 64", |s| Some(s.exposure?.is_valid())),
    ("tone_map", "'aces' or 'linear'", any),
    ("keep_improving", "true or false", any),
    ("pictures", "a folder", any),
    ("theme", "'system', 'dark' or 'light'", any),
    ("ui_scale", "a number from 0.5 to 3", |s| Some(UI_SCALES.contains(&s.ui_scale?))),
    ("reduced_motion", "true or false", any),
    ("tab", "'scene', 'look', 'camera', 'method' or 'numbers'", any),
    ("keys", "a section [keys] with actions and their keys", any),
];

/// The check of settings whose type says all.
fn any(_: &Settings) -> Option<bool> {
    Some(true)
}

/// The value that is serialized under a name.
pub(crate) fn named<T: DeserializeOwned>(name: &str) -> Result<T, NameError> {
    T::deserialize(IntoDeserializer::<NameError>::into_deserializer(name))
}

/// Reads a seed. TOML has no whole numbers above `i64::MAX`, so that a larger seed is text.
fn seed<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<u64>, D::Error> {
    match Value::deserialize(deserializer)? {
        Value::Integer(number) => number.try_into().map(Some).map_err(D::Error::custom),
        Value::String(text) => text.parse().map(Some).map_err(D::Error::custom),
        _ => Err(D::Error::custom("a seed is a whole number")),
    }
}

/// Parses a picture size like `1280x720`.
pub(crate) fn picture_size(text: &str) -> Result<[u32; 2], &'static str> {
    let expected = "a size is two whole numbers from 1 to 65536, like 1280x720";
    let (width, height) = text.split_once(['x', 'X']).ok_or(expected)?;
    let side = |t: &str| t.parse().ok().filter(|n| (1..=65536).contains(n)).ok_or(expected);
    Ok([side(width)?, side(height)?])
}

/// Range of [`Settings::ui_scale`].
pub const UI_SCALES: std::ops::RangeInclusive<f32> = 0.5..=3.0;

/// Maximum length in bytes of the settings file and of a sidecar. The importer has the same limit.
pub(crate) const MAX_BYTES: u64 = 16 << 20;

/// Environment variable with the path of the settings file.
pub const CONFIG_VARIABLE: &str = "AFTERIMAGE_CONFIG";

/// Environment variables that are not settings: they serve tests and builds.
const OTHER_VARIABLES: [&str; 3] = [CONFIG_VARIABLE, "AFTERIMAGE_REQUIRE_GRAPHICS", "AFTERIMAGE_COMMIT"];

/// All layers below the flags, merged.
#[derive(Debug, Default)]
pub struct Layers {
    values: Table,
    /// Path of the settings file.
    pub user_file: Option<PathBuf>,
    /// One sentence for each setting or file that is ignored.
    pub warnings: Vec<String>,
}

impl Layers {
    /// Reads all layers. `scene` is the name of the scene as given by the user, `variables` is the
    /// environment.
    pub fn load(
        user_file: Option<PathBuf>,
        scene: Option<&str>,
        variables: impl Iterator<Item = (String, String)>,
    ) -> Self {
        let mut layers = Self { user_file: user_file.clone(), ..Self::default() };
        if let Some(path) = user_file {
            let table = read_table(&path).unwrap_or_else(|cause| {
                layers.warnings.push(cause.to_string());
                Table::new()
            });
            layers.add(table, |name| format!("{}: the setting '{name}'", path.display()));
        }
        if let Some(path) = scene.filter(|name| !name.starts_with("builtin:")).map(scene_file) {
            // The importer reads the rest of this file and reports what is wrong with it.
            if let Some(Value::Table(table)) = read_table(&path).unwrap_or_default().remove("settings") {
                layers.add(table, |name| format!("{}, [settings]: the setting '{name}'", path.display()));
            }
        }
        let variables = variables.filter(|(name, _)| !OTHER_VARIABLES.contains(&name.as_str()));
        let setting = |(name, text): (String, String)| {
            Some((name.strip_prefix("AFTERIMAGE_")?.to_lowercase(), Value::String(text)))
        };
        layers.add(variables.filter_map(setting).collect(), |name| {
            format!("the environment variable AFTERIMAGE_{}", name.to_uppercase())
        });
        layers
    }

    /// Adds a stronger layer; `subject` begins the sentence about a setting that is ignored.
    fn add(&mut self, table: Table, subject: impl Fn(&str) -> String) {
        for (name, value) in table {
            match checked(&name, value) {
                Ok(value) => drop(self.values.insert(name, value)),
                Err(cause) => self.warnings.push(format!("{} is ignored: {cause}", subject(&name))),
            }
        }
    }

    /// The settings of all layers together.
    pub fn settings(&self) -> Settings {
        self.values.clone().try_into().unwrap_or_default()
    }

    /// The value of a setting as it would be written behind its flag.
    pub fn flag_value(&self, name: &str) -> Option<String> {
        self.values.get(name).map(|value| value.as_str().map_or_else(|| value.to_string(), str::to_owned))
    }
}

/// The value of a setting with the type that [`Settings`] asks for, or a sentence about the values
/// it takes.
fn checked(name: &str, value: Value) -> Result<Value, String> {
    let Some((_, values, is_valid)) = RULES.iter().find(|(known, ..)| *known == name) else {
        return Err(format!(
            "there is no such setting; {}",
            suggestion(name, &RULES.map(|(known, ..)| known))
        ));
    };
    let fits = |value: &Value| {
        let settings: Result<Settings, _> = Table::from_iter([(name.to_owned(), value.clone())]).try_into();
        settings.is_ok_and(|settings| is_valid(&settings) == Some(true))
    };
    // Environment variables are text; a file may have quotes around a number. Numbers are first
    // read as flags read them: TOML refuses `016`, `.5` and `1.`.
    let text = value.as_str().unwrap_or_default();
    let whole = text.parse().ok().map(Value::Integer);
    let number = text.parse().ok().map(Value::Float);
    let switch = text.parse().ok().map(Value::Boolean);
    let spelled = value.as_str().and_then(|text| format!("value = {text}").parse::<Table>().ok());
    let spelled = spelled.and_then(|mut table| table.remove("value"));
    [Some(value), whole, number, switch, spelled]
        .into_iter()
        .flatten()
        .find(fits)
        .ok_or_else(|| format!("its value must be {values}"))
}

/// Path of the sidecar of a scene.
fn scene_file(scene: &str) -> PathBuf {
    Path::new(scene).with_extension("afterimage.toml")
}

/// The table of the settings file or of a sidecar; empty if there is no such file.
fn read_table(path: &Path) -> anyhow::Result<Table> {
    if is_absent(path) {
        return Ok(Table::new());
    }
    let text = read_text(path, MAX_BYTES).map_err(|error| anyhow!("{error}; its settings are ignored"))?;
    text.parse().map_err(|error| anyhow!(broken(path, &text, &error)))
}

/// False also where the file cannot be examined: reading it then says why.
fn is_absent(path: &Path) -> bool {
    path.metadata().is_err_and(|error| error.kind() == std::io::ErrorKind::NotFound)
}

/// Reads a text file of at most `max_bytes` bytes.
///
/// # Errors
/// If the file cannot be read, is longer, or is not UTF-8.
pub(crate) fn read_text(path: &Path, max_bytes: u64) -> Result<String, LoadError> {
    let not_text = |_| LoadError { path: path.to_owned(), cause: "it is not UTF-8 text".into() };
    String::from_utf8(read_bounded(path, max_bytes)?).map_err(not_text)
}

/// Describes a TOML syntax error with its file and line.
pub(crate) fn broken(path: &Path, text: &str, error: &toml::de::Error) -> String {
    let at = error.span().map_or(0, |span| span.start).min(text.len());
    let line = text.as_bytes()[..at].iter().filter(|b| **b == b'\n').count() + 1;
    format!(
        "{}, line {line}: {}; the file is ignored until this is corrected",
        path.display(),
        error.message()
    )
}

/// Suggests the known word nearest to a misspelled one, or lists all of them.
pub(crate) fn suggestion(word: &str, known: &[&str]) -> String {
    let similarity = |k: &&&str| (strsim::jaro_winkler(word, k) * 1000.0) as u32;
    match known.iter().max_by_key(similarity) {
        Some(best) if similarity(&best) > 750 => format!("did you mean '{best}'?"),
        _ => format!("there are {}", known.join(", ")),
    }
}

/// Writes one setting into the user's file, or removes it if `value` is `None`. The rest of the
/// file, with its comments, stays as it is.
///
/// # Errors
/// If the file cannot be read or written, or is not valid TOML.
pub fn write(path: &Path, name: &str, value: Option<toml_edit::Value>) -> anyhow::Result<()> {
    let text = if is_absent(path) { String::new() } else { read_text(path, MAX_BYTES)? };
    let mut document: toml_edit::DocumentMut = text.parse().map_err(|error| {
        anyhow!("the settings in {} are not changed because the file is broken: {error}", path.display())
    })?;
    match value {
        Some(value) => document[name] = toml_edit::value(value),
        None => drop(document.remove(name)),
    }
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)
            .with_context(|| format!("cannot create the folder {}", folder.display()))?;
    }
    write_atomically(path, document.to_string().as_bytes())
        .map_err(|error| anyhow!("the setting is not saved: {error}"))
}

#[cfg(test)]
mod tests;
