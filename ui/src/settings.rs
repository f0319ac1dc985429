//! Settings that the command line and the window share, from the weakest to the strongest: the program's own, the user's
//! file, `[settings]` in the file beside the scene, the environment (`AFTERIMAGE_*`), flags.
//!
//! Nothing here is ever fatal: what cannot be used is said, and what is left of it holds.

use crate::cli::flags;
use afterimage::Mode;
use afterimage::raster::color::ToneMap;
use afterimage::raster::load::read_bounded;
use std::path::{Path, PathBuf};
use toml::{Table, Value};

/// Who draws the window: the system's wish, or the user's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Theme {
    /// As the system has it.
    #[default]
    System,
    /// Light on dark.
    Dark,
    /// Dark on light.
    Light,
}

impl Theme {
    /// All of them, with their names in files.
    pub const ALL: [(Self, &'static str); 3] =
        [(Self::System, "system"), (Self::Dark, "dark"), (Self::Light, "light")];

    /// Its name in files.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(theme, _)| *theme == self).map_or("system", |(_, name)| name)
    }
}

/// What someone has set; `None` is the program's own.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Settings {
    /// How frames are made.
    pub mode: Option<Mode>,
    /// Shadow rays per light and pixel.
    pub samples: Option<u32>,
    /// Diffuse bounces.
    pub bounces: Option<u32>,
    /// Of all random numbers.
    pub seed: Option<u64>,
    /// Threads that trace.
    pub threads: Option<usize>,
    /// Picture size in pixels.
    pub size: Option<[u32; 2]>,
    /// In stops.
    pub exposure_ev: Option<f32>,
    /// From radiance to display.
    pub tone_map: Option<ToneMap>,
    /// Where the window saves pictures.
    pub pictures: Option<PathBuf>,
    /// The window's colours.
    pub theme: Option<Theme>,
    /// The window's letters and controls, times their usual size.
    pub ui_scale: Option<f32>,
    /// Views change at once.
    pub reduced_motion: Option<bool>,
    /// `[keys]`: the names of actions and their keys.
    pub keys: Option<Table>,
}

/// Every setting that has one value, in the order of the documentation.
pub const NAMES: [&str; 12] = [
    "mode",
    "samples",
    "bounces",
    "seed",
    "threads",
    "size",
    "exposure",
    "tone_map",
    "pictures",
    "theme",
    "ui_scale",
    "reduced_motion",
];

/// Letters and controls are from half to three times their usual size.
pub const UI_SCALES: std::ops::RangeInclusive<f32> = 0.5..=3.0;

/// A file of settings, by the user or beside a scene, is read up to here; the importer reads no more either.
pub(crate) const MAX_BYTES: u64 = 16 << 20;

/// Names the file of the user's settings.
pub const CONFIG_VARIABLE: &str = "AFTERIMAGE_CONFIG";

/// Variables that are no settings: for tests and builds.
const OTHER_VARIABLES: [&str; 3] = [CONFIG_VARIABLE, "AFTERIMAGE_REQUIRE_GRAPHICS", "AFTERIMAGE_COMMIT"];

impl Settings {
    /// Sets one by name.
    fn set(&mut self, name: &str, text: &str) -> Result<(), String> {
        fn number<T: std::str::FromStr>(
            text: &str,
            is_fine: impl Fn(&T) -> bool,
            wanted: &str,
        ) -> Result<T, String> {
            text.parse().ok().filter(is_fine).ok_or_else(|| wanted.to_owned())
        }
        match name {
            "mode" => self.mode = Some(flags::mode(text)?),
            "samples" => {
                self.samples =
                    Some(number(text, |n| (1..=1 << 20).contains(n), "a number from 1 to 1048576")?);
            }
            "bounces" => self.bounces = Some(number(text, |n| *n <= 64, "a number from 0 to 64")?),
            "seed" => self.seed = Some(number(text, |_| true, "a whole number from 0")?),
            "threads" => self.threads = Some(flags::threads(text)?),
            "size" => self.size = Some(flags::size(text)?),
            "exposure" => self.exposure_ev = Some(flags::exposure(text)?),
            "tone_map" => self.tone_map = Some(flags::tone_map(text)?),
            "pictures" => self.pictures = Some(PathBuf::from(text)),
            "theme" => {
                let found = Theme::ALL.iter().find(|(_, name)| *name == text).map(|(theme, _)| *theme);
                self.theme = Some(found.ok_or("there are 'system', 'dark' and 'light'")?);
            }
            "ui_scale" => {
                self.ui_scale = Some(number(text, |s| UI_SCALES.contains(s), "a number from 0.5 to 3")?);
            }
            "reduced_motion" => {
                self.reduced_motion = Some(number(text, |_: &bool| true, "true or false")?);
            }
            _ => return Err(format!("there is no such setting; {}", suggestion(name, &NAMES))),
        }
        Ok(())
    }

    /// Lays a table of settings over these; `place` says where it stands.
    fn lay_over(&mut self, table: &Table, place: &str, warnings: &mut Vec<String>) {
        for (name, value) in table {
            let text = match value {
                Value::String(text) => Ok(text.clone()),
                Value::Integer(_) | Value::Float(_) | Value::Boolean(_) => Ok(value.to_string()),
                Value::Table(keys) if name == "keys" => {
                    self.keys = Some(keys.clone());
                    continue;
                }
                _ => Err("a word, a number, true or false is wanted".to_owned()),
            };
            if let Err(cause) = text.and_then(|text| self.set(name, &text)) {
                warnings.push(format!("{place}: '{name}' is left aside: {cause}"));
            }
        }
    }
}

/// All layers but the flags', laid over each other, and what could not be used of them.
///
/// `scene` is the scene's name as it was asked for; `variables` are those of the environment.
pub fn load(
    user_file: Option<&Path>,
    scene: Option<&str>,
    variables: impl Iterator<Item = (String, String)>,
) -> (Settings, Vec<String>) {
    let (mut settings, mut warnings) = (Settings::default(), Vec::new());
    if let Some(path) = user_file
        && let Some(table) = table_of(path, &mut warnings)
    {
        settings.lay_over(&table, &path.display().to_string(), &mut warnings);
    }
    if let Some(path) = scene.filter(|name| !name.starts_with("builtin:")).map(beside) {
        // What else is in it is the importer's, and so are its mistakes.
        let table = table_of(&path, &mut Vec::new());
        if let Some(Value::Table(table)) = table.as_ref().and_then(|t| t.get("settings")) {
            settings.lay_over(table, &format!("{}, [settings]", path.display()), &mut warnings);
        }
    }
    let known = |name: &String| name.starts_with("AFTERIMAGE_") && !OTHER_VARIABLES.contains(&name.as_str());
    for (name, text) in variables.filter(|(name, _)| known(name)) {
        let setting = name.trim_start_matches("AFTERIMAGE_").to_lowercase();
        if let Err(cause) = settings.set(&setting, &text) {
            warnings.push(format!("the variable {name} is left aside: {cause}"));
        }
    }
    (settings, warnings)
}

/// The file of a scene's own settings.
fn beside(scene: &str) -> PathBuf {
    Path::new(scene).with_extension("afterimage.toml")
}

/// A file's table; `None` where there is no file.
fn table_of(path: &Path, warnings: &mut Vec<String>) -> Option<Table> {
    if is_absent(path) {
        return None;
    }
    let text = read_text(path, MAX_BYTES)
        .map_err(|cause| warnings.push(format!("{cause}; its settings are left aside")))
        .ok()?;
    text.parse().map_err(|error| warnings.push(broken(path, &text, &error))).ok()
}

/// Where it cannot be told, reading says why.
fn is_absent(path: &Path) -> bool {
    path.metadata().is_err_and(|error| error.kind() == std::io::ErrorKind::NotFound)
}

/// The text of a file that the program keeps, of at most so many bytes.
///
/// # Errors
/// A message for people.
pub(crate) fn read_text(path: &Path, most: u64) -> Result<String, String> {
    let bytes = read_bounded(path, most).map_err(|error| error.to_string())?;
    String::from_utf8(bytes).map_err(|_| format!("{} is no text in UTF-8", path.display()))
}

/// A sentence with the line for what is no TOML.
pub(crate) fn broken(path: &Path, text: &str, error: &toml::de::Error) -> String {
    let at = error.span().map_or(0, |span| span.start).min(text.len());
    let line = text.as_bytes()[..at].iter().filter(|b| **b == b'\n').count() + 1;
    format!(
        "{}, line {line}: {}; the file is left aside until that is mended",
        path.display(),
        error.message()
    )
}

/// What may have been meant.
pub(crate) fn suggestion(word: &str, known: &[&str]) -> String {
    let near = |k: &&&str| (strsim::jaro_winkler(word, k) * 1000.0) as u32;
    match known.iter().max_by_key(near) {
        Some(best) if near(&best) > 750 => format!("did you mean '{best}'?"),
        _ => format!("there are {}", known.join(", ")),
    }
}

/// Writes one of the user's settings, or takes it out; the rest of the file stays as it is, comments too.
///
/// # Errors
/// A message for people.
pub fn write(path: &Path, name: &str, value: Option<toml_edit::Value>) -> Result<(), String> {
    let text = if is_absent(path) { String::new() } else { read_text(path, MAX_BYTES)? };
    let mut document: toml_edit::DocumentMut = text.parse().map_err(|error| {
        format!("the settings in {} are not changed, because the file is broken: {error}", path.display())
    })?;
    match value {
        Some(value) => document[name] = toml_edit::value(value),
        None => drop(document.remove(name)),
    }
    if let Some(folder) = path.parent() {
        let failed = |error| format!("cannot make the folder {}: {error}", folder.display());
        std::fs::create_dir_all(folder).map_err(failed)?;
    }
    let written = afterimage::raster::save::write_atomically(path, document.to_string().as_bytes());
    written.map_err(|error| format!("the setting is not kept: {error}"))
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

    #[test]
    fn the_stronger_layer_holds_and_the_rest_shows_through() {
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
    fn what_cannot_be_used_is_said_and_the_rest_holds() {
        let folder = tempfile::tempdir().unwrap();
        let user = file(&folder, "s.toml", "sampels = 4\nui_scale = 9\nmode = ['full']\nseed = 7\n");
        let (settings, warnings) = load(Some(&user), None, variables(&[("AFTERIMAGE_MODE", "slow")]));
        assert_eq!(settings, Settings { seed: Some(7), ..Settings::default() });
        let said = |words: &str| warnings.iter().any(|w| w.contains(words));
        assert!(
            said("did you mean 'samples'?") && said("from 0.5 to 3") && said("a word, a number"),
            "{warnings:?}"
        );
        assert!(said("AFTERIMAGE_MODE") && said("'exact'") && warnings.len() == 4, "{warnings:?}");
    }

    #[test]
    fn a_broken_file_is_named_with_its_line_and_an_absent_one_is_none() {
        let folder = tempfile::tempdir().unwrap();
        let user = file(&folder, "s.toml", "seed = 7\nmode =\n");
        let (settings, warnings) = load(Some(&user), None, variables(&[]));
        assert_eq!(settings, Settings::default());
        assert!(warnings[0].contains("s.toml, line 2"), "{warnings:?}");
        let (_, warnings) = load(Some(&folder.path().join("none.toml")), None, variables(&[]));
        assert_eq!(warnings, Vec::<String>::new());
    }

    #[test]
    fn what_is_no_file_of_settings_is_left_aside_unread() {
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
    fn one_setting_is_written_and_taken_out_again_beside_comments() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("new/settings.toml");
        write(&path, "theme", Some("dark".into())).unwrap();
        std::fs::write(&path, "# mine\nseed = 7\ntheme = \"dark\"\n").unwrap();
        write(&path, "ui_scale", Some(1.25.into())).unwrap();
        write(&path, "theme", None).unwrap();
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "# mine\nseed = 7\nui_scale = 1.25\n");
        std::fs::write(&path, "seed =\n").unwrap();
        assert!(write(&path, "theme", None).unwrap_err().contains("broken"));
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "seed =\n", "a broken file is not touched");
    }

    #[test]
    fn every_name_is_known() {
        for name in NAMES {
            let error = Settings::default().set(name, "\u{1}").err().unwrap_or_default();
            assert!(!error.contains("no such setting"), "{name}");
        }
    }
}
