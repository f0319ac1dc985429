//! Cases D of the catalogue: materials, lights and textures with extreme or invalid values.

use super::case::{Case, Measured, Outcome, Trial, case, total};
use super::pictures::{
    SIZE, TRACE, bad_values, differing, full, off_percent, paper, picture, reference, seen_in_white,
};
use super::rooms::{Room, ball, cuboid, dvec, imported, quad, tracer, wall};
use crate::bsdf::fresnel_dielectric;
use crate::camera::{Camera, View};
use crate::experiment::run::ExperimentError;
use crate::math::{Ray, key::Key};
use crate::raster::color::{ToneMap, display_linear, metered_exposure_ev};
use crate::render::{Frame, Mode};
use crate::scene::{
    Encoding, Gradient, Material, MaterialId, MaterialKind, PictureSky, SceneBuilder, Sky, SkyImage, Texture,
    TextureRef,
};
use crate::trace::{MAX_BOUNCES, PixelTrace, RayCounts, TraceSettings, Tracer, truncation_bound};
use glam::{DVec3, Vec2, Vec3};
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

pub(super) const CASES: &[Case] = &[
    case("D1 Kd + Ks = 1.8", "reflectance above 1, or not reported", 1e-6, scaled_down),
    case("D1 furnace with a share a of mirror", "error beyond the bound, of 1/(1-a)", 0.01, mirror_furnace),
    case("D2 facing mirrors, R = 0.98", "bounces more or fewer than 309", 1.0, |_| bounces(0.98, 309)),
    case("D2 facing mirrors, R = 0.8", "bounces more or fewer than 28", 1.0, |_| bounces(0.8, 28)),
    case("D2 the error of truncation", "times the printed bound", 1.001, truncated),
    case("D3 1024 bounces in a thread with 256 kB of stack", "bounces missing", 0.0, deep_chain),
    case("D4 total reflection, Ni 2.4", "angles on the wrong side of 24.6 degrees", 0.0, total_reflection),
    case("D4 reflected plus transmitted", "largest difference from 1", 1e-5, fresnel_sum),
    case("D5 glass of Ni 1", "pixels that differ in a bit from none", 0.0, invisible_glass),
    case("D6 Ni of 0, -1, NaN, 1e9", "indices outside 1 to 10, bad values, not reported", 0.0, odd_indices),
    case("D7 a ball of water in one of glass", "% of pixels off in white light", 0.5, nested_glass),
    case("D7 an open sheet in white light", "% of pixels off in white light", 0.5, open_sheet),
    case("D8 Ns of 0, 1e6, -5, nan", "pixels that differ in a bit", 0.0, highlights),
    case("D9 a point light at and on a wall", "bad values", 0.0, light_on_wall),
    case("D9 a lamp in a wall's plane", "bad values", 0.0, lamp_on_wall),
    case("D9 clamps are counted", "shadow rays counted wrongly", 0.0, clamps_counted),
    case("D10 radiance 1e-30 to 1e38", "tone-mapped steps down, or not in 0 to 1", 0.0, tone_map),
    case("D10 a lamp of 1e6", "bad values, full and paper", 0.0, bright_lamp),
    case("D10 a black picture", "exposures that are not absent or finite", 0.0, black_exposure),
    case("D11 no light", "scenes without light that do not report it", 0.0, no_light),
    case("D12 materials of NaN, infinity, negative", "bad values, or not counted", 0.0, broken_materials),
    case("D13 the sky while turning", "% of pixels off by more than 1/255", 0.5, turning_sky),
    case(
        "D13 a sky picture with a sun of 1e9",
        "% the worst pixel is off from its closed form",
        1.0,
        sun_of_1e9,
    ),
    case("D14 textures of 0x0, 1x1, too few texels", "bad values", 0.0, odd_textures),
    case("D14 texture coordinates of NaN and 1e9", "invalid colours", 0.0, odd_coordinates),
];

/// Counts the bad values of a scene's picture from the camera of the room.
fn bad_in_room(b: SceneBuilder) -> Result<usize, ExperimentError> {
    Ok(bad_values(&full(&tracer(b)?, &Room::SHINY.camera())))
}

fn scaled_down(_: &Trial) -> Outcome {
    let mut b = Room::PLAIN.builder();
    b.materials[1] = Material {
        kind: MaterialKind::Mirror { reflectance: Vec3::splat(0.9), fresnel: false },
        ..Material::diffuse("lacquer", Vec3::splat(0.9))
    };
    let scene = b.finish()?;
    let is_reported = scene.conditioning.repairs.materials_scaled == 1
        && scene.warnings.iter().any(|w| w.message.contains("lacquer"));
    let excess = f64::from(scene.conditioning.reflectance_max) - 1.0;
    Ok((excess + f64::from(u8::from(!is_reported))).max(0.0).into())
}

/// Traces the single pixel of a view.
fn middle(tracer: &Tracer, camera: &Camera) -> PixelTrace {
    let view = View::new(camera, &tracer.scene().frame, [1, 1]);
    tracer.pixel(&view, 0, &TraceSettings { samples: 1, ..TRACE }, &mut RayCounts::default())
}

fn mirror_furnace(_: &Trial) -> Outcome {
    let camera = Camera::look_at(dvec(0.1, 0.2, 0.3), dvec(1.0, 0.4, -0.7), 60.0);
    let mut worst = 0f64;
    for a in [0.5f32, 0.8, 0.9, 0.95] {
        let mut b = SceneBuilder::new("furnace");
        let wall =
            b.add_material(Material { emission: Vec3::ONE, ..Material::mirror("wall", Vec3::splat(a)) });
        cuboid(&mut b, [DVec3::splat(-2.0), DVec3::splat(2.0)], wall, true);
        let seen = middle(&tracer(b)?, &camera).radiance.x;
        let right = 1.0 / (1.0 - a);
        let missing = f64::from((right - seen) / right);
        worst = worst.max(missing - f64::from(truncation_bound(a, 1.0) / right)).max(-missing);
    }
    Ok(worst.max(0.0).into())
}

/// Traces a ray between two glowing mirrors that face each other at a distance of four metres.
fn facing(r: f32) -> Result<PixelTrace, ExperimentError> {
    let mut b = SceneBuilder::new("mirrors");
    let mirror = Material { emission: Vec3::splat(0.1), ..Material::mirror("mirror", Vec3::splat(r)) };
    let mirror = b.add_material(mirror);
    for z in [-2.0, 2.0] {
        wall(&mut b, dvec(-50.0, -50.0, z), [100.0, 100.0], mirror);
    }
    Ok(middle(&tracer(b)?, &Camera::look_at(DVec3::ZERO, dvec(0.0, 0.0, -1.0), 1.0)))
}

fn bounces(r: f32, expected: u32) -> Outcome {
    Ok((facing(r)?.reflections.abs_diff(expected) as usize).into())
}

fn truncated(_: &Trial) -> Outcome {
    let mut worst = 0f64;
    let mut bounds = Vec::new();
    for r in [0.5f32, 0.8, 0.9, 0.98] {
        let whole = 0.1 / (1.0 - r);
        let missing = whole - facing(r)?.radiance.x;
        let bound = truncation_bound(r, 0.1);
        bounds.push(format!("R {r}: at most {:.2} %", 100.0 * bound / whole));
        // Allow for the rounding of a sum of hundreds of terms.
        worst = worst.max(f64::from((missing - 1e-5 * whole) / bound));
    }
    Ok(Measured::from(worst).with_note(bounds.join(", ")))
}

fn deep_chain(_: &Trial) -> Outcome {
    let failed = |cause: &str| ExperimentError::Unsuitable(format!("a thread with a small stack {cause}"));
    let work = || facing(1.0).map(|traced| traced.reflections);
    let thread = std::thread::Builder::new().name("small stack".to_owned()).stack_size(256 << 10).spawn(work);
    let thread = thread.map_err(|e| failed(&format!("cannot be started: {e}")))?;
    let reached = thread.join().map_err(|_| failed("panicked"))??;
    Ok((MAX_BOUNCES.abs_diff(reached) as usize).into())
}

fn total_reflection(trial: &Trial) -> Outcome {
    let critical = (1.0f64 / 2.4).asin();
    let wrong = (0..trial.tries).filter(|&i| {
        let angle = FRAC_PI_2 * f64::from(i) / f64::from(trial.tries);
        let mirrored = fresnel_dielectric(angle.cos() as f32, 2.4);
        let is_near = (angle - critical).abs() < 1e-3;
        !is_near && (mirrored == 1.0) != (angle > critical) || !mirrored.is_finite()
    });
    Ok(wrong.count().into())
}

/// Returns the transmitted share by Fresnel's coefficients of transmission, in f64.
fn transmitted(cos: f64, eta: f64) -> f64 {
    let sin2 = eta * eta * (1.0 - cos * cos);
    if sin2 >= 1.0 {
        return 0.0;
    }
    let cos_t = (1.0 - sin2).sqrt();
    // The indices are n1 = eta and n2 = 1.
    let (s, p) = (2.0 * eta * cos / (eta * cos + cos_t), 2.0 * eta * cos / (cos + eta * cos_t));
    cos_t / (eta * cos) * (s * s + p * p) / 2.0
}

fn fresnel_sum(trial: &Trial) -> Outcome {
    let pair = |i: u32| {
        let [u, v] = Key::of_pixel(31, i).pair();
        (u.max(1e-3), v)
    };
    let error = |i: u32| {
        let (cos, v) = pair(i);
        let eta = if i.is_multiple_of(2) { 1.0 + 1.4 * v } else { 1.0 / (1.0 + 1.4 * v) };
        let sum = f64::from(fresnel_dielectric(cos, eta)) + transmitted(f64::from(cos), f64::from(eta));
        (sum - 1.0).abs()
    };
    // Within a thousandth of the critical angle the square root amplifies the rounding of the
    // cosine.
    let is_critical = |i: &u32| {
        let (u, v) = pair(*i);
        let (u, eta) = (f64::from(u), 1.0 + 1.4 * f64::from(v));
        i.is_multiple_of(2) && ((1.0 - u * u).sqrt() * eta - 1.0).abs() < 1e-3
    };
    Ok((0..trial.tries).filter(|i| !is_critical(i)).map(error).fold(0.0, f64::max).into())
}

fn invisible_glass(_: &Trial) -> Outcome {
    let render = |with_glass: bool| -> Result<Frame, ExperimentError> {
        let mut b = SceneBuilder::new("pane");
        let glow = Material { emission: Vec3::new(0.3, 0.5, 0.7), ..Material::diffuse("wall", Vec3::ZERO) };
        let glow = b.add_material(glow);
        wall(&mut b, dvec(-20.0, -20.0, -3.0), [40.0, 40.0], glow);
        if with_glass {
            let glass = b.add_material(Material::glass("glass", 1.0, Vec3::ONE));
            cuboid(&mut b, [dvec(-0.5, -0.5, -1.6), dvec(0.5, 0.5, -1.0)], glass, false);
        }
        Ok(full(&tracer(b)?, &Camera::look_at(dvec(0.3, 0.2, 1.0), dvec(0.0, 0.0, -3.0), 50.0)))
    };
    Ok(differing(&render(true)?, &render(false)?).into())
}

fn odd_indices(_: &Trial) -> Outcome {
    total([0.0, -1.0, f32::NAN, 1e9, f32::INFINITY], |eta| {
        let mut b = Room::SHINY.builder();
        for material in &mut b.materials {
            if let MaterialKind::Glass { transmittance, .. } = material.kind {
                material.kind = MaterialKind::Glass { eta, transmittance };
            }
        }
        let tracer = tracer(b)?;
        let is_outside =
            |m: &&Material| matches!(m.kind, MaterialKind::Glass { eta, .. } if !(1.0..=10.0).contains(&eta));
        Ok(tracer.scene().materials.iter().filter(is_outside).count()
            + usize::from(tracer.scene().conditioning.repairs.values_clamped != 1)
            + bad_values(&full(&tracer, &Room::SHINY.camera())))
    })
}

const WHITE: Gradient = Gradient { zenith: Vec3::ONE, horizon: Vec3::ONE, ground: Vec3::ONE };

fn nested_glass(_: &Trial) -> Outcome {
    let mut b = SceneBuilder::new("aquarium");
    let glass = b.add_material(Material::glass("glass", 1.5, Vec3::ONE));
    let water = b.add_material(Material::glass("water", 1.33, Vec3::ONE));
    ball(&mut b, DVec3::ZERO, 1.0, 48, false, glass);
    ball(&mut b, DVec3::ZERO, 0.6, 48, false, water);
    seen_in_white(b, &Camera::look_at(dvec(0.02, 0.03, 3.0), DVec3::ZERO, 45.0))
}

fn open_sheet(_: &Trial) -> Outcome {
    let mut b = SceneBuilder::new("sheet");
    let glass = b.add_material(Material::glass("glass", 1.5, Vec3::ONE));
    quad(&mut b, dvec(-1.0, -1.0, 0.0), dvec(2.0, 0.0, 0.0), dvec(0.0, 2.0, 0.3), glass);
    seen_in_white(b, &Camera::look_at(dvec(0.5, 0.3, 2.0), DVec3::ZERO, 60.0))
}

fn highlights(_: &Trial) -> Outcome {
    let render = |ns: &str| -> Result<Frame, ExperimentError> {
        let obj = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl m\nf 1 2 3\nf 1 2 4\nf 1 3 4\n";
        let mtl = format!("newmtl m\nKd 0.6 0.5 0.4\nKs 0.3 0.3 0.3\nNs {ns}\nillum 2\n");
        let scene = imported(&[("a.obj", obj), ("a.mtl", &mtl)])?;
        let camera = *scene.start();
        Ok(full(&Tracer::new(Arc::new(scene)), &camera))
    };
    let right = render("10")?;
    total(["0", "1e6", "-5", "nan", ""], |ns| Ok(differing(&right, &render(ns)?)))
}

fn light_on_wall(_: &Trial) -> Outcome {
    total([1e-3, 1e-6, 1e-12, 1e-20, 1e-30, 0.0, -0.5], |distance| {
        let mut b = Room::SHINY.builder();
        b.point_lights.push((dvec(0.1, 1.2, -4.0 + distance), Vec3::splat(5.0)));
        b.point_lights.push((DVec3::splat(distance), Vec3::splat(5.0)));
        let (tracer, camera) = (tracer(b)?, Room::SHINY.camera());
        let reference = reference(&tracer, &camera, SIZE);
        Ok(bad_values(&full(&tracer, &camera)) + reference.disparity().iter().filter(|d| d.is_nan()).count())
    })
}

/// The irradiance of a point light is bounded where it is nearer than a thousandth of a unit, and
/// nowhere else.
fn clamps_counted(_: &Trial) -> Outcome {
    total([(1e-6, 1), (0.5, 0)], |(distance_m, expected)| {
        let mut b = Room::SHINY.builder();
        b.point_lights.push((dvec(0.1, 1.2, -4.0 + distance_m), Vec3::splat(5.0)));
        let tracer = tracer(b)?;
        let [from, foot] =
            [-1.0, -4.0].map(|z| tracer.scene().frame.scene_from_world_f64(dvec(0.1, 1.2, z)).as_vec3());
        let ray = Ray::new(from, foot - from);
        let mut rays = RayCounts::default();
        if let Some(hit) = tracer.closest(&ray) {
            tracer.irradiance(&tracer.surface(&ray, &hit), 16, Key::of_pixel(26, 0), &mut rays);
        }
        Ok(usize::from(rays.clamped != expected))
    })
}

fn lamp_on_wall(_: &Trial) -> Outcome {
    total([1e-3, 1e-9, 0.0, -1e-3], |distance| {
        let mut b = Room::SHINY.builder();
        wall(&mut b, dvec(-1.0, 0.5, -4.0 + distance), [1.0, 1.0], MaterialId(2));
        bad_in_room(b)
    })
}

fn tone_map(_: &Trial) -> Outcome {
    let mut wrong = 0;
    for map in [ToneMap::Aces, ToneMap::Linear] {
        for ev in [-20.0, 0.0, 20.0, 200.0] {
            let shown = (-100..=126).map(|k| display_linear(Vec3::splat(2f32.powi(k)), ev, map).x);
            let shown: Vec<f32> = shown.collect();
            wrong += shown.iter().filter(|c| !(0.0..=1.0).contains(*c)).count();
            wrong += shown.windows(2).filter(|w| w[1] < w[0]).count();
        }
        for broken in [f32::NAN, f32::INFINITY, -1.0] {
            let shown = display_linear(Vec3::splat(broken), 3.0, map);
            wrong += usize::from(!(shown.is_finite() && shown.min_element() >= 0.0));
        }
    }
    Ok(wrong.into())
}

fn bright_lamp(_: &Trial) -> Outcome {
    let mut b = Room::SHINY.builder();
    b.materials[2].emission = Vec3::splat(1e6);
    let tracer = tracer(b)?;
    let reference = reference(&tracer, &Room::SHINY.camera(), SIZE);
    let moved = Room::SHINY.moved(0.2, 0.1);
    Ok((bad_values(&full(&tracer, &moved)) + bad_values(&paper(&tracer, &moved, &[&reference]))).into())
}

fn black_exposure(_: &Trial) -> Outcome {
    let pictures: [&[Vec3]; 4] = [&[], &[Vec3::ZERO; 9], &[Vec3::NAN, Vec3::INFINITY], &[Vec3::splat(1e-38)]];
    Ok(pictures.iter().filter(|p| metered_exposure_ev(p).is_some_and(|ev| !ev.is_finite())).count().into())
}

fn no_light(_: &Trial) -> Outcome {
    let mut b = SceneBuilder::new("dark");
    let grey = b.add_material(Material::diffuse("grey", Vec3::splat(0.5)));
    wall(&mut b, DVec3::ZERO, [1.0, 1.0], grey);
    let scene = b.finish()?;
    let is_reported = scene.warnings.iter().any(|w| w.message.contains("no light"));
    Ok(usize::from(!is_reported || scene.lights.is_empty()).into())
}

fn broken_materials(_: &Trial) -> Outcome {
    total([f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -3.0], |broken| {
        let mut b = Room::SHINY.builder();
        b.materials[0].diffuse.y = broken;
        b.materials[1].emission.x = broken;
        b.point_lights.push((DVec3::ONE, Vec3::splat(broken)));
        b.sky = Some(Sky::Gradient(Gradient { zenith: Vec3::splat(broken), ..WHITE }));
        let tracer = tracer(b)?;
        let is_miscounted = tracer.scene().conditioning.repairs.values_clamped != 4;
        Ok(bad_values(&full(&tracer, &Room::SHINY.camera())) + usize::from(is_miscounted))
    })
}

fn turning_sky(_: &Trial) -> Outcome {
    let mut b = SceneBuilder::new("open");
    let grey = b.add_material(Material::diffuse("grey", Vec3::splat(0.5)));
    quad(&mut b, dvec(-5.0, 0.0, 5.0), dvec(10.0, 0.0, 0.0), dvec(0.0, 0.0, -10.0), grey);
    b.sky = Some(Sky::Gradient(Gradient {
        zenith: Vec3::new(0.2, 0.4, 0.9),
        horizon: Vec3::splat(0.8),
        ground: Vec3::splat(0.2),
    }));
    let tracer = tracer(b)?;
    let camera = Camera::look_at(dvec(0.0, 2.0, 0.0), dvec(0.0, 6.0, -4.0), 50.0);
    let turned = Camera { yaw: camera.yaw + 0.05, pitch: camera.pitch - 0.03, ..camera };
    let reference = reference(&tracer, &camera, [192, 128]);
    let shown = picture(&tracer, &turned, SIZE, Mode::Paper, &[&reference]);
    Ok(off_percent(&shown, &full(&tracer, &turned)).into())
}

/// Level ground under a sky of one, with one texel of 1e9: every pixel must find it.
fn sun_of_1e9(_: &Trial) -> Outcome {
    const SIZE: [u32; 2] = [256, 128];
    const ROW: u32 = 30;
    let mut texels = vec![[1.0; 3]; (SIZE[0] * SIZE[1]) as usize];
    texels[(ROW * SIZE[0] + 77) as usize] = [1e9; 3];
    let image = SkyImage::new("sun.hdr".as_ref(), SIZE, texels, None).expect("a picture of a sky");
    let mut b = SceneBuilder::new("open");
    let grey = b.add_material(Material::diffuse("grey", Vec3::splat(0.5)));
    quad(&mut b, dvec(-5.0, 0.0, 5.0), dvec(10.0, 0.0, 0.0), dvec(0.0, 0.0, -10.0), grey);
    b.sky = Some(Sky::Picture(PictureSky::new(Arc::new(image), 1.0)));
    let seen = full(&tracer(b)?, &Camera::look_at(dvec(0.0, 2.0, 0.0), dvec(0.0, 0.0, -0.1), 50.0));
    let edge = |row: u32| (PI * f64::from(row) / f64::from(SIZE[1])).cos();
    let cosine = (edge(ROW).powi(2) - edge(ROW + 1).powi(2)) / 2.0 * (2.0 * PI / f64::from(SIZE[0]));
    let expected = 0.5 / PI * (1e9 * cosine + PI);
    let off = |c: &Vec3| (f64::from(c.x) / expected - 1.0).abs();
    Ok((seen.radiance.iter().map(off).fold(0.0, f64::max) * 100.0).into())
}

fn odd_textures(_: &Trial) -> Outcome {
    total([(0, 0, 0), (1, 1, 1), (4, 4, 3), (2, 0, 0), (3, 2, 6)], |(width, height, texels)| {
        let mut b = Room::PLAIN.builder();
        let texels = vec![[200, 100, 50, 255]; texels];
        let texture = b.add_texture(Texture { width, height, texels, encoding: Encoding::Srgb });
        b.materials[0].diffuse_texture = Some(TextureRef::plain(texture));
        b.materials[0].alpha_texture = Some(TextureRef::plain(texture));
        bad_in_room(b)
    })
}

fn odd_coordinates(_: &Trial) -> Outcome {
    let texels = (0..16).map(|i| [i * 16, 255 - i * 16, 7, 255]).collect();
    let texture = Texture { width: 4, height: 4, texels, encoding: Encoding::Srgb };
    let odd = [f32::NAN, f32::INFINITY, -1e9, 1e9, 1e38, -0.0, 1.0, 8_388_607.5];
    let is_invalid = |uv: &Vec2| {
        let color = texture.color(*uv);
        !(color.is_finite() && color.min_element() >= 0.0 && color.max_element() <= 1.0)
    };
    let wrong = odd.iter().flat_map(|&u| odd.map(|v| Vec2::new(u, v))).filter(is_invalid).count();
    let mut b = Room::PLAIN.builder();
    let id = b.add_texture(texture);
    b.materials[0].diffuse_texture = Some(TextureRef::plain(id));
    for (uv, &odd) in b.uvs.iter_mut().zip(odd.iter().cycle()) {
        uv.x = odd;
    }
    Ok((wrong + bad_in_room(b)?).into())
}
