//! Ready-made materials, gloss, and the look of one surface copied to another.

use super::editing::click;
use super::*;
use afterimage::scene::{Material, MaterialId, MaterialKind};
use afterimage_ui::window::state::MaterialPreset;
use egui::{Key, Modifiers};

fn material(app: &App, id: MaterialId) -> &Material {
    &app.state().document.as_ref().expect("a document").scene().materials[id.0 as usize]
}

fn chosen(app: &App) -> MaterialId {
    app.state().selection.material.expect("a material was clicked")
}

/// The room with its floor selected.
fn room_with_floor() -> (Harness<'static, App>, MaterialId) {
    let mut window = app();
    click(&mut window, 0.0, 180.0);
    let floor = chosen(window.state());
    (window, floor)
}

/// Makes the window so high that nothing in the panel is scrolled out of it.
fn show_whole_panel(window: &mut Harness<'static, App>) {
    window.set_size(egui::vec2(900.0, 2000.0));
    window.run_steps(3);
}

#[test]
fn a_ready_made_material_is_chosen_by_keyboard_and_undone() {
    let (mut window, floor) = room_with_floor();
    let before = material(window.state(), floor).clone();
    show_whole_panel(&mut window);
    window.get_by_label("Ready-made material").focus();
    window.run_steps(2);
    window.key_press(Key::Space);
    window.run_steps(3);
    window.get_by_label("Concrete").click_accesskit();
    window.run_steps(3);
    let preset = MaterialPreset::ALL.iter().find(|preset| preset.name == "Concrete").expect("it is offered");
    assert_eq!(*material(window.state(), floor), preset.applied_to(&before));
    window.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    window.run_steps(3);
    assert_eq!(*material(window.state(), floor), before);
    settle(&mut window);
}

#[test]
fn gloss_is_typed_and_a_matte_floor_becomes_varnished() {
    let (mut window, floor) = room_with_floor();
    assert_eq!(material(window.state(), floor).kind, MaterialKind::Diffuse);
    show_whole_panel(&mut window);
    window.get_by_role_and_label(egui::accesskit::Role::SpinButton, "Gloss").click();
    window.run_steps(2);
    window.event(egui::Event::Text("70".to_owned()));
    window.key_press(Key::Enter);
    window.run_steps(3);
    let MaterialKind::Glossy { roughness, .. } = material(window.state(), floor).kind else {
        panic!("it has a coat");
    };
    assert!((roughness - 0.3).abs() < 1e-6);
    settle(&mut window);
}

#[test]
fn the_look_of_a_clicked_surface_is_copied_and_escape_ends_picking() {
    let (mut window, floor) = room_with_floor();
    window.get_by_label("Mirror").click_accesskit();
    window.run_steps(3);
    settle(&mut window);
    click(&mut window, 0.0, -40.0);
    let other = chosen(window.state());
    assert_ne!(other, floor, "another surface");
    let before = material(window.state(), other).clone();
    window.get_by_label("Copy from a surface").click_accesskit();
    window.run_steps(3);
    assert!(window.query_by_label_contains("shall look like").is_some(), "a banner says what a click does");
    window.key_press(Key::Escape);
    window.run_steps(2);
    assert!(window.state().state().selection.dropper.is_none());
    window.get_by_label("Copy from a surface").click_accesskit();
    window.run_steps(3);
    click(&mut window, 0.0, 180.0);
    window.run_steps(3);
    let copy = material(window.state(), other);
    assert_eq!((copy.kind, &copy.name), (material(window.state(), floor).kind, &before.name));
    assert_eq!(chosen(window.state()), other, "the material that was changed stays chosen");
    settle(&mut window);
}
