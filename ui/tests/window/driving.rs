//! Keys, mouse, panels.

use super::*;
use afterimage::raster::{color::ToneMap, exposure::Exposure};
use afterimage_ui::window::input::keymap::BINDINGS;
use afterimage_ui::window::state::{Coloring, Heatmap};
use afterimage_ui::window::state::{Severity, Work};
use egui::accesskit::Role;
use egui::{Key, Modifiers, vec2};

#[test]
fn w_flies_forward_and_generations_never_go_back() {
    let mut harness = app();
    let before = camera(&harness);
    let mut newest = generation(&harness);
    harness.key_down(Key::W);
    for _ in 0..30 {
        harness.step();
        assert!(generation(&harness) >= newest, "an older frame after a newer one");
        newest = generation(&harness);
    }
    assert_eq!(harness.state().state().work, Work::Moving);
    harness.key_up(Key::W);
    settle(&mut harness);
    let after = camera(&harness);
    let way = after.eye - before.eye;
    assert!((0.9..1.6).contains(&way.dot(before.forward())), "{way} in half a second at 2.5 m/s");
    let shown = harness.state().state().frame.as_ref().expect("a frame").camera;
    assert_eq!(shown, after, "what is shown at rest is the newest pose");
}

#[test]
fn a_drag_turns_and_the_wheel_dollies_or_changes_the_speed() {
    let mut harness = app();
    let before = camera(&harness);
    let centre = viewport_centre(&harness);
    for event in [centre, centre + vec2(60.0, 30.0)] {
        harness.hover_at(event);
        harness.step();
        if event == centre {
            harness.drag_at(centre);
            harness.step();
        }
    }
    harness.drop_at(centre + vec2(60.0, 30.0));
    harness.step();
    let after = camera(&harness);
    assert!(after.yaw < before.yaw && after.pitch < before.pitch, "right and down: {before:?} {after:?}");
    assert_eq!(after.eye, before.eye);
    let wheel = egui::Event::MouseWheel {
        unit: egui::MouseWheelUnit::Line,
        delta: vec2(0.0, 1.0),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Unknown,
        modifiers: Modifiers::NONE,
    };
    // A release removes the test's cursor.
    harness.hover_at(centre);
    harness.step();
    harness.event(wheel.clone());
    harness.step();
    assert!(harness.state().state().navigation.fly.camera().eye != after.eye, "the wheel flies");
    let speed = harness.state().state().navigation.fly.speed_m_per_s();
    let button = |pressed| egui::Event::PointerButton {
        pos: centre,
        button: egui::PointerButton::Secondary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    harness.event(button(true));
    harness.step();
    harness.event(wheel);
    harness.step();
    harness.event(button(false));
    harness.step();
    assert!(harness.state().state().navigation.fly.speed_m_per_s() > speed);
}

#[test]
fn t_cycles_the_heatmap_and_shift_t_shows_references() {
    let mut harness = app();
    for expected in [Heatmap::Blend, Heatmap::Only, Heatmap::Off] {
        harness.key_press(Key::T);
        harness.step();
        assert_eq!(harness.state().state().options.heatmap, expected);
    }
    harness.key_press_modifiers(Modifiers::SHIFT, Key::T);
    harness.step();
    let options = harness.state().state().options;
    assert_eq!((options.coloring, options.heatmap), (Coloring::ByReference, Heatmap::Blend));
}

#[test]
fn n_adds_a_reference_and_clear_asks_first() {
    let mut harness = app();
    let before = held(&harness);
    assert!(before >= 1, "the policy added one for the first view");
    harness.key_press(Key::N);
    step_until(&mut harness, "one more reference", |app| app.state().references_used_and_held()[1] > before);
    settle(&mut harness);
    harness.key_press_modifiers(Modifiers::SHIFT, Key::Delete);
    harness.step();
    harness.step();
    assert_eq!(held(&harness), before + 1, "nothing is dropped before the answer");
    let newest = harness.state().threads().generation();
    harness.get_by_label("Clear all").click();
    step_until(&mut harness, "the cleared cache", |app| app.threads().generation() > newest);
    settle(&mut harness);
    assert!(held(&harness) <= 1, "the policy may have added one again");
}

#[test]
fn at_rest_everything_is_reused_or_mirrored() {
    let harness = app();
    let frame = harness.state().state().frame.as_ref().expect("a frame");
    let p = frame.stats.types.percentages();
    assert!(p.type1_percent > 50.0 && p.type2_percent > 0.0 && p.type3_percent < 5.0, "{p:?}");
    let start = harness.state().state().navigation.fly.camera();
    assert!(frame.references.iter().all(|r| r.camera == *start), "no reference is at another pose");
}

#[test]
fn p_pauses_and_resumes() {
    let mut harness = app();
    harness.key_press(Key::P);
    harness.step();
    harness.step();
    assert_eq!(harness.state().state().work, Work::Paused);
    assert!(harness.query_by_label("Paused").is_some(), "it is seen");
    let rendered = harness.state().threads().frames_rendered();
    harness.run_steps(10);
    assert_eq!(harness.state().threads().frames_rendered(), rendered, "nothing is rendered while paused");
    harness.key_press(Key::P);
    settle(&mut harness);
    assert!(harness.state().threads().frames_rendered() > rendered);
}

#[test]
fn typing_does_not_fly() {
    let mut harness = app();
    let before = camera(&harness);
    let field = || -> Role { Role::TextInput };
    harness.get_by_role_and_label(field(), "Model file").focus();
    harness.step();
    harness.get_by_role_and_label(field(), "Model file").type_text("wasd");
    for key in [Key::W, Key::A, Key::T, Key::N] {
        harness.key_press(key);
    }
    harness.run_steps(4);
    let state = harness.state().state();
    assert_eq!(state.files.path_text, "wasd");
    assert_eq!(*state.navigation.fly.camera(), before);
    assert_eq!(state.options.heatmap, Heatmap::Off);
}

#[test]
fn the_help_lists_every_key() {
    let mut harness = app();
    harness.key_press(Key::F1);
    harness.run_steps(3);
    for binding in BINDINGS {
        assert!(
            harness.query_all_by_label(binding.help).next().is_some(),
            "no line for {:?}",
            binding.action
        );
    }
    harness.key_press(Key::Escape);
    harness.run_steps(2);
    assert!(!harness.state().state().options.shows_help);
}

#[test]
fn a_broken_path_is_reported_and_the_scene_stays() {
    let mut harness = app();
    harness.get_by_role_and_label(Role::TextInput, "Model file").focus();
    harness.step();
    harness.get_by_role_and_label(Role::TextInput, "Model file").type_text("/no/such/model.obj");
    harness.step();
    harness.get_by_label("Load").click();
    step_until(&mut harness, "a message", |app| !app.state().notices.is_empty());
    let state = harness.state().state();
    assert_eq!(state.notices[0].severity, Severity::Error);
    assert!(state.notices[0].text.contains("/no/such/model.obj"), "{}", state.notices[0].text);
    assert_eq!(state.scene.as_ref().expect("the old scene").name, "builtin:room");
    harness.step();
    harness.get_by_label("Dismiss").click();
    harness.run_steps(2);
    assert!(harness.state().state().notices.is_empty());
    settle(&mut harness);
}

#[test]
fn saved_views_are_reached_by_number_and_in_turn() {
    let mut harness = app();
    let views = harness.state().state().views().to_vec();
    for (key, view) in [(Key::Num2, 1), (Key::L, 2), (Key::Num1, 0)] {
        harness.key_press(key);
        harness.run_steps(60);
        assert_eq!(camera(&harness), views[view].camera);
    }
}

#[test]
fn a_window_without_room_for_a_picture_does_no_harm() {
    let mut harness = app();
    harness.set_size(vec2(40.0, 20.0));
    harness.run_steps(3);
    harness.set_size(vec2(900.0, 600.0));
    settle(&mut harness);
}

#[test]
fn ctrl_c_copies_the_pose() {
    let mut harness = app();
    harness.event(egui::Event::Copy);
    harness.step();
    let is_pose =
        |c: &egui::OutputCommand| matches!(c, egui::OutputCommand::CopyText(t) if t.starts_with("--eye "));
    assert!(harness.output().platform_output.commands.iter().any(is_pose));
}

#[derive(Debug)]
pub(super) struct Dropped(pub(super) PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &std::path::Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        Err("only the path is asked for".to_owned())
    }
}

#[test]
fn a_dropped_model_replaces_the_scene_and_its_warnings_are_listed() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("triangle.obj");
    let text = "mtllib gone.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n";
    std::fs::write(&path, text).expect("a file");
    let mut harness = app();
    let epoch = generation(&harness);
    harness.input_mut().dropped_files.push(Arc::new(Dropped(path)));
    step_until(&mut harness, "another scene", |app| {
        app.state().scene.as_ref().is_some_and(|scene| scene.triangles == 1)
    });
    settle(&mut harness);
    assert!(generation(&harness) > epoch);
    let scene = harness.state().state().scene.as_ref().expect("a scene");
    assert!(!scene.warnings.is_empty(), "the missing library is said");
    assert!(harness.query_all_by_label_contains("import warning").next().is_some());
}

/// The panel shows the automatic exposure; a key ends it, and a reset brings it back.
#[test]
fn a_model_opens_with_the_exposure_that_it_has_without_a_window() {
    let tracer = afterimage::Tracer::new(small_room());
    assert!(tracer.measure_light(&|_| (), &|| false));
    let expected = tracer.metered().expect("the light is measured").ev();
    let mut harness = app();
    let shown = |harness: &Harness<'static, App>| {
        let state = harness.state().state();
        (state.quality.exposure, state.exposure_ev())
    };
    assert_eq!(shown(&harness), (Exposure::Auto, expected));
    show_tab(&mut harness, "Look");
    let text = format!("{expected:+.1} EV");
    assert!(harness.query_by_label(&text).is_some());
    harness.key_press(Key::Equals);
    harness.run_steps(2);
    assert_eq!(shown(&harness), (Exposure::Stops(expected + 0.5), expected + 0.5));
    assert!(harness.query_by_label(&text).is_none(), "no longer automatic");
    harness.key_press(Key::Num0);
    harness.run_steps(2);
    assert_eq!(shown(&harness), (Exposure::Auto, expected));
}

#[test]
fn options_of_the_start_are_kept() {
    let asked = LaunchOptions {
        view: Some("mirror".to_owned()),
        fov_y_deg: Some(8.5),
        exposure: Some(Exposure::Stops(9.25)),
        tone_map: ToneMap::Linear,
        ..request()
    };
    let mut harness = open(asked, false);
    harness.run_steps(3);
    let state = harness.state().state();
    assert!((state.navigation.fly.camera().fov_y.to_degrees() - 8.5).abs() < 1e-9);
    assert_eq!(state.navigation.fly.camera().eye, state.views()[1].camera.eye);
    assert_eq!((state.exposure_ev(), state.quality.tone_map), (9.25, ToneMap::Linear));
    assert_eq!(state.quality, state.default_quality);
    assert!(state.notices.is_empty());
}

#[test]
fn an_unknown_view_is_reported_with_the_known_ones() {
    let harness = open(LaunchOptions { view: Some("kitchen".to_owned()), ..request() }, false);
    let notice = &harness.state().state().notices[0];
    assert_eq!(notice.severity, Severity::Error);
    assert!(notice.text.contains("'kitchen'") && notice.text.contains("mirror"), "{}", notice.text);
}

#[test]
fn without_a_scene_nothing_is_filling() {
    let broken = LaunchOptions { scene: Some(SceneSource::file("/no/such/model.obj")), ..request() };
    let mut harness = begin(broken, false);
    step_until(&mut harness, "a message", |app| !app.state().notices.is_empty());
    harness.run_steps(2);
    assert_eq!(harness.state().state().work, Work::NoScene);
}

#[test]
fn at_rest_the_picture_has_every_pixel_of_the_window_and_fewer_in_motion() {
    let mut request = request();
    request.settings.render.mode = Mode::Exact;
    let mut harness = open(request, false);
    let width = harness.get_by_label("3D viewport").rect().width();
    let is_sharp =
        |app: &App| app.state().frame.as_ref().is_some_and(|f| (f.size[0] as f32 - width).abs() <= 1.0);
    step_until(&mut harness, "a sharp picture", is_sharp);
    harness.key_down(Key::W);
    step_until(&mut harness, "a coarse one", |app| !is_sharp(app));
    harness.key_up(Key::W);
    step_until(&mut harness, "a sharp one again", is_sharp);
}
