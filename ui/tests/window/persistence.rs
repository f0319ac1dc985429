//! Sessions, recent files, settings of the window, models that change on disk.

use super::*;
use afterimage_ui::window::state::{Appearance, Severity};
use egui::{Key, Modifiers};

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

/// Files of a user.
struct Home {
    folder: tempfile::TempDir,
}

impl Home {
    fn new() -> Self {
        let home = Self { folder: tempfile::tempdir().expect("a folder") };
        std::fs::write(home.path("triangle.obj"), TRIANGLE).expect("a file");
        home
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn request(&self) -> LaunchOptions {
        LaunchOptions {
            scene: Some(SceneSource::file(self.path("triangle.obj"))),
            pictures: Some(self.folder.path().to_owned()),
            state_folder: Some(self.path("state")),
            settings_file: Some(self.path("settings.toml")),
            ..request()
        }
    }

    fn open(&self) -> Harness<'static, App> {
        open(self.request(), false)
    }
}

fn said(harness: &mut Harness<'static, App>, words: &'static str) -> Severity {
    step_until(harness, words, move |app| says(app, words));
    let notices = &harness.state().state().notices;
    notices.iter().find(|n| n.text.contains(words)).expect("it was said").severity
}

#[test]
fn a_session_is_saved_and_brought_back() {
    let home = Home::new();
    let mut harness = home.open();
    harness.key_press(Key::K);
    harness.key_down(Key::W);
    harness.run_steps(10);
    harness.key_up(Key::W);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Num7);
    harness.key_press(Key::K);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::S);
    assert_eq!(said(&mut harness, "afterimage-session.toml"), Severity::Info);
    let (camera, path) = {
        let state = harness.state().state();
        (*state.navigation.fly.camera(), state.path().clone())
    };
    drop(harness);
    let mut files =
        std::fs::read_dir(home.folder.path()).expect("the folder").filter_map(|e| Some(e.ok()?.path()));
    let file = files.find(|p| p.to_string_lossy().ends_with("session.toml")).expect("a session");
    let mut harness = app();
    harness.input_mut().dropped_files.push(Arc::new(driving::Dropped(file)));
    step_until(&mut harness, "the session's scene", |app| {
        app.state().scene.as_ref().is_some_and(|s| s.triangles == 1)
    });
    settle(&mut harness);
    let state = harness.state().state();
    assert_eq!((*state.navigation.fly.camera(), state.path(), state.has_own_path()), (camera, &path, true));
    assert!(state.views().iter().any(|v| v.key == Some(7) && v.camera == camera));
}

#[test]
fn a_session_is_opened_by_name() {
    let home = Home::new();
    let mut harness = home.open();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::S);
    said(&mut harness, "afterimage-session.toml");
    let path = home.path("triangle.afterimage-session.toml");
    let named = || LaunchOptions { scene: Some(SceneSource::file(&path)), ..request() };
    let harness = open(named(), false);
    assert_eq!(harness.state().state().scene.as_ref().map(|s| s.triangles), Some(1));
    std::fs::write(&path, "version = 1\nscene\n").expect("a file");
    let harness = begin(named(), false);
    let notices = &harness.state().state().notices;
    assert!(notices.iter().any(|n| n.text.contains("line 2")), "{notices:?}");
    assert!(harness.state().loading().is_some(), "the gallery is shown instead");
}

#[test]
fn the_session_of_one_scene_is_not_overwritten_by_another() {
    let home = Home::new();
    std::fs::write(home.path("other.obj"), format!("{TRIANGLE}v 1 1 0\nf 2 3 4\n")).expect("a file");
    let mut harness = home.open();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::S);
    said(&mut harness, "triangle.afterimage-session.toml");
    harness.input_mut().dropped_files.push(Arc::new(driving::Dropped(home.path("other.obj"))));
    step_until(&mut harness, "the other scene", |app| {
        app.state().scene.as_ref().is_some_and(|s| s.triangles == 2)
    });
    harness.key_press_modifiers(Modifiers::COMMAND, Key::S);
    said(&mut harness, "other.afterimage-session.toml");
    let first = home.path("triangle.afterimage-session.toml");
    assert!(std::fs::read_to_string(first).expect("the session").contains("triangle.obj"));
    settle(&mut harness);
}

#[test]
fn a_session_of_another_version_is_reported_and_left_alone() {
    let home = Home::new();
    let path = home.path("a.afterimage-session.toml");
    std::fs::write(&path, "version = 7\nscene = 'builtin:room'\n").expect("a file");
    let mut harness = app();
    harness.input_mut().dropped_files.push(Arc::new(driving::Dropped(path.clone())));
    assert_eq!(said(&mut harness, "newer program"), Severity::Error);
    assert!(path.exists());
    settle(&mut harness);
}

#[test]
fn after_a_crash_the_session_is_restored() {
    let home = Home::new();
    std::fs::create_dir(home.path("state")).expect("a folder");
    // No process has this number.
    let left = home.path("state/recovery-4000000000.afterimage-session.toml");
    let mut first = home.open();
    first.key_press_modifiers(Modifiers::COMMAND, Key::S);
    said(&mut first, "afterimage-session.toml");
    let saved = home.path("triangle.afterimage-session.toml");
    std::fs::rename(saved, &left).expect("a session");
    drop(first);
    let mut harness = begin(home.request(), false);
    harness.step();
    harness.get_by_label("Restore").click();
    settle(&mut harness);
    assert!(!left.exists(), "it is not offered again");
    // A session that cannot be read is renamed.
    std::fs::write(&left, "version =").expect("a file");
    let mut harness = begin(home.request(), false);
    harness.step();
    harness.get_by_label("Restore").click();
    assert_eq!(said(&mut harness, ".bad"), Severity::Error);
    assert!(!left.exists() && home.path("state/recovery-4000000000.afterimage-session.toml.bad").exists());
    settle(&mut harness);
}

#[test]
fn files_are_remembered() {
    let home = Home::new();
    let mut harness = home.open();
    let file = home.path("state/recent.toml");
    step_until(&mut harness, "the list of recent files", move |_| file.exists());
    drop(harness);
    let harness = home.open();
    assert_eq!(harness.state().state().files.recent, [home.path("triangle.obj")]);
}

#[test]
fn a_changed_model_is_loaded_again_and_a_broken_one_is_not_shown() {
    let home = Home::new();
    let mut harness = home.open();
    harness.key_down(Key::W);
    harness.run_steps(5);
    harness.key_up(Key::W);
    let before = camera(&harness);
    std::fs::write(home.path("triangle.obj"), format!("{TRIANGLE}v 1 1 0\nf 2 3 4\n")).expect("a file");
    step_until(&mut harness, "the new model", |app| {
        app.state().scene.as_ref().is_some_and(|s| s.triangles == 2)
    });
    assert_eq!(camera(&harness), before, "a reload keeps the pose");
    std::fs::write(home.path("triangle.obj"), "nothing\n").expect("a file");
    step_until(&mut harness, "the mistake", |app| {
        app.state().notices.iter().any(|n| n.severity == Severity::Error)
    });
    assert_eq!(harness.state().state().scene.as_ref().map(|s| s.triangles), Some(2));
    settle(&mut harness);
}

#[test]
fn settings_of_the_window_are_kept_and_reset_one_by_one() {
    let home = Home::new();
    let mut harness = home.open();
    harness.get_by_label_contains("Settings").click();
    harness.run_steps(3);
    harness.get_by_label("change views without animation").click();
    harness.run_steps(2);
    assert!(harness.state().state().appearance.has_reduced_motion);
    let file = home.path("settings.toml");
    let written = file.clone();
    step_until(&mut harness, "the settings' file", move |_| written.exists());
    assert_eq!(std::fs::read_to_string(&file).expect("settings"), "reduced_motion = true\n");
    harness.get_by_label("Reset motion").click();
    let written = file.clone();
    step_until(&mut harness, "the reset", move |_| {
        std::fs::read_to_string(&written).is_ok_and(|t| t.is_empty())
    });
    assert_eq!(harness.state().state().appearance, Appearance::default());
}

#[test]
fn invalid_settings_are_reported() {
    let request =
        LaunchOptions { warnings: vec!["settings.toml: 'sampels' is left aside".to_owned()], ..request() };
    let mut harness = open(request, false);
    assert_eq!(said(&mut harness, "sampels"), Severity::Error);
}
