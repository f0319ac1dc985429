//! Settings that the command line and the window share.
//!
//! The layers, from the weakest to the strongest: the program's defaults, the user's file,
//! `[settings]` in the scene's `.afterimage.toml`, the environment (`AFTERIMAGE_*`), flags. Invalid
//! settings are reported with a suggestion and ignored; they never stop the program.

use afterimage::raster::load::{LoadError, read_bounded};
use afterimage::{Mode, raster::color::ToneMap, raster::save::write_atomically};
use anyhow::{Context, anyhow};
use clap::ValueEnum;
use serde::Deserialize;
use serde::de::value::Error as NameError;
use serde::de::{DeserializeOwned, Deserializer, Error, IntoDeserializer};
use std::path::{Path, PathBuf};
use toml::{Table, Value};

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

/// The settings of all layers together; `None` leaves the program's default. A setting with the
/// name of a flag is the default of that flag.
///
/// To add a setting, add a field here and its row to `RULES`.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Settings {
    /// How frames are rendered.
    pub mode: Option<Mode>,
    /// Shadow rays per light and pixel.
    pub samples: Option<u32>,
    /// Diffuse bounces.
    pub bounces: Option<u32>,
    /// Seed of all random numbers.
    #[serde(deserialize_with = "seed")]
    pub seed: Option<u64>,
    /// Number of threads that trace rays.
    pub threads: Option<usize>,
    /// Picture size in pixels, as `1280x720`.
    pub size: Option<String>,
    /// Exposure in stops.
    pub exposure: Option<f32>,
    /// Tone map from radiance to display.
    pub tone_map: Option<ToneMap>,
    /// Folder in which the window saves pictures.
    pub pictures: Option<PathBuf>,
    /// Colour theme of the window.
    pub theme: Option<Theme>,
    /// Size of the window's text and controls, as a factor.
    pub ui_scale: Option<f32>,
    /// True to change views without animation.
    pub reduced_motion: Option<bool>,
    /// The section `[keys]`: names of actions and their keys.
    pub keys: Option<Table>,
}

/// Name of a setting, the values it takes in words, and a check of what its type does not say.
type Rule = (&'static str, &'static str, fn(&Settings) -> Option<bool>);

/// All settings in the order of the documentation.
const RULES: [Rule; 13] = [
    ("mode", "'full', 'paper', 'fast' or 'exact'", any),
    ("samples", "a whole number from 1 to 1048576", |s| Some((1..=1 << 20).contains(&s.samples?))),
    ("bounces", "a whole number from 0 to 64", |s| Some(s.bounces? <= 64)),
    ("seed", "a whole number from 0", any),
    ("threads", "a whole number from 1 to 1024", |s| Some((1..=1024).contains(&s.threads?))),
    ("size", "a size like '1280x720'", |s| Some(picture_size(s.size.as_deref()?).is_ok())),
    ("exposure", "a number of stops from -64 to 64", |s| Some(s.exposure?.abs() <= 64.0)),
    ("tone_map", "'aces' or 'linear'", any),
    ("pictures", "a folder", any),
    ("theme", "'system', 'dark' or 'light'", any),
    ("ui_scale", "a number from 0.5 to 3", |s| Some(UI_SCALES.contains(&s.ui_scale?))),
    ("reduced_motion", "true or false", any),
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
mod tests {
    use super::*;

    fn file(folder: &tempfile::TempDir, name: &str, text: &str) -> PathBuf {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path
    }

    fn variables(list: &[(&str, &str)]) -> impl Iterator<Item = (String, String)> {
        list.iter().map(|(n, v)| ((*n).to_owned(), (*v).to_owned())).collect::<Vec<_>>().into_iter()
    }

    fn load(
        user_file: Option<&Path>,
        scene: Option<&str>,
        variables: impl Iterator<Item = (String, String)>,
    ) -> (Settings, Vec<String>) {
        let layers = Layers::load(user_file.map(Path::to_owned), scene, variables);
        (layers.settings(), layers.warnings)
    }

    #[test]
    fn a_stronger_layer_overrides_a_weaker_one() {
        let folder = tempfile::tempdir().unwrap();
        let user = file(&folder, "settings.toml", "samples = 1\nbounces = 1\nseed = 1\ntheme = 'dark'\n");
        file(&folder, "a.afterimage.toml", "unit = 'm'\n[settings]\nsamples = 2\nbounces = 2\n");
        let scene = folder.path().join("a.obj").display().to_string();
        let environment = variables(&[("AFTERIMAGE_SAMPLES", "3"), ("PATH", "x"), (CONFIG_VARIABLE, "y")]);
        let (settings, warnings) = load(Some(&user), Some(&scene), environment);
        assert_eq!((settings.samples, settings.bounces, settings.seed), (Some(3), Some(2), Some(1)));
        assert_eq!((settings.theme, settings.mode, warnings), (Some(Theme::Dark), None, Vec::new()));
        let (settings, _) = load(Some(&user), Some("builtin:gallery"), variables(&[]));
        assert_eq!(settings.samples, Some(1));
    }

    #[test]
    fn invalid_settings_are_reported_and_ignored() {
        let folder = tempfile::tempdir().unwrap();
        let user = file(&folder, "s.toml", "sampels = 4\nui_scale = 9\nmode = ['full']\nseed = 7\n");
        let (settings, warnings) = load(Some(&user), None, variables(&[("AFTERIMAGE_MODE", "slow")]));
        assert_eq!(settings, Settings { seed: Some(7), ..Settings::default() });
        let said = |words: &str| warnings.iter().any(|w| w.contains(words));
        assert!(
            said("did you mean 'samples'?") && said("from 0.5 to 3") && said("the setting 'mode'"),
            "{warnings:?}"
        );
        assert!(said("AFTERIMAGE_MODE") && said("'exact'") && warnings.len() == 4, "{warnings:?}");
    }

    #[test]
    fn a_broken_file_is_reported_with_its_line_and_a_missing_one_is_empty() {
        let folder = tempfile::tempdir().unwrap();
        let user = file(&folder, "s.toml", "seed = 7\nmode =\n");
        let (settings, warnings) = load(Some(&user), None, variables(&[]));
        assert_eq!(settings, Settings::default());
        assert!(warnings[0].contains("s.toml, line 2"), "{warnings:?}");
        let (_, warnings) = load(Some(&folder.path().join("none.toml")), None, variables(&[]));
        assert_eq!(warnings, Vec::<String>::new());
    }

    #[test]
    fn unreadable_settings_files_are_ignored_and_not_overwritten() {
        let folder = tempfile::tempdir().unwrap();
        let huge = folder.path().join("huge.toml");
        std::fs::File::create(&huge).unwrap().set_len(MAX_BYTES + 1).unwrap();
        let latin = folder.path().join("latin.toml");
        std::fs::write(&latin, b"pictures = '/home/jos\xe9'\n").unwrap();
        for (path, words) in
            [(&huge, "longer than"), (&latin, "UTF-8"), (&folder.path().to_owned(), "regular file")]
        {
            let (settings, warnings) = load(Some(path), None, variables(&[]));
            assert_eq!(settings, Settings::default());
            assert!(warnings.len() == 1 && warnings[0].contains(words), "{warnings:?}");
            assert!(write(path, "theme", Some("dark".into())).is_err());
        }
        assert_eq!(std::fs::metadata(&huge).unwrap().len(), MAX_BYTES + 1, "it is not touched");
    }

    #[test]
    fn writing_and_removing_a_setting_keeps_comments() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new/settings.toml");
        write(&path, "theme", Some("dark".into())).unwrap();
        std::fs::write(&path, "# mine\nseed = 7\ntheme = \"dark\"\n").unwrap();
        write(&path, "ui_scale", Some(1.25.into())).unwrap();
        write(&path, "theme", None).unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "# mine\nseed = 7\nui_scale = 1.25\n");
        std::fs::write(&path, "seed =\n").unwrap();
        assert!(write(&path, "theme", None).unwrap_err().to_string().contains("broken"));
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "seed =\n", "a broken file is not touched");
    }

    #[test]
    fn every_setting_is_read_from_a_file_and_from_the_environment() {
        let folder = tempfile::tempdir().unwrap();
        let values = [
            ("mode", "full"),
            ("samples", "2"),
            ("bounces", "3"),
            ("seed", "4"),
            ("threads", "5"),
            ("size", "6x7"),
            ("exposure", "-1"),
            ("tone_map", "linear"),
            ("pictures", "8"),
            ("theme", "light"),
            ("ui_scale", "1.5"),
            ("reduced_motion", "true"),
        ];
        assert_eq!(values.map(|(name, _)| name)[..], RULES.map(|(name, ..)| name)[..values.len()]);
        let lines = values.map(|(name, text)| format!("{name} = '{text}'\n")).concat();
        let from_file = load(Some(&file(&folder, "s.toml", &lines)), None, variables(&[]));
        let named =
            values.map(|(name, text)| (format!("AFTERIMAGE_{}", name.to_uppercase()), text.to_owned()));
        assert_eq!(load(None, None, named.into_iter()), from_file);
        let (settings, warnings) = from_file;
        assert_eq!((settings.mode, settings.exposure, warnings), (Some(Mode::Full), Some(-1.0), Vec::new()));
        assert_eq!(Theme::value_variants().iter().filter(|t| Some(**t) == settings.theme).count(), 1);
    }
}
