//! Cases K of the catalogue: lamps, by number and by what is measured of them.

use super::case::{Case, Outcome, Trial, case, total};
use super::pictures::bad_values;
use super::rooms::{Room, cuboid, dvec, imported, quad, tracer};
use crate::experiment::run::ExperimentError;
use crate::math::key::Key;
use crate::render::{FrameRequest, Mode, RenderSettings, Renderer};
use crate::scene::{Material, Scene, SceneBuilder};
use crate::trace::{RayCounts, TraceSettings, Tracer};
use glam::Vec3;
use std::sync::Arc;

pub(super) const CASES: &[Case] = &[
    case("K1 profiles of every kind", "bad values, and lamps that are lost", 0.0, profiles),
    case("K1 broken profiles", "bad values, and lamps that are kept", 0.0, broken_profiles),
    case("K2 10,000 lamps", "bad values, and rays beyond 16 for each sample", 0.0, ten_thousand),
    case("K2 10,000 lamps against each on its own", "% of difference of the mean", 2.0, each_on_its_own),
    case("K2 10,000 lamps in one place, and of 1e-30 and 1e30", "bad values", 0.0, in_one_place),
];

const MODES: [Mode; 3] = [Mode::Full, Mode::Exact, Mode::Fast];

const TRACE: TraceSettings = TraceSettings { samples: 2, bounces: 0, seed: 3 };

/// Numbers of a file between its name and its angles: how many of each, and the type.
fn head(vertical: u32, horizontal: u32, kind: u32) -> String {
    format!("1 -1 1 {vertical} {horizontal} {kind} 2 0 0 0\n1 1 1\n")
}

/// A floor below a lamp with a profile.
fn lit_by(profile: &str) -> Result<Scene, ExperimentError> {
    let floor = "v -3 0 -3\nv 3 0 -3\nv 3 0 3\nv -3 0 3\nf 4 3 2 1\n";
    let lamp = "[[point_light]]\nposition_m = [0, 1, 0]\nies = 'a.ies'\n\
                [start]\neye = [0, 2, 2]\nat = [0, 0, 0]\n";
    imported(&[("scene.obj", floor), ("scene.afterimage.toml", lamp), ("a.ies", profile)])
}

/// Returns the number of bad values of the start view in all modes.
fn bad_pixels(scene: Scene) -> usize {
    let tracer = Tracer::new(Arc::new(scene));
    let camera = *tracer.scene().start();
    let bad = MODES.map(|mode| {
        let settings = RenderSettings { mode, trace: TRACE };
        let mut renderer = Renderer::default();
        bad_values(renderer.render(&FrameRequest::new(&tracer, &camera, [24, 16], &settings)))
    });
    bad.into_iter().sum()
}

fn has_profile(scene: &Scene) -> bool {
    use crate::scene::Light;
    scene.lights.iter().any(|light| matches!(light, Light::Point { profile: Some(_), .. }))
}

fn profiles(_: &Trial) -> Outcome {
    let full_turn = format!("{}0 90 180\n0 120 240 360\n{}", head(3, 4, 1), "1 2 3 4 5 6 7 8 9 1 2 3");
    let of_kind = |kind: u32| format!("{}-90 0 90\n-45 0 45\n{}", head(3, 3, kind), "0 1 0 1 9 1 0 1 0");
    let names = ["", "IESNA91\n", "IESNA:LM-63-1995\n", "IESNA:LM-63-2002\n", "IES:LM-63-2019\n"];
    let bodies = [
        format!("{}0 180\n0\n5 5", head(2, 1, 1)),
        format!("{}0\n0\n5", head(1, 1, 1)),
        format!("{}0 90\n0 90\n5 5 1 0", head(2, 2, 1)),
        format!("{}90 180\n0 180\n5 5 1 0", head(2, 2, 1)),
        format!("{}0 90\n90 270\n5 5 1 0", head(2, 2, 1)),
        format!("{}0 1e-30 2e-30\n0\n1e-30 1e8 1", head(3, 1, 1)),
        full_turn,
        of_kind(2),
        of_kind(3),
    ];
    total(names.iter().flat_map(|name| bodies.iter().map(move |body| (name, body))), |(name, body)| {
        let scene = lit_by(&format!("{name}a lamp\nTILT=NONE\n{body}\n"))?;
        Ok(usize::from(!has_profile(&scene)) + bad_pixels(scene))
    })
}

fn broken_profiles(_: &Trial) -> Outcome {
    let bodies = [
        String::new(),
        "TILT=NONE".to_owned(),
        "TILT=INCLUDE\n1 999999999".to_owned(),
        format!("TILT=NONE\n{}0 90\n0\n5", head(2, 1, 1)),
        format!("TILT=NONE\n{}0 90\n0\n0 0", head(2, 1, 1)),
        format!("TILT=NONE\n{}0 90\n0\n-1 5", head(2, 1, 1)),
        format!("TILT=NONE\n{}90 0\n0\n5 5", head(2, 1, 1)),
        format!("TILT=NONE\n{}0 90\n0 33\n5 5 5 5", head(2, 2, 1)),
        format!("TILT=NONE\n{}0 inf\n0\n5 5", head(2, 1, 1)),
        format!("TILT=NONE\n{}", head(16_000, 16_000, 1)),
    ];
    total(bodies, |text| {
        let scene = lit_by(&text)?;
        Ok(usize::from(has_profile(&scene)) + bad_pixels(scene))
    })
}

/// A room with `count` lamps, whose places and intensities `lamp` returns.
fn with_lamps(count: u32, lamp: impl Fn(u32) -> (Vec3, f32)) -> SceneBuilder {
    let mut b = SceneBuilder::new("lamps");
    let wall = b.add_material(Material::diffuse("wall", Vec3::splat(0.6)));
    cuboid(&mut b, [dvec(-3.0, 0.0, -4.0), dvec(3.0, 3.0, 4.0)], wall, true);
    cuboid(&mut b, [dvec(-1.5, 0.0, -2.0), dvec(-0.5, 1.25, -1.0)], wall, false);
    b.point_lights.extend((0..count).map(|i| {
        let (at, intensity) = lamp(i);
        (at.as_dvec3(), Vec3::splat(intensity))
    }));
    quad(&mut b, dvec(0.0, 2.9, 0.0), dvec(0.01, 0.0, 0.0), dvec(0.0, 0.0, 0.01), wall);
    b
}

fn scattered(i: u32) -> (Vec3, f32) {
    let ([x, y], [z, bright]) = (Key::of_pixel(1, i).pair(), Key::of_pixel(2, i).pair());
    (Vec3::new(5.8 * x - 2.9, 2.0 + 0.9 * y, 7.8 * z - 3.9), 1e-4 * (1.0 + 9.0 * bright))
}

fn ten_thousand(_: &Trial) -> Outcome {
    let tracer = tracer(with_lamps(10_000, scattered))?;
    let camera = Room::PLAIN.camera();
    total(MODES, |mode| {
        let settings = RenderSettings { mode, trace: TRACE };
        let mut renderer = Renderer::default();
        let frame = renderer.render(&FrameRequest::new(&tracer, &camera, [24, 16], &settings));
        let most = u64::from(24 * 16 * TRACE.samples * 16);
        Ok(bad_values(frame) + frame.stats.rays.shadow.saturating_sub(most) as usize)
    })
}

/// The mean over many seeds of what the chosen lamps bring, against the sum of all lamps.
fn each_on_its_own(_: &Trial) -> Outcome {
    const SEEDS: u32 = 512;
    let tracer = tracer(with_lamps(10_000, scattered))?;
    let camera = Room::PLAIN.camera();
    let view = crate::camera::View::new(&camera, &tracer.scene().frame, [1, 1]);
    let ray = Tracer::primary_ray(&view, 0);
    let Some(hit) = tracer.closest(&ray) else { return Ok(f64::NAN.into()) };
    let (point, mut rays) = (tracer.surface(&ray, &hit), RayCounts::default());
    let one = |seed: u32, rays: &mut RayCounts| {
        f64::from(tracer.irradiance(&point, 1, Key::of_pixel(seed.into(), seed), rays).x)
    };
    let mean = (0..SEEDS).map(|seed| one(seed, &mut rays)).sum::<f64>() / f64::from(SEEDS);
    let lights = &tracer.scene().lights;
    let all: f64 = lights
        .iter()
        .map(|light| f64::from(tracer.irradiance_of_light(light, &point, 1, [0.0; 2], &mut rays).x))
        .sum();
    Ok((100.0 * (mean / all - 1.0).abs()).into())
}

fn in_one_place(_: &Trial) -> Outcome {
    let place = |_: u32| (Vec3::new(0.5, 2.0, 0.5), 1e-3);
    let extreme = |i: u32| (scattered(i).0, if i.is_multiple_of(2) { 1e-30 } else { 1e30 });
    let scenes = [with_lamps(10_000, place), with_lamps(10_000, extreme)];
    total(scenes, |scene| {
        let mut scene = scene.finish()?;
        scene.views[0].camera = Room::PLAIN.camera();
        Ok(bad_pixels(scene))
    })
}
