//! Pictures of the light that arrives at surfaces, and the daylight factor, against theorems.

use crate::rooms::{cuboid, dvec};
use afterimage::raster::color::luminance;
use afterimage::render::lighting::{
    Fisheye, LightMeter, SeenSun, SeenSurfaces, Sensor, SurfaceLight, sun_hours, under_overcast_sky,
};
use afterimage::render::{Mode, RenderSettings};
use afterimage::scene::place::{PlaceAndTime, SunTimes};
use afterimage::scene::{CieSky, Material, MaterialId, SceneBuilder, Sky, Sun};
use afterimage::trace::{TraceSettings, parallel::NEVER};
use afterimage::{Camera, Frame, FrameRequest, Renderer, Tracer, Walkthrough, WalkthroughSettings};
use glam::{DVec3, Vec2, Vec3};
use std::f64::consts::PI;
use std::sync::Arc;

const SIZE: [u32; 2] = [40, 30];

fn tracer(builder: SceneBuilder) -> Tracer {
    Tracer::new(Arc::new(builder.finish().unwrap()))
}

fn level_quad(b: &mut SceneBuilder, [x, z]: [f64; 2], half: f64, y: f64, material: MaterialId) {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    b.add_quad(corners.map(|[i, j]| dvec(x + i * half, y, z + j * half)), Vec2::ONE, material);
}

/// A room of coloured walls with a lamp, a varnished cupboard and a mirror.
fn colored_room() -> Tracer {
    let mut b = SceneBuilder::new("coloured room");
    let wall = b.add_material(Material::diffuse("wall", Vec3::new(0.7, 0.4, 0.1)));
    let lamp =
        b.add_material(Material { emits_from_front: true, ..Material::emissive("lamp", Vec3::splat(9.0)) });
    let mirror = b.add_material(Material::mirror("mirror", Vec3::splat(0.9)));
    let dark = b.add_material(Material::diffuse("cupboard", Vec3::new(0.02, 0.05, 0.9)));
    cuboid(&mut b, dvec(-3.0, 0.0, -3.0), dvec(3.0, 3.0, 3.0), wall, true);
    cuboid(&mut b, dvec(-2.0, 0.0, -2.0), dvec(-1.0, 1.2, -1.0), dark, false);
    level_quad(&mut b, [0.5, -0.5], 0.5, 2.9, lamp);
    let corners = [[0.4, 0.6], [1.6, 0.6], [1.6, 1.8], [0.4, 1.8]];
    b.add_quad(corners.map(|[x, y]| dvec(x, y, -2.9)), Vec2::ONE, mirror);
    tracer(b)
}

fn camera() -> Camera {
    Camera::look_at(dvec(0.0, 1.6, 2.8), dvec(0.0, 1.2, -2.0), 70.0)
}

fn settings(mode: Mode, samples: u32) -> RenderSettings {
    RenderSettings { mode, trace: TraceSettings { samples, bounces: 3, seed: 5 } }
}

fn surfaces<'a>(frame: &'a Frame, tracer: &'a Tracer) -> SeenSurfaces<'a> {
    let (view, triangle, disparity) = (&frame.view, &frame.triangle, &frame.disparity);
    SeenSurfaces { scene: tracer.scene(), view, triangle, disparity }
}

/// What a matte surface shows is its emission, and its colour times the light: the same random
/// numbers give the same light, so a picture of the light times the colours is the picture.
#[test]
fn light_times_colour_is_the_picture() {
    let tracer = colored_room();
    let of_light = tracer.showing_light(true);
    assert_eq!(of_light.epoch(), tracer.epoch(), "references serve both");
    let (camera, settings) = (camera(), settings(Mode::Full, 4));
    let render = |tracer: &Tracer| {
        Renderer::default().render(&FrameRequest::new(tracer, &camera, SIZE, &settings)).clone()
    };
    let (picture, light) = (render(&tracer), render(&of_light));
    let surfaces = surfaces(&picture, &tracer);
    let mut compared = 0;
    for pixel in 0..picture.radiance.len() {
        let material = tracer.scene().material_of(picture.triangle[pixel]);
        if !surfaces.scatters(pixel) || material.is_view_dependent() || material.is_emissive() {
            continue;
        }
        let (shown, expected) = (picture.radiance[pixel], material.diffuse * light.radiance[pixel]);
        assert!((shown - expected).abs().max_element() <= 1e-5 * expected.max_element().max(1e-3), "{pixel}");
        compared += 1;
    }
    assert!(compared > 900, "{compared}");
}

/// A walk shows the light from the references that it has for its pictures, and back again.
#[test]
fn a_walk_changes_between_pictures_and_light() {
    let tracer = Arc::new(colored_room());
    let walk_settings = WalkthroughSettings { render: settings(Mode::Exact, 32), ..Default::default() };
    let mut walk = Walkthrough::new(tracer.clone(), walk_settings);
    let reference = walk.reference_job(camera(), SIZE).trace(NEVER).unwrap();
    walk.insert(reference);
    let picture = walk.render(&camera(), SIZE, NEVER).clone();
    walk.show_light(true);
    let light = walk.render(&camera(), SIZE, NEVER).clone();
    assert!(light.stats.types.percentages().unseen_percent < 5.0, "the references are reused");
    let trace = TraceSettings { samples: 256, ..walk_settings.render.trace };
    let truth = SurfaceLight::trace(&tracer, &camera(), SIZE, &trace, NEVER).unwrap();
    let surfaces = surfaces(&light, &tracer);
    let known = |pixel: &usize| surfaces.scatters(*pixel) && truth.light[*pixel].is_finite();
    let pixels: Vec<usize> = (0..light.radiance.len()).filter(known).collect();
    let sum = |of: &[Vec3]| pixels.iter().map(|p| f64::from(luminance(of[*p]))).sum::<f64>();
    let ratio = sum(&light.radiance) / sum(&truth.light);
    assert!((ratio - 1.0).abs() < 0.03 && pixels.len() > 900, "{ratio} over {} pixels", pixels.len());
    walk.show_light(false);
    assert_eq!(walk.render(&camera(), SIZE, NEVER).radiance.len(), picture.radiance.len());
    let back = sum(&walk.frame().radiance) / sum(&picture.radiance);
    assert!((back - 1.0).abs() < 0.01, "{back}");
}

/// At rest, the mean of the passes shows the same light.
#[test]
fn light_at_rest_converges_to_the_light() {
    let tracer = Arc::new(colored_room());
    let walk_settings = WalkthroughSettings { render: settings(Mode::Exact, 16), ..Default::default() };
    let mut walk = Walkthrough::new(tracer.clone(), walk_settings);
    walk.show_light(true);
    walk.render(&camera(), SIZE, NEVER);
    while !walk.refine(NEVER).is_complete {}
    let trace = TraceSettings { samples: 512, ..walk_settings.render.trace };
    let truth = SurfaceLight::trace(&tracer, &camera(), SIZE, &trace, NEVER).unwrap();
    let frame = walk.frame();
    let surfaces = surfaces(frame, &tracer);
    let is_inner = |pixel: &usize| {
        let edge = pixel % 40 == 39 || pixel / 40 == 29;
        !edge && surfaces.scatters(*pixel) && truth.light[*pixel].is_finite()
    };
    let ratios: Vec<f32> = (0..frame.radiance.len())
        .filter(is_inner)
        .map(|p| luminance(frame.radiance[p]) / luminance(truth.light[p]))
        .collect();
    let near = ratios.iter().filter(|r| (**r - 1.0).abs() < 0.1).count();
    assert!(near * 10 > ratios.len() * 9, "{near} of {} within a tenth", ratios.len());
}

fn reading(tracer: &Tracer, position_m: DVec3, facing: Vec3) -> f64 {
    let trace = TraceSettings { samples: 4096, bounces: 4, seed: 3 };
    let mut meter = LightMeter::new(tracer, vec![Sensor { position_m, facing }], trace);
    (0..32).for_each(|_| assert!(meter.pass(NEVER)));
    let reading = meter.readings()[0];
    assert!(reading.standard_error_lux < 0.004 * reading.lux, "{reading:?}");
    reading.lux
}

/// Open level ground has a daylight factor of 100 %, and a wall on black ground that of half the
/// sky, 3 (pi / 4 + 2 / 3) 2 / (7 pi) = 39.6 %; lamps and the sun do not count.
#[test]
fn daylight_factors_in_the_open_have_their_closed_forms() {
    let mut b = SceneBuilder::new("field");
    let black = b.add_material(Material::diffuse("ground", Vec3::ZERO));
    let lamp = b.add_material(Material::emissive("lamp", Vec3::splat(500.0)));
    level_quad(&mut b, [0.0, 0.0], 500.0, 0.0, black);
    level_quad(&mut b, [300.0, 0.0], 0.2, 1.0, lamp);
    b.sun = Some(Sun::clear_day());
    b.sky = Some(Sky::CLEAR_DAY);
    let tracer = under_overcast_sky(&tracer(b));
    let level = reading(&tracer, dvec(0.0, 1.0, 0.0), Vec3::Y);
    assert!((level - 100.0).abs() < 0.5, "{level}");
    let wall = reading(&tracer, dvec(0.0, 0.5, 0.0), Vec3::X);
    let expected = 100.0 * 2.0 / 3.0 * (PI / 4.0 + 2.0 / 3.0) * 9.0 / (7.0 * PI);
    assert!((wall / expected - 1.0).abs() < 0.01, "{wall} for {expected}");
}

/// Under a square roof light in a black room, the factor is the integral of the sky's luminance
/// over the opening.
#[test]
fn a_roof_light_has_its_closed_form_within_one_percent() {
    let (half, height) = (0.5, 3.0);
    let mut b = SceneBuilder::new("roof light");
    let black = b.add_material(Material::diffuse("black", Vec3::ZERO));
    level_quad(&mut b, [0.0, 0.0], 60.0, 0.0, black);
    let around = [-30.5, 0.0, 30.5];
    for [x, z] in around.into_iter().flat_map(|x| around.map(|z| [x, z])).filter(|at| *at != [0.0; 2]) {
        // Pieces of a roof of 121 m, eight around the opening.
        let sides = [x, z].map(|at: f64| if at == 0.0 { half } else { 30.0 });
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let corner = |[i, j]: [f64; 2]| dvec(x + i * sides[0], height, z + j * sides[1]);
        b.add_quad(corners.map(corner), Vec2::ONE, black);
    }
    let tracer = under_overcast_sky(&tracer(b));
    let at = dvec(0.0, 0.85, 0.0);
    let found = reading(&tracer, at, Vec3::Y);
    let sky = CieSky::overcast(Vec3::ONE, Vec3::ZERO);
    let expected = 100.0 * through_opening(&sky, half, height - at.y);
    assert!((found / expected - 1.0).abs() < 0.01, "{found} for {expected}");
}

/// The irradiance below the middle of a square opening, by the midpoint rule.
fn through_opening(sky: &CieSky, half: f64, rise: f64) -> f64 {
    const STEPS: i32 = 300;
    let middle = |i: i32| half * ((f64::from(i) + 0.5) * 2.0 / f64::from(STEPS) - 1.0);
    let area = (2.0 * half / f64::from(STEPS)).powi(2);
    let piece = |(i, j): (i32, i32)| {
        let way = dvec(middle(i), rise, middle(j));
        let direction = way.normalize_or(DVec3::Y);
        f64::from(sky.radiance(direction.as_vec3()).y) * direction.y.powi(2) * area / way.length_squared()
    };
    (0..STEPS).flat_map(|i| (0..STEPS).map(move |j| (i, j))).map(piece).sum()
}

/// Neighbouring pixels are of one surface along a wall, and not across a corner or an outline.
#[test]
fn surfaces_end_at_corners_and_outlines() {
    let tracer = colored_room();
    let settings = settings(Mode::Full, 1);
    let mut renderer = Renderer::default();
    let frame = renderer.render(&FrameRequest::new(&tracer, &camera(), [160, 120], &settings));
    let surfaces = surfaces(frame, &tracer);
    let normal = |pixel: usize| {
        let [a, b, c] = tracer.scene().corners(frame.triangle[pixel]);
        (b - a).cross(c - a).normalize_or_zero().abs()
    };
    let material = |pixel: usize| tracer.scene().material_of(frame.triangle[pixel]).name.clone();
    let (mut one, mut apart) = (0, 0);
    for pixel in (0..frame.radiance.len() - 1).filter(|p| p % 160 != 159) {
        let (here, there) = (pixel, pixel + 1);
        let is_same = material(here) == material(there) && normal(here).dot(normal(there)) > 0.99;
        assert!(!surfaces.are_one(here, there) || is_same || material(here) == material(there), "{pixel}");
        one += usize::from(is_same && surfaces.are_one(here, there));
        apart += usize::from(is_same && !surfaces.are_one(here, there));
        assert!(!surfaces.are_one(here, there) || normal(here).dot(normal(there)) > 0.85, "{pixel}");
    }
    assert!(one > 15_000 && apart < one / 50, "{one} {apart}");
}

/// In a closed room of walls that emit 1 and reflect rho, an eye sees 1 / (1 - rho) everywhere.
#[test]
fn an_eye_in_a_white_room_sees_and_receives_its_closed_form() {
    let rho = 0.5f32;
    let mut b = SceneBuilder::new("white room");
    let wall =
        b.add_material(Material { emission: Vec3::ONE, ..Material::diffuse("wall", Vec3::splat(rho)) });
    cuboid(&mut b, dvec(-2.0, -2.0, -2.0), dvec(2.0, 2.0, 2.0), wall, true);
    let tracer = tracer(b);
    let camera = Camera::look_at(dvec(0.3, 0.0, 0.5), dvec(0.0, 0.4, -2.0), 60.0);
    let mut view = Fisheye::of_camera(&camera, 48);
    let eye = tracer.scene().frame.scene_from_world_f64(camera.eye).as_vec3();
    let trace = TraceSettings { samples: 64, bounces: TraceSettings::ALL_BOUNCES, seed: 1 };
    view.luminance = view.trace_pass(&tracer, eye, &trace, 0, NEVER).unwrap();
    let luminance = f64::from(tracer.scene().nits_per_unit() / (1.0 - rho));
    assert!((view.illuminance() / (PI * luminance) - 1.0).abs() < 0.02, "{}", view.illuminance());
    assert!((view.mean_luminance() / luminance - 1.0).abs() < 0.03);
    assert!(SeenSun::of(&tracer, eye).is_none());
}

/// The disk of a sun in the open has the illuminance of the sun, and none behind a roof.
#[test]
fn the_disk_of_the_sun_has_its_illuminance_and_hides_behind_a_roof() {
    let mut b = SceneBuilder::new("roof");
    let black = b.add_material(Material::diffuse("black", Vec3::ZERO));
    level_quad(&mut b, [0.0, 0.0], 1.0, 3.0, black);
    let sun = Sun { direction: Vec3::Y, ..Sun::clear_day() };
    b.sun = Some(sun);
    let tracer = tracer(b);
    let seen = |x: f64| {
        let eye = tracer.scene().frame.scene_from_world_f64(dvec(x, 1.0, 0.0)).as_vec3();
        SeenSun::of(&tracer, eye)
    };
    assert_eq!(seen(0.0), None);
    let open = seen(5.0).unwrap();
    let lux = f64::from(luminance(sun.irradiance) * tracer.scene().nits_per_unit());
    assert!((open.luminance * open.solid_angle / lux - 1.0).abs() < 1e-4);
    let half = seen(1.0).unwrap();
    assert!((half.solid_angle / open.solid_angle - 0.5).abs() < 0.1, "the edge of the roof halves it");
}

/// In the open, the hours of direct sun are those from sunrise to sunset; a wall of the horizon's
/// eastern half takes the morning, and a window with glass takes nothing.
#[test]
fn hours_of_sun_in_the_open_are_the_length_of_the_day() {
    let day = PlaceAndTime::default();
    let SunTimes::Changes { sunrise: Some(rise), sunset: Some(set) } = day.sun_times().unwrap() else {
        panic!()
    };
    const STEP: f64 = 5.0 / 60.0;
    let at = |step: u32| PlaceAndTime { hours: (f64::from(step) + 0.5) * STEP, ..day.clone() };
    let suns: Vec<DVec3> = (0..288).map(|step| at(step).sun().unwrap().direction(0.0)).collect();
    let noon = suns.iter().position(|sun| sun.x < 0.0 && sun.y > 0.0).unwrap() as f64 * STEP;
    let hours = |material: Material| {
        let mut b = SceneBuilder::new("field");
        let (ground, wall) =
            (b.add_material(Material::diffuse("ground", Vec3::ONE)), b.add_material(material));
        level_quad(&mut b, [0.0, 0.0], 50.0, -1.0, ground);
        // North is -Z and east +X: a wall along the meridian, just east of the sensor.
        let corners = [[-40.0, -1.0], [40.0, -1.0], [40.0, 40.0], [-40.0, 40.0]];
        b.add_quad(corners.map(|[z, y]| dvec(0.01, y, z)), Vec2::ONE, wall);
        let sensor = |x: f64| Sensor { position_m: dvec(x, 0.0, 0.0), facing: Vec3::Y };
        let found = sun_hours(&tracer(b), &[sensor(0.0), sensor(-200.0)], &suns, STEP);
        found.iter().map(|reading| reading.lux).collect::<Vec<f64>>()
    };
    let [behind, open] = hours(Material::diffuse("wall", Vec3::ONE))[..] else { panic!() };
    // Sunrise is when the upper edge of the sun is seen, half a disk before its middle.
    assert!((open - (set - rise)).abs() < 0.3, "{open} for {}", set - rise);
    assert!((behind - (set - noon)).abs() < 0.3, "{behind} for {}", set - noon);
    let glass = hours(Material::glass("glass", 1.5, Vec3::ONE))[0];
    assert!((glass - open).abs() < 0.3, "{glass}");
}
