//! Normal maps, and roughness, metal and transmission by picture.

use afterimage::camera::Camera;
use afterimage::math::key::Key;
use afterimage::reference::ReferenceFrame;
use afterimage::scene::{
    Detail, Encoding, Gradient, Material, MaterialId, MaterialKind, NormalMap, Sampling, Scene, SceneBuilder,
    Sky, Sun, Texture, TextureRef,
};
use afterimage::trace::parallel::NEVER;
use afterimage::trace::{RayCounts, TraceSettings};
use afterimage::{
    FrameRequest, Mode, RenderSettings, Renderer, Tracer, View, Walkthrough, WalkthroughSettings,
};
use glam::{DVec3, Vec2, Vec3};
use std::sync::Arc;
use std::time::Instant;

const SIZE: [u32; 2] = [24, 16];
const TRACE: TraceSettings = TraceSettings { samples: 4, bounces: 2, seed: 5 };

fn texture(width: u32, texels: Vec<[u8; 4]>) -> Texture {
    Texture { width, height: texels.len() as u32 / width, texels, encoding: Encoding::Linear }
}

fn even([r, g, b]: [u8; 3]) -> Texture {
    texture(2, vec![[r, g, b, 255]; 4])
}

/// Texels without a pattern.
fn random(side: u32, seed: u32) -> Texture {
    let byte = |i: u32, c: u32| Key::of_pixel(u64::from(seed), i).with(c).pair()[0] * 256.0;
    let texel = |i| [byte(i, 0) as u8, byte(i, 1) as u8, byte(i, 2) as u8, 255];
    texture(side, (0..side * side).map(texel).collect())
}

fn glossy(base: f32, reflectance: f32, roughness: f32) -> Material {
    let kind = MaterialKind::Glossy { reflectance: Vec3::splat(reflectance), roughness };
    Material { kind, ..Material::diffuse("glossy", Vec3::splat(base)) }
}

fn quad(b: &mut SceneBuilder, corners: [[f64; 3]; 4], material: MaterialId) {
    b.add_quad(corners.map(DVec3::from), Vec2::splat(4.0), material);
}

fn floor(b: &mut SceneBuilder, material: MaterialId) {
    quad(b, [[-4.0, 0.0, 4.0], [4.0, 0.0, 4.0], [4.0, 0.0, -4.0], [-4.0, 0.0, -4.0]], material);
}

/// Gives a material a normal map.
fn mapped(b: &mut SceneBuilder, mut material: Material, map: Texture, strength: f32) -> Material {
    let texture = TextureRef::plain(b.add_texture(map));
    material.detail.normal = Some(NormalMap { texture, strength });
    material
}

/// A room with a floor of a material, a lamp and a window to a sky.
fn room(make: impl FnOnce(&mut SceneBuilder) -> Material) -> Scene {
    let mut b = SceneBuilder::new("room");
    let of_floor = make(&mut b);
    let of_floor = b.add_material(of_floor);
    floor(&mut b, of_floor);
    let wall = b.add_material(Material::diffuse("wall", Vec3::new(0.8, 0.6, 0.4)));
    quad(&mut b, [[-4.0, 0.0, -4.0], [4.0, 0.0, -4.0], [4.0, 3.0, -4.0], [-4.0, 3.0, -4.0]], wall);
    quad(&mut b, [[-4.0, 0.0, 4.0], [-4.0, 0.0, -4.0], [-4.0, 3.0, -4.0], [-4.0, 3.0, 4.0]], wall);
    quad(&mut b, [[-4.0, 3.0, -4.0], [4.0, 3.0, -4.0], [4.0, 3.0, 1.0], [-4.0, 3.0, 1.0]], wall);
    let lamp = b.add_material(Material::emissive("lamp", Vec3::splat(9.0)));
    quad(&mut b, [[-1.0, 2.9, -2.0], [0.0, 2.9, -2.0], [0.0, 2.9, -1.0], [-1.0, 2.9, -1.0]], lamp);
    b.sky = Some(Sky::Gradient(Gradient {
        zenith: Vec3::new(0.5, 0.7, 1.0),
        horizon: Vec3::ONE,
        ground: Vec3::splat(0.1),
    }));
    b.finish().expect("a room")
}

fn camera() -> Camera {
    Camera::look_at(DVec3::new(0.7, 1.6, 3.5), DVec3::new(0.0, 0.2, -1.0), 60.0)
}

fn full(scene: Scene) -> Vec<Vec3> {
    let tracer = Tracer::new(Arc::new(scene));
    let settings = RenderSettings { mode: Mode::Full, trace: TRACE };
    Renderer::default().render(&FrameRequest::new(&tracer, &camera(), SIZE, &settings)).radiance.clone()
}

#[test]
fn a_flat_normal_map_has_the_very_bits_of_none() {
    for material in
        [Material::diffuse("floor", Vec3::splat(0.7)), glossy(0.5, 0.04, 0.3), glossy(0.0, 0.9, 0.4)]
    {
        let plain = full(room(|_| material.clone()));
        for flat in [[128, 128, 255], [127, 128, 255], [127, 127, 200]] {
            assert!(full(room(|b| mapped(b, material.clone(), even(flat), 3.0))) == plain, "{flat:?}");
        }
    }
}

#[test]
fn maps_and_coordinates_without_a_direction_give_the_plain_normal() {
    let material = || Material::diffuse("floor", Vec3::splat(0.7));
    let plain = full(room(|_| material()));
    // Zero, and directions into the surface.
    for odd in [[128, 128, 128], [255, 0, 0], [255, 128, 20]] {
        assert!(full(room(|b| mapped(b, material(), even(odd), 1.0))) == plain, "{odd:?}");
    }
    assert!(full(room(|b| mapped(b, material(), random(8, 1), 0.0))) == plain);
    let no_area = |b: &mut SceneBuilder| {
        let mut m = mapped(b, material(), random(8, 1), f32::NAN);
        m.detail.normal.as_mut().unwrap().texture.scale = Vec2::new(1.0, 0.0);
        m
    };
    assert!(full(room(no_area)) == plain);
}

/// The direct light of a sun on a floor whose map is tilted by 3 to 4 to 5 towards +u or +v, in
/// texture coordinates that are mirrored, turned and scaled.
#[test]
fn a_tilted_map_has_the_direct_light_of_tilted_geometry() {
    let sun = Vec3::new(0.3, 0.8, -0.2).normalize_or_zero();
    for (along_u, along_v) in [(3.0f32, 0.0f32), (0.0, 3.0), (-3.0, 0.0), (2.0, -2.0)] {
        for (scale, turn) in [([1.0, 1.0], 0.0f32), ([-1.0, 1.0], 0.0), ([2.0, -0.5], 0.0), ([1.0, 1.0], 0.7)]
        {
            let n = Vec3::new(along_u, along_v, 4.0).normalize_or_zero();
            let byte = |x: f32| (127.5 + x * 127.0 + 0.5 * x.signum()) as u8;
            let mut b = SceneBuilder::new("sun");
            let white = Material::diffuse("floor", Vec3::ONE);
            let mut material = mapped(&mut b, white, even(n.to_array().map(byte)), 1.0);
            let map = material.detail.normal.as_mut().unwrap();
            map.texture.scale = Vec2::from_array(scale);
            map.texture.sampling = Sampling { turn, ..Sampling::default() };
            let id = b.add_material(material);
            floor(&mut b, id);
            b.sun = Some(Sun { direction: sun, angular_radius: 0.0, irradiance: Vec3::ONE });
            let found = full(b.finish().unwrap())[12 * 24 + 12].x * std::f32::consts::PI;
            // Right in the picture is along +x where u is not mirrored, up is along -z.
            let (right, up) = (Vec3::X * f32::signum(scale[0]), Vec3::NEG_Z * f32::signum(scale[1]));
            // A picture that is turned by an angle lies turned back on the surface.
            let (sin, cos) = turn.sin_cos();
            let [right, up] = [right * cos - up * sin, right * sin + up * cos];
            let normal = right * n.x + up * n.y + Vec3::Y * n.z;
            let expected = normal.dot(sun);
            assert!((found - expected).abs() < 0.01, "{n}, {scale:?}, {turn}: {found} for {expected}");
        }
    }
}

/// Radiance of a floor in light of one from everywhere, seen from several heights.
fn in_white_light(make: impl Fn(&mut SceneBuilder) -> Material) -> Vec<f32> {
    let mut b = SceneBuilder::new("white");
    let material = make(&mut b);
    let id = b.add_material(material);
    floor(&mut b, id);
    b.sky = Some(Sky::Gradient(Gradient { zenith: Vec3::ONE, horizon: Vec3::ONE, ground: Vec3::ONE }));
    let tracer = Tracer::new(Arc::new(b.finish().unwrap()));
    let heights = [0.1, 0.7, 2.5];
    let of_height = heights.map(|height| {
        let camera = Camera::look_at(DVec3::new(0.2, height, 2.0), DVec3::ZERO, 20.0);
        let view = View::new(&camera, &tracer.scene().frame, [8, 6]);
        let settings = TraceSettings { samples: 64, bounces: 2, seed: 1 };
        let pixel = |pixel| tracer.pixel(&view, pixel, &settings, &mut RayCounts::default()).radiance;
        (0..48).map(pixel).sum::<Vec3>().max_element() / 48.0
    });
    of_height.into()
}

#[test]
fn random_maps_gain_no_energy() {
    for seed in 0..3 {
        for strength in [0.3, 1.0, 20.0] {
            for (base, reflectance, roughness) in [(1.0, 0.04, 0.1), (1.0, 0.04, 0.5), (0.0, 1.0, 0.3)] {
                let make = |b: &mut SceneBuilder| {
                    mapped(b, glossy(base, reflectance, roughness), random(16, seed), strength)
                };
                let found = in_white_light(make);
                assert!(found.iter().all(|light| *light < 1.02), "{strength} {roughness}: {found:?}");
            }
            let matte = |b: &mut SceneBuilder| {
                mapped(b, Material::diffuse("m", Vec3::ONE), random(16, seed), strength)
            };
            assert!(in_white_light(matte).iter().all(|light| *light < 1.0 + 1e-4));
        }
        let by_place = |b: &mut SceneBuilder| varied(b, glossy(1.0, 0.04, 1.0), random(16, seed), 1.0);
        let found = in_white_light(by_place);
        assert!(found.iter().all(|light| *light < 1.02), "{found:?}");
        for roughness in [0.0, 0.5, 1.0] {
            let sheet = |b: &mut SceneBuilder| in_part(b, roughness, random(16, seed));
            let found = in_white_light(sheet);
            assert!(found.iter().all(|light| *light < 1.02), "{roughness}: {found:?}");
        }
    }
}

/// Gives a glossy material a picture of roughness and metal, and a base colour by picture.
fn varied(b: &mut SceneBuilder, mut material: Material, map: Texture, metalness: f32) -> Material {
    let map = Some(TextureRef::plain(b.add_texture(map)));
    material.detail = Detail { metalness, metalness_texture: map, roughness_texture: map, ..material.detail };
    material
}

/// A sheet of glass that transmits by a picture.
fn in_part(b: &mut SceneBuilder, roughness: f32, map: Texture) -> Material {
    let (eta, transmittance) = (1.5, Vec3::ONE);
    let kind = match roughness {
        0.0 => MaterialKind::Glass { eta, transmittance },
        _ => MaterialKind::Frosted { eta, transmittance, roughness },
    };
    let texture = Some(TextureRef::plain(b.add_texture(map)));
    let detail = Detail { transmission: 1.0, transmission_texture: texture, ..Detail::default() };
    Material { kind, detail, is_thin: true, ..Material::diffuse("sheet", Vec3::ONE) }
}

/// A picture of one texel value, read without a filter, whose rounding would show.
fn unfiltered(material: &mut Material) {
    let nearest = Sampling { is_nearest: true, ..Sampling::default() };
    material.detail.textures_mut().into_iter().flatten().for_each(|used| used.sampling = nearest);
}

#[test]
fn an_even_picture_is_the_same_as_a_factor_bit_for_bit() {
    for byte in [0u8, 60, 200, 255] {
        let share = f32::from(byte) / 255.0;
        for metalness in [0.0, 0.5, 1.0] {
            let by_picture = full(room(|b| {
                let mut material = varied(b, glossy(0.6, 0.04, 0.8), even([9, byte, byte]), metalness);
                unfiltered(&mut material);
                material
            }));
            let m = metalness * share;
            let kind = MaterialKind::Glossy {
                reflectance: if m > 0.0 {
                    Vec3::splat(0.04).lerp(Vec3::splat(0.6), m)
                } else {
                    Vec3::splat(0.04)
                },
                roughness: 0.8 * share,
            };
            let diffuse = Vec3::splat(0.6) * (1.0 - m);
            let by_factor = full(room(|_| Material { kind, ..Material::diffuse("floor", diffuse) }));
            assert!(by_picture == by_factor, "{byte}, {metalness}");
        }
    }
}

#[test]
fn a_picture_of_transmission_casts_the_shadow_of_its_frame() {
    let mut b = SceneBuilder::new("pane");
    let white = b.add_material(Material::diffuse("floor", Vec3::ONE));
    floor(&mut b, white);
    let half = texture(2, vec![[255, 0, 0, 255], [0, 0, 0, 255]]);
    let mut pane = in_part(&mut b, 0.0, half);
    pane.detail.transmission_texture.as_mut().unwrap().scale = Vec2::splat(0.25);
    unfiltered(&mut pane);
    let pane = b.add_material(pane);
    quad(&mut b, [[-4.0, 5.0, 4.0], [4.0, 5.0, 4.0], [4.0, 5.0, -4.0], [-4.0, 5.0, -4.0]], pane);
    b.sun = Some(Sun { direction: Vec3::Y, angular_radius: 0.0, irradiance: Vec3::ONE });
    let tracer = Tracer::new(Arc::new(b.finish().unwrap()));
    let light = |x: f64| {
        let camera = Camera::look_at(DVec3::new(x, 2.0, 0.1), DVec3::new(x, 0.0, 0.0), 2.0);
        let view = View::new(&camera, &tracer.scene().frame, [1, 1]);
        let settings = TraceSettings { samples: 1, bounces: 0, seed: 1 };
        tracer.pixel(&view, 0, &settings, &mut RayCounts::default()).radiance.x * std::f32::consts::PI
    };
    assert!(light(-2.0) > 0.9 && light(2.0) == 0.0, "{} and {}", light(-2.0), light(2.0));
}

/// Waves and noise, as on plaster.
fn plaster() -> Texture {
    let texel = |i: u32| {
        let (x, y) = ((i % 32) as f32, (i / 32) as f32);
        let part = |phase: f32| (128.0 + 60.0 * phase.sin()) as u8;
        [part(x * 0.6 + 0.3 * y), part(y * 0.8), 220, 255]
    };
    texture(32, (0..32 * 32).map(texel).collect())
}

/// A walk past a room.
struct Walk {
    tracer: Arc<Tracer>,
    trace: TraceSettings,
    size: [u32; 2],
    step_m: f64,
    frames: u32,
}

impl Walk {
    fn new(material: impl Fn(&mut SceneBuilder) -> Material, size: [u32; 2], trace: TraceSettings) -> Self {
        let tracer = Arc::new(Tracer::new(Arc::new(room(material))));
        Self { tracer, trace, size, step_m: 0.3, frames: 5 }
    }

    fn camera(&self, frame: u32) -> Camera {
        let eye = DVec3::new(-1.0 + self.step_m * f64::from(frame), 1.5, 3.4);
        Camera::look_at(eye, DVec3::new(0.0, 0.2, -1.0), 60.0)
    }

    /// The last frame in mode `full`.
    fn full(&self, seed: u64) -> Vec<Vec3> {
        let settings = RenderSettings { mode: Mode::Full, trace: TraceSettings { seed, ..self.trace } };
        let (camera, mut renderer) = (self.camera(self.frames - 1), Renderer::default());
        let request = FrameRequest::new(&self.tracer, &camera, self.size, &settings);
        renderer.render(&request).radiance.clone()
    }

    fn truth(&self, passes: u64) -> Vec<Vec3> {
        let mut truth = vec![Vec3::ZERO; (self.size[0] * self.size[1]) as usize];
        for seed in 0..passes {
            let picture = self.full(1000 + seed);
            truth.iter_mut().zip(picture).for_each(|(sum, r)| *sum += r / passes as f32);
        }
        truth
    }

    /// The last frame of the walk in a mode that looks up, and seconds of a frame of its second
    /// half.
    fn looked_up(&self, mode: Mode) -> (Vec<Vec3>, f64) {
        let mut walk = Walkthrough::new(self.tracer.clone(), WalkthroughSettings::default());
        let mut settings = *walk.settings();
        settings.render = RenderSettings { mode, trace: self.trace };
        walk.set_settings(settings);
        let mut frame = |k| _ = walk.render(&self.camera(k), self.size, NEVER);
        (0..self.frames / 2).for_each(&mut frame);
        let start = Instant::now();
        (self.frames / 2..self.frames).for_each(&mut frame);
        let secs = start.elapsed().as_secs_f64() / f64::from(self.frames.div_ceil(2));
        (walk.frame().radiance.clone(), secs)
    }

    /// True for each pixel of the last frame that shows the floor.
    fn floor(&self) -> Vec<bool> {
        let scene = self.tracer.scene();
        let view = View::new(&self.camera(self.frames - 1), &scene.frame, self.size);
        let hit = |pixel| self.tracer.closest(&Tracer::primary_ray(&view, pixel));
        let is_floor =
            |pixel| hit(pixel).is_some_and(|h| scene.triangle_materials[h.triangle as usize].0 == 0);
        (0..self.size[0] * self.size[1]).map(is_floor).collect()
    }
}

#[test]
fn a_reference_of_the_view_shows_its_relief_in_mode_paper() {
    let scene = room(|b| mapped(b, Material::diffuse("floor", Vec3::splat(0.7)), plaster(), 2.0));
    let expected = full(scene.clone());
    let tracer = Tracer::new(Arc::new(scene));
    let reference = ReferenceFrame::trace(&tracer, &camera(), SIZE, &TRACE, NEVER).expect("a reference");
    let settings = RenderSettings { mode: Mode::Paper, trace: TRACE };
    let mut renderer = Renderer::default();
    let (camera, references) = (camera(), [&reference]);
    let request = FrameRequest::new(&tracer, &camera, SIZE, &settings).warping(&references);
    let shown = &renderer.render(&request).radiance;
    for (shown, expected) in shown.iter().zip(&expected) {
        // Stored light is rounded to a 512th of its largest channel, in two parts.
        let most = expected.max_element() / 256.0;
        assert!((*shown - *expected).abs().max_element() <= most + 1e-6, "{shown} for {expected}");
    }
    assert!(renderer.frame().stats.types.reused > 300, "{:?}", renderer.frame().stats.types);
}

/// By the mean squared error of the floor's radiance. Prints the figures of docs/RESULTS.md.
#[test]
fn exact_has_less_error_than_full_on_gentle_relief_and_little_more_on_steep() {
    for (strength, [most_exact, most_fast]) in [(1.0, [0.7, 1.1]), (3.0, [1.2, 4.0])] {
        let floor = |b: &mut SceneBuilder| {
            mapped(b, Material::diffuse("floor", Vec3::splat(0.7)), plaster(), strength)
        };
        let trace = TraceSettings { samples: 16, bounces: u32::MAX, seed: 3 };
        let walk = Walk { step_m: 0.05, frames: 16, ..Walk::new(floor, [160, 100], trace) };
        let (truth, floor) = (walk.truth(32), walk.floor());
        let count = floor.iter().filter(|is_floor| **is_floor).count() as f64;
        let print = |name: &str, (shown, secs): (Vec<Vec3>, f64)| {
            let off = shown.iter().zip(&truth).zip(&floor).filter(|(_, is_floor)| **is_floor);
            let sum: f64 = off.map(|((a, b), _)| f64::from((*a - *b).length_squared())).sum();
            eprintln!("strength {strength}, {name}: {secs:.3} s, squared error {:.4}", sum / count);
            sum / count
        };
        let start = Instant::now();
        let full = walk.full(3);
        let of_full = print("full", (full, start.elapsed().as_secs_f64()));
        let of_exact = print("exact", walk.looked_up(Mode::Exact));
        let of_fast = print("fast", walk.looked_up(Mode::Fast));
        assert!(
            of_exact < most_exact * of_full && of_fast < most_fast * of_full,
            "{of_exact}, {of_fast} and {of_full}"
        );
    }
}
