//! A ground that is added below a model.

use crate::rooms::cuboid;
use afterimage::math::Ray;
use afterimage::scene::{
    Daylight, Ground, GroundAdvice, GroundChoice, Material, Scene, SceneBuilder, SceneEdit, Sun,
};
use afterimage::trace::TraceSettings;
use afterimage::{Tracer, View};
use glam::{DVec3, Vec2, Vec3};
use std::sync::Arc;

/// A house of 8 x 4 x 6 m without a ground, in sun and sky; all lengths times `scale`.
fn house(scale: f64) -> SceneBuilder {
    let mut b = SceneBuilder::new("house");
    let wall = b.add_material(Material::diffuse("wall", Vec3::splat(0.6)));
    let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z) * scale;
    cuboid(&mut b, at(0.0, 1.0, 0.0), at(8.0, 5.0, 6.0), wall, false);
    b
}

fn finished(b: SceneBuilder) -> Scene {
    b.finish().unwrap()
}

#[test]
fn a_ground_comes_and_goes_and_leaves_every_bit_of_the_model() {
    let bare = finished(house(1.0));
    let grounded = bare.with_ground_choice(GroundChoice::Auto);
    assert_eq!(grounded.ground(), Some(Ground { height_m: 1.0, albedo: Ground::DEFAULT_ALBEDO }));
    let count = bare.triangles.len();
    assert_eq!(grounded.triangles[..count], bare.triangles[..]);
    assert_eq!(grounded.positions[..bare.positions.len()], bare.positions[..]);
    assert!(grounded.is_added_ground(count as u32) && !grounded.is_added_ground(count as u32 - 1));
    assert_eq!((grounded.bounds_m, grounded.building_m), (bare.bounds_m, bare.building_m));
    assert_eq!(grounded.frame, bare.frame);
    assert!(grounded.hash != bare.hash);
    let again = grounded.with_ground_choice(GroundChoice::Off);
    assert!(again.hash == bare.hash && again.has_same_geometry(&bare));
    assert_eq!((again.to_edit(), again.materials.len()), (bare.to_edit(), bare.materials.len()));
}

#[test]
fn other_edits_keep_the_geometry_of_a_ground_and_undo_brings_its_hash_back() {
    let grounded = finished(house(1.0)).with_ground_choice(GroundChoice::Auto);
    let edit = grounded.to_edit();
    let sun = Some(Sun { direction: Vec3::new(0.8, 0.6, 0.0), ..Sun::clear_day() });
    let mut evening = SceneEdit { daylight: Daylight { sun, ..edit.daylight.clone() }, ..edit.clone() };
    evening.materials[0].diffuse = Vec3::new(0.7, 0.2, 0.1);
    let moved = grounded.with_edit(&evening);
    assert!(moved.has_same_geometry(&grounded), "the hierarchy is kept");
    assert_eq!((moved.ground(), moved.to_edit()), (grounded.ground(), evening));
    assert_eq!(moved.with_edit(&edit).hash, grounded.hash);
    let darker = SceneEdit { ground: Some(Ground { albedo: 0.1, ..edit.ground.unwrap() }), ..edit.clone() };
    let darker = grounded.with_edit(&darker);
    assert!(darker.has_same_geometry(&grounded) && darker.hash != grounded.hash);
    let far = SceneEdit { ground: Some(Ground { height_m: 1e9, albedo: 0.3 }), ..edit };
    assert_eq!(grounded.with_edit(&far).ground(), None, "it cannot be that far away");
}

#[test]
fn the_ground_has_the_same_bits_at_any_power_of_two() {
    let of = |scale| finished(house(scale)).with_ground_choice(GroundChoice::Auto);
    let (one, far) = (of(1.0), of(1024.0));
    assert_eq!((&one.positions, &one.triangles), (&far.positions, &far.triangles));
}

#[test]
fn a_house_throws_its_shadow_on_the_ground_and_a_floor_at_its_height_is_seen() {
    let mut b = house(1.0);
    // A terrace at the very height of the ground.
    let terrace = b.add_material(Material::diffuse("terrace", Vec3::splat(0.5)));
    let at = |x: f64, z: f64| DVec3::new(x, 1.0, z);
    b.add_quad([at(8.0, 0.0), at(8.0, 6.0), at(10.0, 6.0), at(10.0, 0.0)], Vec2::ONE, terrace);
    b.sun = Some(Sun { direction: Vec3::new(0.6, 0.8, 0.0), ..Sun::clear_day() });
    let tracer = Tracer::new(Arc::new(finished(b).with_ground_choice(GroundChoice::Auto)));
    let scene = tracer.scene().clone();
    let seen = |x: f64, z: f64, from_m: f64| {
        let eye = scene.frame.scene_from_world_f64(DVec3::new(x, from_m, z)).as_vec3();
        tracer.closest(&Ray::new(eye, Vec3::NEG_Y)).map(|hit| scene.material_of(hit.triangle).name.clone())
    };
    for from_m in [2.0, 50.0, 200.0] {
        for i in 0..40 {
            let along = 0.07 + f64::from(i) * 0.149;
            assert_eq!(seen(8.5, along, from_m).as_deref(), Some("terrace"), "{from_m} {along}");
            assert_eq!(seen(-3.0, along, from_m).as_deref(), Some("Ground"));
        }
    }
    let settings = TraceSettings { samples: 4, bounces: 0, seed: 0 };
    let light = |x: f64| {
        let camera = afterimage::Camera::look_at(DVec3::new(x, 9.0, 3.0), DVec3::new(x, 1.0, 3.01), 2.0);
        let view = View::new(&camera, &scene.frame, [1, 1]);
        tracer.pixel(&view, 0, &settings, &mut Default::default()).radiance.y
    };
    assert!(light(-1.0) < 0.2 * light(-12.0), "{} in the shadow of {}", light(-1.0), light(-12.0));
}

#[test]
fn only_daylit_models_without_a_ground_get_one() {
    let mut lawn = house(1.0);
    let grass = lawn.add_material(Material::diffuse("grass", Vec3::new(0.1, 0.3, 0.1)));
    let at = |x: f64, z: f64| DVec3::new(x, 0.9, z);
    lawn.add_quad([at(-20.0, -20.0), at(-20.0, 30.0), at(30.0, 30.0), at(30.0, -20.0)], Vec2::ONE, grass);
    let lawn = finished(lawn);
    assert_eq!(lawn.ground_advice(), GroundAdvice::HasOwn);
    assert_eq!(lawn.with_ground_choice(GroundChoice::Auto).hash, lawn.hash);
    let mut lamp = house(1.0);
    lamp.point_lights.push((DVec3::new(4.0, 3.0, 3.0), Vec3::ONE));
    assert_eq!(finished(lamp).ground_advice(), GroundAdvice::NoDaylight);
    assert_eq!(finished(house(1.0)).ground_advice(), GroundAdvice::Wanted);
}

#[test]
fn the_start_view_and_the_exposure_do_not_see_the_ground() {
    let started = |scene: Scene| Tracer::new(Arc::new(scene)).with_start_view();
    let bare = started(finished(house(1.0)));
    let grounded = started(finished(house(1.0)).with_ground_choice(GroundChoice::Auto));
    assert_eq!(bare.scene().views, grounded.scene().views);
    for tracer in [&bare, &grounded] {
        assert!(tracer.measure_light(&|_| {}, &|| false));
    }
    let [a, b] = [&bare, &grounded].map(|tracer| tracer.metered().unwrap().ev());
    assert!((a - b).abs() < 0.5, "only the light from the ground differs: {a} and {b}");
}
