//! No panel changes anything by being drawn, or by walking over it with Tab.

use super::*;
use afterimage::Tracer;
use afterimage::camera::CameraPath;
use afterimage::raster::exposure::Exposure;
use afterimage::scene::{LightSetting, Material, MaterialId, MaterialKind, ObjectEdit, SceneEdit};
use afterimage_ui::window::input::playback::{path_secs, with_key};
use afterimage_ui::window::panels;
use afterimage_ui::window::state::{
    AppState, Change, Command, Compare, Document, EditCommand, OpenDocument, SceneInfo, SunControls,
};
use egui::Key;
use glam::{DVec3, Vec3};
use proptest::prelude::*;
use std::sync::OnceLock;

/// The scene that all states show, and what its files hold.
fn room_info() -> &'static (SceneInfo, SceneEdit) {
    static INFO: OnceLock<(SceneInfo, SceneEdit)> = OnceLock::new();
    INFO.get_or_init(|| {
        let tracer = Tracer::new(small_room());
        let source = SceneSource::Ready(small_room());
        (SceneInfo::new(source, &tracer), tracer.scene().to_edit())
    })
}

fn kinds() -> impl Strategy<Value = MaterialKind> {
    let color = || [0.0f32..1.0, 0.0f32..1.0, 0.0f32..1.0].prop_map(Vec3::from_array);
    let roughness = 0.0f32..1.0;
    prop_oneof![
        Just(MaterialKind::Diffuse),
        (color(), any::<bool>())
            .prop_map(|(reflectance, fresnel)| MaterialKind::Mirror { reflectance, fresnel }),
        (1.0f32..10.0, color()).prop_map(|(eta, transmittance)| MaterialKind::Glass { eta, transmittance }),
        (color(), roughness.clone())
            .prop_map(|(reflectance, roughness)| MaterialKind::Glossy { reflectance, roughness }),
        (1.0f32..10.0, color(), roughness).prop_map(|(eta, transmittance, roughness)| {
            MaterialKind::Frosted { eta, transmittance, roughness }
        }),
    ]
}

/// Numbers that sliders cannot hold: with many digits, and outside their ranges.
fn numbers() -> impl Strategy<Value = Vec<f32>> {
    proptest::collection::vec(prop_oneof![0.001f32..1.0, 0.5f32..400.0], 12)
}

fn state_of(kind: MaterialKind, diffuse: [f32; 3], n: &[f32]) -> AppState {
    let (scene, saved) = room_info().clone();
    let mut edit = saved.clone();
    let number = |i: usize| f64::from(n[i]);
    edit.materials[0] =
        Material { kind, diffuse: Vec3::from_array(diffuse), ..Material::diffuse("m", Vec3::ONE) };
    let key = scene.objects.keys().first().cloned();
    if let Some(key) = &key {
        let moved_m = DVec3::new(number(0), -number(1), number(2) / 3.0);
        let turned_deg = number(3) / 7.0;
        edit.objects.insert(key.clone(), ObjectEdit { moved_m, turned_deg, ..ObjectEdit::default() });
    }
    for group in &scene.light_groups {
        let setting = LightSetting { intensity: n[4] / 3.0, color: Vec3::from_array(diffuse), is_on: true };
        edit.lights.set(&group.name, setting);
    }
    let document = Document { scene: edit, sun: sun_of(n), path: Some(path_of(n)), ..Document::default() };
    let mut state = AppState { scene: Some(scene), ..AppState::default() };
    set_quality(&mut state, n);
    state.navigation.playback.at_secs = path_secs(&path_of(n)) * 0.123_456_789;
    state.document = Some(OpenDocument::new(document, state.quality));
    (state.selection.material, state.selection.object) = (Some(MaterialId(0)), key);
    state.knows_lights = true;
    state
}

fn sun_of(n: &[f32]) -> SunControls {
    let number = |i: usize| f64::from(n[i]);
    let mut sun = SunControls { is_by_place: n[5] > 1.0, ..SunControls::default() };
    sun.place.hours = number(5) % 24.0;
    (sun.place.latitude_deg, sun.direction.azimuth_deg) = (number(6) % 90.0, number(6) % 360.0);
    (sun.north_deg, sun.turbidity) = (number(7) % 180.0, 1.0 + n[7] % 9.0);
    sun
}

fn path_of(n: &[f32]) -> CameraPath {
    let key = |i: usize| Camera::look_at(DVec3::X * f64::from(n[i]), DVec3::Y, 60.0);
    let path = with_key(None, &key(0));
    with_key(Some(&with_key(Some(&path), &key(1))), &key(2))
}

fn set_quality(state: &mut AppState, n: &[f32]) {
    let number = |i: usize| f64::from(n[i]);
    let quality = &mut state.quality;
    (quality.render_scale, quality.budget_ms) = (n[8] / 400.0, n[8] * 3.1);
    quality.exposure = if n[8] > 1.0 { Exposure::Stops(n[9] / 17.0) } else { Exposure::Auto };
    quality.walk.placement.percent = number(9) / 3.0;
    quality.walk.cache_bytes = (number(10) * 1e7) as usize;
    quality.walk.render.trace.samples = n[10] as u32;
    (state.comparison.shows, state.comparison.split) = (Compare::Split, n[11] / 400.0);
    state.navigation.fly.jump_to(Camera::look_at(DVec3::ZERO, DVec3::X, 20.0 + number(11) / 5.0));
    state.navigation.fly.set_speed(number(11) / 3.0);
}

fn draw(ui: &mut egui::Ui, state: &AppState, commands: &mut Vec<Command>) {
    panels::menu::show(ui, state, commands);
    panels::scene::show(ui, state, commands);
    panels::views::show(ui, state, commands);
    panels::path::show(ui, state, commands);
    panels::inspector::show(ui, state, commands);
    panels::material::show(ui, state, commands);
    panels::object::show(ui, state, commands);
    panels::daylight::show(ui, state, commands);
    panels::lights::show(ui, state, commands);
    panels::plan::show(ui, state, commands);
    panels::legend::show(ui, state, commands);
    panels::comparison::show(ui, state, commands);
    panels::quality::show(ui, state, commands);
    panels::quality::show_look(ui, state, commands);
    panels::quality::show_movement(ui, state, commands);
    panels::toolbar::show(ui, state, commands);
    panels::references::show(ui, state, commands);
    panels::plots::show(ui, state);
    panels::settings::show(ui.ctx(), state, commands);
}

/// Draws everything twice, presses Tab `tabs` times, and returns the commands that come out.
fn commands_of(state: AppState, is_all_open: bool, tabs: usize) -> Vec<Command> {
    let app = |ui: &mut egui::Ui, (state, commands): &mut (AppState, Vec<Command>)| draw(ui, state, commands);
    let builder = Harness::builder().with_size([500.0, 3600.0]);
    let mut window = builder.build_ui_state(app, (state, Vec::new()));
    // Popups such as those of colours are drawn too.
    window.ctx.memory_mut(|m| m.set_everything_is_visible(is_all_open));
    window.run_steps(2);
    for _ in 0..tabs {
        window.key_press(Key::Tab);
        window.step();
    }
    std::mem::take(&mut window.state_mut().1)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_panel_that_is_only_drawn_changes_nothing(
        kind in kinds(),
        diffuse in [0.0f32..1.0, 0.0f32..1.0, 0.0f32..1.0],
        n in numbers(),
    ) {
        for is_all_open in [false, true] {
            let commands = commands_of(state_of(kind, diffuse, &n), is_all_open, 0);
            prop_assert!(commands.is_empty(), "{commands:?}");
        }
    }
}

#[test]
fn walking_over_all_controls_with_tab_changes_nothing() {
    let kind = MaterialKind::Frosted { eta: 5.432_1, transmittance: Vec3::splat(0.123_4), roughness: 0.5678 };
    for number in [0.001_234_5, 333.333_3] {
        let commands = commands_of(state_of(kind, [0.123_4; 3], &[number; 12]), false, 90);
        assert!(commands.is_empty(), "{commands:?}");
    }
}

/// The roof of a house was changed by clicking on it.
#[test]
fn clicking_a_surface_does_not_edit_it() {
    let mut window = app();
    for [right, down] in [[-20.0, 180.0], [0.0, 0.0], [90.0, -60.0], [-120.0, 40.0]] {
        editing::click(&mut window, right, down);
        window.run_steps(3);
        let state = window.state().state();
        assert!(!state.is_unsaved() && !state.document.as_ref().expect("a scene").can_undo());
    }
    settle(&mut window);
}

#[test]
fn a_path_plays_while_its_panel_is_open() {
    let mut window = app();
    show_tab(&mut window, "Camera");
    window.get_by_label("Camera path").click_accesskit();
    for _ in 0..2 {
        window.key_press(Key::K);
        window.run_steps(2);
    }
    window.key_press(Key::Space);
    window.run_steps(8);
    let playback = &window.state().state().navigation.playback;
    assert!(playback.is_playing && playback.at_secs > 0.01);
    window.key_press(Key::Space);
    settle(&mut window);
}

#[test]
fn a_typed_number_counts_on_enter() {
    let kind = MaterialKind::Glossy { reflectance: Vec3::splat(0.123_456), roughness: 0.654_321 };
    let state = state_of(kind, [0.3; 3], &[0.5; 12]);
    let app = |ui: &mut egui::Ui, (state, commands): &mut (AppState, Vec<Command>)| {
        panels::material::show(ui, state, commands);
    };
    let mut window = Harness::builder().build_ui_state(app, (state, Vec::new()));
    window.run_steps(2);
    window.get_by_role_and_label(egui::accesskit::Role::SpinButton, "Gloss").click();
    window.run_steps(2);
    window.event(egui::Event::Text("75".to_owned()));
    window.run_steps(2);
    assert!(window.state().1.is_empty(), "typing is not finished");
    window.key_press(Key::Enter);
    window.run_steps(2);
    let typed = window.state().1.iter().find_map(|command| match command {
        Command::Edit(EditCommand::Change(Change::Material(_, material))) => match material.kind {
            MaterialKind::Glossy { roughness, .. } => Some(roughness),
            _ => None,
        },
        _ => None,
    });
    assert_eq!(typed, Some(0.25));
}
