//! Sun and sky as their controls show them: what is typed, night and day, and undo.

use super::{app, step_until};
use afterimage::scene::Daylight;
use afterimage_ui::window::App;
use afterimage_ui::window::state::SunControls;
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
    for label in ["Sun and sky", "Sun", "Sky", "By place and time"] {
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
    type_into(&mut harness, "Time", "15:00", |_| {});
    enter(&mut harness);
    harness.get_by_label("Time").focus();
    harness.key_press(Key::Escape);
    harness.run_steps(3);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    harness.run_steps(3);
    assert!(sun(harness.state()).is_by_place);
}
