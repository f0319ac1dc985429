//! Emission by picture and alpha that varies: what is seen, and what reaches the room.

use afterimage::camera::Camera;
use afterimage::math::{Ray, key::Key};
use afterimage::render::WalkthroughSettings;
use afterimage::scene::{
    Encoding, LightSetting, Material, MaterialKind, Scene, SceneBuilder, Texture, TextureRef,
};
use afterimage::trace::RayCounts;
use afterimage::trace::parallel::NEVER;
use afterimage::{Mode, Tracer, Walkthrough};
use glam::{DVec3, Vec2, Vec3};
use std::sync::Arc;

const MODES: [Mode; 4] = [Mode::Full, Mode::Exact, Mode::Fast, Mode::Paper];

fn texture(side: u32, texel: impl Fn(u32, u32) -> [u8; 4]) -> Texture {
    let texels = (0..side * side).map(|i| texel(i % side, i / side)).collect();
    Texture { width: side, height: side, texels, encoding: Encoding::Linear }
}

/// A screen of 2 m by 2 m that hangs 3 m above a floor, dark but for a small red and a dim blue
/// window.
fn screen() -> SceneBuilder {
    let mut b = SceneBuilder::new("screen");
    let floor = b.add_material(Material::diffuse("floor", Vec3::splat(0.5)));
    let picture = b.add_texture(texture(32, |x, y| match (x, y) {
        (3..6, 24..27) => [255, 20, 10, 255],
        (16..30, 2..12) => [0, 0, 12, 255],
        _ => [0, 0, 0, 255],
    }));
    let mut lit = Material::emissive("screen", Vec3::new(3.0, 2.0, 5.0));
    lit.emission_texture = Some(TextureRef::plain(picture));
    let lit = b.add_material(lit);
    b.add_quad(plane(4.0, 0.0), Vec2::ONE, floor);
    b.add_quad(plane(1.0, 3.0), Vec2::ONE, lit);
    b
}

/// A square of twice `half` at a height, seen from above.
fn plane(half: f64, y: f64) -> [DVec3; 4] {
    [[-half, half], [half, half], [half, -half], [-half, -half]].map(|[x, z]| DVec3::new(x, y, z))
}

fn build(b: SceneBuilder) -> Arc<Tracer> {
    Arc::new(Tracer::new(Arc::new(b.finish().unwrap())))
}

/// Irradiance on the floor under a point, by the mean over `calls` of 16 samples each, and the root
/// mean square of single calls relative to it.
fn irradiance(tracer: &Tracer, at: [f64; 2], calls: u32) -> (Vec3, f32) {
    let frame = tracer.scene().frame;
    let eye = frame.scene_from_world_f64(DVec3::new(at[0], 1.0, at[1])).as_vec3();
    let ray = Ray::new(eye, Vec3::NEG_Y);
    let point = tracer.surface(&ray, &tracer.closest(&ray).unwrap());
    let one = |i| tracer.irradiance(&point, 16, Key::of_pixel(5, i), &mut RayCounts::default());
    let all: Vec<Vec3> = (0..calls).map(one).collect();
    let mean = all.iter().sum::<Vec3>() / calls as f32;
    let square = all.iter().map(|e| (*e - mean).length_squared()).sum::<f32>() / calls as f32;
    (mean, square.sqrt() / mean.length())
}

/// Irradiance by a sum over the screen, without random numbers.
fn summed(scene: &Scene, at: [f64; 2]) -> Vec3 {
    const STEPS: u32 = 512;
    let m = scene.materials.iter().find(|m| m.name == "screen").unwrap();
    let mut sum = Vec3::ZERO;
    for i in 0..STEPS * STEPS {
        let [u, v] = [i % STEPS, i / STEPS].map(|k| (k as f32 + 0.5) / STEPS as f32);
        // The first corner is at -x, +z.
        let d = Vec3::new(2.0 * u - 1.0 - at[0] as f32, 3.0, 1.0 - 2.0 * v - at[1] as f32);
        let cos2 = (d.y / d.length()).powi(2);
        sum += m.emission_at(&scene.textures, || Vec2::new(u, v)) * (cos2 / d.length_squared());
    }
    sum * (4.0 / (STEPS * STEPS) as f32)
}

#[test]
fn a_picture_lights_the_room_in_proportion_without_a_bias() {
    let tracer = build(screen());
    assert_eq!(tracer.scene().lights.len(), 1);
    for at in [[0.0, 0.0], [-0.9, 0.8], [1.7, -2.1]] {
        let (mean, noise) = irradiance(&tracer, at, 2000);
        let expected = summed(tracer.scene(), at);
        let error = (mean - expected).abs() / expected;
        assert!(error.max_element() < 0.02, "{at:?}: {mean} instead of {expected}");
        // A hundredth of the screen is bright: samples spread evenly would be off by 100 %.
        assert!(noise < 0.4, "{noise}");
    }
}

/// A rough metal floor under a lit window of 1 m by 1 m, which is a part of a dark screen or a
/// lamp.
fn rough_floor(roughness: f32, is_picture: bool) -> SceneBuilder {
    let mut b = SceneBuilder::new("rough floor");
    let kind = MaterialKind::Glossy { reflectance: Vec3::splat(0.8), roughness };
    let floor = b.add_material(Material { kind, ..Material::diffuse("floor", Vec3::ZERO) });
    b.add_quad(plane(4.0, 0.0), Vec2::ONE, floor);
    let mut lit = Material::emissive("screen", Vec3::splat(4.0));
    if is_picture {
        let window = |k: u32| (16..48).contains(&k);
        let picture = texture(64, |x, y| if window(x) && window(y) { [255; 4] } else { [0, 0, 0, 255] });
        lit.emission_texture = Some(TextureRef::plain(b.add_texture(picture)));
    }
    let lit = b.add_material(lit);
    b.add_quad(plane(if is_picture { 1.0 } else { 0.5 }, 1.5), Vec2::ONE, lit);
    b
}

#[test]
fn a_rough_floor_shows_a_picture_as_it_shows_a_lamp_of_the_same_light() {
    let camera = Camera::look_at(DVec3::new(0.0, 1.2, 3.0), DVec3::new(0.0, 0.0, 0.2), 40.0);
    for roughness in [0.1, 0.3, 0.7] {
        let [picture, lamp] = [true, false].map(|is_picture| {
            let mut settings = WalkthroughSettings::default();
            settings.render.mode = Mode::Full;
            settings.render.trace.samples = 16;
            let mut walk = Walkthrough::new(build(rough_floor(roughness, is_picture)), settings);
            let frame = walk.render(&camera, [64, 48], NEVER);
            frame.radiance.iter().map(|c| c.x).sum::<f32>() / frame.radiance.len() as f32
        });
        assert!(lamp > 0.01 && (picture / lamp - 1.0).abs() < 0.03, "{roughness}: {picture}, {lamp}");
    }
}

#[test]
fn a_dimmed_picture_brings_less_light() {
    let tracer = build(screen());
    let scene = tracer.scene().clone();
    let mut edit = scene.to_edit();
    let half = LightSetting { intensity: 0.5, ..LightSetting::FULL };
    edit.lights.set(&scene.light_groups.list[0].name.clone(), half);
    let dimmed = tracer.with_same_geometry(Arc::new(scene.with_edit(&edit)));
    let [(full, _), (less, _)] = [&tracer, &Arc::new(dimmed)].map(|t| irradiance(t, [0.3, 0.2], 50));
    assert!((less - full * 0.5).abs().max_element() < 1e-5 * full.max_element(), "{less}, {full}");
}

#[test]
fn the_picture_is_seen_in_every_mode() {
    let tracer = build(screen());
    let camera = Camera::look_at(DVec3::new(0.1, 0.5, 0.1), DVec3::new(0.0, 3.0, 0.0), 60.0);
    for mode in MODES {
        let mut settings = WalkthroughSettings::default();
        settings.render.mode = mode;
        let mut walk = Walkthrough::new(tracer.clone(), settings);
        for _ in 0..2 {
            let frame = walk.render(&camera, [90, 90], NEVER);
            let red = frame.radiance.iter().filter(|c| c.x > 2.0 && c.z < 0.5).count();
            let blue = frame.radiance.iter().filter(|c| c.x < 0.01 && c.z > 0.2).count();
            assert!((15..80).contains(&red) && blue > 200, "{mode:?}: {red}, {blue}");
        }
    }
}

/// A wall behind a curtain whose alpha rises from left to right.
fn curtain() -> SceneBuilder {
    let mut b = SceneBuilder::new("curtain");
    let mut wall = Material::emissive("wall", Vec3::new(0.0, 1.0, 0.0));
    wall.diffuse = Vec3::splat(0.004);
    let wall = b.add_material(wall);
    let cloth = b.add_texture(texture(64, |x, _| [255, 255, 255, (x * 4) as u8]));
    let mut sheer = Material::diffuse("curtain", Vec3::splat(0.004));
    sheer.cover_by(TextureRef::plain(cloth));
    sheer.emission = Vec3::new(1.0, 0.0, 0.0);
    let sheer = b.add_material(sheer);
    b.add_quad(plane(8.0, 0.0), Vec2::ONE, wall);
    b.add_quad(plane(2.0, 1.0), Vec2::ONE, sheer);
    b
}

#[test]
fn a_curtain_shows_what_is_behind_it_in_proportion_in_every_mode() {
    let tracer = build(curtain());
    let camera = Camera::look_at(DVec3::new(0.0, 4.0, 0.01), DVec3::ZERO, 50.0);
    for mode in MODES {
        let mut settings = WalkthroughSettings::default();
        settings.render.mode = mode;
        settings.render.trace.samples = 1;
        let mut walk = Walkthrough::new(tracer.clone(), settings);
        for _ in 0..2 {
            let frame = walk.render(&camera, [64, 64], NEVER);
            let row = &frame.radiance[32 * 64..33 * 64];
            // Red comes from the curtain, green from the wall behind it.
            for (x, c) in row.iter().enumerate().skip(8).take(48) {
                let at = 3.0 * ((x as f32 + 0.5) / 32.0 - 1.0) * (25f32.to_radians()).tan();
                let alpha = ((at + 2.0) / 4.0 * 64.0 - 0.5) * 4.0 / 255.0;
                let off = Vec3::new(c.x - alpha, c.y - (1.0 - alpha), c.z).abs().max_element();
                assert!(off < 0.05, "{mode:?}, {x}: {c}, {alpha}");
            }
        }
    }
}

#[test]
fn a_curtain_casts_a_shadow_in_proportion() {
    let tracer = build(curtain());
    let frame = tracer.scene().frame;
    for x in [-1.9, -1.0, 0.0, 0.7, 1.9] {
        let at = |y| frame.scene_from_world_f64(DVec3::new(x, y, 0.1)).as_vec3();
        let ray = Ray::segment(at(0.2), at(3.0));
        let alpha = ((x as f32 + 2.0) / 4.0 * 64.0 - 0.5) * 4.0 / 255.0;
        let passed = tracer.transmittance(&ray, &mut Default::default());
        assert!((passed - Vec3::splat(1.0 - alpha)).abs().max_element() < 0.01, "{x}: {passed}");
    }
}
