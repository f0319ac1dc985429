//! Cases F of the catalogue: theorems of rays, checked against implementations too simple to be
//! wrong.

use super::case::{Case, Measured, Outcome, Trial, case};
use super::pictures::{SIZE, bad_values, differing, fastest_ratio, picture, reference};
use super::rooms::{Room, ball, cuboid, random, soup, tracer, triangle};
use super::scale::self_hits;
use crate::camera::Camera;
use crate::experiment::run::ExperimentError;
use crate::math::{Ray, key::Key};
use crate::render::{Frame, FrameRequest, Mode, RenderSettings, Renderer};
use crate::scene::{Material, SceneBuilder};
use crate::trace::{Bvh, TraceSettings};
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::time::Instant;

pub(super) const CASES: &[Case] = &[
    case(
        "F1 watertight at 10 scales and places",
        "rays at edges and vertices that leave a ball",
        0.0,
        watertight,
    ),
    case("F2 rays from surfaces", "self-hits", 0.0, no_self_hits),
    case("F3 against all triangles in f64", "rays with another answer, margin 1e-5", 0.0, against_f64),
    case("F4 time of rays of NaN and infinity", "times that of usual rays", 2.5, broken_rays_time).timed(),
    case("F4 rays of NaN and infinity", "hits that are not finite", 0.0, broken_rays),
    case("F5 energy of a closed white room", "% of difference from the closed form", 1.0, furnace),
    case("F6 1, 2, 3 and 8 threads", "pixels that differ in a bit, full and paper", 0.0, threads),
];

fn sphere(scale: f64, offset: DVec3) -> Vec<[Vec3; 3]> {
    let mut b = SceneBuilder::new("ball");
    let m = b.add_material(Material::diffuse("m", Vec3::splat(0.5)));
    ball(&mut b, DVec3::ZERO, 1.0, 24, false, m);
    // The scene is not finished, because finishing would scale the coordinates.
    let at = |v: u32| (b.positions[v as usize] * scale + offset).as_vec3();
    b.triangles.iter().map(|t| t.map(at)).collect()
}

fn watertight(trial: &Trial) -> Outcome {
    let mut missed = 0;
    let near = [(1.0, 0.0), (1e-3, 0.0), (1e5, 0.0), (1e-6, 0.0), (1e9, 0.0), (0.1, 7.0)];
    let far = [(1.0, 300.0), (100.0, -512.0), (1e3, 1e4), (3.7, 50.0)];
    for (scale, offset) in near.into_iter().chain(far) {
        let offset = DVec3::new(offset, -offset, offset / 2.0);
        let triangles = sphere(scale, offset);
        let bvh = Bvh::build(&triangles);
        let is_missed = |&i: &u32| {
            let key = Key::of_pixel(51, i);
            let origin = offset.as_vec3() + random(key, 0) * (scale * 0.5) as f32;
            let [a, b, c] = triangles[i as usize % triangles.len()];
            let aim = match i % 3 {
                0 => a,
                1 => (a + b) / 2.0,
                _ => a + (c - a) * key.pair()[0],
            };
            bvh.closest(&Ray::new(origin, aim - origin), |_| true).is_none()
        };
        missed += (0..trial.tries / 10).into_par_iter().filter(is_missed).count();
    }
    Ok(missed.into())
}

/// A scene of random triangles, enlarged and away from the origin.
fn scattered() -> SceneBuilder {
    let mut b = SceneBuilder::new("soup");
    let matte = b.add_material(Material::diffuse("matte", Vec3::splat(0.5)));
    for t in soup(2000, 0.2, 5) {
        triangle(&mut b, t.map(|p| p.as_dvec3() * 30.0 + DVec3::splat(1000.0)), matte);
    }
    b
}

fn no_self_hits(trial: &Trial) -> Outcome {
    let tracer = tracer(scattered())?;
    let all: Vec<u32> = (0..tracer.scene().triangles.len() as u32).collect();
    Ok(self_hits(&tracer, &all, trial.tries).into())
}

/// Intersects by Moeller and Trumbore in f64. Returns the distance and the least barycentric
/// coordinate.
fn hit_f64(ray: &Ray, triangle: &[Vec3; 3]) -> Option<(f64, f64)> {
    let [a, b, c] = triangle.map(Vec3::as_dvec3);
    let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let (e1, e2) = (b - a, c - a);
    let p = d.cross(e2);
    let det = e1.dot(p);
    let s = o - a;
    let (u, q) = (s.dot(p) / det, s.cross(e1));
    let (v, t) = (d.dot(q) / det, e2.dot(q) / det);
    (t > 0.0 && det != 0.0).then_some((t, u.min(v).min(1.0 - u - v)))
}

/// Compares 200 scenes. All rays together are a tenth of the tries, because every ray is tested
/// against every triangle.
fn against_f64(trial: &Trial) -> Outcome {
    const SCENES: u32 = 200;
    const MARGIN: f64 = 1e-5;
    let rays = (trial.tries / 10).div_ceil(SCENES);
    let wrong_in = |scene: u32| {
        let soup = soup(120, 0.05 + 0.005 * scene as f32, 100 + u64::from(scene));
        let bvh = Bvh::build(&soup);
        let is_wrong = |i: &u32| {
            let key = Key::of_pixel(u64::from(scene) + 1000, *i);
            let ray = Ray::new(random(key, 0) * 1.5, random(key, 1));
            let hits: Vec<_> =
                soup.iter().zip(0u32..).filter_map(|(t, k)| Some((k, hit_f64(&ray, t)?))).collect();
            let inside = |(_, (_, least)): &&(u32, (f64, f64))| *least > 0.0;
            let slow = hits.iter().filter(inside).min_by(|a, b| a.1.0.total_cmp(&b.1.0));
            let unclear = |(k, (t, least)): &(u32, (f64, f64))| {
                let is_second =
                    slow.is_some_and(|(first, (nearest, _))| k != first && (t - nearest).abs() < MARGIN * t);
                least.abs() < MARGIN || *least > 0.0 && is_second
            };
            let is_clear = !hits.iter().any(unclear);
            is_clear && bvh.closest(&ray, |_| true).map(|h| h.triangle) != slow.map(|(k, _)| *k)
        };
        (0..rays).filter(is_wrong).count()
    };
    let wrong: usize = (0..SCENES).into_par_iter().map(wrong_in).sum();
    Ok(Measured::from(wrong).with_note(format!("{} rays in {SCENES} scenes", rays * SCENES)))
}

/// Returns rays that start among the triangles; with `is_broken`, one component of each is invalid
/// or extreme.
fn rays(count: u32, is_broken: bool) -> Vec<Ray> {
    let broken = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 0.0, f32::MAX, f32::MIN_POSITIVE / 4.0];
    let ray = |i: u32| {
        let key = Key::of_pixel(53, i);
        let mut ray = Ray::new(random(key, 0), random(key, 1));
        if is_broken {
            let value = broken[i as usize / 6 % broken.len()];
            match i % 6 {
                axis @ 0..3 => ray.direction[axis as usize] = value,
                3 => ray.direction = Vec3::splat(value),
                4 => ray.origin.x = value,
                _ => ray.t_max = value,
            }
        }
        ray
    };
    (0..count).map(ray).collect()
}

fn broken_rays(trial: &Trial) -> Outcome {
    let bvh = Bvh::build(&soup(5000, 0.1, 54));
    let is_wrong = |ray: &&Ray| {
        bvh.any(ray, |_| true);
        bvh.closest(ray, |_| true).is_some_and(|h| !(h.t.is_finite() && h.b1.is_finite() && h.b2.is_finite()))
    };
    Ok(rays(trial.tries, true).iter().filter(is_wrong).count().into())
}

fn broken_rays_time(trial: &Trial) -> Outcome {
    let bvh = Bvh::build(&soup(5000, 0.1, 54));
    let [usual, broken] = [false, true].map(|is_broken| rays(trial.tries / 4, is_broken));
    let secs = |rays: &[Ray]| {
        let start = Instant::now();
        std::hint::black_box(rays.iter().filter(|ray| bvh.closest(ray, |_| true).is_some()).count());
        start.elapsed().as_secs_f64()
    };
    Ok(fastest_ratio(5, || [secs(&broken), secs(&usual)]).into())
}

fn furnace(_: &Trial) -> Outcome {
    let mut worst = f64::NEG_INFINITY;
    for bounces in [0, 1, 4] {
        let mut b = SceneBuilder::new("furnace");
        let wall =
            b.add_material(Material { emission: Vec3::ONE, ..Material::diffuse("wall", Vec3::splat(0.8)) });
        cuboid(&mut b, [DVec3::splat(-2.0), DVec3::splat(2.0)], wall, true);
        let tracer = tracer(b)?;
        let camera = Camera::look_at(DVec3::new(0.1, 0.2, 0.3), DVec3::new(1.0, 0.4, -0.7), 70.0);
        let trace = TraceSettings { samples: 512, bounces, seed: 1 };
        let settings = RenderSettings { mode: Mode::Full, trace };
        let mut renderer = Renderer::default();
        let frame = renderer.render(&FrameRequest::new(&tracer, &camera, [16, 16], &settings));
        let expected: f64 = (0..=bounces + 1).map(|n| 0.8f64.powi(n as i32)).sum();
        let mean = frame.radiance.iter().map(|r| f64::from(r.x)).sum::<f64>() / frame.radiance.len() as f64;
        worst = worst.max(100.0 * (mean / expected - 1.0).abs() + bad_values(frame) as f64);
    }
    Ok(worst.into())
}

fn threads(_: &Trial) -> Outcome {
    let (tracer, camera) = Room::SHINY.stage()?;
    let references = [camera, Room::SHINY.moved(0.5, 0.2)].map(|c| reference(&tracer, &c, SIZE));
    let here = Room::SHINY.moved(0.3, 0.1);
    let render = |threads: usize| -> Result<[Frame; 2], ExperimentError> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let pool =
            pool.map_err(|e| ExperimentError::Unsuitable(format!("cannot start {threads} threads: {e}")))?;
        let references = references.each_ref();
        let frame = |mode| picture(&tracer, &here, SIZE, mode, &references);
        Ok(pool.install(|| [Mode::Full, Mode::Paper].map(frame)))
    };
    let one = render(1)?;
    let mut wrong = 0;
    for count in [2, 3, 8] {
        wrong += one.iter().zip(&render(count)?).map(|(a, b)| differing(a, b)).sum::<usize>();
    }
    Ok(wrong.into())
}
