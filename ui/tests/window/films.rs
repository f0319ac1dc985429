//! Films of the camera path: by key, with progress, and what is kept when they are cancelled.

use super::*;
use crate::boxes::Boxes;
use afterimage::raster::film::FilmQuality;
use afterimage_ui::window::state::{PictureSettings, PictureSize, Severity};
use egui::{Key, Modifiers};
use std::path::Path;

const FILM_KEY: (Modifiers, Key) = (Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::F12);

/// The room's app, which saves films of this size and rate in a folder.
fn filming(folder: &Path, size: [u32; 2], film_rate: u32) -> Harness<'static, App> {
    let picture = PictureSettings {
        size: PictureSize::Pixels(size),
        film_rate,
        film_quality: FilmQuality::Small,
        ..PictureSettings::default()
    };
    open(LaunchOptions { pictures: Some(folder.to_owned()), picture, ..request() }, false)
}

/// The newest message.
fn message(harness: &mut Harness<'static, App>) -> (Severity, String) {
    step_until(harness, "a message", |app| !app.state().notices.is_empty());
    let notice = harness.state().state().notices.last().expect("a message");
    (notice.severity, notice.text.clone())
}

fn boxes(path: &Path) -> Boxes {
    Boxes::read(&std::fs::read(path).expect("a film"))
}

#[test]
fn a_key_saves_the_path_as_a_film() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = filming(folder.path(), [32, 24], 2);
    harness.key_press_modifiers(FILM_KEY.0, FILM_KEY.1);
    let (severity, text) = message(&mut harness);
    assert_eq!(severity, Severity::Info, "{text}");
    let film = boxes(&folder.path().join("afterimage-room-0001.mp4"));
    let secs = afterimage_ui::window::input::playback::path_secs(harness.state().state().path());
    assert_eq!((film.size, film.frames()), ([32, 24], (secs * 2.0).round() as usize + 1));
    assert!(text.starts_with(&format!("saved {} frames", film.frames())), "{text}");
    let picture = &harness.state().state().picture;
    assert!(picture.secs_per_film_ray.is_some() && picture.running_film.is_none());
}

#[test]
fn a_film_that_is_cancelled_keeps_what_was_complete() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = filming(folder.path(), [160, 96], 60);
    harness.key_press_modifiers(FILM_KEY.0, FILM_KEY.1);
    let has_frames =
        |app: &App| app.state().picture.exporting.as_ref().is_some_and(|p| p.fraction > Some(0.0));
    step_until(&mut harness, "the first frames", has_frames);
    harness.step();
    harness.get_by_label("Cancel saving").click_accesskit();
    let (severity, text) = message(&mut harness);
    assert_eq!(severity, Severity::Info, "{text}");
    let film = boxes(&folder.path().join("afterimage-room-0001.mp4"));
    // A fast machine may be done before the click arrives.
    let words = [format!("saved the first {} of", film.frames()), format!("saved {} frames", film.frames())];
    assert!(words.iter().any(|words| text.starts_with(words)), "{text}");
    assert_eq!(std::fs::read_dir(folder.path()).expect("the folder").count(), 1, "nothing half-written");
}

#[test]
fn a_size_that_no_film_can_have_is_refused_with_one_that_can() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = filming(folder.path(), [33, 24], 2);
    harness.key_press_modifiers(FILM_KEY.0, FILM_KEY.1);
    let (severity, text) = message(&mut harness);
    assert!(severity == Severity::Error && text.contains("32x24 is"), "{text}");
    assert_eq!(std::fs::read_dir(folder.path()).expect("the folder").count(), 0);
}
