//! E: references, warping, the cache.

use super::bench::{
    Room, SIZE, TRACE, bad_values, ball, differing, dvec, full, off_percent, paper, percent, picture, quad,
    random, reference, srgb, tracer, view,
};
use super::camera::fastest_ratio;
use super::case::{Case, Measured, Outcome, Trial};
use crate::camera::PixelWarp;
use crate::camera::{Camera, View};
use crate::experiment::run::ExperimentError;
use crate::lookup::LookupSet;
use crate::math::key::Key;
use crate::raster::pixel_types::PixelType;
use crate::reference::{ReferenceCache, ReferenceFrame};
use crate::render::{Frame, FrameRequest, Mode, RenderSettings, Renderer, Walkthrough, WalkthroughSettings};
use crate::scene::{Material, SceneBuilder};
use crate::trace::Tracer;
use crate::trace::parallel::NEVER;
use crate::warp::ReferenceSelector;
use glam::{DVec3, Vec3};
use std::sync::Arc;
use std::time::Instant;

pub(super) const CASES: &[Case] = &[
    Case::new("E1 a reference on its own camera", "holes, and pixels off by more than 1/255", 0.0, identity),
    Case::new(
        "E2 points behind and at the eye",
        "points let through that are not in front",
        0.0,
        behind_the_eye,
    ),
    Case::new("E3 pixels cast to whole numbers", "samples that land elsewhere than in f64", 0.0, casts),
    Case::new("E4 two references disagree", "pixels that show neither's colour", 0.0, disagreement),
    Case::new(
        "E5 mirror and glass from the stored point",
        "% of Type 2 pixels off by more than 1/255",
        2.0,
        type_2,
    ),
    Case::new(
        "E5 mirror and glass are never copied",
        "pixels of Type 1 that mirror or pass light",
        0.0,
        never_copied,
    ),
    Case::new("E6 more than 255 reflections", "mirror pixels whose count is not 255", 0.0, counts_saturate),
    Case::new("E7 references of another epoch", "references accepted", 0.0, other_epochs),
    Case::new("E7 references of other sizes and lenses", "bad values and uncounted pixels", 0.0, other_sizes),
    Case::new("E7 an edited material", "pixels unlike the full tracer's after it", 0.0, edited),
    Case::new("E8 a reference taken on a surface", "pixels it lends from too near", 0.0, on_surface),
    Case::new("E8 a reference taken inside glass", "% of pixels off by more than 1/255", 2.0, inside_glass),
    Case::new("E9 1 % of bits flipped", "pixels changed for one damaged, paper", 2.0, |_| {
        damaged(Mode::Paper)
    }),
    Case::new("E9 1 % of bits flipped, looked up", "% of pixels changed, exact", 16.0, |_| damaged_look_up()),
    Case::new("E9 lookups survive any damage", "bad values, exact, half of all bits flipped", 0.0, |_| {
        ruined()
    }),
    Case::new("E10 the cache's limit", "bytes held for one allowed, with one more reference", 1.0, budget),
    Case::new("E10 a reference in use is evicted", "pixels it lends that change", 0.0, evicted_in_use),
    Case::new("E11 a mirror hall, all Type 2", "pixels not of Type 2, or miscounted", 0.0, all_type_2),
    Case::new("E11 a matte room, all Type 1", "pixels not of Type 1, or miscounted", 0.0, all_type_1),
    Case::new("E11 time of a mirror hall", "times that of the full tracer", 1.10, mirror_hall_time).timed(),
    Case::new("E11 time of a matte room", "times that of the full tracer", 1.10, matte_time).timed(),
];

fn count_type(frame: &Frame, wanted: PixelType) -> usize {
    frame.types.iter().filter(|t| **t == wanted).count()
}

fn identity(_: &Trial) -> Outcome {
    let tracer = Room::PLAIN.tracer()?;
    let camera = Room::PLAIN.camera();
    let lent = reference(&tracer, &camera, SIZE);
    let shown = paper(&tracer, &camera, &[&lent]);
    let holes = shown.types.len() - count_type(&shown, PixelType::Reused);
    let off = off_percent(&shown, &full(&tracer, &camera)) * shown.types.len() as f64 / 100.0;
    Ok((holes as f64 + off.round() + shown.stats.rays.total() as f64).into())
}

/// Warps between random views of the room.
fn random_warp(key: Key, tracer: &Tracer) -> (View, View, PixelWarp) {
    let pose = |index: u32| {
        let r = random(key, index).as_dvec3();
        let turn = random(key, index + 1).as_dvec3();
        let eye = dvec(r.x * 2.5, 1.5 + r.y, r.z * 3.5);
        Camera { eye, yaw: turn.x * 3.2, pitch: turn.y * 1.5, fov_y: 0.1 + turn.z.abs() * 2.0 }
    };
    let [from, to] = [10, 20].map(|index| view(tracer, &pose(index)));
    (from, to, PixelWarp::new(&from, &to))
}

/// A random pixel of the view and a disparity, of which many are extreme.
fn random_sample(key: Key) -> (u32, u32, f32) {
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
    ((u * SIZE[0] as f32) as u32, (v * SIZE[1] as f32) as u32, disparity)
}

fn behind_the_eye(trial: &Trial) -> Outcome {
    let tracer = Room::PLAIN.tracer()?;
    let wrong = (0..trial.tries).filter(|&i| {
        let key = Key::of_pixel(41, i);
        let (from, to, warp) = random_warp(key, &tracer);
        let (x, y, disparity) = random_sample(key);
        let Some((px, py, factor)) = warp.point(x, y, disparity) else { return false };
        let direction = from.scene_from_pixel_f64 * DVec3::new(f64::from(x) + 0.5, f64::from(y) + 0.5, 1.0);
        let point = direction + (from.eye_f64 - to.eye_f64) * f64::from(disparity);
        let depth = (to.scene_from_pixel_f64.inverse() * point).z;
        !(depth > 0.0 && px.is_finite() && py.is_finite() && factor > 0.0)
    });
    Ok(wrong.count().into())
}

fn casts(trial: &Trial) -> Outcome {
    let tracer = Room::PLAIN.tracer()?;
    let wrong = (0..trial.tries).filter(|&i| {
        let key = Key::of_pixel(42, i);
        let (from, to, warp) = random_warp(key, &tracer);
        let (x, y, disparity) = random_sample(key);
        let Some((tx, ty, _)) = warp.target(x, y, disparity) else { return false };
        let direction = from.scene_from_pixel_f64 * DVec3::new(f64::from(x) + 0.5, f64::from(y) + 0.5, 1.0);
        let point = direction + (from.eye_f64 - to.eye_f64) * f64::from(disparity);
        let p = to.scene_from_pixel_f64.inverse() * point;
        let lands = |at: f64, pixel: u32| (f64::from(pixel)..f64::from(pixel) + 1.0).contains(&at);
        !(lands(p.x / p.z, tx) && lands(p.y / p.z, ty)) || tx >= SIZE[0] || ty >= SIZE[1]
    });
    Ok(wrong.count().into())
}

fn disagreement(_: &Trial) -> Outcome {
    let tracer = Room::SHINY.tracer()?;
    let lent = [(0.0, 0.0), (0.6, 0.2)].map(|(f, t)| reference(&tracer, &Room::SHINY.moved(f, t), SIZE));
    let here = Room::SHINY.moved(0.3, 0.1);
    let both = paper(&tracer, &here, &[&lent[0], &lent[1]]);
    let alone = [paper(&tracer, &here, &[&lent[0]]), paper(&tracer, &here, &[&lent[1]])];
    let is_mixed = |(pixel, kind): (usize, &PixelType)| {
        *kind == PixelType::Reused && alone.iter().all(|a| a.radiance[pixel] != both.radiance[pixel])
    };
    let differ = alone[0].radiance.iter().zip(&alone[1].radiance).filter(|(a, b)| a != b).count();
    let mixed = both.types.iter().enumerate().filter(|&pixel| is_mixed(pixel)).count();
    Ok(Measured { note: format!("{differ} pixels on which the two differ"), ..Measured::from(mixed) })
}

fn type_2(_: &Trial) -> Outcome {
    let tracer = Room::SHINY.tracer()?;
    let here = Room::SHINY.camera();
    let lent = reference(&tracer, &here, SIZE);
    let (shown, right) = (paper(&tracer, &here, &[&lent]), full(&tracer, &here));
    let [a, b] = [srgb(&shown), srgb(&right)];
    let specular = (0..a.len())
        .filter(|&i| shown.types[i] == PixelType::Secondary && shown.triangle[i] == right.triangle[i]);
    let specular: Vec<usize> = specular.collect();
    let off = specular.iter().filter(|&&i| a[i].iter().zip(&b[i]).any(|(x, y)| x.abs_diff(*y) > 1)).count();
    let note = format!("{} pixels", specular.len());
    Ok(Measured { note, picture: Some((SIZE, a)), ..Measured::from(percent(off, specular.len())) })
}

fn never_copied(_: &Trial) -> Outcome {
    let tracer = Room::SHINY.tracer()?;
    let lent = [
        reference(&tracer, &Room::SHINY.camera(), SIZE),
        reference(&tracer, &Room::SHINY.moved(0.5, 0.2), SIZE),
    ];
    let mut wrong = 0;
    for (forward, turn) in [(0.0, 0.0), (0.2, 0.1), (1.0, -0.3)] {
        let shown = paper(&tracer, &Room::SHINY.moved(forward, turn), &[&lent[0], &lent[1]]);
        let is_wrong = |(kind, &t): (&PixelType, &u32)| {
            *kind == PixelType::Reused && t != u32::MAX && tracer.scene().material_of(t).is_view_dependent()
        };
        wrong += shown.types.iter().zip(&shown.triangle).filter(|&pair| is_wrong(pair)).count();
    }
    Ok(wrong.into())
}

/// Two mirrors that lose so little that light runs to and fro more than 255 times.
fn hall(reflectance: f32) -> Result<(Tracer, Camera), ExperimentError> {
    let mut b = SceneBuilder::new("hall");
    let mirror = b.add_material(Material::mirror("mirror", Vec3::splat(reflectance)));
    for z in [-2.0, 2.0] {
        quad(&mut b, dvec(-90.0, -90.0, z), dvec(180.0, 0.0, 0.0), dvec(0.0, 180.0, 0.0), mirror);
    }
    b.point_lights.push((DVec3::ZERO, Vec3::ONE));
    Ok((tracer(b)?, Camera::look_at(DVec3::ZERO, dvec(0.0, 0.0, -1.0), 3.0)))
}

fn counts_saturate(_: &Trial) -> Outcome {
    let (tracer, camera) = hall(0.99)?;
    let lent = reference(&tracer, &camera, [24, 16]);
    Ok((0..24 * 16).filter(|&pixel| lent.reflections(pixel) != u8::MAX).count().into())
}

fn other_epochs(_: &Trial) -> Outcome {
    let (old, new) = (Room::PLAIN.tracer()?, Arc::new(Room::PLAIN.tracer()?));
    let lent = reference(&old, &Room::PLAIN.camera(), SIZE);
    let mut cache = ReferenceCache::new(new.scene(), 1 << 30);
    cache.insert(Arc::new(lent.clone()));
    let mut accepted = ReferenceSelector::default()
        .select(&mut cache, &view(&new, &Room::PLAIN.camera()), new.epoch(), 8)
        .len();
    accepted += LookupSet::new(&cache, new.epoch()).len();
    accepted += usize::from(Walkthrough::new(new, WalkthroughSettings::default()).insert(lent).is_some());
    Ok(accepted.into())
}

fn other_sizes(_: &Trial) -> Outcome {
    let tracer = Room::SHINY.tracer()?;
    let here = Room::SHINY.camera();
    let mut wrong = 0;
    for (size, fov_y) in [([1, 1], 1.0), ([7, 300], 0.5), ([256, 192], 2.9), ([333, 17], 0.02)] {
        let lent = reference(&tracer, &Camera { fov_y, ..here }, size);
        let shown = paper(&tracer, &here, &[&lent]);
        wrong += bad_values(&shown) + shown.stats.types.total().abs_diff(shown.types.len());
    }
    Ok(wrong.into())
}

fn edited(_: &Trial) -> Outcome {
    let tracer = Arc::new(Room::PLAIN.tracer()?);
    let settings = WalkthroughSettings {
        render: RenderSettings { mode: Mode::Paper, trace: TRACE },
        ..Default::default()
    };
    let mut walk = Walkthrough::new(tracer.clone(), settings);
    walk.insert(reference(&tracer, &Room::PLAIN.camera(), SIZE));
    let mut look = tracer.scene().to_edit();
    look.materials[0] = Material::diffuse("wall", Vec3::new(0.1, 0.6, 0.2));
    let scene = tracer.scene().with_edit(&look);
    let edited = Arc::new(tracer.with_same_geometry(Arc::new(scene)));
    walk.set_tracer(edited.clone());
    let shown = walk.render(&Room::PLAIN.camera(), SIZE, NEVER);
    Ok((differing(shown, &full(&edited, &Room::PLAIN.camera())) + shown.stats.references_used).into())
}

/// Before a wall at three metres, metres: less than an f32 tells apart there (2.4e-7).
const UNSEEN_M: f64 = 1e-8;

fn on_surface(_: &Trial) -> Outcome {
    let tracer = Room::SHINY.tracer()?;
    let mut wrong = 0;
    for eye in [dvec(3.0, 1.5, 0.0), dvec(3.0 - UNSEEN_M, 1.5, 0.0), dvec(-1.0, 1.0, -3.875)] {
        let lent = reference(&tracer, &Camera::look_at(eye, dvec(4.0, 1.5, -9.0), 70.0), SIZE);
        wrong += lent.disparity().iter().filter(|d| **d > 1.0 / crate::camera::NEAREST_DEPTH).count();
    }
    Ok(wrong.into())
}

fn inside_glass(_: &Trial) -> Outcome {
    let mut b = Room::PLAIN.builder();
    let glass = b.add_material(Material::glass("glass", 1.5, Vec3::splat(0.98)));
    ball(&mut b, dvec(0.0, 1.4, 1.0), 0.5, 24, false, glass);
    let tracer = tracer(b)?;
    let inside = Camera::look_at(dvec(0.0, 1.4, 1.1), dvec(0.0, 1.3, -4.0), 65.0);
    let lent = reference(&tracer, &inside, SIZE);
    let shown = paper(&tracer, &inside, &[&lent]);
    let note = format!(
        "{} pixels of Type 2, {} of Type 1",
        count_type(&shown, PixelType::Secondary),
        count_type(&shown, PixelType::Reused)
    );
    Ok(Measured {
        note,
        ..Measured::from(off_percent(&shown, &full(&tracer, &inside)) + bad_values(&shown) as f64)
    })
}

fn damaged(mode: Mode) -> Outcome {
    let tracer = Room::SHINY.tracer()?;
    let here = Room::SHINY.camera();
    let whole = reference(&tracer, &here, SIZE);
    let mut broken = whole.clone();
    let hit = broken.flip_bits(0.01, 77).len();
    let [right, shown] = [&whole, &broken].map(|lent| picture(&tracer, &here, SIZE, mode, &[lent]));
    let changed = right.radiance.iter().zip(&shown.radiance).filter(|(a, b)| a != b).count();
    Ok((changed as f64 / hit.max(1) as f64 + bad_values(&shown) as f64).into())
}

/// A picture by look-up in one sparse reference, whole or damaged.
fn looked_up(tracer: &Tracer, share: f32) -> Frame {
    let here = Room::SHINY.camera();
    let mut cache = ReferenceCache::new(tracer.scene(), 1 << 30);
    let known = cache.snapshot();
    let lookup = LookupSet::of_snapshot(&known, tracer.epoch());
    let traced = ReferenceFrame::trace_sparse(tracer, &here, SIZE, &TRACE, &lookup, NEVER);
    if let Some(mut lent) = traced {
        lent.flip_bits(share, 78);
        cache.insert(Arc::new(lent));
    }
    let mut renderer = Renderer::default();
    let settings = RenderSettings { mode: Mode::Exact, trace: TRACE };
    renderer.render(&FrameRequest::new(tracer, &here, SIZE, &settings).reusing(&cache));
    renderer.into_frame()
}

fn damaged_look_up() -> Outcome {
    let tracer = Room::SHINY.tracer()?;
    let (right, shown) = (looked_up(&tracer, 0.0), looked_up(&tracer, 0.01));
    let changed = right.radiance.iter().zip(&shown.radiance).filter(|(a, b)| a != b).count();
    let note = "a pixel is looked up in four neighbours, and a mirror shows others".to_owned();
    Ok(Measured {
        note,
        ..Measured::from(percent(changed, right.radiance.len()) + bad_values(&shown) as f64)
    })
}

fn ruined() -> Outcome {
    let tracer = Room::SHINY.tracer()?;
    Ok(bad_values(&looked_up(&tracer, 0.5)).into())
}

fn budget(_: &Trial) -> Outcome {
    let tracer = Room::SHINY.tracer()?;
    let one = reference(&tracer, &Room::SHINY.camera(), SIZE);
    let (bytes, most) = (one.bytes(), 4 * one.bytes());
    let mut cache = ReferenceCache::new(tracer.scene(), most);
    let mut worst = 0f64;
    for _ in 0..12 {
        cache.insert(Arc::new(one.clone()));
        worst = worst.max(cache.bytes() as f64 / (most + bytes) as f64);
    }
    Ok(worst.into())
}

fn evicted_in_use(_: &Trial) -> Outcome {
    let tracer = Room::PLAIN.tracer()?;
    let camera = Room::PLAIN.camera();
    let mut cache = ReferenceCache::new(tracer.scene(), 1);
    cache.insert(Arc::new(reference(&tracer, &camera, SIZE)));
    let held = ReferenceSelector::default().select(&mut cache, &view(&tracer, &camera), tracer.epoch(), 1);
    let before = paper(&tracer, &camera, &held.iter().map(|r| &*r.frame).collect::<Vec<_>>());
    cache.insert(Arc::new(reference(&tracer, &Room::PLAIN.moved(0.1, 0.0), SIZE)));
    let is_gone = cache.entries().iter().all(|e| e.id != held[0].id);
    let after = paper(&tracer, &camera, &held.iter().map(|r| &*r.frame).collect::<Vec<_>>());
    Ok(if is_gone { differing(&before, &after).into() } else { f64::NAN.into() })
}

fn all_of(tracer: &Tracer, camera: &Camera, wanted: PixelType) -> Outcome {
    let lent = reference(tracer, camera, SIZE);
    let shown = paper(tracer, camera, &[&lent]);
    let miscounted = shown.stats.types.total().abs_diff(shown.types.len());
    Ok((shown.types.len() - count_type(&shown, wanted) + miscounted + bad_values(&shown)).into())
}

fn all_type_2(_: &Trial) -> Outcome {
    let (tracer, camera) = hall(0.9)?;
    all_of(&tracer, &camera, PixelType::Secondary)
}

fn all_type_1(_: &Trial) -> Outcome {
    all_of(&Room::PLAIN.tracer()?, &Room::PLAIN.camera(), PixelType::Reused)
}

fn time_ratio(tracer: &Tracer, camera: &Camera) -> Outcome {
    let size = [480, 320];
    let lent = reference(tracer, camera, size);
    let mut renderer = Renderer::default();
    let mut secs = |mode, lent: &[&ReferenceFrame]| {
        let start = Instant::now();
        renderer.render(
            &FrameRequest::new(tracer, camera, size, &RenderSettings { mode, trace: TRACE }).warping(lent),
        );
        start.elapsed().as_secs_f64()
    };
    Ok(fastest_ratio(7, || [secs(Mode::Paper, &[&lent]), secs(Mode::Full, &[])]).into())
}

fn mirror_hall_time(_: &Trial) -> Outcome {
    let (tracer, camera) = hall(0.9)?;
    time_ratio(&tracer, &camera)
}

fn matte_time(_: &Trial) -> Outcome {
    time_ratio(&Room::PLAIN.tracer()?, &Room::PLAIN.camera())
}
