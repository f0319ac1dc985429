//! Unsaved changes are asked about before they would be lost.

use super::*;
use afterimage_ui::window::state::Severity;
use egui::{Key, ViewportCommand, ViewportEvent, ViewportId};

/// A wall on disk that was made a mirror, unsaved.
struct Changed {
    folder: tempfile::TempDir,
    window: Harness<'static, App>,
}

impl Changed {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let model = folder.path().join("wall.obj");
        std::fs::write(&model, "usemtl wall\nv -1 0 0\nv 1 0 0\nv 1 2 0\nv -1 2 0\nf 1 2 3 4\n")
            .expect("a file");
        let mut window = open(LaunchOptions { scene: Some(SceneSource::file(&model)), ..request() }, false);
        make_mirror(&mut window, 0.0);
        Self { folder, window }
    }

    fn saved(&self) -> Option<String> {
        std::fs::read_to_string(self.folder.path().join("wall.afterimage-session.toml")).ok()
    }
}

/// Changes the material at a point below the centre, in points.
fn make_mirror(window: &mut Harness<'static, App>, down: f32) {
    editing::click(window, 0.0, down);
    window.get_by_label("Mirror").click_accesskit();
    settle(window);
    assert!(is_unsaved(window.state()));
}

fn is_unsaved(app: &App) -> bool {
    app.state().is_unsaved()
}

/// Requests to close the window; true where that was held up.
fn close(window: &mut Harness<'static, App>) -> bool {
    window.input_mut().viewports.entry(ViewportId::ROOT).or_default().events.push(ViewportEvent::Close);
    window.step();
    let is_held = sends(window, &ViewportCommand::CancelClose);
    window.input_mut().viewports.entry(ViewportId::ROOT).or_default().events.clear();
    window.run_steps(2);
    is_held
}

/// Steps until the window closes itself.
fn wait_for_close(window: &mut Harness<'static, App>) {
    let start = Instant::now();
    while !sends(window, &ViewportCommand::Close) {
        assert!(start.elapsed() < DEADLINE, "it stays open");
        std::thread::yield_now();
        window.step();
    }
}

#[test]
fn closing_asks_and_enter_saves() {
    let mut changed = Changed::new();
    assert!(close(&mut changed.window));
    assert!(changed.window.get_by_label("Save").is_focused(), "the first answer has the keyboard");
    let before = camera(&changed.window);
    changed.window.key_down(Key::W);
    changed.window.run_steps(3);
    changed.window.key_up(Key::W);
    assert_eq!(camera(&changed.window), before, "a question has the keys");
    changed.window.key_press(Key::Enter);
    wait_for_close(&mut changed.window);
    assert!(changed.saved().is_some_and(|text| text.contains("kind = \"mirror\"")));
    assert!(!close(&mut changed.window), "it is not asked again");
}

#[test]
fn escape_stays_and_tab_reaches_the_other_answers() {
    let mut changed = Changed::new();
    assert!(close(&mut changed.window));
    changed.window.key_press(Key::Escape);
    changed.window.run_steps(2);
    assert!(changed.window.query_by_label("Don't save").is_none());
    assert!(is_unsaved(changed.window.state()), "nothing is lost");
    assert!(close(&mut changed.window));
    changed.window.key_press(Key::Tab);
    changed.window.run_steps(2);
    assert!(changed.window.get_by_label("Don't save").is_focused());
    changed.window.key_down(Key::Enter);
    wait_for_close(&mut changed.window);
    assert_eq!(changed.saved(), None);
}

#[test]
fn what_cannot_be_saved_is_not_left() {
    let mut changed = Changed::new();
    changed.window.key_press_modifiers(egui::Modifiers::COMMAND, Key::S);
    step_until(&mut changed.window, "a session", |app| !is_unsaved(app));
    let session = changed.folder.path().join("wall.afterimage-session.toml");
    std::fs::remove_file(&session).expect("the session");
    std::fs::create_dir(&session).expect("a folder in the way");
    changed.window.get_by_label("Matte").click_accesskit();
    step_until(&mut changed.window, "a change", is_unsaved);
    assert!(close(&mut changed.window));
    changed.window.get_by_label("Save").click();
    step_until(&mut changed.window, "a message", |app| {
        app.state().notices.iter().any(|n| n.severity == Severity::Error)
    });
    assert!(!sends(&changed.window, &ViewportCommand::Close) && is_unsaved(changed.window.state()));
    assert!(changed.window.state().state().dialogs.leaving.is_none(), "the message can be read");
}

#[test]
fn another_scene_waits_for_the_answer() {
    let mut changed = Changed::new();
    let other = changed.folder.path().join("triangle.obj");
    std::fs::write(&other, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("a file");
    let triangles = |app: &App| app.state().scene.as_ref().map(|s| s.triangles);
    for answer in ["Cancel", "Don't save"] {
        changed.window.input_mut().dropped_files.push(Arc::new(driving::Dropped(other.clone())));
        changed.window.run_steps(3);
        assert!(changed.window.state().loading().is_none());
        assert_eq!(triangles(changed.window.state()), Some(2));
        changed.window.get_by_label(answer).click();
        changed.window.run_steps(2);
    }
    step_until(&mut changed.window, "the other scene", |app| triangles(app) == Some(1));
    settle(&mut changed.window);
    assert_eq!(changed.saved(), None);
    assert!(!close(&mut changed.window), "nothing is left to be lost");
}

/// The file is dropped and the surface changed in the same update, so that the scene arrives after
/// the change.
#[test]
fn what_is_changed_while_another_scene_loads_is_asked_about() {
    for answer in ["Cancel", "Don't save", "Save"] {
        let mut changed = Changed::new();
        changed.window.get_by_label("Save changes").click_accesskit();
        step_until(&mut changed.window, "saved", |app| !is_unsaved(app));
        let saved = changed.saved();
        let other = changed.folder.path().join("triangle.obj");
        std::fs::write(&other, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("a file");
        let triangles = |app: &App| app.state().scene.as_ref().map(|s| s.triangles);
        changed.window.input_mut().dropped_files.push(Arc::new(driving::Dropped(other)));
        changed.window.get_by_label("Glass").click_accesskit();
        step_until(&mut changed.window, "the question", |app| app.state().dialogs.leaving.is_some());
        assert_eq!(triangles(changed.window.state()), Some(2), "the changed scene is still there");
        assert!(is_unsaved(changed.window.state()));
        changed.window.run_steps(2);
        changed.window.get_by_label(answer).click();
        if answer == "Cancel" {
            settle(&mut changed.window);
            assert!(triangles(changed.window.state()) == Some(2) && is_unsaved(changed.window.state()));
        } else {
            step_until(&mut changed.window, "the other scene", |app| triangles(app) == Some(1));
        }
        assert_eq!(changed.saved() != saved, answer == "Save");
    }
}

#[test]
fn a_scene_of_the_program_is_saved_in_a_session_before_leaving() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut window = app_saving_to(folder.path().to_owned());
    make_mirror(&mut window, 180.0);
    assert!(close(&mut window));
    window.get_by_label("Save").click();
    wait_for_close(&mut window);
    assert!(folder.path().join("afterimage-room-0001.afterimage-session.toml").exists());
}

#[test]
fn views_and_path_keys_are_asked_about_which_were_lost_before() {
    for key in [(egui::Modifiers::COMMAND, Key::Num7), (egui::Modifiers::NONE, Key::K)] {
        let mut window = app();
        window.key_press_modifiers(key.0, key.1);
        step_until(&mut window, "a change", is_unsaved);
        assert!(close(&mut window));
        window.get_by_label("Don't save").click();
        wait_for_close(&mut window);
    }
    let mut window = app();
    window.key_down(Key::W);
    window.run_steps(5);
    window.key_up(Key::W);
    settle(&mut window);
    assert!(!close(&mut window), "to have moved is no change");
}

#[test]
fn without_changes_nothing_is_asked() {
    let mut window = app();
    assert!(!close(&mut window));
    assert!(window.state().state().dialogs.leaving.is_none());
}
