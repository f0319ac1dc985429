//! Saved pictures: of any size, off the window's thread, and the way back to their view.

use super::*;
use afterimage::raster::load::{Picture, read_notes};
use afterimage::render::render_antialiased;
use afterimage::{FrameRequest, Mode, Tracer};
use afterimage_ui::window::state::{PictureFormat, PictureSettings, PictureSize, Severity};
use egui::{Key, Modifiers};

/// The room's app with settings of the picture that F12 saves.
fn saving(folder: &std::path::Path, settings: PictureSettings) -> Harness<'static, App> {
    open(LaunchOptions { pictures: Some(folder.to_owned()), picture: settings, ..request() }, false)
}

fn notice(harness: &mut Harness<'static, App>) -> (Severity, String) {
    step_until(harness, "a message", |app| !app.state().notices.is_empty());
    let notice = harness.state().state().notices.last().expect("a message");
    (notice.severity, notice.text.clone())
}

fn small() -> PictureSettings {
    PictureSettings { size: PictureSize::Pixels([40, 30]), antialias: 2, ..PictureSettings::default() }
}

#[test]
fn f12_saves_the_full_tracers_picture_of_the_asked_size_bit_for_bit() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = saving(folder.path(), PictureSettings { format: PictureFormat::Exr, ..small() });
    harness.key_press(Key::F12);
    assert_eq!(notice(&mut harness).0, Severity::Info, "{}", notice(&mut harness).1);
    let path = folder.path().join("afterimage-room-0001.exr");
    let picture = Picture::load(&path).expect("a picture");
    let state = harness.state().state();
    let tracer = Tracer::new(small_room());
    let mut settings = state.quality.walk.render;
    settings.mode = Mode::Full;
    let expected = render_antialiased(
        &FrameRequest::new(&tracer, state.navigation.fly.camera(), [40, 30], &settings),
        2,
    );
    assert_eq!(picture.values, expected.radiance);
    let notes = read_notes(&path).expect("notes");
    let note = |name: &str| notes.iter().find(|(n, _)| n == name).map(|(_, t)| t.clone()).unwrap_or_default();
    assert!(
        note("Settings").contains("--size 40x30 --mode full --samples 1")
            && note("Settings").contains("--antialias 2")
    );
    assert_eq!(note("Complete"), "yes");
    let layers = exr::prelude::read_first_flat_layer_from_file(&path).expect("layers");
    let mut names: Vec<String> =
        layers.layer_data.channel_data.list.iter().map(|c| c.name.to_string()).collect();
    names.sort();
    let wanted = [
        "B",
        "G",
        "R",
        "depth.Z",
        "normal.X",
        "normal.Y",
        "normal.Z",
        "primitive.V",
        "reference.V",
        "type.V",
    ];
    assert_eq!(names, wanted);
}

#[test]
fn without_anything_set_it_is_as_large_as_the_viewport() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = saving(folder.path(), PictureSettings { antialias: 1, ..PictureSettings::default() });
    harness.key_press(Key::F12);
    assert_eq!(notice(&mut harness).0, Severity::Info);
    let size = harness.get_by_label("3D viewport").rect().size();
    let picture = image::open(folder.path().join("afterimage-room-0001.png")).expect("a picture").to_rgb8();
    assert_eq!([picture.width(), picture.height()], [size.x.round() as u32, size.y.round() as u32]);
    assert!(picture.pixels().any(|p| p.0 != [0, 0, 0]));
}

#[test]
fn a_picture_from_references_reuses_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness =
        saving(folder.path(), PictureSettings { mode: Mode::Paper, format: PictureFormat::Exr, ..small() });
    harness.key_press(Key::F12);
    assert_eq!(notice(&mut harness).0, Severity::Info, "{}", notice(&mut harness).1);
    let path = folder.path().join("afterimage-room-0001.exr");
    let image = exr::prelude::read_first_flat_layer_from_file(&path).expect("layers");
    let list = &image.layer_data.channel_data.list;
    let types = list.iter().find(|c| c.name.to_string() == "type.V").expect("types");
    let exr::prelude::FlatSamples::U32(types) = &types.sample_data else { panic!("indices") };
    assert!(types.iter().filter(|t| **t == 1).count() > types.len() / 2, "most of the room is reused");
}

#[test]
fn a_panorama_is_saved_from_the_picture_settings() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = saving(folder.path(), PictureSettings { panorama_width: 64, ..small() });
    harness.get_by_role_and_label(egui::Role::Button, "File").click_accesskit();
    harness.run_steps(3);
    harness.get_by_label_contains("Picture settings").click_accesskit();
    harness.run_steps(5);
    harness.get_by_label("Save panorama").click_accesskit();
    assert_eq!(notice(&mut harness).0, Severity::Info, "{}", notice(&mut harness).1);
    let path = folder.path().join("afterimage-room-panorama-0001.png");
    let picture = image::open(&path).expect("a panorama");
    assert_eq!([picture.width(), picture.height()], [64, 32]);
    let notes = read_notes(&path).expect("notes");
    assert!(notes.iter().any(|(name, text)| name == "XML:com.adobe.xmp" && text.contains("equirectangular")));
    settle(&mut harness);
    // Its time is the guess for the next one.
    assert!(harness.state().state().picture.secs_per_panorama_pixel.is_some());
}

#[test]
fn ctrl_f12_leaves_the_sky_out() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = saving(folder.path(), small());
    harness.key_press_modifiers(Modifiers::COMMAND, Key::F12);
    assert_eq!(notice(&mut harness).0, Severity::Info);
    let picture = image::open(folder.path().join("afterimage-room-0001.png")).expect("a picture");
    assert!(picture.color().has_alpha());
}

#[test]
fn a_picture_is_cancelled_and_leaves_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let huge = PictureSettings { size: PictureSize::Pixels([16384, 16384]), ..small() };
    let mut harness = saving(folder.path(), huge);
    harness.key_press(Key::F12);
    step_until(&mut harness, "its progress", |app| app.state().picture.exporting.is_some());
    harness.step();
    harness.get_by_label("Cancel saving").click();
    let (severity, text) = notice(&mut harness);
    assert_eq!((severity, text.as_str()), (Severity::Info, "saving was cancelled"));
    assert_eq!(std::fs::read_dir(folder.path()).expect("the folder").count(), 0);
    settle(&mut harness);
}

#[test]
fn a_folder_that_accepts_no_file_is_reported_with_a_remedy() {
    let mut harness = saving(std::path::Path::new("/no/such/folder"), small());
    harness.key_press(Key::F12);
    let (severity, text) = notice(&mut harness);
    assert_eq!(severity, Severity::Error);
    assert!(text.contains("/no/such/folder") && text.contains("choose another folder"), "{text}");
    settle(&mut harness);
}

#[test]
fn a_dropped_picture_leads_back_to_its_view() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = saving(folder.path(), small());
    let there = camera(&harness);
    harness.key_press(Key::F12);
    assert_eq!(notice(&mut harness).0, Severity::Info);
    harness.key_press(Key::Num2);
    harness.run_steps(60);
    assert_ne!(camera(&harness), there);
    let path = folder.path().join("afterimage-room-0001.png");
    harness.input_mut().dropped_files.push(Arc::new(driving::Dropped(path)));
    step_until(&mut harness, "the picture's view", |app| says(app, "picture was taken"));
    harness.run_steps(60);
    let back = camera(&harness);
    assert!(
        (back.eye - there.eye).length() < 1e-9 && (back.yaw - there.yaw).abs() < 1e-9,
        "{back:?} {there:?}"
    );
    assert!(!harness.state().state().is_unsaved(), "nothing that is saved has changed");
}

#[test]
fn a_jpeg_is_saved_and_leads_back_to_its_view_and_without_sky_it_is_a_png() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = saving(folder.path(), PictureSettings { format: PictureFormat::Jpeg, ..small() });
    let there = camera(&harness);
    harness.key_press(Key::F12);
    assert_eq!(notice(&mut harness).0, Severity::Info, "{}", notice(&mut harness).1);
    let path = folder.path().join("afterimage-room-0001.jpg");
    assert_eq!(Picture::load(&path).expect("a picture").size, [40, 30]);
    let notes = read_notes(&path).expect("notes");
    for (name, expected) in [("Settings", "--antialias 2"), ("Pose", "--eye"), ("Complete", "yes")] {
        assert!(notes.iter().any(|(n, text)| n == name && text.contains(expected)), "{name}: {notes:?}");
    }
    harness.key_press(Key::Num2);
    harness.run_steps(60);
    harness.input_mut().dropped_files.push(Arc::new(driving::Dropped(path)));
    step_until(&mut harness, "the picture's view", |app| says(app, "picture was taken"));
    harness.run_steps(60);
    assert!((camera(&harness).eye - there.eye).length() < 1e-9);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::F12);
    step_until(&mut harness, "a picture without sky", |app| says(app, "0001.png"));
}

#[test]
fn a_picture_of_another_program_is_refused_with_a_message() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("holiday.png");
    image::RgbImage::new(2, 2).save(&path).expect("a picture");
    let mut harness = app();
    harness.input_mut().dropped_files.push(Arc::new(driving::Dropped(path)));
    let (severity, text) = notice(&mut harness);
    assert_eq!(severity, Severity::Error);
    assert!(text.contains("does not say what it shows"), "{text}");
    settle(&mut harness);
}

#[test]
fn the_path_becomes_numbered_pictures_and_goes_on_where_it_was_cut() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = saving(
        folder.path(),
        PictureSettings { size: PictureSize::Pixels([16, 12]), antialias: 1, ..small() },
    );
    harness.key_press_modifiers(Modifiers::SHIFT, Key::F12);
    let (severity, text) = notice(&mut harness);
    assert_eq!(severity, Severity::Info, "{text}");
    let sequence = folder.path().join("afterimage-room-sequence-0001");
    let frames = harness.state().state().path().frames as usize;
    let count = || std::fs::read_dir(&sequence).expect("the folder").count() - 1;
    assert_eq!(count(), frames, "and its description");
    let command = harness.state().state().picture.film_command.clone().expect("a command");
    assert!(
        command.starts_with("ffmpeg -framerate 30 -i '") && command.contains("frame_%04d.png"),
        "{command}"
    );
    std::fs::remove_file(sequence.join("frame_0001.png")).expect("it was there");
    let first =
        std::fs::metadata(sequence.join("frame_0000.png")).and_then(|m| m.modified()).expect("a time");
    harness.key_press_modifiers(Modifiers::SHIFT, Key::F12);
    step_until(&mut harness, "another message", |app| says(app, "already"));
    assert_eq!(count(), frames);
    let again =
        std::fs::metadata(sequence.join("frame_0000.png")).and_then(|m| m.modified()).expect("a time");
    assert_eq!(first, again, "what was there is not made again");
}

/// Writes a program that notes what it is asked to open.
#[cfg(unix)]
fn opener(folder: &std::path::Path) -> PathBuf {
    use std::os::unix::fs::PermissionsExt;
    let program = folder.join("opener");
    let text = format!("#!/bin/sh\necho \"$1\" > '{}/opened'\n", folder.display());
    std::fs::write(&program, text).expect("a program");
    std::fs::set_permissions(&program, std::fs::Permissions::from_mode(0o755)).expect("it may run");
    program
}

#[test]
#[cfg(unix)]
fn a_saved_picture_is_opened_and_shown_in_its_folder_from_the_message() {
    let folder = tempfile::tempdir().expect("a folder");
    let pictures = folder.path().join("pictures");
    std::fs::create_dir(&pictures).expect("a folder");
    let launch = LaunchOptions {
        pictures: Some(pictures.clone()),
        picture: small(),
        opener: opener(folder.path()),
        ..request()
    };
    let mut harness = open(launch, false);
    harness.key_press(Key::F12);
    assert_eq!(notice(&mut harness).0, Severity::Info);
    let opened = folder.path().join("opened");
    let wanted =
        [("Open the saved file", pictures.join("afterimage-room-0001.png")), ("Show in folder", pictures)];
    for (button, path) in wanted {
        harness.step();
        harness.get_by_label(button).click_accesskit();
        let is_opened = |path: &std::path::Path| {
            std::fs::read_to_string(&opened).is_ok_and(|text| text.trim() == path.display().to_string())
        };
        step_until(&mut harness, button, |_| is_opened(&path));
    }
}

#[test]
fn where_the_system_opens_nothing_a_message_says_so() {
    let folder = tempfile::tempdir().expect("a folder");
    let launch = LaunchOptions {
        pictures: Some(folder.path().to_owned()),
        picture: small(),
        opener: "/no/such/opener".into(),
        ..request()
    };
    let mut harness = open(launch, false);
    harness.key_press(Key::F12);
    assert_eq!(notice(&mut harness).0, Severity::Info);
    harness.step();
    harness.get_by_label("Show in folder").click_accesskit();
    step_until(&mut harness, "a message", |app| says(app, "open it in your file manager"));
    assert!(says(harness.state(), "/no/such/opener"));
}

#[test]
fn pictures_of_a_model_are_saved_beside_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let model = folder.path().join("yard.obj");
    std::fs::write(&model, desk::COURTYARD).expect("a model");
    let launch = LaunchOptions { scene: Some(SceneSource::file(&model)), picture: small(), ..request() };
    let mut harness = open(launch, false);
    harness.key_press(Key::F12);
    step_until(&mut harness, "the picture", |app| says(app, "yard-0001.png"));
    assert!(folder.path().join("afterimage-yard-0001.png").exists());
}

#[test]
fn the_dialog_offers_qualities_with_their_times_and_what_a_film_takes() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = saving(folder.path(), small());
    harness.key_press(Key::F12);
    assert_eq!(notice(&mut harness).0, Severity::Info);
    assert!(harness.state().state().picture.secs_per_sample.is_some(), "measured with the first frame");
    harness.get_by_role_and_label(egui::Role::Button, "File").click_accesskit();
    harness.run_steps(3);
    harness.get_by_label_contains("Picture settings").click_accesskit();
    harness.run_steps(5);
    harness.get_by_label("Draft").click_accesskit();
    harness.run_steps(3);
    assert_eq!(harness.state().state().picture.settings.antialias, 4);
    harness.get_by_label("Best").click_accesskit();
    harness.run_steps(3);
    let settings = &harness.state().state().picture.settings;
    assert!(settings.antialias > PictureSettings::default().antialias);
    let frames = harness.state().state().path().frames;
    harness.get_by_label_contains(&format!("{frames} pictures; time: "));
}

#[test]
fn a_film_has_its_own_sky_and_rate() {
    let folder = tempfile::tempdir().expect("a folder");
    let settings = PictureSettings {
        size: PictureSize::Pixels([16, 12]),
        antialias: 1,
        film_background: afterimage::render::bands::Background::LeftOut,
        film_rate: 2,
        ..PictureSettings::default()
    };
    let mut harness = saving(folder.path(), settings);
    harness.key_press_modifiers(Modifiers::SHIFT, Key::F12);
    let (severity, text) = notice(&mut harness);
    assert_eq!(severity, Severity::Info, "{text}");
    let command = harness.state().state().picture.film_command.clone().expect("a command");
    assert!(command.starts_with("ffmpeg -framerate 2 "), "{command}");
    let sequence = folder.path().join("afterimage-room-sequence-0001");
    let first = image::open(sequence.join("frame_0000.png")).expect("a picture");
    assert!(first.color().has_alpha(), "the film leaves the sky out, pictures do not");
    let secs = afterimage_ui::window::input::playback::path_secs(harness.state().state().path());
    let pictures = std::fs::read_dir(&sequence).expect("the folder").count() - 1;
    assert_eq!(pictures, (secs * 2.0).round() as usize + 1);
}
