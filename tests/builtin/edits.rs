//! Edits of the materials, the sun and the sky of a scene.

use super::scene;
use afterimage::scene::{
    LampGroup, Light, LightGroupKind, LightSetting, MAX_LAMP_GROUPS, MAX_LIGHT_GROUPS, Material,
    MaterialKind, SceneBuilder, Sky, Sun, builtin,
};
use glam::{DVec3, Vec2, Vec3};
use std::collections::BTreeSet;

#[test]
fn a_scene_edited_to_itself_is_the_same_scene() {
    for name in builtin::NAMES {
        let scene = scene(name);
        let same = scene.with_edit(&scene.to_edit());
        assert_eq!((&same.hash, &same.lights), (&scene.hash, &scene.lights), "{name}");
        assert_eq!((same.features, &same.solids), (scene.features, &scene.solids), "{name}");
    }
}

#[test]
fn an_edit_changes_what_depends_on_it_and_can_be_undone() {
    let scene = scene("cornell");
    let mut edit = scene.to_edit();
    edit.materials.iter_mut().for_each(|m| m.emission = Vec3::ZERO);
    edit.materials[0].kind = MaterialKind::Glass { eta: 1.5, transmittance: Vec3::ONE };
    edit.daylight.sky = Some(Sky::even(Vec3::ONE));
    let edited = scene.with_edit(&edit);
    assert_eq!(edited.lights, [Light::Sky]);
    assert!(edited.features.glass && edited.features.sky && !edited.features.area_lights);
    assert_eq!(edited.solids.len(), edited.triangles.len());
    assert_ne!(edited.hash, scene.hash);
    assert_eq!(edited.with_edit(&scene.to_edit()).hash, scene.hash);
}

#[test]
fn the_sun_keeps_its_angular_radius_in_an_edit() {
    let scene = scene("cornell");
    let mut edit = scene.to_edit();
    edit.daylight.sun = Some(Sun::clear_day());
    assert_eq!(scene.with_edit(&edit).to_edit(), edit);
}

#[test]
fn every_light_belongs_to_one_of_a_few_groups() {
    for name in builtin::NAMES {
        let scene = scene(name);
        let groups = &scene.light_groups;
        let names: BTreeSet<&str> = groups.list.iter().map(|group| group.name.as_str()).collect();
        assert!(names.len() == groups.list.len() && names.len() <= MAX_LIGHT_GROUPS, "{name}: {names:?}");
        assert_eq!(groups.of_light.len(), scene.lights.len(), "{name}");
        assert!(groups.of_light.iter().all(|&group| usize::from(group) < groups.list.len()), "{name}");
        let lamps = groups.list.iter().filter(|group| group.kind == LightGroupKind::Lamps).count();
        assert!(lamps <= MAX_LAMP_GROUPS, "{name}");
    }
}

#[test]
fn more_lamps_than_groups_share_the_last() {
    let mut builder = SceneBuilder::new("lamps");
    for lamp in 0..12 {
        let power = Vec3::splat(f32::from(lamp as u8 % 6 + 1));
        let material = builder.add_material(Material::emissive(&format!("lamp {lamp}"), power));
        let corner = DVec3::X * 2.0 * f64::from(lamp);
        let corners = [corner, corner + DVec3::X, corner + DVec3::X + DVec3::Y, corner + DVec3::Y];
        builder.add_quad(corners, Vec2::ONE, material);
    }
    builder.lamp_groups =
        vec![LampGroup { name: "weak".into(), materials: vec!["lamp 0".into(), "lamp 6".into()] }];
    let groups = builder.finish().unwrap().light_groups;
    assert_eq!((groups.list.len(), groups.list[0].name.as_str()), (MAX_LAMP_GROUPS, "weak"));
    assert_eq!((groups.list[1].name.as_str(), groups.list[7].name.as_str()), ("lamp 5", "Other lamps"));
    let sizes: Vec<usize> =
        (0..8).map(|group| groups.of_light.iter().filter(|&&of| of == group).count()).collect();
    assert_eq!(sizes, [2, 1, 1, 1, 1, 1, 1, 4]);
    assert_eq!(groups.of_light, groups.of_material);
}

#[test]
fn lights_are_dimmed_without_losing_their_numbers() {
    let mut builder = SceneBuilder::new("lights");
    let material = builder.add_material(Material::emissive("lamp", Vec3::splat(4.0)));
    let corners = [DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y];
    builder.add_quad(corners, Vec2::ONE, material);
    builder.point_lights.push((DVec3::Z, Vec3::ONE));
    (builder.sun, builder.sky) = (Some(Sun::clear_day()), Some(Sky::even(Vec3::ONE)));
    let scene = builder.finish().unwrap();
    let mut edit = scene.to_edit();
    let red = LightSetting { color: Vec3::new(1.0, 0.5, 0.0), intensity: 2.0, is_on: true };
    edit.lights.set("lamp", red);
    edit.lights.set("Sun", LightSetting { is_on: false, ..LightSetting::FULL });
    edit.lights.set("Sky", LightSetting { intensity: 0.5, ..LightSetting::FULL });
    let dimmed = scene.with_edit(&edit);
    assert_eq!(dimmed.lights.len(), scene.lights.len());
    assert_eq!(dimmed.materials[0].emission, Vec3::new(8.0, 4.0, 0.0));
    assert_eq!(dimmed.sun.unwrap().irradiance, Vec3::ZERO);
    assert_eq!(dimmed.sky.as_ref().unwrap().radiance(Vec3::Y), Vec3::splat(0.5));
    assert_eq!((dimmed.to_edit(), dimmed.full_hash()), (edit.clone(), scene.hash.as_str()));
    assert_ne!(dimmed.hash, scene.hash);
    // The settings stay when something else is edited, and all can be undone.
    edit.materials[0].diffuse = Vec3::splat(0.5);
    let painted = dimmed.with_edit(&edit);
    assert_eq!((painted.lights.len(), painted.sky), (4, dimmed.sky.clone()));
    assert_eq!(painted.lights, dimmed.lights);
    assert_eq!(dimmed.with_edit(&scene.to_edit()).hash, scene.hash);
}
