//! D: materials and light.

use super::bench::{
    Room, SIZE, TRACE, bad_values, cuboid, differing, dvec, full, off_percent, paper, picture, quad,
    reference, seen_in_white, tracer,
};
use super::case::{Case, Measured, Outcome, Trial};
use super::geometry::imported;
use crate::bsdf::fresnel_dielectric;
use crate::camera::{Camera, View};
use crate::experiment::run::ExperimentError;
use crate::math::Ray;
use crate::math::key::Key;
use crate::raster::color::{ToneMap, display_linear, metered_exposure_ev};
use crate::render::{Frame, Mode};
use crate::scene::{Encoding, Material, MaterialId, MaterialKind, SceneBuilder, Sky, Texture, TextureRef};
use crate::trace::{MAX_BOUNCES, PixelTrace, RayCounts, TraceSettings, Tracer, truncation_bound};
use glam::{DVec3, Vec2, Vec3};

pub(super) const CASES: &[Case] = &[
    Case::new("D1 Kd + Ks = 1.8", "reflectance above 1, or not told", 1e-6, scaled_down),
    Case::new(
        "D1 furnace with a share a of mirror",
        "error beyond the printed bound, of 1/(1-a)",
        0.01,
        mirror_furnace,
    ),
    Case::new("D2 facing mirrors, R = 0.98", "bounces more or fewer than 309", 1.0, |_| bounces(0.98, 309)),
    Case::new("D2 facing mirrors, R = 0.8", "bounces more or fewer than 28", 1.0, |_| bounces(0.8, 28)),
    Case::new("D2 what cutting leaves out", "times the printed bound", 1.001, truncated),
    Case::new("D3 1024 bounces in a thread with 256 kB of stack", "bounces missing", 0.0, deep_chain),
    Case::new(
        "D4 total reflection, Ni 2.4",
        "angles on the wrong side of 24.6 degrees",
        0.0,
        total_reflection,
    ),
    Case::new("D4 reflected plus transmitted", "largest difference from 1", 1e-5, fresnel_sum),
    Case::new("D5 glass of Ni 1", "pixels that differ in a bit from none", 0.0, invisible_glass),
    Case::new("D6 Ni of 0, -1, NaN, 1e9", "indices outside 1 to 10, bad values, silence", 0.0, odd_indices),
    Case::new("D7 a ball of water in one of glass", "% of pixels off in white light", 0.5, nested_glass),
    Case::new("D7 an open sheet in white light", "% of pixels off in white light", 0.5, open_sheet),
    Case::new("D8 Ns of 0, 1e6, -5, nan", "pixels that differ in a bit", 0.0, highlights),
    Case::new("D9 a point light at and on a wall", "bad values", 0.0, light_on_wall),
    Case::new("D9 a lamp in a wall's plane", "bad values", 0.0, lamp_on_wall),
    Case::new("D9 clamps are counted", "shadow rays counted wrongly", 0.0, clamps_counted),
    Case::new("D10 radiance 1e-30 to 1e38", "tone-mapped steps down, or not in 0 to 1", 0.0, tone_map),
    Case::new("D10 a lamp of 1e6", "bad values, full and paper", 0.0, bright_lamp),
    Case::new("D10 a black picture", "exposures that are not absent or finite", 0.0, black_exposure),
    Case::new("D11 no light", "scenes without light that do not say so", 0.0, no_light),
    Case::new(
        "D12 materials of NaN, infinity, negative",
        "bad values, or not counted",
        0.0,
        broken_materials,
    ),
    Case::new("D13 the sky while turning", "% of pixels off by more than 1/255", 0.5, turning_sky),
    Case::new("D14 textures of 0x0, 1x1, too few texels", "bad values", 0.0, odd_textures),
    Case::new("D14 texture coordinates of NaN and 1e9", "colours that are no colours", 0.0, odd_coordinates),
];

fn scaled_down(_: &Trial) -> Outcome {
    let mut b = Room::PLAIN.builder();
    b.materials[1] = Material {
        kind: MaterialKind::Mirror { reflectance: Vec3::splat(0.9), fresnel: false },
        ..Material::diffuse("lacquer", Vec3::splat(0.9))
    };
    let scene = b.finish()?;
    let told = scene.conditioning.repairs.materials_scaled == 1
        && scene.warnings.iter().any(|w| w.message.contains("lacquer"));
    Ok((f64::from(scene.conditioning.reflectance_max) - 1.0 + f64::from(u8::from(!told))).max(0.0).into())
}

/// The middle pixel of a view.
fn middle(tracer: &Tracer, camera: &Camera) -> PixelTrace {
    let view = View::new(camera, &tracer.scene().frame, [1, 1]);
    tracer.pixel(&view, 0, &TraceSettings { samples: 1, ..TRACE }, &mut RayCounts::default())
}

fn mirror_furnace(_: &Trial) -> Outcome {
    let mut worst = 0f64;
    for a in [0.5f32, 0.8, 0.9, 0.95] {
        let mut b = SceneBuilder::new("furnace");
        let wall =
            b.add_material(Material { emission: Vec3::ONE, ..Material::mirror("wall", Vec3::splat(a)) });
        cuboid(&mut b, [DVec3::splat(-2.0), DVec3::splat(2.0)], wall, true);
        let tracer = tracer(b)?;
        let seen =
            middle(&tracer, &Camera::look_at(dvec(0.1, 0.2, 0.3), dvec(1.0, 0.4, -0.7), 60.0)).radiance.x;
        let right = 1.0 / (1.0 - a);
        let missing = f64::from((right - seen) / right);
        worst = worst.max(missing - f64::from(truncation_bound(a, 1.0) / right)).max(-missing);
    }
    Ok(worst.max(0.0).into())
}

/// Two mirrors face to face, four metres apart, each of which glows.
fn facing(r: f32) -> Result<PixelTrace, ExperimentError> {
    let mut b = SceneBuilder::new("mirrors");
    let mirror = Material { emission: Vec3::splat(0.1), ..Material::mirror("mirror", Vec3::splat(r)) };
    let mirror = b.add_material(mirror);
    for z in [-2.0, 2.0] {
        quad(&mut b, dvec(-50.0, -50.0, z), dvec(100.0, 0.0, 0.0), dvec(0.0, 100.0, 0.0), mirror);
    }
    Ok(middle(&tracer(b)?, &Camera::look_at(DVec3::ZERO, dvec(0.0, 0.0, -1.0), 1.0)))
}

fn bounces(r: f32, expected: u32) -> Outcome {
    Ok((facing(r)?.reflections.abs_diff(expected) as usize).into())
}

fn truncated(_: &Trial) -> Outcome {
    let mut worst = 0f64;
    let mut told = Vec::new();
    for r in [0.5f32, 0.8, 0.9, 0.98] {
        let whole = 0.1 / (1.0 - r);
        let missing = whole - facing(r)?.radiance.x;
        let bound = truncation_bound(r, 0.1);
        told.push(format!("R {r}: at most {:.2} %", 100.0 * bound / whole));
        // The sum of hundreds of terms rounds.
        worst = worst.max(f64::from((missing - 1e-5 * whole) / bound));
    }
    Ok(Measured { note: told.join(", "), ..Measured::from(worst) })
}

fn deep_chain(_: &Trial) -> Outcome {
    let work = || facing(1.0).map(|traced| traced.reflections);
    let thread = std::thread::Builder::new().name("small stack".to_owned()).stack_size(256 << 10).spawn(work);
    let thread = thread.map_err(|e| ExperimentError::Unsuitable(format!("no thread: {e}")))?;
    let reached =
        thread.join().map_err(|_| ExperimentError::Unsuitable("the chain panicked".to_owned()))??;
    Ok((MAX_BOUNCES.abs_diff(reached) as usize).into())
}

fn total_reflection(trial: &Trial) -> Outcome {
    let critical = (1.0f64 / 2.4).asin();
    let wrong = (0..trial.tries).filter(|&i| {
        let angle = std::f64::consts::FRAC_PI_2 * f64::from(i) / f64::from(trial.tries);
        let mirrored = fresnel_dielectric(angle.cos() as f32, 2.4);
        let is_near = (angle - critical).abs() < 1e-3;
        !is_near && (mirrored == 1.0) != (angle > critical) || !mirrored.is_finite()
    });
    Ok(wrong.count().into())
}

/// What passes by Fresnel's coefficients of transmission, in f64.
fn transmitted(cos: f64, eta: f64) -> f64 {
    let sin2 = eta * eta * (1.0 - cos * cos);
    if sin2 >= 1.0 {
        return 0.0;
    }
    let cos_t = (1.0 - sin2).sqrt();
    // With indices n1 = eta, n2 = 1.
    let (s, p) = (2.0 * eta * cos / (eta * cos + cos_t), 2.0 * eta * cos / (cos + eta * cos_t));
    cos_t / (eta * cos) * (s * s + p * p) / 2.0
}

fn fresnel_sum(trial: &Trial) -> Outcome {
    let error = |i: u32| {
        let [u, v] = Key::of_pixel(31, i).pair();
        let (cos, eta) =
            (u.max(1e-3), if i.is_multiple_of(2) { 1.0 + 1.4 * v } else { 1.0 / (1.0 + 1.4 * v) });
        let sum = f64::from(fresnel_dielectric(cos, eta)) + transmitted(f64::from(cos), f64::from(eta));
        (sum - 1.0).abs()
    };
    // Within a thousandth of the critical angle the square root magnifies rounding of the cosine itself.
    let is_critical = |i: &u32| {
        let [u, v] = Key::of_pixel(31, *i).pair();
        let eta = 1.0 + 1.4 * f64::from(v);
        let u = f64::from(u.max(1e-3));
        i.is_multiple_of(2) && ((1.0 - u * u).sqrt() * eta - 1.0).abs() < 1e-3
    };
    Ok((0..trial.tries).filter(|i| !is_critical(i)).map(error).fold(0.0, f64::max).into())
}

fn invisible_glass(_: &Trial) -> Outcome {
    let render = |with_glass: bool| -> Result<Frame, ExperimentError> {
        let mut b = SceneBuilder::new("pane");
        let glow = Material { emission: Vec3::new(0.3, 0.5, 0.7), ..Material::diffuse("wall", Vec3::ZERO) };
        let wall = b.add_material(glow);
        quad(&mut b, dvec(-20.0, -20.0, -3.0), dvec(40.0, 0.0, 0.0), dvec(0.0, 40.0, 0.0), wall);
        if with_glass {
            let glass = b.add_material(Material::glass("glass", 1.0, Vec3::ONE));
            cuboid(&mut b, [dvec(-0.5, -0.5, -1.6), dvec(0.5, 0.5, -1.0)], glass, false);
        }
        Ok(full(&tracer(b)?, &Camera::look_at(dvec(0.3, 0.2, 1.0), dvec(0.0, 0.0, -3.0), 50.0)))
    };
    Ok(differing(&render(true)?, &render(false)?).into())
}

fn odd_indices(_: &Trial) -> Outcome {
    let mut wrong = 0;
    for eta in [0.0, -1.0, f32::NAN, 1e9, f32::INFINITY] {
        let mut b = Room::SHINY.builder();
        for material in &mut b.materials {
            if let MaterialKind::Glass { transmittance, .. } = material.kind {
                material.kind = MaterialKind::Glass { eta, transmittance };
            }
        }
        let tracer = tracer(b)?;
        let is_outside =
            |m: &Material| matches!(m.kind, MaterialKind::Glass { eta, .. } if !(1.0..=10.0).contains(&eta));
        wrong += tracer.scene().materials.iter().filter(|m| is_outside(m)).count();
        wrong += usize::from(tracer.scene().conditioning.repairs.values_clamped != 1);
        wrong += bad_values(&full(&tracer, &Room::SHINY.camera()));
    }
    Ok(wrong.into())
}

const WHITE: Sky = Sky { zenith: Vec3::ONE, horizon: Vec3::ONE, ground: Vec3::ONE };

fn nested_glass(_: &Trial) -> Outcome {
    let mut b = SceneBuilder::new("aquarium");
    let glass = b.add_material(Material::glass("glass", 1.5, Vec3::ONE));
    let water = b.add_material(Material::glass("water", 1.33, Vec3::ONE));
    super::bench::ball(&mut b, DVec3::ZERO, 1.0, 48, false, glass);
    super::bench::ball(&mut b, DVec3::ZERO, 0.6, 48, false, water);
    Ok(seen_in_white(b, &Camera::look_at(dvec(0.02, 0.03, 3.0), DVec3::ZERO, 45.0))?)
}

fn open_sheet(_: &Trial) -> Outcome {
    let mut b = SceneBuilder::new("sheet");
    let glass = b.add_material(Material::glass("glass", 1.5, Vec3::ONE));
    quad(&mut b, dvec(-1.0, -1.0, 0.0), dvec(2.0, 0.0, 0.0), dvec(0.0, 2.0, 0.3), glass);
    Ok(seen_in_white(b, &Camera::look_at(dvec(0.5, 0.3, 2.0), DVec3::ZERO, 60.0))?)
}

fn highlights(_: &Trial) -> Outcome {
    let render = |ns: &str| -> Result<Frame, ExperimentError> {
        let obj = "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nusemtl m\nf 1 2 3\nf 1 2 4\nf 1 3 4\n";
        let mtl = format!("newmtl m\nKd 0.6 0.5 0.4\nKs 0.3 0.3 0.3\nNs {ns}\nillum 2\n");
        let scene = imported(&[("a.obj", obj), ("a.mtl", &mtl)])?;
        let camera = *scene.start();
        Ok(full(&Tracer::new(std::sync::Arc::new(scene)), &camera))
    };
    let right = render("10")?;
    let mut wrong = 0;
    for ns in ["0", "1e6", "-5", "nan", ""] {
        wrong += differing(&right, &render(ns)?);
    }
    Ok(wrong.into())
}

fn light_on_wall(_: &Trial) -> Outcome {
    let mut wrong = 0;
    for distance in [1e-3, 1e-6, 1e-12, 1e-20, 1e-30, 0.0, -0.5] {
        let mut b = Room::SHINY.builder();
        b.point_lights.push((dvec(0.1, 1.2, -4.0 + distance), Vec3::splat(5.0)));
        b.point_lights.push((dvec(distance, distance, distance), Vec3::splat(5.0)));
        let tracer = tracer(b)?;
        wrong += bad_values(&full(&tracer, &Room::SHINY.camera()));
        wrong +=
            reference(&tracer, &Room::SHINY.camera(), SIZE).disparity().iter().filter(|d| d.is_nan()).count();
    }
    Ok(wrong.into())
}

/// At the foot of a light the irradiance is bounded where the light is nearer than a thousandth of a unit, and nowhere else.
fn clamps_counted(_: &Trial) -> Outcome {
    let mut wrong = 0;
    for (distance_m, expected) in [(1e-6, 1), (0.5, 0)] {
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
        wrong += usize::from(rays.clamped != expected);
    }
    Ok(wrong.into())
}

fn lamp_on_wall(_: &Trial) -> Outcome {
    let mut wrong = 0;
    for distance in [1e-3, 1e-9, 0.0, -1e-3] {
        let mut b = Room::SHINY.builder();
        quad(
            &mut b,
            dvec(-1.0, 0.5, -4.0 + distance),
            dvec(1.0, 0.0, 0.0),
            dvec(0.0, 1.0, 0.0),
            MaterialId(2),
        );
        wrong += bad_values(&full(&tracer(b)?, &Room::SHINY.camera()));
    }
    Ok(wrong.into())
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
    let lent = reference(&tracer, &Room::SHINY.camera(), SIZE);
    let moved = Room::SHINY.moved(0.2, 0.1);
    Ok((bad_values(&full(&tracer, &moved)) + bad_values(&paper(&tracer, &moved, &[&lent]))).into())
}

fn black_exposure(_: &Trial) -> Outcome {
    let pictures: [&[Vec3]; 4] = [&[], &[Vec3::ZERO; 9], &[Vec3::NAN, Vec3::INFINITY], &[Vec3::splat(1e-38)]];
    Ok(pictures.iter().filter(|p| metered_exposure_ev(p).is_some_and(|ev| !ev.is_finite())).count().into())
}

fn no_light(_: &Trial) -> Outcome {
    let mut b = SceneBuilder::new("dark");
    let grey = b.add_material(Material::diffuse("grey", Vec3::splat(0.5)));
    quad(&mut b, DVec3::ZERO, DVec3::X, DVec3::Y, grey);
    let scene = b.finish()?;
    let is_told = scene.warnings.iter().any(|w| w.message.contains("no light"));
    Ok(usize::from(!is_told || scene.lights.is_empty()).into())
}

fn broken_materials(_: &Trial) -> Outcome {
    let mut wrong = 0;
    for broken in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -3.0] {
        let mut b = Room::SHINY.builder();
        b.materials[0].diffuse.y = broken;
        b.materials[1].emission.x = broken;
        b.point_lights.push((dvec(1.0, 1.0, 1.0), Vec3::splat(broken)));
        b.sky = Some(Sky { zenith: Vec3::splat(broken), ..WHITE });
        let tracer = tracer(b)?;
        wrong += bad_values(&full(&tracer, &Room::SHINY.camera()));
        wrong += usize::from(tracer.scene().conditioning.repairs.values_clamped != 4);
    }
    Ok(wrong.into())
}

fn turning_sky(_: &Trial) -> Outcome {
    let mut b = SceneBuilder::new("open");
    let grey = b.add_material(Material::diffuse("grey", Vec3::splat(0.5)));
    quad(&mut b, dvec(-5.0, 0.0, 5.0), dvec(10.0, 0.0, 0.0), dvec(0.0, 0.0, -10.0), grey);
    b.sky =
        Some(Sky { zenith: Vec3::new(0.2, 0.4, 0.9), horizon: Vec3::splat(0.8), ground: Vec3::splat(0.2) });
    let tracer = tracer(b)?;
    let camera = Camera::look_at(dvec(0.0, 2.0, 0.0), dvec(0.0, 6.0, -4.0), 50.0);
    let turned = Camera { yaw: camera.yaw + 0.05, pitch: camera.pitch - 0.03, ..camera };
    let lent = reference(&tracer, &camera, [192, 128]);
    let shown = picture(&tracer, &turned, SIZE, Mode::Paper, &[&lent]);
    Ok(off_percent(&shown, &full(&tracer, &turned)).into())
}

fn odd_textures(_: &Trial) -> Outcome {
    let mut wrong = 0;
    for (width, height, texels) in [(0, 0, 0), (1, 1, 1), (4, 4, 3), (2, 0, 0), (3, 2, 6)] {
        let mut b = Room::PLAIN.builder();
        let texels = vec![[200, 100, 50, 255]; texels];
        let texture = b.add_texture(Texture { width, height, texels, encoding: Encoding::Srgb });
        b.materials[0].diffuse_texture = Some(TextureRef::plain(texture));
        b.materials[0].alpha_texture = Some(TextureRef::plain(texture));
        wrong += bad_values(&full(&tracer(b)?, &Room::PLAIN.camera()));
    }
    Ok(wrong.into())
}

fn odd_coordinates(_: &Trial) -> Outcome {
    let texels = (0..16).map(|i| [i * 16, 255 - i * 16, 7, 255]).collect();
    let texture = Texture { width: 4, height: 4, texels, encoding: Encoding::Srgb };
    let odd = [f32::NAN, f32::INFINITY, -1e9, 1e9, 1e38, -0.0, 1.0, 8_388_607.5];
    let mut wrong = 0;
    for u in odd {
        for v in odd {
            let color = texture.color(Vec2::new(u, v));
            wrong +=
                usize::from(!(color.is_finite() && color.min_element() >= 0.0 && color.max_element() <= 1.0));
        }
    }
    let mut b = Room::PLAIN.builder();
    let id = b.add_texture(texture);
    b.materials[0].diffuse_texture = Some(TextureRef::plain(id));
    b.uvs.iter_mut().zip(odd.iter().cycle()).for_each(|(uv, &odd)| uv.x = odd);
    let tracer = tracer(b)?;
    let frame = full(&tracer, &Room::PLAIN.camera());
    Ok((wrong + bad_values(&frame)).into())
}
