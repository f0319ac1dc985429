//! Tests of the layers of settings.

use super::*;
use afterimage::raster::exposure::Exposure;

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
    assert_eq!((settings.samples, settings.bounces, settings.seed), (Some(3), Some(BounceLimit(2)), Some(1)));
    assert_eq!((settings.theme, settings.mode, warnings), (Some(Theme::Dark), None, Vec::new()));
    let (settings, _) = load(Some(&user), Some("builtin:gallery"), variables(&[]));
    assert_eq!(settings.samples, Some(1));
}

#[test]
fn bounces_are_a_number_or_all_in_every_layer() {
    let folder = tempfile::tempdir().unwrap();
    let user = file(&folder, "s.toml", "bounces = 'all'\n");
    file(&folder, "a.afterimage.toml", "[settings]\nbounces = 3\n");
    file(&folder, "b.afterimage.toml", "[settings]\nbounces = 65\n");
    let scene = |name: &str| folder.path().join(name).display().to_string();
    let limit = |scene: &str, variable: Option<&str>| {
        let set = variable.map(|value| ("AFTERIMAGE_BOUNCES", value));
        let (settings, warnings) = load(Some(&user), Some(scene), variables(set.as_slice()));
        (settings.bounces, warnings.len())
    };
    assert_eq!(limit("builtin:gallery", None), (Some(BounceLimit::ALL), 0));
    assert_eq!(limit(&scene("a.obj"), None), (Some(BounceLimit(3)), 0));
    assert_eq!(limit(&scene("a.obj"), Some("all")), (Some(BounceLimit::ALL), 0));
    assert_eq!(limit(&scene("a.obj"), Some("0")), (Some(BounceLimit::NONE), 0));
    assert_eq!(limit(&scene("b.obj"), Some("every")), (Some(BounceLimit::ALL), 2));
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
        ("keep_improving", "true"),
        ("pictures", "8"),
        ("theme", "light"),
        ("ui_scale", "1.5"),
        ("reduced_motion", "true"),
        ("tab", "look"),
    ];
    assert_eq!(values.map(|(name, _)| name)[..], RULES.map(|(name, ..)| name)[..values.len()]);
    let lines = values.map(|(name, text)| format!("{name} = '{text}'\n")).concat();
    let from_file = load(Some(&file(&folder, "s.toml", &lines)), None, variables(&[]));
    let named = values.map(|(name, text)| (format!("AFTERIMAGE_{}", name.to_uppercase()), text.to_owned()));
    assert_eq!(load(None, None, named.into_iter()), from_file);
    let (settings, warnings) = from_file;
    assert_eq!(
        (settings.mode, settings.exposure, warnings),
        (Some(Mode::Full), Some(Exposure::Stops(-1.0)), Vec::new())
    );
    assert_eq!(Theme::value_variants().iter().filter(|t| Some(**t) == settings.theme).count(), 1);
}
