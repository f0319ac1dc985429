//! The inspector, distances, single references, the plan, thumbnails.

use super::editing::click;
use super::*;
use afterimage_ui::window::state::{Selection, SnapKind};
use egui::Key;

fn selection(app: &App) -> &Selection {
    &app.state().selection
}

#[test]
fn a_click_tells_what_is_there() {
    let mut harness = app();
    click(&mut harness, 0.0, 0.0);
    let found = selection(harness.state()).inspection.clone().expect("a wall at least");
    let camera = camera(&harness);
    assert!((found.position_m.distance(camera.eye) - found.distance_m).abs() < 1e-3);
    assert!((found.depth_m - found.distance_m).abs() < 1e-6, "in the centre depth is distance");
    let facts = found.pixel.expect("the frame is of this pose");
    let frame = harness.state().state().frame.as_ref().expect("a frame");
    assert_eq!(facts.at, frame.size.map(|s| s / 2));
    assert!(
        facts.supplier.is_some() || facts.kind.number() == 3,
        "a supplier of a pixel that is not traced: {facts:?}"
    );
    assert!(facts.radiance.is_finite() && facts.radiance.max_element() > 0.0);
    harness.get_by_label("Copy the inspected values").click_accesskit();
    harness.step();
    let copied = harness.output().platform_output.commands.iter().find_map(|command| match command {
        egui::OutputCommand::CopyText(text) => Some(text.clone()),
        _ => None,
    });
    let text = copied.expect("text in the clipboard");
    assert!(text.contains("material: ") && text.contains("triangle: ") && text.contains("type: "), "{text}");
    harness.key_press(Key::Escape);
    harness.run_steps(2);
    assert!(selection(harness.state()).inspection.is_none());
}

fn measures(app: &App) -> &[[glam::DVec3; 2]] {
    &app.state().document.as_ref().expect("a scene").now().measures
}

#[test]
fn m_measures_between_two_clicks_and_corners_attract() {
    let mut harness = app();
    harness.key_press(Key::M);
    harness.run_steps(2);
    assert!(selection(harness.state()).measure.is_on);
    harness.get_by_label_contains("click the first point; Esc ends");
    click(&mut harness, -150.0, 150.0);
    harness.get_by_label_contains("click the second point");
    click(&mut harness, 160.0, 150.0);
    let [a, b] = measures(harness.state())[0];
    assert!([a, b].iter().all(|p| p.y.abs() < 1e-3), "both on the floor: {a} {b}");
    harness.get_by_label_contains(&format!("{:.3} m; horizontal", a.distance(b)));
    // The near edge of the red box's top.
    let tracer_corner = glam::DVec3::new(0.35, 0.5, -0.35);
    let rect = harness.get_by_label("3D viewport").rect();
    let camera = camera(&harness);
    let seen = afterimage_ui::window::gpu::projection::Projection::new(&camera, rect).point(tracer_corner);
    let offset = seen.expect("before the eye") - rect.center();
    click(&mut harness, offset.x + 2.0, offset.y + 2.0);
    let first = selection(harness.state()).measure.first.expect("a point");
    assert_eq!(first.kind, SnapKind::Vertex);
    assert!(first.position_m.distance(tracer_corner) < 1e-3, "{first:?}");
    harness.key_press(Key::Escape);
    harness.run_steps(2);
    assert!(!selection(harness.state()).measure.is_on);
    assert!(selection(harness.state()).inspection.is_none(), "clicks measured and inspected nothing");
    assert_eq!(measures(harness.state()).len(), 1, "the complete distance is kept, the half one dropped");
}

#[test]
fn distances_are_kept_deleted_and_undone() {
    let mut harness = app();
    harness.key_press(Key::M);
    harness.step();
    for right in [-150.0, 150.0, -100.0, 100.0] {
        click(&mut harness, right, 150.0);
    }
    harness.key_press(Key::M);
    harness.run_steps(3);
    assert_eq!(measures(harness.state()).len(), 2);
    assert!(harness.state().state().is_unsaved());
    let second = measures(harness.state())[1];
    harness.get_by_label("Delete distance 1").click_accesskit();
    harness.run_steps(2);
    assert_eq!(measures(harness.state()), [second]);
    harness.key_press_modifiers(egui::Modifiers::COMMAND, Key::Z);
    harness.run_steps(2);
    assert_eq!(measures(harness.state()).len(), 2);
    harness.get_by_label("Delete all distances").click_accesskit();
    harness.run_steps(2);
    assert!(measures(harness.state()).is_empty());
}

#[test]
fn the_selection_is_the_surface_and_its_distance_is_that_of_now() {
    let mut harness = app();
    click(&mut harness, -150.0, 150.0);
    step_until(&mut harness, "an outline", |app| selection(app).outline.is_some());
    let outline = |app: &App| selection(app).outline.clone().expect("an outline").1;
    let floor = outline(harness.state());
    assert!(floor.iter().flatten().all(|p| p.y.abs() < 1e-3), "the floor: {floor:?}");
    let found = selection(harness.state()).inspection.clone().expect("the floor");
    let longest = floor.iter().map(|[a, b]| a.distance(*b)).fold(0.0, f64::max);
    assert!(longest > 1.0, "more than a triangle: {floor:?}");
    harness.key_down(Key::S);
    harness.run_steps(10);
    harness.key_up(Key::S);
    harness.run_steps(3);
    let now = found.position_m.distance(camera(&harness).eye);
    assert!(now > found.distance_m + 0.01);
    harness.get_by_label_contains(&format!("{now:.3} m, depth"));
    harness.get_by_label_contains("grey lines are of the moment of the click");
    harness.key_press(Key::Escape);
    harness.run_steps(2);
    assert!(selection(harness.state()).outline.is_none());
}

#[test]
fn a_reference_is_switched_off_shown_and_chosen() {
    let mut harness = app();
    let first = |app: &App| app.state().frame.as_ref().expect("a frame").references[0];
    let number = first(harness.state()).id.0;
    show_tab(&mut harness, "Method");
    harness.get_by_label(&format!("Disable reference {number}")).click_accesskit();
    step_until(&mut harness, "a frame without it", |app| !first(app).is_enabled);
    settle(&mut harness);
    let app = harness.state();
    let stands_in = app
        .state()
        .frame
        .as_ref()
        .expect("a frame")
        .references
        .iter()
        .any(|r| r.is_enabled && r.contribution > 0.1);
    assert!(stands_in, "the policy took another");
    harness.step();
    harness.get_by_label(&format!("Enable reference {number}")).click_accesskit();
    step_until(&mut harness, "a frame with it", |app| first(app).is_enabled);
    harness.get_by_label(&format!("Show reference {number}")).click_accesskit();
    step_until(&mut harness, "its picture", |app| selection(app).reference_view.is_some());
    let view = selection(harness.state()).reference_view.clone().expect("its picture");
    assert!(view.id.0 == number && view.lit > 0.5, "{view:?}");
    harness.key_press(Key::Escape);
    harness.run_steps(2);
    assert!(selection(harness.state()).reference_view.is_none());
    harness.get_by_label(&format!("Select reference {number}")).click_accesskit();
    harness.run_steps(2);
    assert_eq!(selection(harness.state()).reference.map(|id| id.0), Some(number));
    show_tab(&mut harness, "Camera");
    harness.get_by_label(&format!("Go to selected reference {number}"));
}

#[test]
fn the_plan_is_cut_zoomed_and_clicked() {
    let mut harness = app();
    show_tab(&mut harness, "Camera");
    step_until(&mut harness, "a plan", |app| app.state().plan.cut.is_some());
    let plan = harness.state().state().plan.cut.clone().expect("a plan");
    assert!(plan.lines.len() >= 8, "four walls at least: {}", plan.lines.len());
    harness.run_steps(2);
    harness.get_by_label("Zoom in on the plan").click_accesskit();
    harness.run_steps(2);
    assert!((harness.state().state().plan.view.zoom() - 1.5).abs() < 1e-9);
    harness.get_by_label("Follow camera").click_accesskit();
    harness.run_steps(2);
    settle(&mut harness);
    harness.get_by_label("Plan map").scroll_to_me();
    harness.run_steps(30);
    // The first reference is at the camera: in the centre of the plan, which follows the camera.
    // Content that appears above moves the plan.
    let mut at = egui::Pos2::ZERO;
    while harness.get_by_label("Plan map").rect().center() != at {
        at = harness.get_by_label("Plan map").rect().center();
        harness.run_steps(10);
    }
    harness.hover_at(at);
    harness.step();
    for pressed in [true, false] {
        let (button, modifiers) = (egui::PointerButton::Primary, egui::Modifiers::NONE);
        harness.event(egui::Event::PointerButton { pos: at, button, pressed, modifiers });
        harness.step();
    }
    harness.step();
    let state = harness.state().state();
    let eyes: Vec<_> = state.frame.iter().flat_map(|f| &f.references).map(|r| r.camera.eye).collect();
    let now = harness.get_by_label("Plan map").rect();
    assert!(state.selection.reference.is_some(), "clicked {at} in {now}, {:?}; {eyes:?}", state.plan.view);
    harness.get_by_label("Whole plan").click_accesskit();
    harness.run_steps(2);
    assert_eq!(harness.state().state().plan.view, Default::default());
}

#[test]
fn views_and_references_get_small_pictures() {
    let mut harness = app();
    let is_there = |app: &App| {
        let state = app.state();
        let thumbnails = &state.thumbnails;
        let views = state.views().iter().map(|v| v.camera);
        let references = state.frame.iter().flat_map(|f| &f.references).map(|r| r.camera);
        views.chain(references).all(|camera| thumbnails.of(&camera).is_some())
    };
    step_until(&mut harness, "all small pictures", is_there);
}

#[test]
fn the_report_is_filtered() {
    let folder = tempfile::tempdir().expect("a folder");
    let model = folder.path().join("m.obj");
    let text = "mtllib gone.mtl\nusemtl a\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 0 0\nf 1 2 3\nf 1 2 9\n";
    std::fs::write(&model, text).expect("a file");
    let mut harness = open(LaunchOptions { scene: Some(SceneSource::file(&model)), ..request() }, false);
    let count = harness.state().state().scene.as_ref().expect("a scene").warnings.len();
    assert!(count >= 2);
    harness.get_by_label(&format!("{count} import warnings")).click_accesskit();
    harness.run_steps(30);
    harness.get_by_label("Filter the warnings").focus();
    harness.step();
    harness.get_by_label("Filter the warnings").type_text("GONE.mtl");
    harness.run_steps(3);
    harness.get_by_label_contains("1 shown");
}

#[test]
fn the_picture_keeps_its_size_whatever_the_panel_says() {
    let mut harness = begin(request(), false);
    harness.step();
    let room = |harness: &Harness<'static, App>| harness.get_by_label("3D viewport").rect();
    let first = room(&harness);
    show_tab(&mut harness, "Camera");
    step_until(&mut harness, "a plan", |app| app.state().plan.cut.is_some());
    settle(&mut harness);
    for step in 0..60 {
        harness.step();
        assert_eq!(room(&harness), first, "at step {step}: every other size is another picture to render");
    }
}

#[test]
fn a_half_finished_distance_is_dropped_when_measuring_ends() {
    let mut harness = app();
    for end in [Key::M, Key::Escape] {
        harness.key_press(Key::M);
        harness.step();
        click(&mut harness, -150.0, 150.0);
        assert!(selection(harness.state()).measure.first.is_some());
        harness.key_press(end);
        harness.run_steps(2);
        assert!(selection(harness.state()).measure.first.is_none(), "after {end:?}");
    }
    harness.key_press(Key::M);
    harness.step();
    click(&mut harness, 160.0, 150.0);
    assert!(selection(harness.state()).measure.first.is_some(), "a first point, not a second one");
    assert!(measures(harness.state()).is_empty());
}

#[test]
fn a_click_on_the_plan_goes_there_at_eye_height() {
    let mut harness = app();
    show_tab(&mut harness, "Camera");
    step_until(&mut harness, "a plan", |app| app.state().plan.cut.is_some());
    let plan = harness.state().state().plan.cut.clone().expect("a plan");
    assert!(plan.floor_m.expect("a floor").abs() < 1e-3, "{:?}", plan.storeys_m);
    harness.get_by_label("Plan map").scroll_to_me();
    harness.run_steps(30);
    let mut rect = egui::Rect::NOTHING;
    while harness.get_by_label("Plan map").rect() != rect {
        rect = harness.get_by_label("Plan map").rect();
        harness.run_steps(10);
    }
    // A corner of the room, where no reference is.
    let at = rect.center() + egui::vec2(-40.0, -60.0);
    harness.hover_at(at);
    harness.step();
    for pressed in [true, false] {
        let (button, modifiers) = (egui::PointerButton::Primary, egui::Modifiers::NONE);
        harness.event(egui::Event::PointerButton { pos: at, button, pressed, modifiers });
        harness.step();
    }
    harness.run_steps(90);
    let eye = camera(&harness).eye;
    assert!((eye.y - 1.6).abs() < 1e-3 && eye.x < -0.5 && eye.z < -0.5, "{eye}");
    let zoom = harness.state().state().plan.view.zoom();
    harness.hover_at(at);
    let (unit, delta) = (egui::MouseWheelUnit::Line, egui::vec2(0.0, 3.0));
    let (phase, modifiers) = (egui::TouchPhase::Move, egui::Modifiers::NONE);
    let source = egui::MouseWheelSource::Unknown;
    harness.event(egui::Event::MouseWheel { unit, delta, phase, source, modifiers });
    harness.run_steps(10);
    assert!(harness.state().state().plan.view.zoom() > zoom, "the wheel zooms");
}
