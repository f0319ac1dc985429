//! Sun and sky as their controls show them: what is typed, night and day, and undo.

use super::{app, camera, open, request, says, settle, show_tab, step_until};
use afterimage::scene::Daylight;
use afterimage::trace::TraceSettings;
use afterimage::{Camera, Mode};
use afterimage_ui::window::input::fly_camera::MoveMode;
use afterimage_ui::window::state::SunControls;
use afterimage_ui::window::{App, LaunchOptions, SceneSource};
use egui::{Event, Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

fn sun(app: &App) -> &SunControls {
    &app.state().document.as_ref().expect("a scene").now().sun
}

fn daylight(app: &App) -> &Daylight {
    &app.state().document.as_ref().expect("a scene").scene().daylight
}

/// The app with sun and sky by place and time, at noon of midsummer.
fn sunny() -> Harness<'static, App> {
    let mut harness = app();
    show_tab(&mut harness, "Look");
    for label in ["Sun", "Sky", "By place and time"] {
        harness.get_by_label(label).click_accesskit();
        harness.run_steps(30);
    }
    assert!(daylight(harness.state()).sun.is_some() && daylight(harness.state()).sky.is_some());
    harness
}

/// Types a text into a field, letter by letter. `after` is called after each letter.
fn type_into(harness: &mut Harness<'static, App>, field: &str, text: &str, after: impl Fn(&App)) {
    harness.get_by_label(field).focus();
    harness.run_steps(3);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.run_steps(2);
    for letter in text.chars() {
        harness.event(Event::Text(letter.to_string()));
        harness.run_steps(2);
        after(harness.state());
    }
}

fn enter(harness: &mut Harness<'static, App>) {
    harness.key_press(Key::Enter);
    harness.run_steps(4);
}

#[test]
fn a_time_that_is_typed_counts_on_enter_and_is_not_rounded() {
    let mut harness = sunny();
    let before = sun(harness.state()).clone();
    type_into(&mut harness, "Time", "18:33", |app| assert_eq!(*sun(app), before, "nothing before Enter"));
    enter(&mut harness);
    assert!((sun(harness.state()).place.hours - 18.55).abs() < 1e-9, "{:?}", sun(harness.state()));
    let evening = sun(harness.state()).clone();
    type_into(&mut harness, "Time", "noon", |app| assert_eq!(*sun(app), evening));
    enter(&mut harness);
    assert_eq!(*sun(harness.state()), evening, "a text that is no time changes nothing");
    type_into(&mut harness, "Year", "2031", |app| assert_eq!(*sun(app), evening));
    enter(&mut harness);
    assert_eq!(sun(harness.state()).place.year, 2031);
}

#[test]
fn a_zone_counts_when_its_field_is_left() {
    let mut harness = sunny();
    let (before, light) = (sun(harness.state()).clone(), daylight(harness.state()).clone());
    type_into(&mut harness, "Time zone", "Europe/Lisbon", |app| {
        assert_eq!((sun(app), daylight(app)), (&before, &light));
    });
    harness.key_press(Key::Tab);
    harness.run_steps(4);
    assert_eq!(sun(harness.state()).place.zone, "Europe/Lisbon");
    assert!(*daylight(harness.state()) != light, "an hour later by the sun");
}

#[test]
fn the_sun_comes_back_after_the_night() {
    let mut harness = sunny();
    let noon = daylight(harness.state()).clone();
    let lights = |app: &App| app.state().scene.as_ref().expect("a scene").lights;
    step_until(&mut harness, "sun and sky", |app| lights(app) == 4);
    type_into(&mut harness, "Time", "23:30", |_| {});
    enter(&mut harness);
    assert_eq!(*daylight(harness.state()), Daylight::default(), "it is night");
    assert!(sun(harness.state()).has_sun && sun(harness.state()).has_sky, "both are still wanted");
    harness.get_by_label_contains("Night");
    step_until(&mut harness, "a dark sky", |app| lights(app) == 2);
    type_into(&mut harness, "Time", "12:00", |_| {});
    enter(&mut harness);
    assert_eq!(*daylight(harness.state()), noon);
    // Keys move the slider by five minutes.
    harness.get_by_label("Time of day").focus();
    harness.run_steps(2);
    harness.key_press(Key::ArrowRight);
    harness.run_steps(2);
    assert!((sun(harness.state()).place.hours - 12.0 - 1.0 / 12.0).abs() < 1e-9);
    harness.get_by_label("21 Dec").click_accesskit();
    harness.run_steps(3);
    assert_eq!((sun(harness.state()).place.month, sun(harness.state()).place.day), (12, 21));
    harness.get_by_label_contains("Sunrise 08:1");
    harness.get_by_label("CET");
}

#[test]
fn undo_of_another_time_stays_by_place_and_time() {
    let mut harness = sunny();
    let noon = sun(harness.state()).clone();
    // Changes of one thing in a short time are one step; this is another thing.
    harness.get_by_label("Ground").click_accesskit();
    harness.run_steps(3);
    type_into(&mut harness, "Time", "15:00", |_| {});
    enter(&mut harness);
    assert!(*sun(harness.state()) != noon);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    harness.run_steps(3);
    assert_eq!(*sun(harness.state()), noon, "by place and time as before, at the time of before");
    harness.get_by_label("Time of day");
}

/// A closed box without a ground, 4 m wide and 3 m high, as a model file in a folder.
fn box_model(folder: &std::path::Path) -> std::path::PathBuf {
    let path = folder.join("box.obj");
    let model = "v 0 0 0\nv 4 0 0\nv 4 0 4\nv 0 0 4\nv 0 3 0\nv 4 3 0\nv 4 3 4\nv 0 3 4\n\
                 f 1 2 3 4\nf 8 7 6 5\nf 1 5 6 2\nf 2 6 7 3\nf 3 7 8 4\nf 4 8 5 1\n";
    std::fs::write(&path, model).expect("the folder can be written to");
    path
}

fn open_model(path: std::path::PathBuf) -> Harness<'static, App> {
    let daylight = Default::default();
    open(LaunchOptions { scene: Some(SceneSource::file(path)), daylight, ..request() }, false)
}

#[test]
fn a_model_without_a_ground_gets_one_that_goes_and_comes_back_and_is_kept() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = box_model(folder.path());
    let mut harness = open_model(path.clone());
    let ground = |app: &App| app.state().document.as_ref().expect("a scene").scene().ground;
    let triangles = |app: &App| app.state().scene.as_ref().expect("a scene").triangles;
    assert_eq!(ground(harness.state()).map(|g| g.height_m), Some(0.0));
    assert!(triangles(harness.state()) > 12);
    show_tab(&mut harness, "Look");
    harness.run_steps(30);
    harness.get_by_label_contains("no ground of its own");
    harness.get_by_label("Ground").click_accesskit();
    harness.run_steps(3);
    assert_eq!(ground(harness.state()), None);
    step_until(&mut harness, "the box alone", |app| triangles(app) == 12);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    step_until(&mut harness, "the ground again", |app| triangles(app) > 12);
    type_into(&mut harness, "Ground height", "-0.25", |app| {
        assert_eq!(ground(app).map(|g| g.height_m), Some(0.0), "nothing before Enter");
    });
    enter(&mut harness);
    assert_eq!(ground(harness.state()).map(|g| g.height_m), Some(-0.25));
    harness.get_by_label("Ground").click_accesskit();
    harness.run_steps(3);
    harness.get_by_label("Edit").click_accesskit();
    harness.run_steps(3);
    harness.get_by_label_contains("Save changes of the scene").click_accesskit();
    step_until(&mut harness, "the file", |_| path.with_extension("afterimage.toml").exists());
    drop(harness);
    let again = open_model(path);
    assert_eq!(ground(again.state()), None, "the file beside the model says that there is none");
}

#[test]
fn a_model_without_lamps_opens_dark_where_sun_and_sky_were_switched_off() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = box_model(folder.path());
    let mut harness = open_model(path.clone());
    assert!(daylight(harness.state()).sun.is_some(), "it is given the light of a day");
    show_tab(&mut harness, "Look");
    harness.run_steps(30);
    for label in ["Sun", "Sky"] {
        harness.get_by_label(label).click_accesskit();
        harness.run_steps(3);
    }
    assert_eq!(*daylight(harness.state()), Daylight::default());
    harness.get_by_label("Edit").click_accesskit();
    harness.run_steps(3);
    harness.get_by_label_contains("Save changes of the scene").click_accesskit();
    step_until(&mut harness, "the file", |_| path.with_extension("afterimage.toml").exists());
    drop(harness);
    let again = open_model(path);
    assert_eq!(*daylight(again.state()), Daylight::default());
    assert!(!again.state().state().is_unsaved());
}

#[test]
fn one_walks_on_the_ground_and_flies_where_there_is_none() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = open_model(box_model(folder.path()));
    harness.key_press(Key::G);
    step_until(&mut harness, "a walker on the ground", |app| {
        !app.state().navigation.fly.is_easing() && says(app, "walking: on the floor below")
    });
    let height = |harness: &Harness<'static, App>| camera(harness).eye.y;
    assert!((height(&harness) - Camera::EYE_HEIGHT_M).abs() < 0.02, "{}", height(&harness));
    harness.key_press(Key::Home);
    harness.run_steps(2);
    step_until(&mut harness, "arrival", |app| !app.state().navigation.fly.is_easing());
    assert!((height(&harness) - Camera::EYE_HEIGHT_M).abs() < 0.02, "{}", height(&harness));
    harness.key_press(Key::G);
    harness.run_steps(3);
    show_tab(&mut harness, "Look");
    harness.get_by_label("Ground").click_accesskit();
    harness.run_steps(30);
    let triangles = |app: &App| app.state().scene.as_ref().expect("a scene").triangles;
    step_until(&mut harness, "the box alone", |app| triangles(app) == 12);
    harness.key_press(Key::G);
    step_until(&mut harness, "no floor", |app| says(app, "no floor below: flying"));
    assert_eq!(harness.state().state().navigation.fly.move_mode(), MoveMode::Fly);
}

#[test]
fn the_exposure_follows_into_the_dark_and_one_that_is_set_stays() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = box_model(folder.path());
    // A gap below the roof lets a little light in.
    let text = std::fs::read_to_string(&path).expect("it was written").replace("f 4 8 5 1\n", "");
    std::fs::write(&path, text + "v 0 2.9 0\nv 0 2.9 4\nf 4 10 9 1\n").expect("written");
    let mut options = LaunchOptions { scene: Some(SceneSource::file(path)), ..request() };
    options.settings.render.mode = Mode::Exact;
    options.settings.render.trace = TraceSettings { samples: 4, bounces: 4, seed: 0 };
    let mut harness = open(options, false);
    let exposure = |harness: &Harness<'static, App>| harness.state().state().exposure_ev();
    let outside = exposure(&harness);
    let inside = Camera::look_at(glam::DVec3::new(1.0, 1.6, 2.0), glam::DVec3::new(3.9, 0.8, 2.0), 60.0);
    harness.event(Event::Paste(pose_text(&inside)));
    harness.run_steps(90);
    settle(&mut harness);
    harness.run_steps(90);
    assert!(exposure(&harness) > outside + 1.0, "{outside} outside, {} inside", exposure(&harness));
    harness.key_press(Key::V);
    harness.run_steps(2);
    assert!(says(harness.state(), "for this view"));
    let fixed = exposure(&harness);
    let sun = Camera::look_at(glam::DVec3::new(12.0, 6.0, 12.0), glam::DVec3::new(2.0, 1.0, 2.0), 60.0);
    harness.event(Event::Paste(pose_text(&sun)));
    harness.run_steps(90);
    settle(&mut harness);
    assert!((exposure(&harness) - fixed).abs() < 1e-6, "what the user has set stays");
}

fn pose_text(camera: &Camera) -> String {
    let (eye, at) = (camera.eye, camera.eye + camera.forward());
    format!("--eye {},{},{} --look-at {},{},{} --fov-y 60", eye.x, eye.y, eye.z, at.x, at.y, at.z)
}
