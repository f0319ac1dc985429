//! The automatic exposure.

use crate::rooms::{cuboid, dvec, quad, room_tracer};
use afterimage::camera::{CameraKey, CameraPath};
use afterimage::raster::exposure::{Exposure, Metered, decimal};
use afterimage::scene::{Gradient, Material, NamedView, Scene, SceneBuilder, Sky, builtin};
use afterimage::trace::parallel::NEVER;
use afterimage::{Camera, Tracer};
use glam::Vec3;
use std::sync::Arc;

fn metered(scene: Scene) -> Metered {
    let tracer = Tracer::new(Arc::new(scene));
    assert!(tracer.measure_light(&|_| (), NEVER));
    tracer.metered().unwrap()
}

fn ev(scene: Scene) -> f64 {
    match metered(scene) {
        Metered::Stops(ev) => f64::from(ev),
        Metered::Dark => panic!("there is light"),
    }
}

/// A room with a window to an even sky, in which lamp and sky have `light` times their radiance and
/// all lengths are `scale` times theirs.
fn lit_room(light: f32, scale: f64) -> Scene {
    let mut b = SceneBuilder::new("lit room");
    let wall = b.add_material(Material::diffuse("wall", Vec3::new(0.7, 0.6, 0.5)));
    let lamp = b.add_material(Material::emissive("lamp", Vec3::splat(3.0 * light)));
    let at = |x: f64, y: f64, z: f64| dvec(x, y, z) * scale;
    cuboid(&mut b, at(-3.0, 0.0, -4.0), at(3.0, 3.0, 4.0), wall, true);
    cuboid(&mut b, at(-1.5, 0.0, -2.0), at(-0.5, 1.2, -1.0), wall, false);
    quad(&mut b, at(-0.5, 2.9, -0.5), at(1.0, 0.0, 0.0), at(0.0, 0.0, 1.0), lamp);
    b.sky = Some(even_sky(light));
    let key = |x: f64, z: f64| CameraKey::new(at(x, 1.6, z), at(0.0, 1.6, 0.0));
    let start = Camera::look_at(at(0.0, 1.6, 3.0), at(0.0, 1.6, -4.0), 65.0);
    b.views.push(NamedView { name: "start".to_owned(), camera: start });
    b.walk = Some(CameraPath { fov_y_deg: 65.0, frames: 9, keyframes: vec![key(2.0, 3.0), key(-2.0, 1.0)] });
    b.finish().unwrap()
}

fn even_sky(radiance: f32) -> Sky {
    let radiance = Vec3::splat(radiance);
    Sky::Gradient(Gradient { zenith: radiance, horizon: radiance, ground: radiance })
}

/// A floor of one albedo under an even sky, seen from above.
fn floor(albedo: f32, sky: f32) -> Scene {
    let mut b = SceneBuilder::new("floor");
    let floor = b.add_material(Material::diffuse("floor", Vec3::splat(albedo)));
    quad(&mut b, dvec(-9.0, 0.0, 9.0), dvec(18.0, 0.0, 0.0), dvec(0.0, 0.0, -18.0), floor);
    b.sky = Some(even_sky(sky));
    let start = Camera::look_at(dvec(0.0, 2.0, 3.0), dvec(0.0, 0.0, 0.0), 65.0);
    b.views.push(NamedView { name: "start".to_owned(), camera: start });
    b.finish().unwrap()
}

#[test]
fn twice_the_light_is_one_stop_less() {
    let once = ev(lit_room(1.0, 1.0));
    for (light, stops) in [(2.0, 1.0), (0.25, -2.0), (64.0, 6.0)] {
        assert!((once - ev(lit_room(light, 1.0)) - stops).abs() < 1e-5, "{light} times the light");
    }
}

#[test]
fn the_size_of_a_model_does_not_matter() {
    let expected = metered(lit_room(1.0, 1.0));
    for exponent in [-20, -3, 1, 12] {
        assert_eq!(metered(lit_room(1.0, f64::from(exponent).exp2())), expected, "2^{exponent}");
    }
}

/// Every point of the floor receives the radiance of the sky from all sides: typical light is one,
/// and all surfaces show the albedo.
#[test]
fn a_floor_under_an_even_sky_has_the_exposure_of_its_closed_form() {
    for albedo in [0.05_f32, 0.18, 0.8] {
        let expected = 0.46_f64.log2() - f64::from(albedo).log2() / 2.0;
        assert!((ev(floor(albedo, 1.0)) - expected).abs() < 0.051, "albedo {albedo}");
    }
}

#[test]
fn without_light_the_exposure_is_zero_and_says_so() {
    let dark = metered(floor(0.5, 0.0));
    assert_eq!((dark, dark.ev()), (Metered::Dark, 0.0));
}

#[test]
fn every_exposure_is_finite_and_in_range() {
    for value in [0.0, 1e-320, 1e-45, 1.0, 3e38, 1e308, f64::INFINITY, f64::NAN, -1.0] {
        let metered = Metered::of(vec![value; 3], vec![value; 3]);
        assert!(Exposure::Stops(metered.ev()).is_valid(), "{value}: {metered:?}");
    }
    assert_eq!(Metered::of(Vec::new(), Vec::new()), Metered::Dark);
    for (sky, albedo) in [(1e-38, 1e-30), (1e38, 1.0), (1e38, 1e-30)] {
        assert!(Exposure::Stops(metered(floor(albedo, sky)).ev()).is_valid(), "{sky} {albedo}");
    }
}

#[test]
fn one_thread_and_many_find_the_same_exposure() {
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| metered(lit_room(1.0, 1.0)))
    };
    assert_eq!(with(1), with(3));
}

/// All walls of the furnace emit, so that everything counts.
#[test]
fn a_scene_of_lamps_alone_has_light() {
    assert!(matches!(metered(builtin::build("furnace").unwrap()), Metered::Stops(_)));
}

#[test]
fn a_stopped_measurement_leaves_the_exposure_unknown() {
    let tracer = room_tracer(false, false);
    assert!(!tracer.measure_light(&|_| (), &|| true));
    assert_eq!((tracer.metered(), tracer.stops(Exposure::Auto)), (None, None));
    assert_eq!(tracer.stops(Exposure::Stops(-1.5)), Some(-1.5));
}

#[test]
fn embedded_scenes_are_made_for_an_exposure_and_models_are_not() {
    assert_eq!(builtin::build("cornell").unwrap().exposure, Exposure::Stops(0.0));
    assert_eq!(lit_room(1.0, 1.0).exposure, Exposure::Auto);
}

#[test]
fn exposures_are_written_and_read_as_a_word_or_a_number() {
    for (text, exposure) in [("auto", Exposure::Auto), ("-1.5", Exposure::Stops(-1.5))] {
        assert_eq!(text.parse(), Ok(exposure));
        assert_eq!(exposure.to_string(), text);
    }
    for text in ["65", "-65", "nan", "inf", "Auto", "", "1 EV"] {
        assert!(text.parse::<Exposure>().is_err(), "{text}");
    }
    let json = |e: Exposure| serde_json::to_string(&e).unwrap();
    assert_eq!((json(Exposure::Auto), json(Exposure::Stops(2.5))), ("\"auto\"".to_owned(), "2.5".to_owned()));
    assert_eq!(serde_json::from_str::<Exposure>("\"auto\"").unwrap(), Exposure::Auto);
    assert_eq!(serde_json::from_str::<Exposure>("2").unwrap(), Exposure::Stops(2.0));
    assert_eq!([2.9_f32, -0.1, 0.0, 64.0].map(decimal), [2.9_f64, -0.1, 0.0, 64.0]);
}
