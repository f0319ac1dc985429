//! Edits of the materials, the sun and the sky of a scene.

use super::scene;
use afterimage::scene::{Light, MaterialKind, Sky, Sun, builtin};
use glam::Vec3;

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
