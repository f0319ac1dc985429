//! Every key of the map does what the map says. A key without a check here fails.

use super::*;
use afterimage::raster::exposure::Exposure;
use afterimage_ui::window::input::fly_camera::MoveMode;
use afterimage_ui::window::input::keymap::{Action, Attention, BINDINGS, Chord, Keyboard, Pressed};
use afterimage_ui::window::state::{AppState, Compare, Options, PictureSettings, PictureSize};
use egui::{Key, Modifiers, ViewportCommand, vec2};
use glam::DVec3;

type Window = Harness<'static, App>;

fn press(window: &mut Window, chord: Chord) {
    let modifiers =
        Modifiers { shift: chord.shift, ctrl: chord.ctrl, command: chord.ctrl, ..Modifiers::NONE };
    window.key_press_modifiers(modifiers, chord.key);
    window.run_steps(2);
}

fn state(window: &Window) -> &AppState {
    window.state().state()
}

fn arrive(window: &mut Window) {
    window.step();
    for _ in 0..120 {
        if !state(window).navigation.fly.is_easing() {
            return;
        }
        window.step();
    }
    panic!("the camera never arrives");
}

/// Motion of a held key as the user sees it: right, up, forward.
fn way(window: &mut Window, key: Key) -> DVec3 {
    let before = camera(window);
    window.key_down(key);
    window.run_steps(6);
    window.key_up(key);
    window.step();
    let way = before.world_from_camera().transpose() * (camera(window).eye - before.eye);
    DVec3::new(way.x, camera(window).eye.y - before.eye.y, -way.z)
}

/// Change of yaw and pitch by a held key.
fn turn(window: &mut Window, key: Key) -> [f64; 2] {
    let before = camera(window);
    way(window, key);
    [camera(window).yaw - before.yaw, camera(window).pitch - before.pitch]
}

/// Presses a key, and returns the options before and after.
fn options(window: &mut Window, chord: Chord) -> [Options; 2] {
    let before = state(window).options;
    press(window, chord);
    [before, state(window).options]
}

fn moves(window: &mut Window, action: Action, chord: Chord, index: usize) {
    match action {
        Action::Forward => assert!(way(window, chord.key).z > 0.1),
        Action::Back => assert!(way(window, chord.key).z < -0.1),
        Action::Left => assert!(way(window, chord.key).x < -0.1),
        Action::Right => assert!(way(window, chord.key).x > 0.1),
        Action::Up => assert!(way(window, chord.key).y > 0.1),
        Action::Down => assert!(way(window, chord.key).y < -0.1),
        Action::LookLeft => assert!(turn(window, chord.key)[0] > 0.05),
        Action::LookRight => assert!(turn(window, chord.key)[0] < -0.05),
        Action::LookUp => assert!(turn(window, chord.key)[1] > 0.05),
        Action::LookDown => assert!(turn(window, chord.key)[1] < -0.05),
        Action::GoThere => {
            let before = camera(window);
            press(window, chord);
            arrive(window);
            assert!(camera(window).eye != before.eye);
        }
        Action::ToggleWalk => {
            press(window, chord);
            assert_eq!(state(window).navigation.fly.move_mode(), MoveMode::Walk);
            press(window, chord);
            assert_eq!(state(window).navigation.fly.move_mode(), MoveMode::Fly);
        }
        Action::Focus => {
            let before = camera(window);
            window.hover_at(viewport_centre(window) + vec2(90.0, 40.0));
            window.step();
            press(window, chord);
            arrive(window);
            assert!(camera(window).yaw != before.yaw && camera(window).pitch != before.pitch);
        }
        Action::FrameAll => {
            press(window, chord);
            arrive(window);
            assert!(camera(window).eye.y > 3.0, "above the room");
        }
        _ => changes_view(window, action, chord, index),
    }
}

fn changes_view(window: &mut Window, action: Action, chord: Chord, index: usize) {
    match action {
        Action::NextView | Action::PreviousView => {
            let (count, before) = (state(window).views().len(), state(window).navigation.view_index);
            press(window, chord);
            arrive(window);
            let step = if action == Action::NextView { 1 } else { count - 1 };
            assert_eq!(state(window).navigation.view_index, (before + step) % count);
        }
        Action::GoToView => {
            let view = state(window).views().get(index).map(|v| v.camera);
            press(window, chord);
            arrive(window);
            match view {
                Some(view) => assert_eq!(camera(window), view),
                None => assert!(says(window.state(), &format!("Ctrl+{}", index + 1))),
            }
        }
        Action::SaveView => {
            press(window, chord);
            let key = Some(index as u8 + 1);
            let views = state(window).views();
            let saved = views.iter().find(|v| v.key == key).expect("a view of this key");
            assert_eq!(saved.camera, camera(window));
        }
        Action::Level => {
            press(window, chord);
            arrive(window);
            assert_eq!(camera(window).pitch, 0.0);
        }
        Action::NarrowFov | Action::WidenFov => {
            let before = camera(window).fov_y;
            press(window, chord);
            assert_eq!(camera(window).fov_y > before, action == Action::WidenFov);
        }
        _ => shows(window, action, chord),
    }
}

fn shows(window: &mut Window, action: Action, chord: Chord) {
    match action {
        _ if lighting::chooses(window, action, chord) => {}
        Action::DarkerExposure | Action::BrighterExposure => {
            let before = state(window).exposure_ev();
            press(window, chord);
            let step = if action == Action::BrighterExposure { 0.5 } else { -0.5 };
            assert_eq!(state(window).quality.exposure, Exposure::Stops(before + step));
        }
        Action::ResetExposure => {
            window.key_press(Key::Minus);
            press(window, chord);
            assert_eq!(state(window).quality.exposure, state(window).default_quality.exposure);
        }
        Action::ExposeForView => exposes(window, chord),
        Action::CycleHeatmap => {
            let [before, after] = options(window, chord);
            assert!(before.heatmap != after.heatmap);
        }
        Action::ToggleByReference => {
            let [before, after] = options(window, chord);
            assert!(before.coloring != after.coloring);
        }
        Action::ToggleOutline | Action::ToggleEdges => {
            let [before, after] = options(window, chord);
            assert_eq!(before.has_outline != after.has_outline, action == Action::ToggleOutline);
            assert_eq!(before.has_edges != after.has_edges, action == Action::ToggleEdges);
        }
        Action::TogglePanels => {
            let [before, after] = options(window, chord);
            assert!(before.shows_panels != after.shows_panels);
            press(window, chord);
        }
        Action::ToggleStatistics => {
            let [before, after] = options(window, chord);
            assert!(before.statistics != after.statistics);
        }
        Action::Help => {
            let [before, after] = options(window, chord);
            assert!(!before.shows_help && after.shows_help);
            // A question mark would be typed into the filter.
            window.key_press(Key::F1);
            window.run_steps(2);
            assert!(!state(window).options.shows_help);
        }
        Action::Escape => {
            window.key_press(Key::F1);
            window.run_steps(2);
            press(window, chord);
            assert!(!state(window).options.shows_help);
        }
        Action::FullScreen => {
            window.key_down(chord.key);
            window.step();
            assert!(sends(window, &ViewportCommand::Fullscreen(true)));
            window.key_up(chord.key);
        }
        _ => works(window, action, chord),
    }
}

fn exposes(window: &mut Window, chord: Chord) {
    press(window, chord);
    assert!(state(window).quality.exposure.stops().is_some());
    assert!(says(window.state(), "for this view"));
}

fn works(window: &mut Window, action: Action, chord: Chord) {
    match action {
        Action::Pause => {
            let [before, after] = options(window, chord);
            assert!(!before.is_paused && after.is_paused);
            press(window, chord);
        }
        Action::AddReference => {
            settle(window);
            let before = held(window);
            press(window, chord);
            step_until(window, "one more reference", |app| {
                app.state().references_used_and_held()[1] > before
            });
        }
        Action::ClearCache => {
            press(window, chord);
            assert!(state(window).dialogs.asks_to_clear);
            window.key_press(Key::Escape);
            window.run_steps(2);
            assert!(!state(window).dialogs.asks_to_clear);
        }
        Action::ShowFull => {
            settle(window);
            window.key_down(chord.key);
            step_until(window, "the full tracer's picture", |app| app.state().comparison.full.is_some());
            assert!(state(window).comparison.is_held);
            window.key_up(chord.key);
            window.run_steps(2);
            assert!(!state(window).comparison.is_held);
        }
        Action::CompareSplit | Action::CompareErrors => {
            let wanted = if action == Action::CompareSplit { Compare::Split } else { Compare::Errors };
            press(window, chord);
            assert_eq!(state(window).comparison.shows, wanted);
            press(window, chord);
            assert_eq!(state(window).comparison.shows, Compare::Off);
        }
        Action::Quit => {
            let (key, physical_key, modifiers) = (chord.key, Some(chord.key), Modifiers::COMMAND);
            window.event(egui::Event::Key { key, physical_key, pressed: true, repeat: false, modifiers });
            window.step();
            assert!(sends(window, &ViewportCommand::Close));
        }
        _ => reaches(window, action, chord),
    }
}

fn reaches(window: &mut Window, action: Action, chord: Chord) {
    match action {
        Action::Freeze => {
            let [before, after] = options(window, chord);
            assert!(!before.is_frozen && after.is_frozen && after.is_paused);
            press(window, chord);
            assert!(!state(window).options.is_paused);
        }
        Action::Pick => {
            press(window, chord);
            assert!(state(window).selection.inspection.is_some());
        }
        Action::NextRegion | Action::PreviousRegion => {
            press(window, chord);
            assert!(window.ctx.memory(|memory| memory.focused().is_some()));
            window.key_press(Key::Escape);
            window.run_steps(2);
        }
        _ => asks(window, action, chord),
    }
}

fn goes_back(window: &mut Window, chord: Chord) {
    let before = camera(window);
    window.event(egui::Event::Paste("--eye 0.5,1.2,0.5 --look-at 0,1,1".to_owned()));
    arrive(window);
    press(window, chord);
    arrive(window);
    assert_eq!(camera(window), before);
}

fn is_requested(action: Action, chord: Chord) {
    let modifiers =
        Modifiers { shift: chord.shift, ctrl: chord.ctrl, command: chord.ctrl, ..Modifiers::NONE };
    let (key, physical_key) = (chord.key, Some(chord.key));
    let event = egui::Event::Key { key, physical_key, pressed: true, repeat: false, modifiers };
    let pressed = Keyboard::default().update(&[event], Attention::View);
    assert!(matches!(pressed[..], [Pressed { action: found, .. }] if found == action));
}

fn asks(window: &mut Window, action: Action, chord: Chord) {
    match action {
        Action::Reload => {
            settle(window);
            let newest = window.state().threads().generation();
            press(window, chord);
            step_until(window, "the scene again", |app| {
                app.loading().is_none() && app.threads().generation() > newest
            });
        }
        Action::Screenshot => {
            press(window, chord);
            step_until(window, "a picture", |app| says(app, "saved"));
        }
        Action::CopyPose => {
            window.event(egui::Event::Copy);
            window.step();
            let is_pose = |c: &egui::OutputCommand| matches!(c, egui::OutputCommand::CopyText(t) if t.starts_with("--eye "));
            assert!(window.output().platform_output.commands.iter().any(is_pose));
        }
        Action::PastePose => {
            window.event(egui::Event::Paste("--eye 1,1,1 --look-at 0,1,1".to_owned()));
            arrive(window);
            assert!(camera(window).eye.distance(DVec3::ONE) < 1e-6);
        }
        Action::GoBack => goes_back(window, chord),
        Action::AddPathKey => {
            press(window, chord);
            assert!(state(window).has_own_path());
        }
        Action::PlayPath => {
            press(window, chord);
            assert!(state(window).navigation.playback.is_playing);
            press(window, chord);
            assert!(!state(window).navigation.playback.is_playing);
        }
        // Checks only that the key requests it: a dialog of the desktop would stay open, and the
        // others have tests of their own.
        Action::Open
        | Action::SaveSession
        | Action::ScreenshotWithoutBackground
        | Action::SaveSequence
        | Action::SaveFilm
        | Action::Measure
        | Action::ObjectAway
        | Action::ObjectNearer
        | Action::ObjectLeft
        | Action::ObjectRight
        | Action::ObjectUp
        | Action::ObjectDown
        | Action::HideObject
        | Action::DeleteObject
        | Action::Bake
        | Action::ToggleSection
        | Action::SectionBack
        | Action::SectionForward
        | Action::Undo
        | Action::Redo => is_requested(action, chord),
        moving => panic!("{moving:?} has no check"),
    }
}

#[test]
fn every_key_does_what_the_map_says() {
    let folder = tempfile::tempdir().expect("a folder");
    let picture =
        PictureSettings { size: PictureSize::Pixels([40, 30]), antialias: 2, ..PictureSettings::default() };
    let asked = LaunchOptions { pictures: Some(folder.path().to_owned()), picture, ..request() };
    let mut window = open(asked, false);
    for binding in BINDINGS {
        for (index, chord) in binding.chords.iter().enumerate() {
            moves(&mut window, binding.action, *chord, index);
        }
    }
}

/// The arrow keys chose an entry of an open list, and flew meanwhile.
#[test]
fn an_open_list_keeps_its_keys() {
    let mut window = open(request(), false);
    let before = camera(&window);
    window.get_by_label("Toolbar: mode").click();
    window.run_steps(3);
    for key in [Key::ArrowDown, Key::ArrowUp, Key::W, Key::T] {
        window.key_down(key);
        window.run_steps(4);
        window.key_up(key);
        window.step();
    }
    assert_eq!(camera(&window), before);
    assert_eq!(state(&window).options.heatmap, Default::default());
    window.key_press(Key::Escape);
    window.run_steps(3);
    assert!(way(&mut window, Key::W).z > 0.1, "closed, it leaves the keys to the camera");
    settle(&mut window);
}

#[test]
fn the_chosen_tab_is_kept_in_the_settings() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("settings.toml");
    let mut window = open(LaunchOptions { settings_file: Some(file.clone()), ..request() }, false);
    show_tab(&mut window, "Numbers");
    let is_kept = |_: &App| std::fs::read_to_string(&file).is_ok_and(|text| text == "tab = \"numbers\"\n");
    step_until(&mut window, "the setting", is_kept);
}

#[test]
fn f3_shows_all_figures_then_none_then_few() {
    let mut window = open(request(), false);
    let shows = |window: &Window| ["reused", "rays"].map(|name| window.query_by_label(name).is_some());
    assert_eq!(shows(&window), [true, false]);
    for expected in [[true, true], [false, false], [true, false]] {
        window.key_press(Key::F3);
        window.run_steps(2);
        assert_eq!(shows(&window), expected);
    }
    window.key_press(Key::T);
    window.run_steps(2);
    assert!(window.query_all_by_label_contains("mirror or glass ").next().is_some(), "the legend");
    settle(&mut window);
}

#[test]
fn the_edit_menu_names_the_step_and_the_title_has_a_mark() {
    let mut window = open(request(), false);
    assert!(!state(&window).title().starts_with('*') && state(&window).title().ends_with("Afterimage"));
    editing::click(&mut window, -20.0, 180.0);
    window.get_by_label("Mirror").click_accesskit();
    window.run_steps(2);
    assert!(state(&window).title().starts_with('*'));
    window.get_by_label("Edit").click_accesskit();
    window.run_steps(3);
    assert!(window.query_all_by_label_contains("Undo mirror on ").next().is_some());
    window.key_press(Key::Escape);
    settle(&mut window);
}

#[test]
fn old_errors_vanish_when_something_else_is_opened() {
    let folder = tempfile::tempdir().expect("a folder");
    let broken = folder.path().join("archive.glb");
    std::fs::write(&broken, b"PK\x03\x04 rest").expect("a file");
    let good = folder.path().join("triangle.obj");
    std::fs::write(&good, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("a file");
    let mut window = open(request(), false);
    window.input_mut().dropped_files.push(Arc::new(driving::Dropped(broken)));
    step_until(&mut window, "an error that names the kind of file", |app| says(app, "ZIP archive"));
    window.input_mut().dropped_files.push(Arc::new(driving::Dropped(good)));
    step_until(&mut window, "the other scene", |app| {
        app.state().scene.as_ref().is_some_and(|scene| scene.triangles == 1)
    });
    assert!(!says(window.state(), "ZIP archive"));
    settle(&mut window);
}
