//! Rough surfaces in scenes: what lights and rays of a lobe bring together is what plain sampling
//! of the lobe brings, and reuse shows no highlight of another view.

use afterimage::bsdf::Lobe;
use afterimage::camera::Camera;
use afterimage::math::key::Key;
use afterimage::scene::{Gradient, Material, MaterialId, MaterialKind, Scene, SceneBuilder, Sky, Sun};
use afterimage::trace::parallel::NEVER;
use afterimage::trace::{SurfacePoint, TraceSettings};
use afterimage::{
    FrameRequest, Mode, RenderSettings, Renderer, Tracer, View, Walkthrough, WalkthroughSettings,
};
use glam::{DVec3, Vec2, Vec3};
use std::sync::Arc;

fn glossy(base: f32, reflectance: f32, roughness: f32) -> Material {
    let kind = MaterialKind::Glossy { reflectance: Vec3::splat(reflectance), roughness };
    Material { kind, ..Material::diffuse("glossy", Vec3::splat(base)) }
}

fn pane(roughness: f32) -> Material {
    let kind = MaterialKind::Frosted { eta: 1.5, transmittance: Vec3::splat(0.9), roughness };
    Material { kind, ..Material::diffuse("pane", Vec3::ZERO) }
}

fn quad(b: &mut SceneBuilder, corners: [[f64; 3]; 4], material: MaterialId) {
    b.add_quad(corners.map(DVec3::from), Vec2::ONE, material);
}

/// A floor of a material under a large and a small lamp, with a third behind the viewer.
fn under_lamps(floor: Material) -> SceneBuilder {
    let mut b = SceneBuilder::new("lamps");
    let floor = b.add_material(floor);
    quad(&mut b, [[-4.0, 0.0, -4.0], [-4.0, 0.0, 4.0], [4.0, 0.0, 4.0], [4.0, 0.0, -4.0]], floor);
    let dim = b.add_material(Material::emissive("dim", Vec3::splat(2.0)));
    quad(&mut b, [[-2.0, 3.0, -4.0], [2.0, 3.0, -4.0], [2.0, 3.0, -2.0], [-2.0, 3.0, -2.0]], dim);
    let small = b.add_material(Material::emissive("small", Vec3::new(40.0, 30.0, 20.0)));
    quad(&mut b, [[0.5, 1.5, -2.5], [0.8, 1.5, -2.5], [0.8, 1.8, -2.5], [0.5, 1.8, -2.5]], small);
    b
}

fn tracer(b: SceneBuilder) -> Tracer {
    Tracer::new(Arc::new(b.finish().expect("a scene")))
}

const SIZE: [u32; 2] = [12, 8];

fn camera() -> Camera {
    Camera::look_at(DVec3::new(0.3, 1.2, 2.5), DVec3::new(0.2, 0.0, 0.0), 30.0)
}

/// Mean radiance of a picture of mode `full`, over several seeds.
fn full(tracer: &Tracer, trace: TraceSettings, passes: u64) -> Vec3 {
    let (mut sum, mut renderer) = (Vec3::ZERO, Renderer::default());
    for seed in 0..passes {
        let settings = RenderSettings { mode: Mode::Full, trace: TraceSettings { seed, ..trace } };
        let frame = renderer.render(&FrameRequest::new(tracer, &camera(), SIZE, &settings));
        sum += frame.radiance.iter().sum::<Vec3>() / frame.radiance.len() as f32;
    }
    sum / passes as f32
}

/// What a rough surface shows by rays of its lobe alone, which see lamps, the sky and panes.
fn by_lobe_alone(tracer: &Tracer, point: &SurfacePoint, incident: Vec3, key: Key) -> Vec3 {
    let scene = tracer.scene();
    let (mut point, mut incident, mut throughput, mut radiance) = (*point, incident, Vec3::ONE, Vec3::ZERO);
    for bounce in 0..4 {
        let material = &scene.materials[point.material.0 as usize];
        let [choice, _] = key.with(2 * bounce).pair();
        let set = material.sample(&point.facing(scene), incident, key.with(2 * bounce + 1).pair());
        let Some(scatter) = set.choose(choice) else { break };
        throughput *= scatter.weight;
        let ray = point.scattered_ray(&scatter);
        let Some(hit) = tracer.closest(&ray) else {
            radiance += throughput * tracer.sky(ray.direction);
            break;
        };
        (point, incident) = (tracer.surface(&ray, &hit), ray.direction);
        radiance += throughput * scene.materials[point.material.0 as usize].emission;
    }
    radiance
}

/// Mean of [`by_lobe_alone`] over a picture.
fn slow(tracer: &Tracer, samples: u32) -> Vec3 {
    let view = View::new(&camera(), &tracer.scene().frame, SIZE);
    let mut sum = Vec3::ZERO;
    for pixel in 0..SIZE[0] * SIZE[1] {
        let ray = Tracer::primary_ray(&view, pixel);
        let hit = tracer.closest(&ray).expect("the floor fills the picture");
        let (point, incident) = (tracer.surface(&ray, &hit), ray.direction.normalize_or_zero());
        let of = |i| by_lobe_alone(tracer, &point, incident, Key::of_pixel(99, pixel).with(i));
        sum += (0..samples).map(of).sum::<Vec3>() / samples as f32;
    }
    sum / (SIZE[0] * SIZE[1]) as f32
}

fn assert_close(found: Vec3, expected: Vec3, share: f32, what: &str) {
    let off = ((found - expected) / expected).abs().max_element();
    assert!(off < share, "{what}: {found} for {expected}");
}

#[test]
fn lamps_on_rough_metal_are_what_plain_sampling_of_the_lobe_finds() {
    for roughness in [0.1, 0.3, 0.7] {
        let tracer = tracer(under_lamps(glossy(0.0, 0.9, roughness)));
        let found = full(&tracer, TraceSettings { samples: 16, bounces: 0, seed: 0 }, 300);
        assert_close(found, slow(&tracer, 4000), 0.02, &format!("roughness {roughness}"));
    }
}

#[test]
fn lamps_behind_frosted_glass_are_what_plain_sampling_of_the_lobe_finds() {
    for roughness in [0.2, 0.5] {
        let mut b = under_lamps(pane(roughness));
        let lamp = b.add_material(Material::emissive("below", Vec3::new(3.0, 9.0, 3.0)));
        quad(&mut b, [[-0.4, -1.0, -0.4], [0.4, -1.0, -0.4], [0.4, -1.0, 0.4], [-0.4, -1.0, 0.4]], lamp);
        let tracer = tracer(b);
        let found = full(&tracer, TraceSettings { samples: 16, bounces: 0, seed: 0 }, 300);
        assert_close(found, slow(&tracer, 16_000), 0.03, &format!("roughness {roughness}"));
    }
}

#[test]
fn the_sky_on_rough_metal_is_what_the_lobe_scatters() {
    let mut b = SceneBuilder::new("sky");
    let floor = b.add_material(glossy(0.0, 1.0, 0.6));
    quad(&mut b, [[-4.0, 0.0, -4.0], [-4.0, 0.0, 4.0], [4.0, 0.0, 4.0], [4.0, 0.0, -4.0]], floor);
    b.sky = Some(Sky::Gradient(Gradient { zenith: Vec3::ONE, horizon: Vec3::ONE, ground: Vec3::ONE }));
    let tracer = tracer(b);
    for bounces in [0, 2] {
        let found = full(&tracer, TraceSettings { samples: 16, bounces, seed: 0 }, 4);
        assert!(found.max_element() <= 1.0 + 1e-4 && found.min_element() > 0.9, "a furnace: {found}");
    }
}

#[test]
fn a_sun_on_a_coat_shines_as_its_lobe_is_bright() {
    let mut b = SceneBuilder::new("sun");
    let floor = b.add_material(glossy(0.2, 0.04, 0.3));
    quad(&mut b, [[-4.0, 0.0, -4.0], [-4.0, 0.0, 4.0], [4.0, 0.0, 4.0], [4.0, 0.0, -4.0]], floor);
    let direction = Vec3::new(0.05, 0.5, -0.9).normalize_or_zero();
    b.sun = Some(Sun { direction, angular_radius: 0.0, irradiance: Vec3::splat(3.0) });
    let tracer = tracer(b);
    let (scene, view) = (tracer.scene(), View::new(&camera(), &tracer.scene().frame, SIZE));
    let mut expected = Vec3::ZERO;
    for pixel in 0..SIZE[0] * SIZE[1] {
        let ray = Tracer::primary_ray(&view, pixel);
        let point = tracer.surface(&ray, &tracer.closest(&ray).expect("a floor"));
        let material = &scene.materials[point.material.0 as usize];
        let lobe = material.evaluate(&point.facing(scene), ray.direction.normalize_or_zero(), direction);
        let diffuse = point.albedo(scene) / std::f32::consts::PI;
        expected += (lobe + diffuse) * direction.y * 3.0 / (SIZE[0] * SIZE[1]) as f32;
    }
    let found = full(&tracer, TraceSettings { samples: 4, bounces: 0, seed: 0 }, 1);
    assert_close(found, expected, 1e-3, "sun");
}

/// A matte floor and a lamp before a wall of metal.
fn before_wall(roughness: f32) -> SceneBuilder {
    let mut b = SceneBuilder::new("wall");
    let floor = b.add_material(Material::diffuse("floor", Vec3::splat(0.5)));
    quad(&mut b, [[-4.0, 0.0, -4.0], [-4.0, 0.0, 4.0], [4.0, 0.0, 4.0], [4.0, 0.0, -4.0]], floor);
    let wall = b.add_material(glossy(0.0, 0.9, roughness));
    quad(&mut b, [[-3.0, 0.0, -1.0], [3.0, 0.0, -1.0], [3.0, 3.0, -1.0], [-3.0, 3.0, -1.0]], wall);
    let lamp = b.add_material(Material::emissive("lamp", Vec3::splat(5.0)));
    quad(&mut b, [[-1.0, 2.5, 1.0], [1.0, 2.5, 1.0], [1.0, 2.5, 3.0], [-1.0, 2.5, 3.0]], lamp);
    b
}

/// Few paths find a small lamp by way of smooth metal, so paths take it as half rough.
#[test]
fn smooth_metal_lights_a_floor_as_half_rough_metal_does() {
    let [smooth, rough] = [0.05, 0.5].map(|roughness| {
        let tracer = tracer(before_wall(roughness));
        let view = View::new(&camera(), &tracer.scene().frame, SIZE);
        let settings = TraceSettings { samples: 4, bounces: 1, seed: 1 };
        let pixel = |pixel| tracer.pixel(&view, pixel, &settings, &mut Default::default());
        let traced = (0..SIZE[0] * SIZE[1]).map(pixel);
        traced.filter(|traced| traced.reflections == 0).map(|traced| traced.radiance).collect::<Vec<_>>()
    });
    assert!(smooth.len() > 20 && smooth == rough, "{} pixels show the floor", smooth.len());
}

/// Light that reaches a matte floor by way of a rough metal wall.
#[test]
fn light_by_way_of_rough_metal_is_what_plain_paths_find() {
    let b = before_wall(0.5);
    // A lamp without size is found by shadow rays alone: it must not be lost.
    let dark = tracer(b);
    let view = View::new(&camera(), &dark.scene().frame, SIZE);
    let scene = dark.scene();
    let (mut plain, mut count) = (Vec3::ZERO, 0u32);
    for pixel in 0..SIZE[0] * SIZE[1] {
        let ray = Tracer::primary_ray(&view, pixel);
        let point = dark.surface(&ray, &dark.closest(&ray).expect("a hit"));
        if scene.materials[point.material.0 as usize].is_glossy() {
            continue;
        }
        count += 1;
        for i in 0..4000 {
            let key = Key::of_pixel(7, pixel).with(i);
            let facing = point.facing(scene);
            let Some(d) = afterimage::bsdf::Diffuse::sample_direction(&facing, key.pair()) else { continue };
            let ray = afterimage::math::Ray::new(point.origin_in_front(), d);
            let Some(hit) = dark.closest(&ray) else { continue };
            let next = dark.surface(&ray, &hit);
            if scene.materials[next.material.0 as usize].is_glossy() {
                plain += by_lobe_alone(&dark, &next, d, key.with(1)) * 0.5 / 4000.0;
            }
        }
    }
    let mut found = Vec3::ZERO;
    for (bounces, sign) in [(1, 1.0), (0, -1.0)] {
        for seed in 0..24 {
            let settings = TraceSettings { samples: 16, bounces, seed };
            for pixel in 0..SIZE[0] * SIZE[1] {
                let traced = dark.pixel(&view, pixel, &settings, &mut Default::default());
                if traced.reflections == 0 {
                    found += traced.radiance * (sign / 24.0);
                }
            }
        }
    }
    assert!(count > 20, "{count} pixels show the floor");
    assert_close(found, plain, 0.04, "by way of the wall");
}

/// A room with a varnished floor, a rough metal block and a lamp.
fn hall() -> Scene {
    let mut b = SceneBuilder::new("hall");
    let mut add = |material| b.add_material(material);
    let (floor, wall) = (add(glossy(0.3, 0.04, 0.2)), add(Material::diffuse("wall", Vec3::splat(0.7))));
    let (metal, lamp) = (add(glossy(0.0, 0.8, 0.35)), add(Material::emissive("lamp", Vec3::splat(12.0))));
    quad(&mut b, [[-3.0, 0.0, -4.0], [-3.0, 0.0, 4.0], [3.0, 0.0, 4.0], [3.0, 0.0, -4.0]], floor);
    quad(&mut b, [[-3.0, 3.0, -4.0], [3.0, 3.0, -4.0], [3.0, 3.0, 4.0], [-3.0, 3.0, 4.0]], wall);
    quad(&mut b, [[-3.0, 0.0, -4.0], [3.0, 0.0, -4.0], [3.0, 3.0, -4.0], [-3.0, 3.0, -4.0]], wall);
    quad(&mut b, [[-3.0, 0.0, 4.0], [-3.0, 3.0, 4.0], [3.0, 3.0, 4.0], [3.0, 0.0, 4.0]], wall);
    quad(&mut b, [[-3.0, 0.0, -4.0], [-3.0, 3.0, -4.0], [-3.0, 3.0, 4.0], [-3.0, 0.0, 4.0]], wall);
    quad(&mut b, [[3.0, 0.0, -4.0], [3.0, 0.0, 4.0], [3.0, 3.0, 4.0], [3.0, 3.0, -4.0]], wall);
    quad(&mut b, [[-0.5, 2.9, -2.0], [0.5, 2.9, -2.0], [0.5, 2.9, -1.0], [-0.5, 2.9, -1.0]], lamp);
    quad(&mut b, [[1.0, 0.0, -2.0], [1.8, 0.0, -2.4], [1.8, 1.5, -2.4], [1.0, 1.5, -2.0]], metal);
    b.finish().expect("a hall")
}

fn clipped(radiance: &[Vec3]) -> Vec<Vec3> {
    radiance.iter().map(|r| r.clamp(Vec3::ZERO, Vec3::ONE)).collect()
}

#[test]
fn no_highlight_is_older_than_its_view() {
    let (size, tracer) = ([96, 60], Arc::new(Tracer::new(Arc::new(hall()))));
    let trace = TraceSettings { samples: 16, bounces: 2, seed: 3 };
    let at = |k: f64| Camera::look_at(DVec3::new(-1.2 + 0.3 * k, 1.5, 3.4), DVec3::new(0.0, 0.3, -1.5), 60.0);
    let picture = |camera: &Camera, seed: u64| {
        let settings = RenderSettings { mode: Mode::Full, trace: TraceSettings { seed, ..trace } };
        let mut renderer = Renderer::default();
        renderer.render(&FrameRequest::new(&tracer, camera, size, &settings)).radiance.clone()
    };
    let mut walk = Walkthrough::new(tracer.clone(), WalkthroughSettings::default());
    let mut settings = *walk.settings();
    settings.render = RenderSettings { mode: Mode::Exact, trace };
    walk.set_settings(settings);
    for k in 0..5 {
        walk.render(&at(f64::from(k)), size, NEVER);
    }
    let exact = walk.frame().radiance.clone();
    let mut truth = vec![Vec3::ZERO; exact.len()];
    for seed in 0..24 {
        truth.iter_mut().zip(picture(&at(4.0), 1000 + seed)).for_each(|(sum, r)| *sum += r / 24.0);
    }
    let view = View::new(&at(4.0), &tracer.scene().frame, size);
    let is_rough = |pixel: u32| {
        let hit = tracer.closest(&Tracer::primary_ray(&view, pixel));
        hit.is_some_and(|hit| tracer.scene().material_of(hit.triangle).is_glossy())
    };
    let (truth, exact, one) = (clipped(&truth), clipped(&exact), clipped(&picture(&at(4.0), 3)));
    let error = |shown: &[Vec3]| {
        let rough = (0..size[0] * size[1]).filter(|&pixel| is_rough(pixel)).map(|pixel| pixel as usize);
        rough.map(|i| f64::from((shown[i] - truth[i]).length_squared())).sum::<f64>()
    };
    let (of_exact, of_full) = (error(&exact), error(&one));
    assert!(of_exact <= of_full, "{of_exact} for {of_full}");
    // The frame traced what it shows there.
    assert!(walk.frame().stats.types.secondary > 500, "{:?}", walk.frame().stats.types);
}
