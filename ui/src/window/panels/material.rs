//! The editor of the selected material: matte, glossy, mirror, glass or frosted glass.

use super::super::state::{
    AppState, COAT, Change, Command, EditCommand, InspectCommand, MaterialPreset, OpenDocument, gloss_of,
    with_gloss,
};
use super::{color::color_button, numbers::Number, widgets::key_hint};
use crate::window::input::keymap::Action;
use crate::window::rendering::scene_loading::SceneSource;
use afterimage::scene::{Material, MaterialId, MaterialKind};
use egui::Ui;
use glam::Vec3;

/// Shows the selected material, its controls, and undo.
pub fn show(ui: &mut Ui, state: &AppState, commands: &mut Vec<Command>) {
    let Some(document) = &state.document else {
        ui.weak("No scene yet.");
        return;
    };
    let chosen = state.selection.material.filter(|id| (id.0 as usize) < document.scene().materials.len());
    choice(ui, state, document, chosen, commands);
    match chosen {
        None => {
            ui.weak("Click a surface or select a material.");
        }
        Some(id) => {
            let material = &document.scene().materials[id.0 as usize];
            let before = &document.files().scene.materials[id.0 as usize];
            if let Some([number, count]) = state.number_of_name(id) {
                ui.weak(format!(
                    "{number} of {count} materials named {}: only this one is changed.",
                    material.name
                ));
            }
            let chosen = ready_made(ui, state, id, material, commands);
            let edited = chosen.unwrap_or_else(|| controls(ui, material, before));
            if edited != *material {
                commands.push(Command::Edit(EditCommand::Change(Change::Material(id, Box::new(edited)))));
            }
        }
    }
    history(ui, state, document, commands);
}

/// Shows the list of materials to choose from, and the button that copies one of a surface. Returns
/// the material with what was chosen.
fn ready_made(
    ui: &mut Ui,
    state: &AppState,
    id: MaterialId,
    material: &Material,
    commands: &mut Vec<Command>,
) -> Option<Material> {
    let mut chosen = None;
    ui.horizontal(|ui| {
        let is_it =
            |preset: &&MaterialPreset| preset.kind == material.kind && preset.diffuse == material.diffuse;
        let shown = MaterialPreset::ALL.iter().find(is_it).map_or("Choose a material", |preset| preset.name);
        let combo = egui::ComboBox::from_id_salt("ready made").selected_text(shown).width(170.0);
        let response = combo.show_ui(ui, |ui| {
            for preset in &MaterialPreset::ALL {
                if ui.selectable_label(is_it(&preset), preset.name).clicked() {
                    chosen = Some(preset.applied_to(material));
                    ui.close();
                }
            }
        });
        response.response.accessible_name("Ready-made material");
        let help =
            "Then click the surface that this material shall look like, or choose a material in the list";
        let picks = state.selection.dropper.is_some();
        if ui
            .selectable_label(picks, "Pick")
            .on_hover_text(help)
            .accessible_name("Copy from a surface")
            .clicked()
        {
            commands.push(Command::Inspect(InspectCommand::ToggleDropper(id)));
        }
    });
    if material.diffuse_texture.is_some() {
        ui.weak("Its picture stays, whatever is chosen.");
    }
    chosen
}

fn choice(
    ui: &mut Ui,
    state: &AppState,
    document: &OpenDocument,
    chosen: Option<MaterialId>,
    commands: &mut Vec<Command>,
) {
    let materials = &document.scene().materials;
    let name_of = |id: MaterialId| {
        let name = &materials[id.0 as usize].name;
        match state.number_of_name(id) {
            Some([number, count]) => format!("{name} ({number} of {count})"),
            None => name.clone(),
        }
    };
    let name = chosen.map_or("none selected".to_owned(), name_of);
    let combo = egui::ComboBox::from_id_salt("chosen material").selected_text(name).width(230.0).truncate();
    let response = combo.show_ui(ui, |ui| {
        // Only visible rows are laid out: a model may have thousands of materials.
        let height = ui.text_style_height(&egui::TextStyle::Button) + 2.0 * ui.spacing().button_padding.y;
        egui::ScrollArea::vertical().max_height(240.0).show_rows(ui, height, materials.len(), |ui, rows| {
            for i in rows {
                let id = MaterialId(i as u32);
                if ui.selectable_label(chosen == Some(id), name_of(id)).clicked() {
                    commands.push(Command::Inspect(InspectCommand::SelectMaterial(id)));
                }
            }
        });
    });
    response.response.accessible_name("Material to change");
}

/// Shows the controls and returns the edited material.
fn controls(ui: &mut Ui, material: &Material, before: &Material) -> Material {
    let mut edited = material.clone();
    ui.horizontal_wrapped(|ui| {
        let kind = std::mem::discriminant(&material.kind);
        let kinds = [
            ("Matte", matte(material, before)),
            ("Glossy", glossy(material, before)),
            ("Mirror", mirror(material)),
            ("Glass", glass(material)),
            ("Frosted", frosted(material)),
        ];
        for (name, other) in kinds {
            let is_it = std::mem::discriminant(&other.kind) == kind;
            if ui.radio(is_it, name).clicked() && !is_it {
                edited = other;
            }
        }
    });
    ui.spacing_mut().slider_width = 110.0;
    gloss_row(ui, &mut edited);
    egui::Grid::new("material controls").num_columns(2).min_col_width(84.0).show(ui, |ui| match &mut edited
        .kind
    {
        MaterialKind::Diffuse => {
            let name = if material.diffuse_texture.is_some() { "Texture tint" } else { "Colour" };
            color_row(ui, name, &mut edited.diffuse);
            brightness_row(ui, "Brightness", &mut edited.diffuse);
        }
        MaterialKind::Mirror { reflectance, fresnel } => {
            color_row(ui, "Colour", reflectance);
            brightness_row(ui, "Reflectance", reflectance);
            let label = ui.label("Grazing angles");
            ui.checkbox(fresnel, "reflect fully").labelled_by(label.id);
            ui.end_row();
        }
        MaterialKind::Glass { eta, transmittance } => {
            refraction_row(ui, eta);
            color_row(ui, "Tint", transmittance);
        }
        MaterialKind::Glossy { reflectance, .. } => {
            let name = if material.diffuse_texture.is_some() { "Texture tint" } else { "Base colour" };
            color_row(ui, name, &mut edited.diffuse);
            color_row(ui, "Reflection", reflectance);
            brightness_row(ui, "Reflectance", reflectance);
        }
        MaterialKind::Frosted { eta, transmittance, .. } => {
            refraction_row(ui, eta);
            color_row(ui, "Tint", transmittance);
        }
    });
    let by_picture = material.varies_by_picture();
    if !by_picture.is_empty() {
        ui.weak(format!("By picture: {}.", by_picture.join(", ")));
    }
    if material.is_emissive() {
        ui.weak("This material also emits light; its emission is not edited here.");
    }
    edited
}

fn refraction_row(ui: &mut Ui, eta: &mut f32) {
    let label = ui
        .label("Refraction")
        .on_hover_text("Index of refraction: water 1.33, window glass 1.52, diamond 2.42");
    Number::new(1.0..=3.0, 2, "").slider(ui, eta).labelled_by(label.id);
    ui.end_row();
}

/// Shows the gloss. It keeps its place among the controls while the kind changes under it.
fn gloss_row(ui: &mut Ui, edited: &mut Material) {
    let before = gloss_of(edited);
    let mut gloss = before;
    ui.push_id("gloss", |ui| {
        ui.horizontal(|ui| {
            let help = "0 % is matte, 50 % brushed metal, 70 % satin varnish, 100 % polished. It is one minus the roughness.";
            let label = ui.label("Gloss").on_hover_text(help);
            Number::percent(0.0..=100.0).slider(ui, &mut gloss).labelled_by(label.id);
        });
    });
    if gloss != before {
        *edited = with_gloss(edited, gloss);
    }
}

fn color_row(ui: &mut Ui, name: &str, color: &mut Vec3) {
    let label = ui.label(name);
    color_button(ui, name, color).labelled_by(label.id);
    ui.end_row();
}

/// A slider for the largest channel in percent; the ratios of the channels are kept.
fn brightness_row(ui: &mut Ui, name: &str, color: &mut Vec3) {
    let label = ui.label(name);
    let largest = color.max_element();
    let mut wanted = largest;
    Number::percent(0.0..=100.0).slider(ui, &mut wanted).labelled_by(label.id);
    if wanted != largest {
        let share = if largest > 0.0 { *color / largest } else { Vec3::ONE };
        *color = share * wanted;
    }
    ui.end_row();
}

/// The material made matte, with its own colour, the colour in its file, or that of a typical wall.
fn matte(material: &Material, before: &Material) -> Material {
    let color = [material.diffuse, before.diffuse].into_iter().find(|c| c.max_element() > 0.0);
    let diffuse = color.unwrap_or(Vec3::splat(0.7));
    Material { kind: MaterialKind::Diffuse, diffuse, ..material.clone() }
}

fn mirror(material: &Material) -> Material {
    let kind = MaterialKind::Mirror { reflectance: Vec3::splat(0.9), fresnel: false };
    Material { kind, diffuse: Vec3::ZERO, ..material.clone() }
}

fn glass(material: &Material) -> Material {
    let kind = MaterialKind::Glass { eta: 1.52, transmittance: Vec3::splat(0.95) };
    Material { kind, diffuse: Vec3::ZERO, ..material.clone() }
}

/// The material under a satin varnish; a mirror becomes rough metal.
fn glossy(material: &Material, before: &Material) -> Material {
    let is_metal = matches!(material.kind, MaterialKind::Mirror { .. });
    let (reflectance, base) = match is_metal {
        true => (material.specular(), Vec3::ZERO),
        false => (Vec3::splat(COAT), matte(material, before).diffuse),
    };
    let kind = MaterialKind::Glossy { reflectance, roughness: 0.3 };
    Material { kind, diffuse: base, ..material.clone() }
}

fn frosted(material: &Material) -> Material {
    let kind = MaterialKind::Frosted { eta: 1.52, transmittance: Vec3::splat(0.95), roughness: 0.3 };
    Material { kind, diffuse: Vec3::ZERO, ..material.clone() }
}

fn history(ui: &mut Ui, state: &AppState, document: &OpenDocument, commands: &mut Vec<Command>) {
    ui.horizontal_wrapped(|ui| {
        let mut button = |ui: &mut Ui, text: &str, is_enabled: bool, help: String, editing: EditCommand| {
            let button = ui.add_enabled(is_enabled, egui::Button::new(text));
            if button.on_hover_text(&help).on_disabled_hover_text(help).clicked() {
                commands.push(Command::Edit(editing));
            }
        };
        button(ui, "Undo", document.can_undo(), key_hint(Action::Undo), EditCommand::Undo);
        button(ui, "Redo", document.can_redo(), key_hint(Action::Redo), EditCommand::Redo);
        let is_file = state.scene.as_ref().is_some_and(|s| matches!(s.source, SceneSource::File { .. }));
        let help = if is_file {
            "Save materials, objects, sun, sky, ground and lights in the sidecar (.afterimage.toml) of the model; the model itself is not changed"
        } else {
            "This scene is built in; open a model file to save changes"
        };
        let can_save = document.differs_from_files() && is_file;
        button(ui, "Save changes", can_save, help.to_owned(), EditCommand::SaveSidecar);
    });
}
