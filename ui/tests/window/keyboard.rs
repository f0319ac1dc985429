//! Everything by keyboard alone: numbers that are typed, the focus and its regions, the help, and
//! the camera.

use super::*;
use afterimage::raster::exposure::Exposure;
use afterimage_ui::window::input::keymap::{BINDINGS, MOUSE};
use afterimage_ui::window::panels::side::TABS;
use afterimage_ui::window::state::{AppState, Work};
use egui::accesskit::Role;
use egui::{Key, Modifiers};
use egui_kittest::kittest::NodeT;

type Window = Harness<'static, App>;

fn state(window: &Window) -> &AppState {
    window.state().state()
}

fn press(window: &mut Window, modifiers: Modifiers, key: Key) {
    window.key_press_modifiers(modifiers, key);
    window.run_steps(3);
}

fn type_text(window: &mut Window, text: &str) {
    window.event(egui::Event::Text(text.to_owned()));
    window.run_steps(2);
}

/// Role and name of what has the focus.
fn focused(window: &Window) -> (Role, String) {
    let node = window.query_all_by(|node| node.is_focused()).next().expect("something has the focus");
    let node = node.accesskit_node();
    (node.role(), node.label().or_else(|| node.value()).unwrap_or_default())
}

/// Types into the number field of a name.
fn type_into(window: &mut Window, name: &str, text: &str) {
    window.get_by_role_and_label(Role::SpinButton, name).click();
    window.run_steps(2);
    type_text(window, text);
}

/// Escape stored the typed number.
#[test]
fn escape_drops_a_typed_number_and_enter_tab_and_a_click_elsewhere_store_it() {
    let mut window = app();
    show_tab(&mut window, "Look");
    let exposure = |window: &Window| state(window).quality.exposure;
    let before = exposure(&window);
    type_into(&mut window, "Exposure", "2.5");
    press(&mut window, Modifiers::NONE, Key::Escape);
    window.run_steps(3);
    assert_eq!(exposure(&window), before);
    type_into(&mut window, "Exposure", "2.5");
    press(&mut window, Modifiers::NONE, Key::Enter);
    assert_eq!(exposure(&window), Exposure::Stops(2.5));
    type_into(&mut window, "Exposure", "1.5");
    press(&mut window, Modifiers::NONE, Key::Tab);
    assert_eq!(exposure(&window), Exposure::Stops(1.5));
    press(&mut window, Modifiers::NONE, Key::Escape);
    type_into(&mut window, "Exposure", "-1.0");
    editing::click(&mut window, 0.0, 0.0);
    window.run_steps(3);
    assert_eq!(exposure(&window), Exposure::Stops(-1.0));
    type_into(&mut window, "Exposure", "3.0");
    press(&mut window, Modifiers::NONE, Key::Escape);
    window.run_steps(3);
    assert_eq!(exposure(&window), Exposure::Stops(-1.0));
    settle(&mut window);
}

#[test]
fn escape_drops_what_is_typed_in_a_dialog_and_leaves_it_open() {
    let mut window = app();
    window.get_by_role_and_label(Role::Button, "File").click_accesskit();
    window.run_steps(3);
    window.get_by_label_contains("Picture settings").click_accesskit();
    window.run_steps(3);
    for name in ["Samples", "Anti-aliasing"] {
        let before = state(&window).picture.settings.clone();
        type_into(&mut window, name, "77");
        press(&mut window, Modifiers::NONE, Key::Escape);
        window.run_steps(2);
        assert!(state(&window).picture.settings == before && state(&window).picture.is_open, "{name}");
        type_into(&mut window, name, "78");
        press(&mut window, Modifiers::NONE, Key::Enter);
    }
    let now = &state(&window).picture.settings;
    assert_eq!((now.samples, now.antialias), (Some(78), 78));
    press(&mut window, Modifiers::NONE, Key::Escape);
    assert!(!state(&window).picture.is_open, "without a field, Escape closes the dialog");
}

#[test]
fn escape_drops_a_typed_time_of_day() {
    let mut window = app();
    show_tab(&mut window, "Look");
    window.get_by_label("By place and time").click_accesskit();
    window.run_steps(3);
    let hours =
        |window: &Window| state(window).document.as_ref().map_or(0.0, |open| open.now().sun.place.hours);
    let before = hours(&window);
    for (name, text) in [("Time", "18:31"), ("Time zone", "Asia/Tokyo")] {
        let role = if name == "Time" { Role::SpinButton } else { Role::TextInput };
        window.get_by_role_and_label(role, name).click();
        window.run_steps(2);
        type_text(&mut window, text);
        press(&mut window, Modifiers::NONE, Key::Escape);
        window.run_steps(2);
    }
    assert_eq!(hours(&window), before);
    assert!(state(&window).document.as_ref().is_some_and(|open| open.now().sun.place.zone != "Asia/Tokyo"));
    type_into(&mut window, "Time", "18:31");
    press(&mut window, Modifiers::NONE, Key::Enter);
    assert_eq!(hours(&window), 18.0 + 31.0 / 60.0);
    settle(&mut window);
}

#[test]
fn arrows_turn_the_camera_and_letters_move_it() {
    let mut window = app();
    for (key, right, up) in [
        (Key::ArrowRight, 1.0, 0.0),
        (Key::ArrowLeft, -1.0, 0.0),
        (Key::ArrowUp, 0.0, 1.0),
        (Key::ArrowDown, 0.0, -1.0),
    ] {
        let before = camera(&window);
        window.key_down(key);
        window.run_steps(6);
        window.key_up(key);
        window.step();
        let after = camera(&window);
        assert_eq!(after.eye, before.eye);
        // To the right is clockwise, seen from above.
        let turned = [before.yaw - after.yaw, after.pitch - before.pitch];
        assert!((turned[0] * right) >= 0.0 && (turned[1] * up) >= 0.0, "{key:?}: {turned:?}");
        assert!(turned[0].abs().max(turned[1].abs()) > 0.05, "{key:?}: {turned:?}");
        assert!(turned[0].abs().min(turned[1].abs()) < 1e-12, "{key:?}: {turned:?}");
    }
    settle(&mut window);
}

#[test]
fn a_control_with_the_focus_has_the_arrows_and_the_viewport_has_them_back() {
    let mut window = app();
    show_tab(&mut window, "Look");
    window.get_by_role_and_label(Role::Slider, "Exposure").focus();
    window.run_steps(2);
    let (before, ev) = (camera(&window), state(&window).exposure_ev());
    press(&mut window, Modifiers::NONE, Key::ArrowRight);
    assert_eq!(camera(&window), before);
    assert!(state(&window).exposure_ev() != ev, "the slider moved");
    window.get_by_label("3D viewport").focus();
    window.run_steps(2);
    for _ in 0..2 {
        press(&mut window, Modifiers::NONE, Key::ArrowRight);
    }
    assert!(camera(&window).yaw != before.yaw, "the viewport turned");
    assert_eq!(focused(&window).1, "3D viewport");
    settle(&mut window);
}

#[test]
fn f6_visits_all_regions_in_order_and_back() {
    let mut window = app();
    window.key_press(Key::T);
    window.run_steps(3);
    let expected = [
        (Role::Tab, "Scene"),
        (Role::DisclosureTriangle, "Scene"),
        (Role::Status, "Figures: "),
        (Role::Legend, "Legend: "),
        (Role::Button, "File"),
        (Role::Button, "Toolbar: heatmap"),
        (Role::Image, "3D viewport"),
    ];
    for (role, name) in expected {
        press(&mut window, Modifiers::NONE, Key::F6);
        let (found_role, found) = focused(&window);
        assert!(found_role == role && found.starts_with(name), "{found_role:?} {found}, not {role:?} {name}");
    }
    for (role, name) in expected.iter().rev().skip(1).chain([&expected[6]]) {
        press(&mut window, Modifiers::SHIFT, Key::F6);
        let (found_role, found) = focused(&window);
        assert!(found_role == *role && found.starts_with(name), "{found_role:?} {found} on the way back");
    }
    settle(&mut window);
}

#[test]
fn f6_leaves_a_text_field_and_reaches_messages_and_dialogs() {
    let mut window = app();
    window.get_by_role_and_label(Role::TextInput, "Model file").focus();
    window.run_steps(2);
    press(&mut window, Modifiers::NONE, Key::F6);
    assert_eq!(focused(&window).0, Role::Status, "after the side panel");
    window.get_by_role_and_label(Role::Button, "Settings").click();
    window.run_steps(3);
    window.event(egui::Event::Paste("nothing like a pose".to_owned()));
    window.run_steps(3);
    let mut visited = Vec::new();
    for _ in 0..8 {
        press(&mut window, Modifiers::NONE, Key::F6);
        visited.push(focused(&window).1);
    }
    for name in ["Dismiss", "File", "3D viewport"] {
        assert!(visited.iter().any(|found| found.starts_with(name)), "{name} is not in {visited:?}");
    }
    settle(&mut window);
}

#[test]
fn regions_have_names_roles_and_an_order() {
    let mut window = app();
    window.key_press(Key::T);
    window.run_steps(3);
    let regions = [
        (Role::MenuBar, "Menu bar"),
        (Role::Toolbar, "Toolbar"),
        (Role::TabList, "Tabs"),
        (Role::TabPanel, "Side panel"),
        (Role::Image, "3D viewport"),
        (Role::Status, "Figures: "),
        (Role::Legend, "Legend: "),
    ];
    let is_region = |role: Role| regions.iter().any(|(known, _)| *known == role);
    let nodes = window.query_all(egui_kittest::kittest::by().predicate(move |node| {
        let roles = [
            Role::MenuBar,
            Role::Toolbar,
            Role::TabList,
            Role::TabPanel,
            Role::Image,
            Role::Status,
            Role::Legend,
        ];
        roles.contains(&node.role()) && node.label().is_some()
    }));
    let found: Vec<(Role, String)> = nodes
        .map(|node| (node.accesskit_node().role(), node.accesskit_node().label().unwrap_or_default()))
        .filter(|(role, name)| is_region(*role) && name != "Plan map")
        .collect();
    assert_eq!(found.len(), regions.len(), "{found:?}");
    for ((role, name), (found_role, found)) in regions.iter().zip(&found) {
        assert!(role == found_role && found.starts_with(name), "{found_role:?} {found}, not {role:?} {name}");
    }
    settle(&mut window);
}

#[test]
fn tabs_are_reached_chosen_and_read_by_keyboard() {
    let mut window = app();
    press(&mut window, Modifiers::NONE, Key::F6);
    assert_eq!(focused(&window), (Role::Tab, "Scene".to_owned()));
    for (tab, title, _) in TABS.iter().skip(1) {
        press(&mut window, Modifiers::NONE, Key::ArrowRight);
        assert_eq!(focused(&window), (Role::Tab, (*title).to_owned()));
        press(&mut window, Modifiers::NONE, Key::Enter);
        assert_eq!(state(&window).appearance.tab, *tab);
        let names: Vec<String> = window
            .query_all_by_role(Role::Tab)
            .map(|node| node.accesskit_node().label().unwrap_or_default())
            .collect();
        assert_eq!(names, TABS.map(|(_, title, _)| title));
        let chosen = window.get_by_role_and_label(Role::Tab, title);
        assert_eq!(chosen.accesskit_node().toggled(), Some(egui::accesskit::Toggled::True), "{title}");
    }
    assert_eq!(camera(&window), camera(&app()), "the arrows did not turn the camera");
}

#[test]
fn headers_open_and_close_with_enter_and_space() {
    let mut window = app();
    show_tab(&mut window, "Camera");
    let is_open = |window: &Window| window.query_by_label("Record path").is_some();
    let shown = ["Camera path"];
    for name in shown {
        window.get_by_role_and_label(Role::DisclosureTriangle, name).focus();
        window.run_steps(2);
        let before = is_open(&window);
        for key in [Key::Enter, Key::Space] {
            press(&mut window, Modifiers::NONE, key);
            window.run_steps(30);
            assert_eq!(is_open(&window), before ^ (key == Key::Enter), "{key:?}");
        }
    }
    assert!(!state(&window).navigation.playback.is_playing, "the space bar opened a header only");
}

#[test]
fn a_control_that_gets_the_focus_is_scrolled_into_view() {
    let mut window = app();
    show_tab(&mut window, "Method");
    press(&mut window, Modifiers::NONE, Key::F6);
    press(&mut window, Modifiers::NONE, Key::F6);
    for _ in 0..80 {
        press(&mut window, Modifiers::NONE, Key::Tab);
        let (role, name) = focused(&window);
        if (role, name.as_str()) == (Role::DisclosureTriangle, "References") {
            window.run_steps(60);
            let rect = window.get_by_role_and_label(Role::DisclosureTriangle, "References").rect();
            assert!(rect.bottom() < 600.0, "{rect}");
            return;
        }
    }
    panic!("Tab does not come to the last section");
}

#[test]
fn the_focus_has_a_ring_once_a_key_moves_it() {
    let Some(mut window) = app_with_graphics() else { return };
    let ring = |window: &mut Window| {
        let rect = window.get_by_role_and_label(Role::DisclosureTriangle, "Scene").rect().expand(4.0);
        let image = window.render().expect("a picture of the window");
        let dark = egui::Visuals::dark().selection.stroke.color.to_array();
        let light = egui::Visuals::light().selection.stroke.color.to_array();
        let pixels = (rect.top() as u32..rect.bottom() as u32)
            .flat_map(|y| (rect.left() as u32..rect.right() as u32).map(move |x| (x, y)));
        pixels.filter(|(x, y)| [dark, light].contains(&image.get_pixel(*x, *y).0)).count()
    };
    assert_eq!(ring(&mut window), 0);
    for _ in 0..2 {
        press(&mut window, Modifiers::NONE, Key::F6);
    }
    assert!(ring(&mut window) > 300, "{}", ring(&mut window));
    let centre = viewport_centre(&window);
    window.hover_at(centre);
    window.step();
    window.drag_at(centre);
    window.step();
    window.drop_at(centre);
    window.run_steps(2);
    assert_eq!(ring(&mut window), 0, "the pointer needs no ring");
    settle(&mut window);
}

#[test]
fn the_help_is_filtered_as_soon_as_it_opens() {
    let mut window = app();
    press(&mut window, Modifiers::NONE, Key::F1);
    assert_eq!(focused(&window), (Role::TextInput, "Filter".to_owned()));
    let lines = |window: &Window| {
        let texts = BINDINGS.iter().map(|b| b.help).chain(MOUSE.iter().map(|line| line.1));
        texts.filter(|text| window.query_all_by_label(text).next().is_some()).count()
    };
    assert!(lines(&window) > BINDINGS.len());
    let before = camera(&window);
    type_text(&mut window, "HorIZon");
    press(&mut window, Modifiers::NONE, Key::W);
    assert_eq!(lines(&window), 1);
    assert!(window.query_by_label("level the horizon").is_some() && window.query_by_label("J").is_some());
    type_text(&mut window, "!?");
    assert_eq!(lines(&window), 0);
    assert!(window.query_all_by_label_contains("No key and no word").next().is_some());
    assert_eq!(camera(&window), before);
    press(&mut window, Modifiers::NONE, Key::F1);
    assert!(!state(&window).options.shows_help, "F1 closes it while a filter is typed");
    press(&mut window, Modifiers::SHIFT, Key::Slash);
    assert!(lines(&window) > BINDINGS.len(), "the filter is empty again");
    press(&mut window, Modifiers::NONE, Key::Escape);
    assert!(!state(&window).options.shows_help);
}

#[test]
fn enter_clicks_in_the_middle_and_measures_without_a_mouse() {
    let mut window = app();
    press(&mut window, Modifiers::NONE, Key::Enter);
    let found = state(&window).selection.inspection.as_ref().expect("a surface in the middle").position_m;
    press(&mut window, Modifiers::NONE, Key::M);
    press(&mut window, Modifiers::NONE, Key::Enter);
    for _ in 0..3 {
        press(&mut window, Modifiers::NONE, Key::ArrowRight);
    }
    press(&mut window, Modifiers::NONE, Key::Enter);
    let measures = &state(&window).document.as_ref().expect("a scene").now().measures;
    assert_eq!(measures.len(), 1);
    press(&mut window, Modifiers::NONE, Key::M);
    let before = camera(&window).eye.distance(found);
    press(&mut window, Modifiers::SHIFT, Key::Enter);
    step_until(&mut window, "the way there", |app| !app.state().navigation.fly.is_easing());
    assert!(camera(&window).eye.distance(found) < before);
    settle(&mut window);
}

#[test]
fn moving_ends_a_pause_and_a_frozen_frame_stays() {
    let mut window = app();
    press(&mut window, Modifiers::NONE, Key::P);
    assert!(window.query_by_label("Paused").is_some() && state(&window).options.is_paused);
    press(&mut window, Modifiers::NONE, Key::ArrowRight);
    assert!(!state(&window).options.is_paused && says(window.state(), "the camera has moved"));
    settle(&mut window);
    press(&mut window, Modifiers::SHIFT, Key::P);
    assert!(window.query_by_label("Frozen").is_some());
    let rendered = window.state().threads().frames_rendered();
    for key in [Key::ArrowRight, Key::W] {
        press(&mut window, Modifiers::NONE, key);
    }
    assert!(state(&window).options.is_paused);
    assert_eq!(window.state().threads().frames_rendered(), rendered);
    press(&mut window, Modifiers::NONE, Key::P);
    assert!(!state(&window).options.is_paused && !state(&window).options.is_frozen);
    settle(&mut window);
}

#[test]
fn a_pause_stops_a_change_of_view_which_would_end_it() {
    let mut window = app();
    window.key_press(Key::L);
    window.run_steps(3);
    assert!(state(&window).navigation.fly.is_easing());
    press(&mut window, Modifiers::NONE, Key::P);
    window.run_steps(30);
    assert!(state(&window).options.is_paused && !state(&window).navigation.fly.is_easing());
    press(&mut window, Modifiers::NONE, Key::P);
    settle(&mut window);
}

#[test]
fn a_picture_goes_on_improving_until_the_camera_moves_where_that_is_wanted() {
    const PLANNED: u32 = 16;
    let mut asked = request();
    asked.settings.render.mode = Mode::Full;
    let mut window = open(asked, false);
    // As high as the section, because parts that are scrolled away are not laid out.
    window.set_size(egui::vec2(420.0, 1400.0));
    step_until(&mut window, "the last pass", |app| app.state().work == Work::Converged);
    show_tab(&mut window, "Method");
    window.get_by_role_and_label(Role::CheckBox, "Go on").click_accesskit();
    step_until(&mut window, "more passes", |app| app.state().work_text().starts_with("improving, pass "));
    assert!(state(&window).is_unsaved(), "it is a setting of the session");
    let before = camera(&window);
    window.key_down(Key::ArrowRight);
    window.run_steps(3);
    window.key_up(Key::ArrowRight);
    window.step();
    assert!(camera(&window) != before);
    let (now, passes) = (camera(&window), |app: &App| {
        app.state().frame.as_ref().map_or((before, 0), |frame| (frame.camera, frame.stats.refined.pass))
    });
    step_until(&mut window, "more passes of the other view", |app| {
        let (camera, pass) = passes(app);
        camera == now && pass > PLANNED
    });
    window.get_by_role_and_label(Role::CheckBox, "Go on").click_accesskit();
    step_until(&mut window, "an end", |app| app.state().work == Work::Converged);
}
