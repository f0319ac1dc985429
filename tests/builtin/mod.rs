//! The embedded scenes: counts, closed solids, clear camera paths, and equal bits in every build.

mod analytic;
mod clearance;
mod edits;
mod gallery;
mod gallery_bench;

use afterimage::scene::{Material, Scene, builtin};
use std::sync::LazyLock;

fn built(name: &str) -> Scene {
    builtin::build(name).expect("the embedded scenes build")
}

/// Returns an embedded scene, which is built once for all tests.
fn scene(name: &str) -> &'static Scene {
    static SCENES: LazyLock<Vec<Scene>> =
        LazyLock::new(|| builtin::NAMES.iter().map(|name| built(name)).collect());
    let at = builtin::NAMES.iter().position(|n| *n == name).expect("an embedded scene");
    &SCENES[at]
}

fn triangles_where(scene: &Scene, test: fn(&Material) -> bool) -> Vec<u32> {
    (0..scene.triangles.len() as u32).filter(|&t| test(scene.material_of(t))).collect()
}

#[test]
fn every_embedded_scene_is_complete() {
    for name in builtin::NAMES {
        let scene = scene(name);
        assert_eq!(scene.name, format!("builtin:{name}"));
        assert!(scene.warnings.is_empty(), "{name}: {:?}", scene.warnings);
        assert!(!scene.lights.is_empty(), "{name}");
        assert_eq!(scene.views[0].name, "start");
        assert!(scene.views.iter().all(|v| v.camera.is_valid()), "{name}");
        assert!(scene.walk.keyframes.len() > 1 && scene.walk.length_m() > 1.0, "{name}");
    }
}

#[test]
fn embedded_scenes_have_the_same_hash_every_time() {
    for name in builtin::NAMES {
        assert_eq!(scene(name).hash, built(name).hash, "{name}");
    }
}

#[test]
fn an_unknown_name_lists_the_known_ones() {
    let message = builtin::build("galery").unwrap_err().to_string();
    assert!(message.contains("'galery'") && message.contains("cornell-glass"), "{message}");
}
