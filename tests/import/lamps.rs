//! Lamps of the settings file: photometric units and light profiles.

use super::gltf::profile;
use super::{Folder, TRIANGLE, assert_clean, warning};
use afterimage::math::key::Key;
use afterimage::scene::{Light, Scene};
use afterimage::trace::RayCounts;
use afterimage::{Camera, Tracer, View};
use glam::{DVec3, Vec3};
use std::sync::Arc;

fn with(toml: &str, files: &[(&str, &str)]) -> Scene {
    let folder = Folder::with_obj(TRIANGLE).add("scene.afterimage.toml", toml);
    files.iter().fold(folder, |folder, (name, text)| folder.add(name, text)).load()
}

/// Illuminance in lux on the triangle, 2 m behind (0.2, 0.2, 2).
fn lux(scene: Scene) -> Vec3 {
    let nits_per_unit = scene.nits_per_unit();
    let tracer = Tracer::new(Arc::new(scene));
    let eye = DVec3::new(0.2, 0.2, 1.0);
    let view = View::new(
        &Camera::look_at(eye, eye + DVec3::new(0.0, 1e-6, -1.0), 30.0),
        &tracer.scene().frame,
        [1, 1],
    );
    let ray = Tracer::primary_ray(&view, 0);
    let point = tracer.surface(&ray, &tracer.closest(&ray).unwrap());
    tracer.irradiance(&point, 4, Key::of_pixel(1, 1), &mut RayCounts::default()) * nits_per_unit
}

fn lamp(rest: &str) -> String {
    format!("[[point_light]]\nposition_m = [0.2, 0.2, 2]\n{rest}\n")
}

#[test]
fn photometric_units_are_those_of_the_inverse_square_law() {
    for rest in ["candela = 1000", "lumens = 12566.37", "candela = 1000\ncolor = [1, 1, 1]"] {
        let scene = with(&lamp(rest), &[]);
        assert_clean(&scene);
        let found = lux(scene);
        assert!((found / 250.0 - Vec3::ONE).length() < 1e-4, "{rest}: {found}");
    }
    let tinted = lux(with(&lamp("candela = 1000\ncolor = [1, 0.5, 0]"), &[]));
    assert!((tinted / 250.0 - Vec3::new(1.0, 0.5, 0.0)).length() < 1e-4, "{tinted}");
    let sun = lux(with(
        "[sun]\ndirection = [0, 0, 1]\nlux = 50000\n[sky]\nzenith = 0\nhorizon = 0\nground = 0\n",
        &[],
    ));
    assert!((sun / 50_000.0 - Vec3::ONE).length() < 1e-3, "{sun}");
}

#[test]
fn profiles_are_read_and_scaled() {
    let lambert: Vec<(f32, f32)> = (0..=18u8)
        .map(|i| (f32::from(i) * 5.0, 1000.0 * (f32::from(i) * 5.0).to_radians().cos().max(0.0)))
        .collect();
    let list = |f: &dyn Fn(&(f32, f32)) -> f32| {
        lambert.iter().map(|pair| f(pair).to_string()).collect::<Vec<_>>().join(" ")
    };
    let lambert = profile(&list(&|pair| pair.0), &list(&|pair| pair.1));
    let files = [("Lambert.IES", lambert.as_str())];
    let aim = "aim = [0, 0, -3]\n";
    for (rest, expected) in [
        ("ies = 'lambert.ies'", 250.0),
        ("ies = 'lambert.ies'\nfactor = 0.5", 125.0),
        ("ies = 'lambert.ies'\ncandela = 100", 25.0),
        // A lamp of Lambert's law sends an intensity of its flux over pi along its axis.
        ("ies = 'lambert.ies'\nlumens = 3141.593", 250.0),
    ] {
        let scene = with(&lamp(&format!("{aim}{rest}")), &files);
        assert_clean(&scene);
        assert!(matches!(&scene.lights[0], Light::Point { profile: Some(_), .. }));
        let found = lux(scene).x;
        assert!((found / expected - 1.0).abs() < 2e-3, "{rest}: {found}, {expected}");
    }
    // It hangs down by default, so its side lights the triangle: nothing does at 90 degrees.
    assert!(lux(with(&lamp("ies = 'lambert.ies'"), &files)).x < 1e-3);
    // An even one is a point light.
    let even = profile("0 180", "500 500");
    let found = lux(with(&lamp("ies = 'even.ies'"), &[("even.ies", &even)]));
    assert_eq!(found, lux(with(&lamp("candela = 500"), &[])));
    assert!((found.x * 4.0 / 500.0 - 1.0).abs() < 1e-5);
}

#[test]
fn what_is_wrong_is_reported_with_its_line() {
    let part = |scene: &Scene, part: &str| {
        let (file, line, message) = warning(scene, part);
        assert_eq!((file, line), ("scene.afterimage.toml", 1), "{message}");
        message.to_owned()
    };
    for rest in ["", "candela = 1\nlumens = 1", "candela = -1", "intensity = 1\ncandela = 1", "ies = 3"] {
        warning(&with(&lamp(rest), &[]), "needs position_m and one of intensity, candela, lumens and ies");
    }
    assert!(part(&with(&lamp("candela = 1\nfactor = 2"), &[]), "'factor'").contains("no effect"));
    let missing = with(&lamp("ies = 'none.ies'"), &[]);
    assert!(part(&missing, "light profile 'none.ies'").contains("not found"));
    let outside = with(&lamp("ies = '../up.ies'"), &[]);
    assert!(part(&outside, "light profile '../up.ies'").contains("left out"));
    let broken = with(&lamp("ies = 'a.ies'"), &[("a.ies", "TILT=NONE\n1 2 3\n4 five")]);
    let message = part(&broken, "light profile 'a.ies'");
    assert!(message.contains("line 3") && message.contains("'five'"), "{message}");
    let tilted = profile("0 180", "5 5").replace("TILT=NONE", "TILT=a.tlt");
    let tilted = with(&lamp("ies = 'a.ies'"), &[("a.ies", &tilted)]);
    assert!(part(&tilted, "light profile 'a.ies'").contains("when tilted"));
}
