//! Cases C of the catalogue: geometry that is coincident, degenerate, nested, needle-shaped or
//! missing.

use super::case::{Case, Measured, Outcome, Trial, case, worst};
use super::pictures::{
    SIZE, bad_values, differing, fastest_ratio, full, off_percent, percent, reference, srgb,
};
use super::rooms::{Room, ball, dvec, imported, is_named, random, soup, tracer, triangle, wall};
use crate::camera::Camera;
use crate::math::{Ray, key::Key, sampling::uniform_triangle};
use crate::render::Frame;
use crate::scene::{Material, MaterialId, SceneBuilder, SceneError, Sun};
use crate::trace::{Bvh, ILL_CONDITIONED, NO_TRIANGLE, Tracer};
use glam::{DVec3, Vec2, Vec3, Vec3Swizzles};
use rayon::prelude::*;
use std::{f64::consts::TAU, time::Instant};

pub(super) const CASES: &[Case] = &[
    case("C1 a face twice", "% of pixels that show the later one", 0.0, |_| twins_shown(true)),
    case("C1 a face on a face cut otherwise", "% of pixels that show the later one", 0.0, |_| {
        twins_shown(false)
    }),
    case("C1 faces on faces at rest", "pixels that change in 100 frames", 0.0, twins_at_rest),
    case("C1 duplicates are counted", "faces counted too many or too few", 0.0, duplicates_counted),
    case("C2 a decal 0.1 mm before a wall at 10 m", "% of its pixels that show the wall", 0.0, decal),
    case("C3 zero area, NaN, infinity, missing vertices", "triangles kept or miscounted", 0.0, dropped),
    case("C3 the rest is as before", "pixels that differ in a bit", 0.0, rest_is_kept),
    case("C4 needles 1e4 x 1e-7, grazing", "hits beyond the triangle's distances", 0.0, needles),
    case("C4 needles are not reused", "needle pixels kept, condition below 1e-5", 0.0, needles_not_kept),
    case("C5 equal triangles", "times the build time of random ones", 2.0, equal_triangles_time).timed(),
    case("C5 equal centroids", "times the build time of random ones", 2.0, equal_centroids_time).timed(),
    case("C6 5,000 nested triangles", "rays that miss the outermost", 0.0, nested),
    case("C6 time of 10,000 nested triangles", "times the build time of random ones", 2.0, nested_time)
        .timed(),
    case("C7 no triangle and one", "answers that are wrong", 0.0, next_to_nothing),
    case("C8 wrong winding", "% of pixels off by more than 1/255", 1.0, wrong_winding),
    case("C8 normals of length 10", "% of pixels off by more than 1/255", 1.0, |_| scaled_normals(10.0)),
    case("C8 normals that point inwards", "% of pixels off by more than 1/255", 1.0, |_| {
        scaled_normals(-1.0)
    }),
    case("C9 a concave polygon of 9 corners", "relative error of its area", 1e-4, concave),
    case("C10 a smooth cylinder of 12 segments", "steps of 255 by which light rises again", 1.0, terminator),
];

/// Returns the share, in percent, of the pixels that see one of two coplanar faces and show the
/// later one.
fn later_percent(tracer: &Tracer, frame: &Frame) -> f64 {
    let count = |name: &str| frame.triangle.iter().filter(|t| is_named(tracer, **t, name)).count();
    percent(count("later"), count("later") + count("first"))
}

/// Two faces in one slanted plane with corners in different order, cut along the same diagonal or
/// not.
fn twins(is_cut_alike: bool) -> Result<(Tracer, Camera), SceneError> {
    let mut b = SceneBuilder::new("twins");
    let first = b.add_material(Material::diffuse("first", Vec3::new(0.7, 0.2, 0.1)));
    let later = b.add_material(Material::diffuse("later", Vec3::new(0.1, 0.3, 0.7)));
    let (corner, u, v) = (dvec(-1.1, -0.9, 0.07), dvec(2.03, 0.31, 0.17), dvec(-0.23, 1.87, 0.41));
    let p = [corner, corner + u, corner + u + v, corner + v];
    let other = if is_cut_alike { [[2, 1, 0], [3, 0, 2]] } else { [[1, 2, 3], [1, 3, 0]] };
    for (corners, material) in [([0, 1, 2], first), ([0, 2, 3], first), (other[0], later), (other[1], later)]
    {
        triangle(&mut b, corners.map(|i: usize| p[i]), material);
    }
    b.point_lights.push((dvec(0.3, 0.5, 3.0), Vec3::splat(9.0)));
    Ok((tracer(b)?, Camera::look_at(dvec(0.4, 0.3, 2.9), dvec(-0.1, 0.05, 0.0), 50.0)))
}

fn twins_shown(is_cut_alike: bool) -> Outcome {
    let (tracer, camera) = twins(is_cut_alike)?;
    let frame = full(&tracer, &camera);
    Ok(Measured::from(later_percent(&tracer, &frame)).with_picture(&frame))
}

fn twins_at_rest(trial: &Trial) -> Outcome {
    let (tracer, camera) = twins(false)?;
    let first = full(&tracer, &camera);
    Ok((0..trial.frames).map(|_| differing(&first, &full(&tracer, &camera))).sum::<usize>().into())
}

fn duplicates_counted(_: &Trial) -> Outcome {
    Ok(twins(true)?.0.scene().conditioning.coplanar_duplicates.abs_diff(2).into())
}

fn decal(_: &Trial) -> Outcome {
    let mut b = SceneBuilder::new("decal");
    let behind = b.add_material(Material::diffuse("later", Vec3::splat(0.5)));
    let sign = b.add_material(Material::diffuse("first", Vec3::new(0.8, 0.1, 0.1)));
    wall(&mut b, dvec(-8.0, -6.0, 0.0), [16.0, 12.0], behind);
    wall(&mut b, dvec(-2.0, -2.0, 1e-4), [4.0, 4.0], sign);
    b.point_lights.push((dvec(0.0, 0.0, 5.0), Vec3::splat(50.0)));
    let tracer = tracer(b)?;
    worst(0..20, |step| {
        // The field of view is so narrow that only the decal is in view.
        let camera = Camera::look_at(dvec(0.001 * f64::from(step), 0.3, 10.0), DVec3::ZERO, 15.0);
        Ok(later_percent(&tracer, &full(&tracer, &camera)))
    })
}

/// The room with nine triangles that cannot be traced: three with corners that are missing or not
/// finite, and six without area.
fn spoiled() -> SceneBuilder {
    let mut b = Room::PLAIN.builder();
    let (p, q) = (dvec(0.5, 0.5, 0.5), dvec(1.0, 0.25, 0.5));
    let not_finite = [[p, q, dvec(f64::NAN, 0.0, 0.0)], [p, q, dvec(0.0, f64::INFINITY, 0.0)]];
    let without_area = [[p, p, p], [p, p, q], [p, q, p], [q, p, p], [p, q, (p + q) / 2.0], [p, q, q]];
    for corners in not_finite.into_iter().chain(without_area) {
        triangle(&mut b, corners, MaterialId(0));
    }
    b.add_triangle([0, 1, 1_000_000_000], MaterialId(0));
    b
}

fn dropped(_: &Trial) -> Outcome {
    let (whole, spoiled) = (Room::PLAIN.builder().finish()?, spoiled().finish()?);
    let repairs = spoiled.conditioning.repairs;
    let wrong = whole.triangles.len().abs_diff(spoiled.triangles.len())
        + repairs.triangles_not_finite.abs_diff(3)
        + repairs.triangles_without_area.abs_diff(6)
        + usize::from(spoiled.warnings.len() < 2);
    Ok(wrong.into())
}

fn rest_is_kept(_: &Trial) -> Outcome {
    let (whole, camera) = Room::PLAIN.stage()?;
    Ok(differing(&full(&tracer(spoiled())?, &camera), &full(&whole, &camera)).into())
}

fn needles(trial: &Trial) -> Outcome {
    let mut b = SceneBuilder::new("needles");
    // Needles of 1e4 x 1e-7 in all directions.
    for i in 0..500 {
        let key = Key::of_pixel(21, i);
        let (along, across) = (random(key, 0).normalize_or(Vec3::X), random(key, 1).normalize_or(Vec3::Y));
        let start = random(key, 2) * 0.5 - along;
        let tip = start + along + across * (2e-7 * (1 + i % 100) as f32);
        triangle(&mut b, [start, start + along * 2.0, tip].map(|p| p.as_dvec3()), MaterialId(0));
    }
    let tracer = tracer(b)?;
    let scene = tracer.scene();
    let soup: Vec<[Vec3; 3]> = (0..scene.triangles.len() as u32).map(|i| scene.corners(i)).collect();
    let length = soup.iter().map(|[a, b, _]| a.distance(*b)).fold(0.0, f32::max);
    let aimed = |i: u32| {
        let key = Key::of_pixel(22, i);
        let [a, b, c] = soup[i as usize % soup.len()];
        let [s, t] = key.pair();
        // Half of the rays graze: they run along the needle at a twentieth of a degree.
        let origin = if i.is_multiple_of(2) {
            random(key, 5) * 1.5 * length
        } else {
            a - (b - a) + random(key, 5) * 4.5e-4 * length
        };
        Ray::new(origin, a + (b - a) * s + (c - a) * (t * (1.0 - s)) - origin)
    };
    let is_wrong = |i: &u32| {
        let ray = aimed(*i);
        tracer.closest(&ray).is_some_and(|hit| {
            let along = ray.direction.as_dvec3() / ray.direction.as_dvec3().length_squared();
            let corners = soup[hit.triangle as usize].map(|p| (p - ray.origin).as_dvec3().dot(along));
            let low = corners.into_iter().fold(f64::INFINITY, f64::min);
            let high = corners.into_iter().fold(f64::NEG_INFINITY, f64::max);
            let slack = 1e-3 * high.abs().max(low.abs());
            !(low - slack..=high + slack).contains(&f64::from(hit.t))
        })
    };
    Ok((0..trial.tries).into_par_iter().filter(is_wrong).count().into())
}

fn needles_not_kept(_: &Trial) -> Outcome {
    let mut b = Room::PLAIN.builder();
    // Slivers in front of the back wall. Each is so thin that few pixels see it; there are enough
    // that some do.
    for i in 0..4000 {
        let y = 0.5 + f64::from(i) * 5e-4;
        let corners = [dvec(-2.9, y, -3.0), dvec(2.9, y, -3.0), dvec(0.0, y + 4e-5, -3.0)];
        triangle(&mut b, corners, MaterialId(0));
    }
    let tracer = tracer(b)?;
    let reference = reference(&tracer, &Room::PLAIN.camera(), [512, 384]);
    let is_kept = |&(pixel, &triangle): &(u32, &u32)| {
        let is_ill = triangle != NO_TRIANGLE
            && tracer.condition(reference.view.direction_of_pixel(pixel), triangle) < ILL_CONDITIONED;
        is_ill && !reference.disparity()[pixel as usize].is_nan()
    };
    let kept = (0..).zip(reference.triangle()).filter(is_kept).count();
    let dropped = reference.disparity().iter().filter(|d| d.is_nan()).count();
    let note = format!("{} needles, {dropped} pixels not kept", tracer.scene().conditioning.needles);
    Ok(Measured::from(kept).with_note(note))
}

fn build_ratio(corners: &[[Vec3; 3]]) -> f64 {
    let random = soup(corners.len() as u32, 0.01, 23);
    let secs = |corners: &[[Vec3; 3]]| {
        let start = Instant::now();
        std::hint::black_box(Bvh::build(corners));
        start.elapsed().as_secs_f64()
    };
    fastest_ratio(3, || [secs(corners), secs(&random)])
}

fn equal_triangles_time(trial: &Trial) -> Outcome {
    Ok(build_ratio(&vec![[Vec3::ZERO, Vec3::X, Vec3::Y]; trial.tries as usize]).into())
}

fn equal_centroids_time(trial: &Trial) -> Outcome {
    let around_one_point = |i| {
        let d = random(Key::of_pixel(24, i), 0);
        [d, d.yzx() - d, -d.yzx()]
    };
    Ok(build_ratio(&(0..trial.tries).map(around_one_point).collect::<Vec<_>>()).into())
}

/// Triangles each of which is slightly smaller than the previous one and slightly behind it.
fn shrinking(count: i32) -> Vec<[Vec3; 3]> {
    let corners = |i| {
        let s = 0.999f32.powi(i);
        [Vec3::ZERO, Vec3::X * s, Vec3::Y * s].map(|p| p + Vec3::Z * (1.0 - s))
    };
    (0..count).map(corners).collect()
}

fn nested(_: &Trial) -> Outcome {
    let bvh = Bvh::build(&shrinking(5000));
    let missed = (0..1000u32).filter(|&i| {
        let [x, y] = uniform_triangle(Key::of_pixel(25, i).pair());
        let hit = bvh.closest(&Ray::new(Vec3::new(x * 0.99, y * 0.99, -1.0), Vec3::Z), |_| true);
        hit.is_none_or(|hit| hit.triangle != 0)
    });
    Ok(missed.count().into())
}

fn nested_time(_: &Trial) -> Outcome {
    Ok(build_ratio(&shrinking(10_000)).into())
}

fn next_to_nothing(_: &Trial) -> Outcome {
    let message = SceneBuilder::new("nothing").finish().err().map(|e| e.to_string()).unwrap_or_default();
    let mut b = SceneBuilder::new("one");
    triangle(&mut b, [dvec(-1.0, -1.0, 0.0), dvec(1.0, -1.0, 0.0), dvec(0.0, 1.0, 0.0)], MaterialId(0));
    let frame = full(&tracer(b)?, &Camera::look_at(dvec(0.0, 0.0, 3.0), DVec3::ZERO, 60.0));
    let seen = frame.triangle.iter().filter(|t| **t == 0).count();
    let wrong = [
        !message.contains("no triangle"),
        Bvh::build(&[]).any(&Ray::new(Vec3::ZERO, Vec3::Z), |_| true),
        seen == 0 || seen == frame.triangle.len(),
    ];
    Ok((wrong.into_iter().filter(|is_wrong| *is_wrong).count() + bad_values(&frame)).into())
}

/// Compares a smooth ball in the room with the same ball after `change`.
fn changed_ball(change: impl Fn(&mut SceneBuilder)) -> Outcome {
    let render = |change: &dyn Fn(&mut SceneBuilder)| -> Result<Frame, SceneError> {
        let mut b = Room::PLAIN.builder();
        ball(&mut b, dvec(0.0, 1.2, 0.5), 0.6, 24, true, MaterialId(1));
        change(&mut b);
        Ok(full(&tracer(b)?, &Room::PLAIN.camera()))
    };
    let (right, changed) = (render(&|_| {})?, render(&change)?);
    Ok((off_percent(&right, &changed) + bad_values(&changed) as f64).into())
}

fn wrong_winding(_: &Trial) -> Outcome {
    // The lamp is left out: with other corners its random points would differ.
    changed_ball(|b| {
        let faces = b.triangles.iter_mut().zip(&b.triangle_materials);
        faces.filter(|(_, m)| m.0 < 2).for_each(|(t, _)| t.swap(1, 2));
    })
}

fn scaled_normals(factor: f32) -> Outcome {
    changed_ball(|b| b.normals.iter_mut().for_each(|n| *n *= factor))
}

fn concave(_: &Trial) -> Outcome {
    let corners = [[0, 0], [4, 0], [4, 3], [3, 1], [2, 3], [2, 1], [1, 3], [1, 1], [0, 3]];
    let mut text: String = corners.iter().map(|[x, y]| format!("v {x}.1 {y}.2 0.5\n")).collect();
    text += "f 1 2 3 4 5 6 7 8 9\n";
    let doubled: i32 = (0..corners.len())
        .map(|i| {
            let ([ax, ay], [bx, by]) = (corners[i], corners[(i + 1) % corners.len()]);
            ax * by - ay * bx
        })
        .sum();
    let expected = f64::from(doubled) / 2.0;
    let scene = imported(&[("star.obj", &text)])?;
    let area = |t: u32| {
        let [a, b, c] = scene.corners(t).map(Vec3::as_dvec3);
        (b - a).cross(c - a).length() / 2.0
    };
    let square = scene.frame.units_per_metre * scene.frame.units_per_metre;
    // The importer guesses the unit; only the shape matters here.
    let [low, high] = scene.bounds_m;
    let unit = (high.x - low.x) / 4.0;
    let found: f64 = (0..scene.triangles.len() as u32).map(area).sum::<f64>() / square / (unit * unit);
    Ok(((found / expected - 1.0).abs()).into())
}

/// On the lit half of the cylinder, light must decrease monotonically towards the shadow.
fn terminator(_: &Trial) -> Outcome {
    let mut b = SceneBuilder::new("cylinder");
    let grey = b.add_material(Material::diffuse("grey", Vec3::splat(0.8)));
    let at = |i: u32| {
        let angle = TAU * f64::from(i) / 12.0;
        dvec(angle.sin(), 0.0, angle.cos())
    };
    for i in 0..12 {
        let corners = [(i, -1.0), (i + 1, -1.0), (i + 1, 1.0), (i, 1.0)];
        let v = corners.map(|(k, y)| b.add_vertex(at(k) + dvec(0.0, y, 0.0), at(k).as_vec3(), Vec2::ZERO));
        b.add_triangle([v[0], v[1], v[2]], grey);
        b.add_triangle([v[0], v[2], v[3]], grey);
    }
    let direction = Vec3::new(1.0, 0.0, 0.3).normalize_or(Vec3::X);
    b.sun = Some(Sun { direction, angular_radius: 0.0, irradiance: Vec3::splat(3.0) });
    let frame = full(&tracer(b)?, &Camera::look_at(dvec(0.0, 0.0, 5.0), DVec3::ZERO, 22.0));
    let shown = srgb(&frame);
    let row = &shown[(SIZE[1] / 2 * SIZE[0]) as usize..][..SIZE[0] as usize];
    // The sun is on the right: from right to left light must not rise again once it has begun to
    // fall.
    let lit: Vec<i32> = row.iter().rev().map(|c| i32::from(c[0])).skip_while(|c| *c == 0).collect();
    let brightest = lit.iter().enumerate().max_by_key(|(_, c)| **c).map_or(0, |(i, _)| i);
    let largest = |step: fn(&[i32]) -> i32| lit[brightest..].windows(2).map(step).max().unwrap_or(0);
    let (rise, fall) = (largest(|w| w[1] - w[0]), largest(|w| w[0] - w[1]));
    let note = format!("the largest decrease from one pixel to the next is {fall} steps");
    Ok(Measured::from(f64::from(rise.max(0))).with_note(note).with_picture(&frame))
}
