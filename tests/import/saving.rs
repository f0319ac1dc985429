//! Saving edited materials and daylight next to a model.

use super::Folder;
use afterimage::import::{EditFolder, apply_edit_text, edit_text, save_edit};
use afterimage::scene::{
    Daylight, DaylightModel, Ground, GroundChoice, LightSetting, Material, SceneBuilder, SceneEdit, SkyKind,
    solar::SunPosition,
};
use glam::{DVec3, Vec3};
use std::fs;

const MODEL: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\n\
                     usemtl wall\nf 1 2 3\nusemtl pane\nf 1 3 4\nusemtl floor\nf 1 2 6 5\n";

const WRITTEN: &str = "# my notes\nunit = \"m\" # metres\n\n[[material]]\nname = \"wall\"\n\
                       diffuse = [0.1, 0.2, 0.3] # painted\n\n[extra]\nkept = true\n\n\
                       [[material]]\nname = \"pane\"\nkind = \"mirror\"\n";

#[test]
fn a_saved_edit_is_imported_again_and_everything_else_is_kept() {
    let folder = Folder::with_obj(MODEL).add("scene.afterimage.toml", WRITTEN);
    let before = folder.load().to_edit();
    let mut now = before.clone();
    let find = |name: &str| before.materials.iter().position(|m| m.name == name).unwrap();
    now.materials[find("wall")].diffuse = Vec3::new(0.7, 0.05, 1.0 / 3.0);
    now.materials[find("pane")] = Material::glass("pane", 1.52, Vec3::new(0.9, 0.95, 0.9));
    now.materials[find("floor")] = Material::mirror("floor", Vec3::splat(0.8));
    let position = SunPosition { azimuth_deg: 200.0, height_deg: 30.0 };
    now.daylight = DaylightModel::new(SkyKind::Gradient, position).daylight();
    let file = save_edit(&folder.path("scene.obj"), &before, &now).unwrap();
    assert_eq!(file, folder.path("scene.afterimage.toml"));
    let again = folder.load().to_edit();
    assert_eq!(again.materials, now.materials);
    let (sun, wanted) = (again.daylight.sun.unwrap(), now.daylight.sun.unwrap());
    assert!((sun.direction - wanted.direction).length() < 1e-6);
    assert!((sun.angular_radius / wanted.angular_radius - 1.0).abs() < 1e-6);
    assert_eq!((sun.irradiance, again.daylight.sky), (wanted.irradiance, now.daylight.sky.clone()));
    let text = fs::read_to_string(&file).unwrap();
    for kept in ["# my notes\nunit = \"m\" # metres\n", "# painted", "[extra]\nkept = true"] {
        assert!(text.contains(kept), "{kept:?} is gone from:\n{text}");
    }
    assert_eq!(text.matches("\"wall\"").count(), 1);
    save_edit(&folder.path("scene.obj"), &now, &now).unwrap();
    assert_eq!(fs::read_to_string(&file).unwrap(), text, "without a difference nothing is written");
}

#[test]
fn a_ground_is_saved_and_imported_again_and_so_is_that_there_is_none() {
    let folder = Folder::with_obj(MODEL);
    let before = folder.load().to_edit();
    let ground = Some(Ground { height_m: -0.45, albedo: 0.25 });
    let now = SceneEdit { ground, ..before.clone() };
    save_edit(&folder.path("scene.obj"), &before, &now).unwrap();
    let scene = folder.load();
    assert_eq!((scene.ground(), scene.is_ground_given), (ground, true));
    assert!(scene.warnings.iter().all(|w| w.file != "scene.afterimage.toml"), "{:?}", scene.warnings);
    save_edit(&folder.path("scene.obj"), &now, &before).unwrap();
    let scene = folder.load();
    assert_eq!(scene.ground(), None);
    assert_eq!(
        scene.with_ground_choice(GroundChoice::Auto).ground(),
        None,
        "the file says that there is none"
    );
}

#[test]
fn every_kind_of_sky_is_saved_and_imported_again() {
    let folder = Folder::with_obj(MODEL);
    let before = folder.load().to_edit();
    for kind in SkyKind::MODELS {
        let position = SunPosition { azimuth_deg: 120.0, height_deg: 25.0 };
        let model = DaylightModel { turbidity: 4.5, ..DaylightModel::new(kind, position) };
        let now = SceneEdit { daylight: model.daylight(), ..before.clone() };
        save_edit(&folder.path("scene.obj"), &before, &now).unwrap();
        let (scene, wanted) = (folder.load(), now.daylight.sky.unwrap());
        assert!(scene.warnings.iter().all(|w| w.file != "scene.afterimage.toml"), "{:?}", scene.warnings);
        let (found, d) = (scene.sky.unwrap(), Vec3::new(0.6, 0.64, 0.48));
        assert_eq!((found.kind(), scene.sun.is_some()), (kind, kind != SkyKind::Overcast));
        assert!((found.radiance(d) / wanted.radiance(d) - 1.0).abs().max_element() < 1e-4, "{kind:?}");
        assert!((found.radiance(-d) / wanted.radiance(-d) - 1.0).abs().max_element() < 1e-4, "{kind:?}");
    }
}

#[test]
fn a_file_that_is_not_valid_toml_is_not_changed() {
    let folder = Folder::with_obj(MODEL);
    let before = folder.load().to_edit();
    let mut now = before.clone();
    now.materials[0].diffuse = Vec3::ZERO;
    for broken in ["material = 3\n", "[[material\n"] {
        let file = folder.path("scene.afterimage.toml");
        fs::write(&file, broken).unwrap();
        let error = save_edit(&folder.path("scene.obj"), &before, &now).unwrap_err();
        assert!(error.to_string().contains("scene.afterimage.toml"), "{error}");
        assert_eq!(fs::read_to_string(&file).unwrap(), broken);
    }
}

#[test]
fn settings_of_lights_are_saved_and_imported_again() {
    let mtl = "newmtl wall\nKd 0.5 0.5 0.5\nnewmtl pane\nKe 1 1 1\nnewmtl floor\nKe 2 2 2\n";
    let notes = "# mine\n[[lights]]\nname = \"both\" # together\nmaterials = [\"pane\", \"floor\"]\n";
    let model = format!("mtllib scene.mtl\n{MODEL}");
    let folder = Folder::with_obj(&model).add("scene.mtl", mtl).add("scene.afterimage.toml", notes);
    let scene = folder.load();
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    let names: Vec<&str> = scene.light_groups.list.iter().map(|group| group.name.as_str()).collect();
    assert_eq!((names, &scene.light_groups.of_light[..]), (vec!["both"], &[0, 0][..]));
    let before = scene.to_edit();
    let mut now = before.clone();
    let color = Vec3::new(1.0, 0.5, 1.0 / 3.0);
    now.lights.set("both", LightSetting { is_on: false, intensity: 0.3, color });
    now.lights.set("Sky", LightSetting { intensity: 2.0, ..LightSetting::FULL });
    let file = save_edit(&folder.path("scene.obj"), &before, &now).unwrap();
    let again = folder.load();
    assert_eq!((&again.to_edit(), again.full_hash()), (&now, scene.hash.as_str()));
    assert!(again.materials.iter().all(|material| !material.is_emissive()));
    save_edit(&folder.path("scene.obj"), &now, &before).unwrap();
    assert_eq!(fs::read_to_string(&file).unwrap(), notes, "only settings are written");
    assert_eq!(folder.load().hash, scene.hash);
}

#[test]
fn a_model_without_lamps_stays_dark_where_its_sun_and_sky_were_switched_off() {
    let folder = Folder::with_obj(MODEL);
    let lit = folder.load();
    assert!(lit.sun.is_some() && lit.sky.is_some() && !lit.warnings.is_empty(), "it has no light of its own");
    let before = lit.to_edit();
    let (sun, sky) = (before.daylight.sun, before.daylight.sky.clone());
    let mut saved = before.clone();
    let parts = [(None, None), (sun, None), (None, sky.clone()), (None, None), (sun, sky)];
    for (sun, sky) in parts {
        let now = SceneEdit { daylight: Daylight { sun, sky }, ..before.clone() };
        save_edit(&folder.path("scene.obj"), &saved, &now).unwrap();
        let scene = folder.load();
        assert_eq!(scene.to_edit().daylight.sky, now.daylight.sky);
        assert_eq!(scene.sun.is_some(), now.daylight.sun.is_some());
        assert!(scene.warnings.iter().all(|w| !w.message.contains("light")), "{:?}", scene.warnings);
        saved = now;
    }
}

#[test]
fn a_part_of_the_daylight_that_the_file_switches_off_is_not_added_to_a_dark_model() {
    let folder = Folder::with_obj(MODEL).add("scene.afterimage.toml", "[sun]\noff = true\n");
    let scene = folder.load();
    assert!(scene.sun.is_none() && scene.sky.is_some());
    assert!(scene.warnings.iter().any(|w| w.message.contains("a sky was added")), "{:?}", scene.warnings);
}

#[test]
fn each_of_several_materials_of_one_name_is_changed_alone() {
    let mut builder = SceneBuilder::new("test");
    let quad = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y];
    for shade in [0.2, 0.4, 0.6] {
        let id = builder.add_material(Material::diffuse("wood", Vec3::splat(shade)));
        builder.add_quad(quad.map(|p| p + DVec3::Z * f64::from(shade)), glam::Vec2::ONE, id);
    }
    let scene = builder.finish().unwrap();
    let (before, folder) = (scene.to_edit(), EditFolder { model: None, allow_outside: false });
    let mut now = before.clone();
    now.materials[1] = Material::mirror("wood", Vec3::splat(0.8));
    now.materials[2].diffuse = Vec3::X;
    let text = edit_text(folder, &before, &now).unwrap();
    let again = apply_edit_text(&text, folder, &scene, &before).unwrap();
    assert_eq!((again.edit, again.messages), (now, Vec::new()), "{text}");
    let mixed = "[[material]]\nname = 'wood'\nnumber = 3\ndiffuse = 0.1\n\
                 [[material]]\nname = 'wood'\ndiffuse = 0.9\n[[material]]\nname = 'wood'\nnumber = 4\n";
    let mixed = apply_edit_text(mixed, folder, &scene, &before).unwrap();
    let shades: Vec<f32> = mixed.edit.materials.iter().map(|m| m.diffuse.x).collect();
    assert_eq!(shades, [0.9, 0.9, 0.1], "one counts more than all");
    assert!(mixed.messages.iter().any(|m| m.contains("no material 'wood' number 4")), "{:?}", mixed.messages);
}
