//! Pictures of the sky, and daylight that the user asks for.

use super::{Folder, TRIANGLE, assert_clean, warning};
use afterimage::import::{DaylightOptions, Limits, SkyChoice, load_sky, save_edit};
use afterimage::scene::place::PlaceAndTime;
use afterimage::scene::{Light, Scene, Sky, SkyKind};
use exr::prelude::*;
use glam::Vec3;
use std::path::PathBuf;

/// A Radiance picture of 8x4 pixels: white, with the value 2^20 in one of them, and `header` lines.
fn hdr(size: &str, header: &str) -> Vec<u8> {
    let mut bytes = format!("#?RADIANCE\n{header}FORMAT=32-bit_rle_rgbe\n\n{size}\n").into_bytes();
    for pixel in 0..32 {
        // The mantissa 128 of exponent e is 2^(e - 129).
        bytes.extend_from_slice(if pixel == 10 { &[128, 128, 128, 149] } else { &[128, 128, 128, 129] });
    }
    bytes
}

/// An OpenEXR picture of one value, with the luminance of white.
fn exr_file(size: [usize; 2], value: f32, nits: Option<f32>) -> Vec<u8> {
    let channels = SpecificChannels::rgb(|_: Vec2<usize>| (value, value, value));
    let attributes = LayerAttributes { white_luminance: nits, ..LayerAttributes::default() };
    let layer = Layer::new((size[0], size[1]), attributes, Encoding::SMALL_LOSSLESS, channels);
    let mut bytes = std::io::Cursor::new(Vec::new());
    Image::from_layer(layer).write().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

fn picture(path: PathBuf) -> DaylightOptions {
    DaylightOptions { sky: Some(SkyChoice::Picture(path)), ..DaylightOptions::default() }
}

fn has_suns(scene: &Scene) -> bool {
    scene.lights.iter().any(|light| matches!(light, Light::SkySuns))
}

#[test]
fn pictures_of_both_formats_are_read_with_their_units() {
    let folder = Folder::with_obj(TRIANGLE)
        .add("a.hdr", hdr("-Y 4 +X 8", "EXPOSURE=4\n"))
        .add("b.exr", exr_file([8, 4], 3.0, Some(5_000.0)))
        .add("c.exr", exr_file([8, 4], 3.0, None));
    let lit = |name: &str| picture(folder.path(name)).apply(folder.load());
    let scene = lit("a.hdr");
    assert!(has_suns(&scene) && scene.sun.is_none());
    assert_eq!(scene.sky.unwrap().diffuse_radiance(-Vec3::Y), Vec3::splat(0.25));
    // Value 3 of 5,000 cd/m2 in units of 10,000.
    let scene = lit("b.exr");
    assert!(!has_suns(&scene));
    assert!((scene.sky.unwrap().radiance(Vec3::Y).x - 1.5).abs() < 1e-6);
    assert!((lit("c.exr").sky.unwrap().radiance(Vec3::Y).x - 3.0).abs() < 1e-6);
}

#[test]
fn a_picture_that_is_no_sky_is_one_line_and_the_old_sky_stays() {
    let mut short = hdr("-Y 4 +X 8", "");
    short.truncate(80);
    let folder = Folder::with_obj(TRIANGLE)
        .add("square.hdr", hdr("-Y 8 +X 4", ""))
        .add("huge.hdr", hdr("-Y 50000 +X 100000", ""))
        .add("short.hdr", short)
        .add("nan.exr", exr_file([8, 4], f32::NAN, None))
        .add("infinite.exr", exr_file([8, 4], f32::INFINITY, None))
        .add("square.exr", exr_file([4, 4], 1.0, None))
        .add("text.hdr", "sunny")
        .add("empty.exr", "")
        .add("folder.hdr/x", "");
    for (name, part) in [
        ("missing.hdr", "or name a kind of sky: none, default, gradient, overcast"),
        ("square.hdr", "4x8 pixels; a picture of all directions is twice as wide as high"),
        ("huge.hdr", "100000x50000 pixels, at most 8192x4096"),
        ("short.hdr", "short.hdr"),
        ("nan.exr", "32 of its pixels are not finite"),
        ("infinite.exr", "not finite"),
        ("square.exr", "twice as wide as high"),
        ("text.hdr", "neither a Radiance picture"),
        ("empty.exr", "neither a Radiance picture"),
        ("folder.hdr", "not a regular file"),
    ] {
        let before = folder.load();
        let scene = picture(folder.path(name)).apply(before.clone());
        let (_, _, message) = warning(&scene, part);
        assert!(message.contains(name) && message.contains("the sky of the scene stays"), "{message}");
        assert!(!message.contains('\n') && scene.warnings.len() == before.warnings.len() + 1);
        assert_eq!((scene.sky, scene.sun), (before.sky, before.sun));
    }
    let limits = Limits { sky_bytes: 100, ..Limits::default() };
    assert!(load_sky(&folder.path("nan.exr"), &limits).unwrap_err().to_string().contains("at most 100"));
}

#[test]
fn a_sidecar_names_a_picture_in_the_folder_of_the_model_only() {
    let toml = "[sky]\npicture = \"Skies\\\\A.hdr\"\nrotation_deg = 90\nbrightness = 2\n";
    let folder = Folder::with_obj(TRIANGLE)
        .add("skies/a.hdr", hdr("-Y 4 +X 8", ""))
        .add("scene.afterimage.toml", toml);
    let scene = folder.load();
    assert_clean(&scene);
    assert!(has_suns(&scene));
    let before = scene.to_edit();
    assert_eq!(before.daylight.sky.as_ref().unwrap().diffuse_radiance(-Vec3::Y), Vec3::splat(2.0));

    // A changed picture is saved with its name relative to the model, and read again.
    let mut now = before.clone();
    if let Some(Sky::Picture(sky)) = &mut now.daylight.sky {
        sky.brightness = 0.5;
    }
    save_edit(&folder.path("scene.obj"), &before, &now).unwrap();
    let text = std::fs::read_to_string(folder.path("scene.afterimage.toml")).unwrap();
    assert!(text.contains("picture = \"skies/a.hdr\"") && text.contains("brightness = 0.5"), "{text}");
    assert_eq!(folder.load().to_edit().daylight, now.daylight);

    let elsewhere = Folder::with_obj(TRIANGLE).add("b.hdr", hdr("-Y 4 +X 8", ""));
    let other = picture(elsewhere.path("b.hdr")).apply(elsewhere.load()).to_edit();
    let error = save_edit(&folder.path("scene.obj"), &before, &other).unwrap_err().to_string();
    assert!(error.contains("not in the model's folder"), "{error}");
    for (name, part) in [("../b.hdr", "outside the scene's folder"), ("none.hdr", "was not found")] {
        let toml = format!("[sky]\npicture = \"{name}\"\n");
        let scene = Folder::with_obj(TRIANGLE).add("scene.afterimage.toml", toml).load();
        let (file, line, message) = warning(&scene, part);
        assert_eq!((file, line), ("scene.afterimage.toml", 1), "{message}");
    }
}

#[test]
fn a_sky_that_is_asked_for_replaces_that_of_the_scene() {
    let scene = || Folder::with_obj(TRIANGLE).load();
    let lit = |sky: &str| {
        let options = DaylightOptions { sky: Some(sky.parse().unwrap()), ..DaylightOptions::default() };
        options.apply(scene())
    };
    assert_eq!(lit("none").sky, None);
    assert!(lit("clear").warnings.iter().all(|w| !w.message.contains("no light")), "it has one now");
    assert!(lit("none").sun.is_some(), "the sun stays");
    for kind in SkyKind::MODELS {
        let lit = lit(kind.name());
        assert_eq!(lit.sky.as_ref().map(Sky::kind), Some(kind));
        assert_eq!(lit.sun.is_none(), kind == SkyKind::Overcast);
        assert_ne!(lit.hash, scene().hash, "{kind:?}");
    }
    assert_eq!(lit("default").sky.map(|sky| sky.kind()), Some(SkyKind::Gradient));
    let sun = Some(PlaceAndTime::default());
    let noon = DaylightOptions { sun, ..DaylightOptions::default() }.apply(scene());
    let direction = noon.sun.unwrap().direction;
    assert!((direction.y.asin().to_degrees() - 58.15).abs() < 0.05, "{direction}");
    let night = PlaceAndTime { hours: 0.0, ..PlaceAndTime::default() };
    let night = DaylightOptions { sun: Some(night), ..DaylightOptions::default() }.apply(scene());
    assert_eq!((night.sun, night.sky), (None, None));
}
