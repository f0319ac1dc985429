//! Cases E of the catalogue: references, their warping, and the cache: damage, memory, other
//! epochs.

use super::camera::too_near;
use super::case::{Case, Measured, Outcome, Trial, case, total};
use super::pictures::{
    SIZE, TRACE, bad_values, count_type, differing, exact, full, is_off, off_percent, paper,
    paper_over_full_secs, percent, reference, srgb, unequal, view,
};
use super::rooms::{Room, ball, dvec, random, tracer, wall};
use crate::camera::{Camera, PixelWarp};
use crate::experiment::run::ExperimentError;
use crate::lookup::LookupSet;
use crate::math::key::Key;
use crate::raster::pixel_types::PixelType;
use crate::reference::{ReferenceCache, ReferenceFrame};
use crate::render::{Frame, Mode, RenderSettings, Walkthrough, WalkthroughSettings};
use crate::scene::{Material, SceneBuilder};
use crate::trace::{NO_TRIANGLE, Tracer, parallel::NEVER};
use crate::warp::ReferenceSelector;
use glam::{DVec3, Vec3};
use std::sync::Arc;

pub(super) const CASES: &[Case] = &[
    case("E1 a reference at its own camera", "holes, and pixels off by more than 1/255", 0.0, identity),
    case("E2 points behind and at the eye", "points accepted that are not in front", 0.0, behind_the_eye),
    case("E3 pixels cast to whole numbers", "samples that land elsewhere than in f64", 0.0, casts),
    case("E4 two references disagree", "pixels that show neither's colour", 0.0, disagreement),
    case(
        "E5 mirror and glass from the stored point",
        "% of Type 2 pixels off by more than 1/255",
        2.0,
        type_2,
    ),
    case("E5 mirror and glass are never copied", "specular pixels of Type 1", 0.0, never_copied),
    case("E6 more than 255 reflections", "mirror pixels whose count is not 255", 0.0, counts_saturate),
    case("E7 references of another epoch", "references accepted", 0.0, other_epochs),
    case("E7 references of other sizes and lenses", "bad values and uncounted pixels", 0.0, other_sizes),
    case("E7 an edited material", "pixels unlike full tracing after it", 0.0, edited),
    case("E8 a reference taken on a surface", "pixels that it keeps from too near", 0.0, on_surface),
    case("E8 a reference taken inside glass", "% of pixels off by more than 1/255", 2.0, inside_glass),
    case("E9 1 % of bits flipped", "pixels changed per damaged pixel, paper", 2.0, damaged),
    case("E9 1 % of bits flipped, looked up", "% of pixels changed, exact", 16.0, damaged_lookup),
    case("E9 lookups survive any damage", "bad values, exact, half of all bits flipped", 0.0, ruined),
    case("E10 the cache's limit", "bytes held per byte allowed plus one reference", 1.0, budget),
    case("E10 a reference in use is evicted", "pixels reused from it that change", 0.0, evicted_in_use),
    case("E11 a mirror hall, all Type 2", "pixels not of Type 2, or miscounted", 0.0, all_type_2),
    case("E11 a diffuse room, all Type 1", "pixels not of Type 1, or miscounted", 0.0, all_type_1),
    case("E11 time of a mirror hall", "times that of full tracing", 1.10, mirror_hall_time).timed(),
    case("E11 time of a diffuse room", "times that of full tracing", 1.10, diffuse_time).timed(),
];

fn identity(_: &Trial) -> Outcome {
    let (tracer, camera) = Room::PLAIN.stage()?;
    let reference = reference(&tracer, &camera, SIZE);
    let shown = paper(&tracer, &camera, &[&reference]);
    let holes = shown.types.len() - count_type(&shown, PixelType::Reused);
    let off = off_percent(&shown, &full(&tracer, &camera)) * shown.types.len() as f64 / 100.0;
    Ok((holes as f64 + off.round() + shown.stats.rays.total() as f64).into())
}

/// A random sample of a reference, warped between two random views of the room.
struct RandomWarp {
    warp: PixelWarp,
    x: u32,
    y: u32,
    /// Many disparities are extreme.
    disparity: f32,
    /// The warped point in pixels of the target view, times its depth in z, computed in f64.
    target: DVec3,
}

impl RandomWarp {
    fn new(key: Key, tracer: &Tracer) -> Self {
        let pose = |index: u32| {
            let r = random(key, index).as_dvec3();
            let turn = random(key, index + 1).as_dvec3();
            let eye = dvec(r.x * 2.5, 1.5 + r.y, r.z * 3.5);
            Camera { eye, yaw: turn.x * 3.2, pitch: turn.y * 1.5, fov_y: 0.1 + turn.z.abs() * 2.0, roll: 0.0 }
        };
        let [from, to] = [10, 20].map(|index| view(tracer, &pose(index)));
        let [u, v] = key.with(1).pair();
        let [d, kind] = key.with(2).pair();
        let disparity = match (kind * 8.0) as u32 {
            0 => 0.0,
            1 => f32::NAN,
            2 => -d,
            3 => f32::INFINITY,
            4 => 1024.0 * d,
            _ => d * 0.05,
        };
        let (x, y) = ((u * SIZE[0] as f32) as u32, (v * SIZE[1] as f32) as u32);
        let direction = from.scene_from_pixel_f64 * DVec3::new(f64::from(x) + 0.5, f64::from(y) + 0.5, 1.0);
        let point = direction + (from.eye_f64 - to.eye_f64) * f64::from(disparity);
        let target = to.scene_from_pixel_f64.inverse() * point;
        Self { warp: PixelWarp::new(&from, &to), x, y, disparity, target }
    }

    /// Counts the samples that are wrong.
    fn count(trial: &Trial, seed: u64, is_wrong: impl Fn(&Self) -> bool) -> Outcome {
        let tracer = Room::PLAIN.tracer()?;
        let samples = (0..trial.tries).map(|i| Self::new(Key::of_pixel(seed, i), &tracer));
        Ok(samples.filter(is_wrong).count().into())
    }
}

fn behind_the_eye(trial: &Trial) -> Outcome {
    RandomWarp::count(trial, 41, |s| {
        let Some((px, py, factor)) = s.warp.point(s.x, s.y, s.disparity) else { return false };
        !(s.target.z > 0.0 && px.is_finite() && py.is_finite() && factor > 0.0)
    })
}

fn casts(trial: &Trial) -> Outcome {
    RandomWarp::count(trial, 42, |s| {
        let Some((tx, ty, _)) = s.warp.target(s.x, s.y, s.disparity) else { return false };
        let p = s.target;
        let lands = |at: f64, pixel: u32| (f64::from(pixel)..f64::from(pixel) + 1.0).contains(&at);
        !(lands(p.x / p.z, tx) && lands(p.y / p.z, ty)) || tx >= SIZE[0] || ty >= SIZE[1]
    })
}

/// Traces references of the room at its camera and at a moved one.
fn pair_of(tracer: &Tracer, forward: f64, turn: f64) -> [ReferenceFrame; 2] {
    [(0.0, 0.0), (forward, turn)].map(|(f, t)| reference(tracer, &Room::SHINY.moved(f, t), SIZE))
}

fn disagreement(_: &Trial) -> Outcome {
    let tracer = Room::SHINY.tracer()?;
    let [one, two] = &pair_of(&tracer, 0.6, 0.2);
    let here = Room::SHINY.moved(0.3, 0.1);
    let both = paper(&tracer, &here, &[one, two]);
    let alone = [one, two].map(|reference| paper(&tracer, &here, &[reference]));
    let is_mixed = |&(pixel, kind): &(usize, &PixelType)| {
        *kind == PixelType::Reused && alone.iter().all(|a| a.radiance[pixel] != both.radiance[pixel])
    };
    let mixed = both.types.iter().enumerate().filter(is_mixed).count();
    let differ = unequal(&alone[0].radiance, &alone[1].radiance);
    Ok(Measured::from(mixed).with_note(format!("the references differ in {differ} pixels")))
}

fn type_2(_: &Trial) -> Outcome {
    let (tracer, here) = Room::SHINY.stage()?;
    let reference = reference(&tracer, &here, SIZE);
    let (shown, right) = (paper(&tracer, &here, &[&reference]), full(&tracer, &here));
    let [a, b] = [&shown, &right].map(srgb);
    let is_specular =
        |&i: &usize| shown.types[i] == PixelType::Secondary && shown.triangle[i] == right.triangle[i];
    let specular: Vec<usize> = (0..a.len()).filter(is_specular).collect();
    let off = specular.iter().filter(|&&i| is_off(&a[i], &b[i])).count();
    let note = format!("{} pixels", specular.len());
    Ok(Measured::from(percent(off, specular.len())).with_note(note).with_picture(&shown))
}

fn never_copied(_: &Trial) -> Outcome {
    let tracer = Room::SHINY.tracer()?;
    let [one, two] = &pair_of(&tracer, 0.5, 0.2);
    total([(0.0, 0.0), (0.2, 0.1), (1.0, -0.3)], |(forward, turn)| {
        let shown = paper(&tracer, &Room::SHINY.moved(forward, turn), &[one, two]);
        let is_wrong = |(kind, t): &(&PixelType, &u32)| {
            **kind == PixelType::Reused
                && **t != NO_TRIANGLE
                && tracer.scene().material_of(**t).is_view_dependent()
        };
        Ok(shown.types.iter().zip(&shown.triangle).filter(is_wrong).count())
    })
}

/// Two mirrors that lose so little light that it is reflected more than 255 times.
fn hall(reflectance: f32) -> Result<(Tracer, Camera), ExperimentError> {
    let mut b = SceneBuilder::new("hall");
    let mirror = b.add_material(Material::mirror("mirror", Vec3::splat(reflectance)));
    for z in [-2.0, 2.0] {
        wall(&mut b, dvec(-90.0, -90.0, z), [180.0, 180.0], mirror);
    }
    b.point_lights.push((DVec3::ZERO, Vec3::ONE));
    Ok((tracer(b)?, Camera::look_at(DVec3::ZERO, dvec(0.0, 0.0, -1.0), 3.0)))
}

fn counts_saturate(_: &Trial) -> Outcome {
    let (tracer, camera) = hall(0.99)?;
    let reference = reference(&tracer, &camera, [24, 16]);
    Ok((0..24 * 16).filter(|&pixel| reference.reflections(pixel) != u8::MAX).count().into())
}

fn other_epochs(_: &Trial) -> Outcome {
    let (old, camera) = Room::PLAIN.stage()?;
    let new = Arc::new(Room::PLAIN.tracer()?);
    let reference = reference(&old, &camera, SIZE);
    let mut cache = ReferenceCache::new(new.scene(), 1 << 30);
    cache.insert(Arc::new(reference.clone()));
    let mut selector = ReferenceSelector::default();
    let selected = selector.select(&mut cache, &view(&new, &camera), new.epoch(), 8).len();
    let looked_up = LookupSet::new(&cache, new.epoch()).len();
    let inserted = Walkthrough::new(new, WalkthroughSettings::default()).insert(reference).is_some();
    Ok((selected + looked_up + usize::from(inserted)).into())
}

fn other_sizes(_: &Trial) -> Outcome {
    let (tracer, here) = Room::SHINY.stage()?;
    total([([1, 1], 1.0), ([7, 300], 0.5), ([256, 192], 2.9), ([333, 17], 0.02)], |(size, fov_y)| {
        let reference = reference(&tracer, &Camera { fov_y, ..here }, size);
        let shown = paper(&tracer, &here, &[&reference]);
        Ok(bad_values(&shown) + miscounted(&shown))
    })
}

/// Counts the pixels that are missing in the statistics of types.
fn miscounted(frame: &Frame) -> usize {
    frame.stats.types.total().abs_diff(frame.types.len())
}

fn edited(_: &Trial) -> Outcome {
    let (tracer, camera) = Room::PLAIN.stage()?;
    let tracer = Arc::new(tracer);
    let render = RenderSettings { mode: Mode::Paper, trace: TRACE };
    let mut walk = Walkthrough::new(tracer.clone(), WalkthroughSettings { render, ..Default::default() });
    walk.insert(reference(&tracer, &camera, SIZE));
    let mut edit = tracer.scene().to_edit();
    edit.materials[0] = Material::diffuse("wall", Vec3::new(0.1, 0.6, 0.2));
    let scene = tracer.scene().with_edit(&edit);
    let edited = Arc::new(tracer.with_same_geometry(Arc::new(scene)));
    walk.set_tracer(edited.clone());
    let shown = walk.render(&camera, SIZE, NEVER);
    Ok((differing(shown, &full(&edited, &camera)) + shown.stats.references_used).into())
}

/// Distance from a wall at three metres, in metres: less than an f32 resolves there (2.4e-7).
const UNSEEN_M: f64 = 1e-8;

fn on_surface(_: &Trial) -> Outcome {
    let tracer = Room::SHINY.tracer()?;
    let eyes = [dvec(3.0, 1.5, 0.0), dvec(3.0 - UNSEEN_M, 1.5, 0.0), dvec(-1.0, 1.0, -3.875)];
    total(eyes.map(|eye| Camera::look_at(eye, dvec(4.0, 1.5, -9.0), 70.0)), |camera| {
        Ok(too_near(&reference(&tracer, &camera, SIZE)))
    })
}

fn inside_glass(_: &Trial) -> Outcome {
    let mut b = Room::PLAIN.builder();
    let glass = b.add_material(Material::glass("glass", 1.5, Vec3::splat(0.98)));
    ball(&mut b, dvec(0.0, 1.4, 1.0), 0.5, 24, false, glass);
    let tracer = tracer(b)?;
    let inside = Camera::look_at(dvec(0.0, 1.4, 1.1), dvec(0.0, 1.3, -4.0), 65.0);
    let reference = reference(&tracer, &inside, SIZE);
    let shown = paper(&tracer, &inside, &[&reference]);
    let [secondary, reused] = [PixelType::Secondary, PixelType::Reused].map(|t| count_type(&shown, t));
    let off = off_percent(&shown, &full(&tracer, &inside)) + bad_values(&shown) as f64;
    Ok(Measured::from(off).with_note(format!("{secondary} pixels of Type 2, {reused} of Type 1")))
}

fn damaged(_: &Trial) -> Outcome {
    let (tracer, here) = Room::SHINY.stage()?;
    let whole = reference(&tracer, &here, SIZE);
    let mut broken = whole.clone();
    let hit = broken.flip_bits(0.01, 77).len();
    let [right, shown] = [&whole, &broken].map(|reference| paper(&tracer, &here, &[reference]));
    let changed = unequal(&right.radiance, &shown.radiance);
    Ok((changed as f64 / hit.max(1) as f64 + bad_values(&shown) as f64).into())
}

fn damaged_lookup(_: &Trial) -> Outcome {
    let (tracer, here) = Room::SHINY.stage()?;
    let [right, shown] = [0.0, 0.01].map(|share| exact(&tracer, &here, &here, share));
    let changed = percent(unequal(&right.radiance, &shown.radiance), right.radiance.len());
    let note = "a pixel is looked up in four neighbours, and a mirror shows others".to_owned();
    Ok(Measured::from(changed + bad_values(&shown) as f64).with_note(note))
}

fn ruined(_: &Trial) -> Outcome {
    let (tracer, here) = Room::SHINY.stage()?;
    Ok(bad_values(&exact(&tracer, &here, &here, 0.5)).into())
}

fn budget(_: &Trial) -> Outcome {
    let (tracer, camera) = Room::SHINY.stage()?;
    let one = reference(&tracer, &camera, SIZE);
    let (bytes, limit) = (one.bytes(), 4 * one.bytes());
    let mut cache = ReferenceCache::new(tracer.scene(), limit);
    let mut worst = 0f64;
    for _ in 0..12 {
        cache.insert(Arc::new(one.clone()));
        worst = worst.max(cache.bytes() as f64 / (limit + bytes) as f64);
    }
    Ok(worst.into())
}

fn evicted_in_use(_: &Trial) -> Outcome {
    let (tracer, camera) = Room::PLAIN.stage()?;
    let mut cache = ReferenceCache::new(tracer.scene(), 1);
    cache.insert(Arc::new(reference(&tracer, &camera, SIZE)));
    let held = ReferenceSelector::default().select(&mut cache, &view(&tracer, &camera), tracer.epoch(), 1);
    let frames: Vec<&ReferenceFrame> = held.iter().map(|r| &*r.frame).collect();
    let before = paper(&tracer, &camera, &frames);
    cache.insert(Arc::new(reference(&tracer, &Room::PLAIN.moved(0.1, 0.0), SIZE)));
    let is_gone = cache.entries().iter().all(|e| e.id != held[0].id);
    let after = paper(&tracer, &camera, &frames);
    Ok(if is_gone { differing(&before, &after).into() } else { f64::NAN.into() })
}

fn all_of((tracer, camera): (Tracer, Camera), wanted: PixelType) -> Outcome {
    let reference = reference(&tracer, &camera, SIZE);
    let shown = paper(&tracer, &camera, &[&reference]);
    let others = shown.types.len() - count_type(&shown, wanted);
    Ok((others + miscounted(&shown) + bad_values(&shown)).into())
}

fn all_type_2(_: &Trial) -> Outcome {
    all_of(hall(0.9)?, PixelType::Secondary)
}

fn all_type_1(_: &Trial) -> Outcome {
    all_of(Room::PLAIN.stage()?, PixelType::Reused)
}

fn time_ratio((tracer, camera): (Tracer, Camera)) -> Outcome {
    paper_over_full_secs(&tracer, [&camera, &camera], [480, 320], 7)
}

fn mirror_hall_time(_: &Trial) -> Outcome {
    time_ratio(hall(0.9)?)
}

fn diffuse_time(_: &Trial) -> Outcome {
    time_ratio(Room::PLAIN.stage()?)
}
