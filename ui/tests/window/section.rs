//! The section and the lines along edges: by key, by the panel, with undo.

use super::{app, open, request, says, settle, show_tab, step_until};
use afterimage::Mode;
use afterimage_ui::window::state::SectionView;
use afterimage_ui::window::{App, LaunchOptions};
use egui::{Key, Modifiers};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

fn section(app: &App) -> Option<SectionView> {
    app.state().document.as_ref().expect("a scene").now().section
}

/// The app in a mode that shows sections.
fn exact() -> Harness<'static, App> {
    let mut launch: LaunchOptions = request();
    launch.settings.render.mode = Mode::Exact;
    open(launch, false)
}

fn radiance(harness: &Harness<'static, App>) -> Vec<u32> {
    harness.state().state().frame.as_ref().expect("a frame").radiance.clone()
}

fn press(harness: &mut Harness<'static, App>, modifiers: Modifiers, key: Key) {
    harness.key_press_modifiers(modifiers, key);
    harness.run_steps(2);
    settle(harness);
}

#[test]
fn the_section_is_switched_and_moved_by_keys_and_undone() {
    let mut harness = exact();
    let whole = radiance(&harness);
    press(&mut harness, Modifiers::NONE, Key::Period);
    assert!(says(harness.state(), "there is no section to move"));
    press(&mut harness, Modifiers::NONE, Key::O);
    let first = section(harness.state()).expect("a section");
    assert!(first.is_on);
    let cut = radiance(&harness);
    assert_ne!(cut, whole, "the picture shows the section");
    press(&mut harness, Modifiers::NONE, Key::Period);
    let moved = section(harness.state()).expect("a section");
    assert!((moved.plane.at_m - first.plane.at_m - 0.1).abs() < 1e-9);
    press(&mut harness, Modifiers::NONE, Key::Comma);
    assert_eq!(section(harness.state()).expect("a section").plane.at_m, moved.plane.at_m - 0.1);
    press(&mut harness, Modifiers::NONE, Key::O);
    assert!(!section(harness.state()).expect("a section").is_on);
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert!(section(harness.state()).expect("a section").is_on, "undo shows it again");
    assert!(
        harness
            .state()
            .state()
            .document
            .as_ref()
            .is_some_and(|d| d.undo_name().as_deref() == Some("section"))
    );
}

#[test]
fn the_panel_sets_axis_place_and_side() {
    let mut harness = exact();
    show_tab(&mut harness, "Look");
    harness.get_by_label("Cut the model open").click_accesskit();
    harness.run_steps(4);
    harness.get_by_label("Section across up").click_accesskit();
    harness.run_steps(4);
    let level = section(harness.state()).expect("a section");
    assert_eq!((level.is_on, level.plane.axis), (true, 1));
    harness.get_by_label("Show the other side of the section").click_accesskit();
    harness.run_steps(4);
    assert_eq!(section(harness.state()).expect("a section").plane.keeps_above, !level.plane.keeps_above);
    assert!(harness.query_all_by_label("Section at").count() == 2, "slider and field have a name");
    settle(&mut harness);
}

/// The mode says so in the panel, and its picture stays whole.
#[test]
fn mode_paper_shows_no_section() {
    let mut harness = app();
    let whole = radiance(&harness);
    show_tab(&mut harness, "Look");
    press(&mut harness, Modifiers::NONE, Key::O);
    assert!(section(harness.state()).is_some_and(|section| section.is_on));
    let words = "Mode paper warps pictures of the whole model and shows no section.";
    assert!(harness.query_by_label(words).is_some());
    assert_eq!(radiance(&harness), whole);
}

#[test]
fn edges_are_drawn_by_key() {
    let mut harness = exact();
    let black =
        |harness: &Harness<'static, App>| radiance(harness).iter().filter(|pixel| **pixel == 0).count();
    let before = black(&harness);
    harness.key_press_modifiers(Modifiers::SHIFT, Key::Y);
    harness.run_steps(2);
    step_until(&mut harness, "lines", |app| {
        app.state()
            .frame
            .as_ref()
            .is_some_and(|f| f.radiance.iter().filter(|p| **p == 0).count() > before + 200)
    });
}
