//! Walking, going to surfaces, saved views, the camera path.

use super::*;
use afterimage::camera::CameraPath;
use afterimage_ui::window::input::fly_camera::{MoveMode, ViewChange};
use egui::{Key, Modifiers, vec2};

/// Steps until an eased change of view is over.
fn arrive(harness: &mut Harness<'static, App>) {
    harness.step();
    for _ in 0..120 {
        if !harness.state().state().navigation.fly.is_easing() {
            return;
        }
        harness.step();
    }
    panic!("the camera never arrives");
}

fn ctrl(harness: &mut Harness<'static, App>, key: Key) {
    harness.key_press_modifiers(Modifiers::COMMAND, key);
    harness.step();
}

#[test]
fn g_walks_on_the_floor_and_a_wall_stops() {
    let mut harness = app();
    harness.key_press(Key::E);
    harness.key_press(Key::G);
    arrive(&mut harness);
    assert_eq!(harness.state().state().navigation.fly.move_mode(), MoveMode::Walk);
    assert!(harness.query_all_by_label("walking").count() >= 1, "the figures say so");
    assert!((camera(&harness).eye.y - 1.6).abs() < 1e-3, "{:?}", camera(&harness));
    harness.key_down(Key::S);
    harness.run_steps(120);
    harness.key_up(Key::S);
    harness.step();
    let eye = camera(&harness).eye;
    assert!((2.5..3.0).contains(&eye.z) && (eye.y - 1.6).abs() < 1e-3, "the wall stands at 3 m: {eye}");
    harness.key_press(Key::G);
    harness.step();
    assert_eq!(harness.state().state().navigation.fly.move_mode(), MoveMode::Fly);
}

#[test]
fn home_shows_the_whole_model() {
    let mut harness = app();
    harness.key_press(Key::Home);
    arrive(&mut harness);
    let eye = camera(&harness).eye;
    assert!(eye.y > 3.0 && eye.length() > 6.0, "outside and above: {eye}");
}

#[test]
fn f_looks_at_what_is_under_the_cursor() {
    let mut harness = app();
    let before = camera(&harness);
    harness.hover_at(viewport_centre(&harness) + vec2(120.0, 0.0));
    harness.step();
    harness.key_press(Key::F);
    arrive(&mut harness);
    assert!(camera(&harness).yaw < before.yaw, "turned to the right");
}

#[test]
fn a_double_click_goes_to_the_floor() {
    let mut harness = app();
    let at = viewport_centre(&harness) + vec2(-60.0, 200.0);
    harness.hover_at(at);
    harness.step();
    for _ in 0..2 {
        harness.drag_at(at);
        harness.step();
        harness.drop_at(at);
        harness.step();
    }
    arrive(&mut harness);
    let (eye, start) = (camera(&harness).eye, *small_room().start());
    assert!((eye.y - 1.6).abs() < 1e-6 && eye.distance(start.eye) > 0.3, "{eye}");
}

#[test]
fn a_view_is_saved_under_a_number_renamed_and_deleted() {
    let mut harness = app();
    harness.key_down(Key::D);
    harness.run_steps(20);
    harness.key_up(Key::D);
    harness.step();
    let here = camera(&harness);
    ctrl(&mut harness, Key::Num7);
    harness.key_press(Key::Num1);
    arrive(&mut harness);
    assert!(camera(&harness) != here);
    harness.key_press(Key::Num7);
    arrive(&mut harness);
    assert_eq!(camera(&harness), here);
    show_tab(&mut harness, "Camera");
    harness.get_by_label("Rename view 7").scroll_to_me();
    harness.run_steps(2);
    harness.get_by_label("Rename view 7").click();
    harness.run_steps(3);
    harness.get_by_label("Name of the view").type_text("the lamp");
    harness.step();
    harness.key_press(Key::Enter);
    harness.run_steps(3);
    let names = |harness: &Harness<'static, App>| -> Vec<String> {
        harness.state().state().views().iter().map(|v| v.name.clone()).collect()
    };
    assert_eq!(names(&harness).last().map(String::as_str), Some("the lamp"));
    harness.get_by_label("Delete the lamp").click();
    harness.run_steps(2);
    assert_eq!(names(&harness).len(), 3);
}

#[test]
fn a_number_without_a_view_says_how_to_save_one() {
    let mut harness = app();
    harness.key_press(Key::Num8);
    harness.run_steps(2);
    assert!(harness.state().state().notices[0].text.contains("Ctrl+8"));
}

#[test]
fn ctrl_v_takes_a_pose() {
    let mut harness = app();
    harness.event(egui::Event::Paste("render --eye 1,1.5,2 --look-at 0,1.5,2 --fov-y 50".to_owned()));
    arrive(&mut harness);
    let c = camera(&harness);
    assert!((c.eye - glam::DVec3::new(1.0, 1.5, 2.0)).length() < 1e-9 && c.forward().x < -0.999);
    harness.event(egui::Event::Paste("a shopping list".to_owned()));
    harness.run_steps(2);
    assert!(says(harness.state(), "no --eye"));
}

#[test]
fn j_levels_and_brackets_change_the_field_of_view() {
    let mut harness = app();
    assert!(camera(&harness).pitch != 0.0);
    harness.key_press(Key::J);
    arrive(&mut harness);
    assert_eq!(camera(&harness).pitch, 0.0);
    let fov = camera(&harness).fov_y;
    harness.key_press(Key::CloseBracket);
    harness.step();
    assert!(camera(&harness).fov_y > fov);
    harness.key_press(Key::OpenBracket);
    harness.key_press(Key::OpenBracket);
    harness.step();
    assert!(camera(&harness).fov_y < fov);
}

#[test]
fn k_sets_keys_and_space_plays_them() {
    let mut harness = app();
    let start = camera(&harness);
    harness.key_press(Key::K);
    harness.key_press(Key::Num2);
    arrive(&mut harness);
    let end = camera(&harness);
    harness.key_press(Key::K);
    harness.step();
    assert_eq!(harness.state().state().path().keyframes.len(), 2);
    harness.key_press(Key::Space);
    harness.run_steps(3);
    assert!(harness.state().state().navigation.playback.is_playing);
    assert!(camera(&harness).eye.distance(start.eye) < 0.3, "from its first key");
    harness.key_press(Key::Space);
    harness.step();
    assert!(!harness.state().state().navigation.playback.is_playing);
    harness.key_press(Key::Space);
    for _ in 0..2000 {
        harness.step();
        if !harness.state().state().navigation.playback.is_playing {
            break;
        }
    }
    assert!(camera(&harness).eye.distance(end.eye) < 1e-6, "to its last");
}

#[test]
fn a_recorded_walk_is_a_file_that_the_tour_reads() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = app_saving_to(folder.path().to_owned());
    let press = |harness: &mut Harness<'static, App>, label: &str| {
        harness.get_by_label_contains(label).scroll_to_me();
        harness.run_steps(3);
        harness.get_by_label_contains(label).click();
        harness.run_steps(2);
    };
    show_tab(&mut harness, "Camera");
    press(&mut harness, "Camera path");
    harness.run_steps(20);
    press(&mut harness, "Record path");
    harness.key_down(Key::A);
    harness.run_steps(60);
    harness.key_up(Key::A);
    let end = camera(&harness);
    press(&mut harness, "Stop and save path");
    step_until(&mut harness, "a message", |app| says(app, "saved"));
    let text = std::fs::read_to_string(folder.path().join("afterimage-room-walk-0001.json")).expect("a file");
    let walk: CameraPath = serde_json::from_str(&text).expect("a walk");
    assert!(walk.keyframes.len() > 5 && walk.frames > 20);
    let last = walk.camera(walk.frames - 1, walk.frames).expect("its end");
    assert!(last.eye.distance(end.eye) < 0.3, "{last:?} {end:?}");
}

#[test]
fn without_motion_views_change_at_once() {
    let mut harness = app();
    show_tab(&mut harness, "Camera");
    let label = "Reduce motion";
    harness.get_by_label(label).scroll_to_me();
    harness.run_steps(3);
    harness.get_by_label(label).click();
    harness.run_steps(2);
    assert_eq!(harness.state().state().options.view_change, ViewChange::AtOnce);
    harness.key_press(Key::Num3);
    harness.step();
    let views = harness.state().state().views();
    assert_eq!(camera(&harness), views[2].camera);
}

#[test]
fn a_path_plays_while_its_section_is_open() {
    let mut harness = app();
    harness.key_press(Key::K);
    harness.key_press(Key::Num2);
    arrive(&mut harness);
    harness.key_press(Key::K);
    harness.step();
    show_tab(&mut harness, "Camera");
    harness.get_by_label_contains("Camera path").scroll_to_me();
    harness.run_steps(3);
    harness.get_by_label_contains("Camera path").click();
    harness.run_steps(20);
    harness.get_by_label("Play path").click_accesskit();
    harness.run_steps(8);
    let playback = harness.state().state().navigation.playback;
    assert!(playback.is_playing, "the timeline has not stopped it: {playback:?}");
    harness.get_by_label("Pause path");
}

#[test]
fn each_key_of_a_path_has_a_row_and_the_time_between_keys_is_set() {
    let mut harness = app();
    show_tab(&mut harness, "Camera");
    let start = camera(&harness);
    harness.key_press(Key::K);
    harness.key_press(Key::Num2);
    arrive(&mut harness);
    harness.key_press(Key::K);
    harness.run_steps(2);
    harness.set_size(vec2(900.0, 4000.0));
    harness.run_steps(3);
    harness.get_by_label("Camera path").click_accesskit();
    harness.run_steps(20);
    harness.get_by_label("Go to path key 1").click_accesskit();
    harness.run_steps(2);
    arrive(&mut harness);
    assert!(camera(&harness).eye.distance(start.eye) < 1e-6);
    harness.key_press(Key::Num3);
    arrive(&mut harness);
    let secs = |harness: &Harness<'static, App>| {
        afterimage_ui::window::input::playback::path_secs(harness.state().state().path())
    };
    let before = secs(&harness);
    harness.get_by_label("Update path key 1").click_accesskit();
    harness.run_steps(3);
    let moved = harness.state().state().path().keyframes[0].eye;
    assert!(moved.distance(camera(&harness).eye) < 1e-9, "{moved}");
    assert_eq!(secs(&harness), before, "the path takes as long as before");
    harness.get_by_label("Seconds from path key 1 to the next").click();
    harness.run_steps(2);
    harness.event(egui::Event::Text("12.5".to_owned()));
    harness.run_steps(2);
    assert_eq!(secs(&harness), before, "typing is not finished");
    harness.key_press(Key::Enter);
    harness.run_steps(3);
    assert_eq!(harness.state().state().path().keyframes[0].secs, Some(12.5));
    assert!((secs(&harness) - 12.5).abs() < 0.02 && harness.state().state().is_unsaved());
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    harness.run_steps(2);
    assert_eq!(secs(&harness), before, "one step");
    harness.get_by_label("Delete path key 2").click_accesskit();
    harness.run_steps(3);
    assert_eq!(harness.state().state().path().keyframes.len(), 1);
}

#[test]
fn views_get_the_next_free_number_and_move_here() {
    let mut harness = app();
    show_tab(&mut harness, "Camera");
    let views = |harness: &Harness<'static, App>| harness.state().state().views().to_vec();
    let saved = views(&harness).len();
    harness.get_by_label("Save this view").click_accesskit();
    harness.run_steps(2);
    let (all, here) = (views(&harness), camera(&harness));
    let added = all.last().expect("a view").clone();
    let taken: Vec<u8> = all[..saved].iter().filter_map(|v| v.key).collect();
    let free = (1..=9).find(|key| !taken.contains(key));
    assert_eq!((added.key, added.camera), (free, here));
    harness.key_press(Key::Num1);
    arrive(&mut harness);
    harness.key_down(Key::D);
    harness.run_steps(10);
    harness.key_up(Key::D);
    harness.step();
    harness.get_by_label(&format!("Update {}", added.name)).click_accesskit();
    harness.run_steps(2);
    assert_eq!(views(&harness).last().expect("a view").camera, camera(&harness));
}

#[test]
fn backspace_goes_back_to_where_the_camera_was() {
    let mut harness = app();
    let first = camera(&harness);
    harness.key_press(Key::Num2);
    arrive(&mut harness);
    let second = camera(&harness);
    assert!(second != first);
    harness.key_press(Key::Home);
    arrive(&mut harness);
    for pose in [second, first] {
        harness.key_press(Key::Backspace);
        arrive(&mut harness);
        assert_eq!(camera(&harness), pose);
    }
    harness.key_press(Key::Backspace);
    harness.run_steps(2);
    assert!(says(harness.state(), "no earlier position"));
}

#[test]
fn a_double_click_renames_a_view_with_its_name_selected() {
    let mut harness = app();
    show_tab(&mut harness, "Camera");
    let name = harness.state().state().views()[0].name.clone();
    let button = |harness: &Harness<'static, App>| {
        let wanted = format!("1  {name}");
        harness.query_all_by_label(&wanted).next().map(|node| node.rect().center())
    };
    harness.get_by_label(&format!("Rename {name}")).scroll_to_me();
    harness.run_steps(30);
    let at = button(&harness).expect("the name is a button");
    harness.hover_at(at);
    harness.step();
    for _ in 0..2 {
        harness.drag_at(at);
        harness.step();
        harness.drop_at(at);
        harness.step();
    }
    harness.run_steps(3);
    harness.get_by_label("Name of the view").type_text("hall");
    harness.step();
    harness.key_press(Key::Enter);
    harness.run_steps(3);
    assert_eq!(harness.state().state().views()[0].name, "hall", "the old name was replaced");
}
