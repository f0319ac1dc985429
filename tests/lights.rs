//! Lights that do not reach a cell cost nothing there, and culling them changes no visible light.

use crate::rooms::{cuboid, dvec, quad};
use afterimage::math::key::Key;
use afterimage::scene::{Light, Material, Scene, SceneBuilder};
use afterimage::trace::{RayCounts, SurfacePoint, TraceSettings};
use afterimage::{Camera, FrameRequest, Mode, RenderSettings, Renderer, Tracer};
use glam::Vec3;
use std::sync::Arc;

/// A row of closed cells of 3 x 3 x 3 m with a lamp in each; the first two are joined by a doorway.
fn row_of_rooms(rooms: u32) -> Scene {
    let mut b = SceneBuilder::new("row");
    let wall = b.add_material(Material::diffuse("wall", Vec3::splat(0.6)));
    let lamp = b.add_material(Material::emissive("lamp", Vec3::splat(6.0)));
    let length = 3.0 * f64::from(rooms);
    cuboid(&mut b, dvec(0.0, 0.0, 0.0), dvec(length, 3.0, 3.0), wall, true);
    for room in 0..rooms {
        let x = 3.0 * f64::from(room);
        quad(&mut b, dvec(x + 1.0, 2.9, 1.0), dvec(1.0, 0.0, 0.0), dvec(0.0, 0.0, 1.0), lamp);
        let front = if room == 1 { 1.2 } else { 0.0 };
        if room > 0 {
            cuboid(&mut b, dvec(x - 0.1, 0.0, front), dvec(x + 0.1, 3.0, 3.0), wall, false);
        }
    }
    b.finish().unwrap()
}

fn shadow_rays_and_radiance(rooms: u32) -> (RayCounts, Vec<Vec3>) {
    let tracer = Tracer::new(Arc::new(row_of_rooms(rooms)));
    let camera = Camera::look_at(dvec(0.4, 1.6, 2.5), dvec(3.0, 1.2, 0.8), 75.0);
    let settings =
        RenderSettings { mode: Mode::Full, trace: TraceSettings { samples: 4, ..Default::default() } };
    let mut renderer = Renderer::default();
    let frame = renderer.render(&FrameRequest::new(&tracer, &camera, [96, 72], &settings));
    (frame.stats.rays, frame.radiance.clone())
}

#[test]
fn time_does_not_grow_with_lights_in_closed_rooms() {
    let (few, _) = shadow_rays_and_radiance(4);
    let (many, _) = shadow_rays_and_radiance(40);
    // The size of cells is relative to that of the scene, so the longer row has coarser cells:
    // allow a factor of 2, not of 10.
    assert!(many.shadow < 2 * few.shadow, "{} shadow rays for 40 rooms, {} for 4", many.shadow, few.shadow);
}

#[test]
fn culled_lights_bring_no_light() {
    let rooms = 12;
    let scene = row_of_rooms(rooms);
    let (_, culled) = shadow_rays_and_radiance(rooms);
    let tracer = Tracer::new(Arc::new(scene));
    let camera = Camera::look_at(dvec(0.4, 1.6, 2.5), dvec(3.0, 1.2, 0.8), 75.0);
    let view = afterimage::View::new(&camera, &tracer.scene().frame, [96, 72]);
    // Render every light on its own and add them up: light is additive, and a scene of one light
    // culls none.
    let mut sum = vec![Vec3::ZERO; view.pixel_count()];
    for light in 0..tracer.scene().lights.len() {
        let mut one = (**tracer.scene()).clone();
        one.lights = vec![one.lights[light].clone()];
        one.materials.iter_mut().for_each(|m| m.emission = Vec3::ZERO);
        let tracer = Tracer::new(Arc::new(one));
        let trace = TraceSettings { samples: 64, ..Default::default() };
        for (pixel, sum) in sum.iter_mut().enumerate().step_by(7) {
            *sum += tracer.pixel(&view, pixel as u32, &trace, &mut RayCounts::default()).radiance;
        }
    }
    let compared = || culled.iter().zip(&sum).step_by(7).filter(|(_, s)| s.x < 1.0);
    let mean = |f: &dyn Fn(Vec3, Vec3) -> f32| {
        compared().map(|(c, s)| f(*c, *s)).sum::<f32>() / compared().count() as f32
    };
    let (with, without) = (mean(&|c, _| c.x), mean(&|_, s| s.x));
    // With 64 and 4 samples, the noise of the mean of some thousand pixels is well below this.
    assert!((with / without - 1.0).abs() < 0.01, "mean radiance {with} with culling, {without} without");
}

#[test]
fn culled_lights_are_counted() {
    let tracer = Tracer::new(Arc::new(row_of_rooms(12)));
    let camera = Camera::look_at(dvec(0.4, 1.6, 2.5), dvec(3.0, 1.2, 0.8), 75.0);
    let settings =
        RenderSettings { mode: Mode::Full, trace: TraceSettings { samples: 1, ..Default::default() } };
    Renderer::default().render(&FrameRequest::new(&tracer, &camera, [32, 24], &settings));
    let cuts = tracer.light_grid().cuts();
    assert_eq!(cuts.lights, 12);
    assert!(cuts.cells > 0 && cuts.kept_mean >= 1.0 && cuts.kept_mean < 4.0, "{cuts:?}");
}

/// A hall with a screen in the middle, and 200 lights of very different brightness below its
/// ceiling: point lights and parallelograms in turns.
fn hall() -> Scene {
    let mut b = SceneBuilder::new("hall");
    let wall = b.add_material(Material::diffuse("wall", Vec3::splat(0.6)));
    cuboid(&mut b, dvec(0.0, 0.0, 0.0), dvec(20.0, 4.0, 10.0), wall, true);
    cuboid(&mut b, dvec(9.9, 0.0, 2.0), dvec(10.1, 3.0, 10.0), wall, false);
    let mut scene = b.finish().unwrap();
    let unit = scene.frame.units_per_metre as f32;
    for i in 0..200 {
        let place = dvec(0.5 + f64::from(i % 20), 3.9, 0.5 + f64::from(i / 20));
        let at = scene.frame.scene_from_world_f64(place).as_vec3();
        let brightness = Vec3::splat(1.0 + 40.0 * f32::from(i % 23 == 0));
        scene.lights.push(if i % 2 == 0 {
            Light::Point {
                position: at,
                intensity: brightness * (0.05 * unit * unit),
                beam: None,
                profile: None,
            }
        } else {
            let side = 0.2 * unit;
            Light::Quad {
                corner: at,
                edge_u: Vec3::X * side,
                edge_v: Vec3::Z * side,
                radiance: brightness,
                has_one_side: false,
            }
        });
    }
    scene
}

/// Points on the floor, on both sides of the screen and in its shadow.
fn floor_points(tracer: &Tracer) -> Vec<SurfacePoint> {
    let frame = &tracer.scene().frame;
    let looking_down = [dvec(3.0, 1.0, 5.0), dvec(9.5, 1.0, 6.0), dvec(15.5, 1.0, 1.0)].map(|eye| {
        let camera = Camera::look_at(eye, eye - dvec(0.0, 1.0, 0.001), 60.0);
        afterimage::View::new(&camera, frame, [1, 1])
    });
    looking_down
        .iter()
        .map(|view| {
            let ray = Tracer::primary_ray(view, 0);
            tracer.surface(&ray, &tracer.closest(&ray).unwrap())
        })
        .collect()
}

#[test]
fn many_lights_share_samples_and_the_mean_is_the_sum_of_all() {
    let tracer = Tracer::new(Arc::new(hall()));
    // Fifty lights at a time all get their samples. Light is additive.
    let parts: Vec<Tracer> = (0..4)
        .map(|part| {
            let mut scene = hall();
            scene.lights = scene.lights.drain(50 * part..50 * (part + 1)).collect();
            Tracer::new(Arc::new(scene))
        })
        .collect();
    for (number, point) in floor_points(&tracer).iter().enumerate() {
        let irradiance = |tracer: &Tracer, samples, seed| {
            let mut rays = RayCounts::default();
            let found = tracer.irradiance(point, samples, Key::of_pixel(seed, number as u32), &mut rays).x;
            (f64::from(found), rays.shadow)
        };
        let whole: f64 = parts.iter().map(|part| irradiance(part, 1024, 1).0).sum();
        for samples in [1u32, 4] {
            const SEEDS: u64 = 600;
            let mut estimates = Vec::new();
            for seed in 0..SEEDS {
                let (estimate, rays) = irradiance(&tracer, samples, seed);
                assert!(rays <= 64 * u64::from(samples), "{rays} rays for {samples} samples");
                estimates.push(estimate);
            }
            let mean = estimates.iter().sum::<f64>() / SEEDS as f64;
            let variance = estimates.iter().map(|e| (e - mean).powi(2)).sum::<f64>() / (SEEDS - 1) as f64;
            let standard_error = (variance / SEEDS as f64).sqrt();
            // A culled light may bring 0.4 % of the light.
            let allowed = 4.0 * standard_error + 0.004 * whole;
            assert!((mean - whole).abs() < allowed, "{samples} samples: {mean}, {whole} +- {standard_error}");
            // The noise of one estimate is that of an ordinary picture.
            let most = if samples == 1 { 0.7 } else { 0.5 };
            assert!(variance.sqrt() < most * whole, "{samples} samples: {whole} +- {}", variance.sqrt());
        }
    }
    assert!(tracer.light_grid().cuts().sharing_cells > 0);
}

/// A hall of 20 x 20 m with pillars and tables under `count` lamps, which emit the same light
/// together.
fn lit_hall(count: u32) -> Scene {
    let mut b = SceneBuilder::new("lit hall");
    let wall = b.add_material(Material::diffuse("wall", Vec3::new(0.75, 0.73, 0.68)));
    let lamp = b.add_material(Material::emissive("lamp", Vec3::splat(40_000.0 / count as f32)));
    cuboid(&mut b, dvec(-10.0, 0.0, -10.0), dvec(10.0, 4.0, 10.0), wall, true);
    for [i, j] in (0..16).map(|k| [f64::from(k % 4), f64::from(k / 4)]) {
        let at = dvec(5.0 * i - 7.5, 0.0, 5.0 * j - 7.5);
        cuboid(&mut b, at - dvec(0.3, 0.0, 0.3), at + dvec(0.3, 4.0, 0.3), wall, false);
    }
    for i in 0..5 {
        let at = dvec(3.0 * f64::from(i) - 6.0, 0.0, 0.0);
        cuboid(&mut b, at - dvec(0.8, 0.0, 1.0), at + dvec(0.8, 0.75, 1.0), wall, false);
    }
    let columns = f64::from(count).sqrt().ceil();
    let rows = (f64::from(count) / columns).ceil();
    for i in 0..count {
        let (column, row) = (f64::from(i) % columns, (f64::from(i) / columns).floor());
        let at = dvec(20.0 * (column + 0.5) / columns - 10.06, 3.97, 20.0 * (row + 0.5) / rows - 10.06);
        quad(&mut b, at, dvec(0.12, 0.0, 0.0), dvec(0.0, 0.0, 0.12), lamp);
    }
    b.finish().unwrap()
}

fn hall_picture(tracer: &Tracer, trace: TraceSettings, mode: Mode) -> (Vec<Vec3>, f64, u64) {
    let camera = Camera::look_at(dvec(0.0, 1.6, 8.8), dvec(0.0, 1.2, 0.0), 52.0);
    let settings = RenderSettings { mode, trace };
    let start = std::time::Instant::now();
    let frame = Renderer::default().render(&FrameRequest::new(tracer, &camera, [64, 36], &settings)).clone();
    (frame.radiance, start.elapsed().as_secs_f64(), frame.stats.rays.total())
}

/// Ten thousand lamps are rendered, by a number of rays that does not grow with theirs.
#[test]
fn rays_are_bounded_with_ten_thousand_lamps() {
    let trace = TraceSettings { samples: 1, ..Default::default() };
    let tracer = Tracer::new(Arc::new(lit_hall(10_000)));
    let (radiance, _, rays) = hall_picture(&tracer, trace, Mode::Full);
    assert!(rays <= 17 * 64 * 36, "{rays} rays");
    assert!(radiance.iter().all(|r| r.is_finite()));
    // The floor, which lies in the lower third of the picture, is lit alike by fewer of more light.
    let mean = |radiance: &[Vec3]| radiance[64 * 24..].iter().map(|r| r.x).sum::<f32>();
    let few = hall_picture(&Tracer::new(Arc::new(lit_hall(400))), trace, Mode::Full).0;
    let ratio = mean(&radiance) / mean(&few);
    assert!((0.9..1.1).contains(&ratio), "{ratio}");
}

/// Squared error of a picture without the worst hundredth of its pixels: there, lamps touch what
/// they light, and single bright paths arrive.
fn squared_error(picture: &[Vec3], truth: &[Vec3]) -> f64 {
    let mut errors: Vec<f32> = picture.iter().zip(truth).map(|(a, b)| (*a - *b).length_squared()).collect();
    errors.sort_by(f32::total_cmp);
    errors.truncate(errors.len() * 99 / 100);
    errors.into_iter().map(f64::from).sum()
}

/// Measures noise and time of 12, 400 and 10,000 lamps:
/// `cargo test --release --test afterimage measured_lamps -- --ignored --nocapture`.
#[test]
#[ignore = "a measurement"]
fn measured_lamps() {
    const SEEDS: u64 = 4;
    for (bounces, samples) in [(0, 4), (0, 16), (8, 4), (8, 16)] {
        let trace = |samples, seed| TraceSettings { samples, bounces, seed };
        let mut of_twelve = None;
        for count in [12, 400, 10_000] {
            let tracer = Tracer::new(Arc::new(lit_hall(count)));
            let (_, first, _) = hall_picture(&tracer, trace(1, 3), Mode::Full);
            let truth = hall_picture(&tracer, trace(if bounces == 0 { 512 } else { 128 }, 99), Mode::Full).0;
            let (mut error, mut secs, mut rays) = (0.0, 0.0, 0);
            for seed in 0..SEEDS {
                let (picture, took, traced) = hall_picture(&tracer, trace(samples, seed), Mode::Full);
                (secs, rays) = (secs + took / SEEDS as f64, rays + traced / SEEDS);
                error += squared_error(&picture, &truth) / SEEDS as f64;
            }
            let of_twelve = *of_twelve.get_or_insert(error * secs);
            let (mse, ratio) = (error / f64::from(64 * 36), error * secs / of_twelve);
            eprintln!(
                "{bounces} bounces, {samples} samples, {count} lamps: first {first:.2} s, {secs:.3} s, \
                 {rays} rays, MSE {mse:.4}, noise x time {ratio:.2}"
            );
        }
    }
}
