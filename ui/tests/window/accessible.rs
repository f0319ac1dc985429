//! A user of a screen reader finds every control by its name.

use super::*;
use afterimage_ui::window::input::keymap::BINDINGS;
use egui::accesskit::{Action, Role};
use egui::{Key, Modifiers, vec2};
use egui_kittest::kittest::{NodeT, by};

type Window = Harness<'static, App>;

/// Returns the controls without a name, as assistive software would find them.
fn nameless(window: &Window) -> Vec<String> {
    // A scroll bar is announced by its role.
    let others =
        [Role::Window, Role::GenericContainer, Role::Pane, Role::ScrollView, Role::ScrollBar, Role::Label];
    let is_control = move |role| role != Role::Unknown && !others.contains(&role);
    let nodes = window.query_all(by().predicate(move |node| {
        let acts = [Action::Click, Action::Focus].into_iter().any(|a| node.data().supports_action(a));
        acts && is_control(node.role()) && node.label().is_none_or(|name| name.trim().is_empty())
    }));
    nodes
        .map(|node| {
            let node = node.accesskit_node();
            format!("{:?} {:?} at {:?}", node.role(), node.value(), node.bounding_box())
        })
        .collect()
}

/// Returns names that two controls of a role share: a listener cannot tell them apart.
fn shared_names(window: &Window) -> Vec<String> {
    let controls =
        [Role::Button, Role::CheckBox, Role::RadioButton, Role::Slider, Role::ComboBox, Role::TextInput];
    let mut names: Vec<String> = window
        .query_all(by().predicate(move |node| controls.contains(&node.role()) && !node.is_disabled()))
        .filter_map(|node| {
            let node = node.accesskit_node();
            Some(format!("{:?} {}", node.role(), node.label()?))
        })
        .collect();
    names.sort();
    let twice = names.windows(2).filter(|pair| pair[0] == pair[1]).map(|pair| pair[0].clone());
    twice.collect()
}

fn check(window: &Window, what: &str) {
    let found = nameless(window);
    assert!(found.is_empty(), "{what}: controls without a name: {found:#?}");
    let found = shared_names(window);
    assert!(found.is_empty(), "{what}: names that stand for several controls: {found:#?}");
}

/// Shows a tab and opens its sections that are closed at first.
fn open_tab(window: &mut Window, tab: &str) {
    show_tab(window, tab);
    for section in ["Camera path", "Lights", "Features", "Numerical conditioning"] {
        if let Some(header) = window.query_all_by_label(section).next() {
            header.click_accesskit();
        }
        window.run_steps(30);
    }
}

#[test]
fn every_control_has_a_name_of_its_own() {
    let mut window = app();
    // As high as the whole side panel, because parts that are scrolled away are not laid out, and
    // hardly wider.
    window.set_size(vec2(420.0, 4000.0));
    window.run_steps(3);
    editing::click(&mut window, 0.0, 180.0);
    window.key_press(Key::C);
    window.key_press(Key::M);
    window.key_press(Key::K);
    window.run_steps(3);
    for tab in ["Camera", "Method", "Numbers", "Look", "Scene"] {
        open_tab(&mut window, tab);
        check(&window, tab);
    }
    for kind in ["Mirror", "Glass"] {
        window.get_by_role_and_label(Role::RadioButton, kind).click_accesskit();
        window.run_steps(3);
        check(&window, kind);
    }
    show_tab(&mut window, "Look");
    window.get_by_label("By place and time").click_accesskit();
    window.run_steps(3);
    check(&window, "sun by place and time");
}

#[test]
fn every_dialog_and_menu_has_names() {
    let mut window = app();
    for menu in ["File", "Edit", "View", "Camera", "Method"] {
        let button = window.query_all_by_role_and_label(Role::Button, menu).next().expect("a menu");
        button.click_accesskit();
        window.run_steps(3);
        check(&window, menu);
        window.key_press(Key::Escape);
        window.run_steps(3);
    }
    window.get_by_role_and_label(Role::Button, "Settings").click_accesskit();
    window.run_steps(3);
    check(&window, "settings");
    window.key_press(Key::Escape);
    window.key_press(Key::F1);
    window.run_steps(3);
    check(&window, "help");
    window.key_press(Key::Escape);
    window.run_steps(3);
    window.key_press_modifiers(Modifiers::SHIFT, Key::Delete);
    window.run_steps(3);
    check(&window, "a question");
}

#[test]
fn every_command_of_the_key_map_is_found_by_its_words() {
    let mut window = app();
    window.key_press(Key::F1);
    window.run_steps(3);
    for binding in BINDINGS {
        assert!(window.query_all_by_label(binding.help).next().is_some(), "no line for {:?}", binding.action);
        let keys = binding.keys();
        assert!(window.query_all_by_label(&keys).next().is_some(), "no keys for {:?}", binding.action);
    }
}
