//! Edits of materials, sun and sky, undone and redone.

use super::*;
use afterimage::import::{DaylightOptions, SkyChoice};
use afterimage::scene::{MaterialKind, Sky, SkyKind};
use afterimage_ui::window::state::{OpenDocument, SceneInfo, Severity};
use egui::{Key, Modifiers};

fn document(app: &App) -> &OpenDocument {
    app.state().document.as_ref().expect("a scene")
}

fn scene(app: &App) -> &SceneInfo {
    app.state().scene.as_ref().expect("a scene")
}

/// Clicks a point of the viewport, given right and down from its centre in points.
pub(super) fn click(harness: &mut Harness<'static, App>, right: f32, down: f32) {
    let at = viewport_centre(harness) + egui::vec2(right, down);
    harness.hover_at(at);
    harness.step();
    for pressed in [true, false] {
        let button = egui::PointerButton::Primary;
        harness.event(egui::Event::PointerButton { pos: at, button, pressed, modifiers: Modifiers::NONE });
        harness.step();
    }
    harness.step();
}

fn kind_of_chosen(app: &App) -> MaterialKind {
    let id = app.state().selection.material.expect("a chosen material");
    document(app).scene().materials[id.0 as usize].kind
}

#[test]
fn a_clicked_surface_is_made_a_mirror_and_matte_again() {
    let mut harness = app();
    // The floor, left below the centre.
    click(&mut harness, -20.0, 180.0);
    let before = document(harness.state()).now().clone();
    let newest = harness.state().threads().generation();
    harness.get_by_label("Mirror").click_accesskit();
    step_until(&mut harness, "the new scene", |app| app.threads().generation() > newest);
    settle(&mut harness);
    assert!(matches!(kind_of_chosen(harness.state()), MaterialKind::Mirror { .. }));
    let p = harness.state().state().frame.as_ref().expect("a frame").stats.types.percentages();
    assert!(p.type2_percent > 15.0, "a floor that mirrors is Type 2: {p:?}");
    harness.get_by_label("Unsaved changes");
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    harness.step();
    assert_eq!(*document(harness.state()).now(), before);
    settle(&mut harness);
    harness.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    harness.step();
    assert!(matches!(kind_of_chosen(harness.state()), MaterialKind::Mirror { .. }));
    harness.get_by_label("Glass").click_accesskit();
    harness.step();
    harness.step();
    assert!(matches!(kind_of_chosen(harness.state()), MaterialKind::Glass { .. }));
    step_until(&mut harness, "glass in the scene", |app| scene(app).features.glass);
    harness.get_by_label("Undo").click_accesskit();
    step_until(&mut harness, "no glass in the scene", |app| !scene(app).features.glass);
}

#[test]
fn the_old_picture_stays_until_there_is_one_of_the_new_scene() {
    let mut harness = app();
    click(&mut harness, 0.0, 180.0);
    let newest = generation(&harness);
    harness.get_by_label("Mirror").click_accesskit();
    step_until(&mut harness, "the first picture of the new scene", |app| {
        app.state().frame.as_ref().expect("never without a picture").generation > newest
    });
    settle(&mut harness);
}

#[test]
fn the_sun_is_switched_on_and_moved() {
    let mut harness = app();
    show_tab(&mut harness, "Look");
    let lights = scene(harness.state()).lights;
    harness.get_by_label("Sun").click_accesskit();
    step_until(&mut harness, "one light more", |app| scene(app).lights == lights + 1);
    let direction = |app: &App| document(app).scene().daylight.sun.expect("a sun").direction;
    let before = direction(harness.state());
    harness.get_by_label("By place and time").click_accesskit();
    harness.run_steps(3);
    let after = direction(harness.state());
    assert!(before.distance(after) > 0.05, "{before} and {after}: another place, another sun");
    assert!(after.z > 0.0, "in the south at noon in Berlin: {after}");
    harness.get_by_label("Sky").click_accesskit();
    step_until(&mut harness, "a sky", |app| scene(app).features.sky);
    for _ in 0..3 {
        harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
        harness.run_steps(2);
    }
    assert!(!harness.state().state().is_unsaved());
    step_until(&mut harness, "the lights there were", |app| scene(app).lights == lights);
}

#[test]
fn a_group_of_lights_is_switched_off_and_on_and_undone() {
    let mut harness = app();
    let name = scene(harness.state()).light_groups[0].name.clone();
    let before = document(harness.state()).now().clone();
    show_tab(&mut harness, "Look");
    harness.get_by_label("Lights").click_accesskit();
    harness.run_steps(30);
    assert!(harness.state().state().knows_lights);
    let setting = |app: &App, name: &str| document(app).scene().lights.get(name);
    let newest = generation(&harness);
    harness.get_by_label(&name).click_accesskit();
    harness.run_steps(2);
    assert!(!setting(harness.state(), &name).is_on);
    step_until(&mut harness, "a picture without the light", |app| {
        app.state().frame.as_ref().expect("a frame").generation > newest
    });
    harness.get_by_label(&name).click_accesskit();
    harness.run_steps(2);
    assert_eq!(*document(harness.state()).now(), before);
    for control in ["intensity", "stops", "colour"] {
        harness.get_by_label(&format!("{name}: {control}"));
    }
    while document(harness.state()).can_undo() {
        harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
        harness.run_steps(2);
    }
    assert!(!harness.state().state().is_unsaved() && *document(harness.state()).now() == before);
    settle(&mut harness);
}

#[test]
fn a_dropped_sky_picture_is_shown_and_one_that_is_no_sky_leaves_the_old_one() {
    let folder = tempfile::tempdir().expect("a folder");
    let (good, square) = (folder.path().join("sky.hdr"), folder.path().join("square.hdr"));
    let picture = |size: &str| {
        [format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n{size}\n").as_bytes(), &[128; 128]].concat()
    };
    std::fs::write(&good, picture("-Y 4 +X 8")).expect("a file");
    std::fs::write(&square, picture("-Y 4 +X 4")).expect("a file");
    let sky = Some(SkyChoice::Model(SkyKind::Overcast));
    let daylight = DaylightOptions { sky, ..DaylightOptions::default() };
    // A file, because a scene in memory keeps its own daylight.
    let model = folder.path().join("wall.obj");
    std::fs::write(&model, "v -1 0 0\nv 1 0 0\nv 1 2 0\nv -1 2 0\nf 1 2 3 4\n").expect("a file");
    let scene = Some(SceneSource::file(&model));
    let mut harness = open(LaunchOptions { scene, daylight, ..request() }, false);
    let kind = |app: &App| document(app).scene().daylight.sky.as_ref().map(Sky::kind);
    assert_eq!(
        (kind(harness.state()), harness.state().state().is_unsaved()),
        (Some(SkyKind::Overcast), false)
    );
    harness.input_mut().dropped_files.push(Arc::new(driving::Dropped(square)));
    step_until(&mut harness, "a message", |app| {
        app.state().notices.iter().any(|n| n.text.contains("twice as wide as high"))
    });
    assert_eq!(kind(harness.state()), Some(SkyKind::Overcast));
    harness.input_mut().dropped_files.push(Arc::new(driving::Dropped(good)));
    step_until(&mut harness, "the picture", |app| kind(app) == Some(SkyKind::Picture));
    settle(&mut harness);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    step_until(&mut harness, "the clouds", |app| kind(app) == Some(SkyKind::Overcast));
}

#[test]
fn changes_are_saved_beside_a_model_and_survive_a_reload_before() {
    let folder = tempfile::tempdir().expect("a folder");
    let model = folder.path().join("wall.obj");
    std::fs::write(&model, "usemtl wall\nv -1 0 0\nv 1 0 0\nv 1 2 0\nv -1 2 0\nf 1 2 3 4\n").expect("a file");
    let side = folder.path().join("wall.afterimage.toml");
    std::fs::write(&side, "# mine\nunit = \"m\"\n").expect("a file");
    let mut harness = open(LaunchOptions { scene: Some(SceneSource::file(&model)), ..request() }, false);
    click(&mut harness, 0.0, 0.0);
    harness.get_by_label("Mirror").click_accesskit();
    settle(&mut harness);
    harness.step();
    harness.key_press(Key::F5);
    harness.step();
    settle(&mut harness);
    assert!(harness.state().state().is_unsaved(), "a reload loses nothing");
    assert!(matches!(kind_of_chosen(harness.state()), MaterialKind::Mirror { .. }));
    step_until(&mut harness, "the mirror", |app| scene(app).features.mirror);
    harness.step();
    harness.get_by_label("Save changes").click_accesskit();
    step_until(&mut harness, "a saved look", |app| !app.state().is_unsaved());
    let text = std::fs::read_to_string(&side).expect("the file");
    assert!(text.starts_with("# mine\nunit = \"m\"\n") && text.contains("kind = \"mirror\""), "{text}");
}

#[test]
fn a_scene_of_the_program_cannot_be_saved_beside_and_says_so() {
    let mut harness = app();
    harness.get_by_label("Edit").click_accesskit();
    harness.run_steps(2);
    click(&mut harness, 0.0, 180.0);
    harness.get_by_label("Glass").click_accesskit();
    harness.run_steps(2);
    harness.get_by_label("Edit").click_accesskit();
    harness.run_steps(2);
    harness.get_by_label_contains("Save changes of the scene").click_accesskit();
    harness.run_steps(2);
    let notice = harness.state().state().notices.last().expect("a message");
    assert!(notice.severity == Severity::Error && notice.text.contains("part of the program"), "{notice:?}");
}

#[test]
fn a_deleted_view_comes_back() {
    let mut harness = app();
    show_tab(&mut harness, "Camera");
    let views = harness.state().state().views().to_vec();
    harness.get_by_label("Delete mirror").click_accesskit();
    harness.run_steps(2);
    assert_eq!(harness.state().state().views().len(), views.len() - 1);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    harness.run_steps(2);
    assert_eq!(harness.state().state().views(), views);
}

#[test]
fn a_clicked_object_is_moved_hidden_shown_and_everything_undone() {
    let mut harness = app();
    // The middle of the tall box, as the start view sees it.
    let camera = *harness.state().state().navigation.fly.camera();
    let (to, forward) = (glam::DVec3::new(-2.4, 0.8, -1.2) - camera.eye, camera.forward());
    let right = forward.cross(glam::DVec3::Y).normalize_or(glam::DVec3::X);
    let height = harness.get_by_label("3D viewport").rect().height();
    let scale = f64::from(height) / 2.0 / (camera.fov_y / 2.0).tan() / to.dot(forward);
    let down = -to.dot(right.cross(forward));
    click(&mut harness, (to.dot(right) * scale) as f32, (down * scale) as f32);
    let key = harness.state().state().selection.object.clone().expect("an object");
    assert_eq!(key.to_string(), "tall box");
    let before = document(harness.state()).now().clone();
    let triangles = scene(harness.state()).triangles;
    let newest = harness.state().threads().generation();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::ArrowLeft);
    step_until(&mut harness, "the new scene", |app| app.threads().generation() > newest);
    let moved = document(harness.state()).object(&key).moved_m;
    assert!((moved.x + 0.1).abs() < 1e-9 && moved.y == 0.0 && moved.z == 0.0, "{moved}");
    settle(&mut harness);
    harness.key_press(Key::H);
    step_until(&mut harness, "the box to go", |app| scene(app).triangles + 12 == triangles);
    harness.get_by_label("Unsaved changes");
    harness.get_by_label("Show tall box").click_accesskit();
    step_until(&mut harness, "the box to come back", |app| scene(app).triangles == triangles);
    assert_eq!(document(harness.state()).object(&key).moved_m, moved);
    for _ in 0..3 {
        harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
        harness.step();
    }
    assert_eq!(*document(harness.state()).now(), before);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Y);
    harness.step();
    assert_eq!(document(harness.state()).object(&key).moved_m, moved);
    settle(&mut harness);
}
