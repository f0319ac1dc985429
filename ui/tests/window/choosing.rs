//! Choosing files in the program's own list, and the path field.

use super::*;
use afterimage_ui::window::state::FileList;
use egui::{Key, Modifiers};
use std::path::Path;

const MODEL: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n";

/// A folder with a model in a folder inside.
fn models() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::create_dir(folder.path().join("deep")).expect("a folder");
    for name in ["deep/house.obj", "deep/hut.obj", "other.obj", "note.txt"] {
        std::fs::write(folder.path().join(name), MODEL).expect("a file");
    }
    folder
}

/// The app on a model of the folder, whose folder the list shows first.
fn app_in(folder: &Path) -> Harness<'static, App> {
    let scene = Some(SceneSource::file(folder.join("other.obj")));
    open(LaunchOptions { scene, ..request() }, false)
}

fn list(app: &App) -> Option<&FileList> {
    app.state().files.list.as_ref().filter(|list| !list.is_reading)
}

fn shows(app: &App, folder: &Path) -> bool {
    list(app).is_some_and(|list| list.folder == folder)
}

fn open_list(harness: &mut Harness<'static, App>) {
    harness.key_press_modifiers(Modifiers::COMMAND, Key::O);
    step_until(harness, "the list", |app| list(app).is_some());
    harness.run_steps(3);
}

fn is_shown(app: &App, path: &Path) -> bool {
    let wanted = SceneSource::file(path);
    app.state().scene.as_ref().is_some_and(|scene| scene.source.is_same(&wanted))
}

#[test]
fn open_shows_a_list_and_keys_alone_open_a_model() {
    let folder = models();
    let mut harness = app_in(folder.path());
    open_list(&mut harness);
    assert!(shows(harness.state(), folder.path()));
    harness.get_by_label("deep/");
    assert!(harness.query_by_label("note.txt").is_none(), "other files are not offered");
    // Folders come first, so that Enter goes into the first one.
    harness.key_press(Key::Enter);
    step_until(&mut harness, "the folder inside", |app| shows(app, &folder.path().join("deep")));
    harness.run_steps(2);
    harness.key_press(Key::ArrowDown);
    harness.run_steps(2);
    assert_eq!(list(harness.state()).expect("a list").chosen, 1);
    harness.key_press(Key::Backspace);
    step_until(&mut harness, "the folder above", |app| shows(app, folder.path()));
    harness.run_steps(2);
    harness.get_by_label("Name or path").type_text("deep/hut.obj");
    harness.run_steps(2);
    harness.key_press(Key::Enter);
    step_until(&mut harness, "the model", |app| is_shown(app, &folder.path().join("deep/hut.obj")));
    assert!(harness.state().state().files.list.is_none());
}

#[test]
fn the_list_is_filtered_clicked_and_closed() {
    let folder = models();
    let mut harness = app_in(&folder.path().join("deep/.."));
    open_list(&mut harness);
    harness.get_by_label("Name or path").type_text("OTH");
    harness.run_steps(3);
    assert_eq!(list(harness.state()).expect("a list").shown.len(), 1);
    harness.key_press(Key::Escape);
    harness.run_steps(3);
    assert!(list(harness.state()).is_none());
    open_list(&mut harness);
    harness.get_by_label("deep/").click_accesskit();
    harness.run_steps(2);
    harness.get_by_label("Open").click_accesskit();
    step_until(&mut harness, "the folder inside", |app| {
        list(app).is_some_and(|l| l.folder.ends_with("deep"))
    });
    harness.run_steps(2);
    harness.get_by_label("house.obj").click_accesskit();
    harness.run_steps(2);
    harness.get_by_label("Open").click_accesskit();
    step_until(&mut harness, "the model", |app| {
        app.state().scene.as_ref().is_some_and(|scene| scene.name.contains("house"))
    });
}

#[test]
fn a_path_that_is_missing_is_said_in_the_list() {
    let folder = models();
    let mut harness = app_in(folder.path());
    open_list(&mut harness);
    harness.get_by_label("Name or path").type_text("/no/such/place");
    harness.run_steps(2);
    harness.key_press(Key::Enter);
    step_until(&mut harness, "the reason", |app| list(app).is_some_and(|list| list.error.is_some()));
    harness.run_steps(2);
    harness.get_by_label_contains("/no/such/place cannot be read");
}

#[test]
fn the_path_field_completes_and_knows_addresses() {
    let folder = models();
    let mut harness = app();
    let field = |harness: &mut Harness<'static, App>| {
        harness.get_by_label("Model file").scroll_to_me();
        harness.run_steps(3);
        harness.get_by_role_and_label(egui::accesskit::Role::TextInput, "Model file").focus();
        harness.run_steps(2);
    };
    field(&mut harness);
    let begun = format!("{}/de", folder.path().display());
    harness.get_by_role_and_label(egui::accesskit::Role::TextInput, "Model file").type_text(&begun);
    step_until(&mut harness, "the folder", |app| !app.state().files.nearby.entries.is_empty());
    harness.run_steps(2);
    harness.key_press(Key::ArrowRight);
    step_until(&mut harness, "the folder inside", |app| app.state().files.nearby.folder.ends_with("deep"));
    assert_eq!(harness.state().state().files.path_text, format!("{}/deep/", folder.path().display()));
    harness.run_steps(2);
    harness.get_by_label("Complete to hut.obj").click_accesskit();
    harness.run_steps(3);
    harness.key_press(Key::Enter);
    step_until(&mut harness, "the model", |app| is_shown(app, &folder.path().join("deep/hut.obj")));
}
