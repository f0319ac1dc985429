//! Properties of the gallery.

use super::{scene, triangles_where};
use afterimage::scene::{Light, SolidSide};

#[test]
fn gallery_has_its_documented_size() {
    let scene = scene("gallery");
    let count = scene.triangles.len();
    assert!((50_000..=400_000).contains(&count), "{count} triangles");
    let size = scene.bounds_m[1] - scene.bounds_m[0];
    // Scene space has 16 units to a metre up to a diagonal of 64 m.
    assert!(size.length() < 64.0, "{size}");
}

#[test]
fn gallery_is_lit_by_lamps_the_sun_and_the_sky() {
    let lights = &scene("gallery").lights;
    assert!(lights.iter().any(|l| matches!(l, Light::Sun { .. })));
    assert!(lights.iter().any(|l| matches!(l, Light::Sky)));
    let is_lamp = |l: &&Light| matches!(l, Light::Quad { .. } | Light::Triangles { .. });
    assert_eq!(lights.iter().filter(is_lamp).count(), 10, "nine lamps and a screen");
    assert_eq!(lights.len(), 12);
}

#[test]
fn gallery_uses_mirrors_glass_textures_area_lights_and_a_sky() {
    let features = scene("gallery").features;
    assert!(features.mirror && features.glass && features.textures && features.area_lights && features.sky);
    assert!(!features.alpha);
}

#[test]
fn gallery_glass_is_solid_in_the_case_and_thin_in_the_windows() {
    let scene = scene("gallery");
    let glass = triangles_where(scene, |m| m.is_glass() && m.coverage_texture.is_none());
    let thin = glass.iter().filter(|&&t| scene.solids[t as usize] == SolidSide::Thin).count();
    // Six windows and the entrance have a pane each; the case has five panes, each of them a box.
    assert_eq!((thin, glass.len() - thin), (7 * 2, 5 * 12));
}

#[test]
fn gallery_reflects_as_plaster_wood_and_stone_do() {
    let scene = scene("gallery");
    for material in &scene.materials {
        let brightest = material.diffuse.max_element();
        assert!(material.diffuse_texture.is_some() || brightest <= 0.8, "{}", material.name);
    }
    for material in scene.materials.iter().filter(|m| m.name.starts_with("wall ")) {
        let albedo = afterimage::raster::color::luminance(material.diffuse);
        assert!((0.5..=0.8).contains(&albedo), "{}: {albedo}", material.name);
    }
}

#[test]
fn gallery_views_are_named() {
    let scene = scene("gallery");
    for name in
        ["start", "hall", "garden room", "mirrors", "vitrine", "railing", "salon", "long gallery", "entrance"]
    {
        assert!(scene.views.iter().any(|v| v.name == name), "{name}");
    }
}

#[test]
fn gallery_camera_path_is_long_and_smooth() {
    let walk = &scene("gallery").walk;
    assert_eq!(walk.frames, 300);
    assert!((60.0..=80.0).contains(&walk.length_m()), "{} m", walk.length_m());
    let eyes: Vec<_> = (0..walk.frames).map(|i| walk.camera(i, walk.frames).unwrap().eye).collect();
    let longest = eyes.windows(2).map(|e| e[0].distance(e[1])).fold(0.0, f64::max);
    assert!(longest < 0.3, "{longest} m in one frame");
}
