//! A: scale and position.

use super::bench::{
    Room, SIZE, bad_values, ball, cuboid, differing, dvec, full, other_triangles_percent, paper, random,
    reference, tracer,
};
use super::case::{Case, Measured, Outcome, Trial};
use crate::camera::Camera;
use crate::experiment::run::ExperimentError;
use crate::math::Ray;
use crate::math::key::Key;
use crate::math::sampling::{cosine_hemisphere, frame_around, uniform_triangle};
use crate::scene::{Light, Material, SceneBuilder};
use crate::trace::{SurfacePoint, Tracer};
use glam::{DVec3, Vec2, Vec3};
use rayon::prelude::*;

pub(super) const CASES: &[Case] = &[
    Case::new("A1 scaled by 2^k, k -20 to 30", "pixels that differ in a bit, full and paper", 0.0, scaled),
    Case::new("A2 moved by 2^20 and 2^23", "pixels that differ in a bit", 0.0, moved_dyadic),
    Case::new("A2 at UTM coordinates", "% of pixels that see another triangle", 0.1, at_utm),
    Case::new("A2 vertices at UTM coordinates", "largest error of a vertex, metres", 1e-4, vertices_at_utm),
    Case::new("A3 units", "scenes whose diagonal is not 512 to 1024", 0.0, diagonals),
    Case::new("A3 picture in any unit", "% of pixels that see another triangle", 0.1, any_unit),
    Case::new("A4 0.1 mm in 1 km, at the origin", "% of pixels of another silhouette", 0.1, tiny_at_origin),
    Case::new(
        "A4 0.1 mm in 1 km, 300 m off",
        "features too small for their place and not told",
        0.0,
        tiny_far_off,
    ),
    Case::new("A4 rays from 0.1 mm in 1 km", "self-hits", 0.0, tiny_self_hits),
    Case::new("A5 a vertex at 1e30 m", "% of pixels that see another triangle", 0.1, outlier_vertex),
    Case::new("A5 a triangle 100 km away", "% of pixels that see another triangle", 0.1, far_triangle),
    Case::new("A5 outliers are told", "outliers without a warning", 0.0, outliers_told),
    Case::new("A6 coordinates of 3e38", "bad values and pixels of another triangle", 6.0, huge),
    Case::new("A6 coordinates of 1e-45", "bad values and pixels of another triangle", 6.0, minute),
];

fn scaled(_: &Trial) -> Outcome {
    let render = |room: Room| -> Result<_, ExperimentError> {
        let tracer = room.tracer()?;
        let reference = reference(&tracer, &room.camera(), SIZE);
        Ok([full(&tracer, &room.camera()), paper(&tracer, &room.moved(0.25, 0.0625), &[&reference])])
    };
    let base = render(Room::SHINY)?;
    let mut wrong = 0;
    for k in [-20, -9, -1, 1, 10, 30] {
        let other = render(Room { scale: 2f64.powi(k), ..Room::SHINY })?;
        wrong += base.iter().zip(&other).map(|(a, b)| differing(a, b)).sum::<usize>();
    }
    Ok(wrong.into())
}

fn moved_dyadic(_: &Trial) -> Outcome {
    let base = full(&Room::SHINY.tracer()?, &Room::SHINY.camera());
    let mut wrong = 0;
    for shift in [2f64.powi(20), 2f64.powi(23)] {
        let room = Room { shift: dvec(shift, -shift, shift), ..Room::SHINY };
        wrong += differing(&base, &full(&room.tracer()?, &room.camera()));
    }
    Ok(wrong.into())
}

const UTM: DVec3 = DVec3::new(500_012.3, 34.7, 5_800_321.9);

fn at_utm(_: &Trial) -> Outcome {
    let room = Room { shift: UTM, ..Room::SHINY };
    let (there, here) =
        (full(&room.tracer()?, &room.camera()), full(&Room::SHINY.tracer()?, &Room::SHINY.camera()));
    Ok(other_triangles_percent(&here, &there).into())
}

fn vertices_at_utm(_: &Trial) -> Outcome {
    let builder = Room { shift: UTM, ..Room::SHINY }.builder();
    let wanted = builder.positions.clone();
    let scene = builder.finish()?;
    let error = |(&p, &wanted): (&Vec3, &DVec3)| (scene.frame.world_from_scene(p) - wanted).length();
    Ok(scene.positions.iter().zip(&wanted).map(error).fold(0.0, f64::max).into())
}

/// Metres in a millimetre, an inch, a foot, and upside down.
const UNITS: [f64; 4] = [0.001, 0.0254, 0.3048, 1.0 / 0.0254];

fn diagonals(_: &Trial) -> Outcome {
    let mut wrong = 0;
    for scale in UNITS {
        let scene = Room { scale, ..Room::PLAIN }.builder().finish()?;
        let [low, high] = scene.bounds_m;
        let diagonal = (high - low).length() * scene.frame.units_per_metre;
        wrong += usize::from(!(512.0..1024.0).contains(&diagonal));
    }
    Ok(wrong.into())
}

fn any_unit(_: &Trial) -> Outcome {
    let base = full(&Room::SHINY.tracer()?, &Room::SHINY.camera());
    let mut worst = 0f64;
    for scale in UNITS {
        let room = Room { scale, ..Room::SHINY };
        worst = worst.max(other_triangles_percent(&base, &full(&room.tracer()?, &room.camera())));
    }
    Ok(worst.into())
}

/// A stadium of a kilometre with a ball of 0.1 mm somewhere in it, or the ball alone.
fn stadium(at: DVec3, has_walls: bool) -> Result<Tracer, ExperimentError> {
    let mut b = SceneBuilder::new("stadium");
    let tiny = b.add_material(Material::diffuse("ball", Vec3::splat(0.5)));
    let wall = b.add_material(Material::diffuse("wall", Vec3::splat(0.5)));
    ball(&mut b, at, 5e-5, 16, false, tiny);
    if has_walls {
        cuboid(&mut b, [dvec(-500.0, -100.0, -500.0), dvec(500.0, 100.0, 500.0)], wall, true);
    }
    b.point_lights.push((at + dvec(0.1, 0.2, 0.3), Vec3::ONE));
    Ok(tracer(b)?)
}

/// The share in percent of pixels in which the ball is seen alone and not in the stadium, or the other way.
fn silhouette_percent(at: DVec3) -> Result<f64, ExperimentError> {
    let camera = Camera::look_at(at + dvec(0.0, 0.0, 0.01), at, 1.0);
    let [alone, inside] = [false, true].map(|walls| -> Result<Vec<bool>, ExperimentError> {
        let tracer = stadium(at, walls)?;
        let is_ball = |&t: &u32| t != u32::MAX && tracer.scene().material_of(t).name == "ball";
        Ok(full(&tracer, &camera).triangle.iter().map(is_ball).collect())
    });
    let (alone, inside) = (alone?, inside?);
    let seen = alone.iter().filter(|is_ball| **is_ball).count();
    let wrong = alone.iter().zip(&inside).filter(|(a, b)| a != b).count();
    Ok(100.0 * wrong as f64 / seen.max(1) as f64)
}

fn tiny_at_origin(_: &Trial) -> Outcome {
    Ok(silhouette_percent(dvec(0.001, 0.002, -0.001))?.into())
}

fn tiny_far_off(_: &Trial) -> Outcome {
    let at = dvec(300.0, 20.0, -250.0);
    let wrong = silhouette_percent(at)?;
    let told_m = stadium(at, true)?.scene().conditioning.smallest_feature_m;
    let is_silent = wrong > 0.1 && told_m < 1e-4;
    let note =
        format!("{wrong:.0} % of the silhouette is wrong; the scene says that features need {told_m:.1e} m");
    Ok(Measured { note, ..Measured::from(usize::from(is_silent)) })
}

fn tiny_self_hits(trial: &Trial) -> Outcome {
    let tracer = stadium(dvec(0.001, 0.002, -0.001), true)?;
    let balls: Vec<u32> = (0..tracer.scene().triangles.len() as u32)
        .filter(|&t| tracer.scene().material_of(t).name == "ball")
        .collect();
    Ok(self_hits(&tracer, &balls, trial.tries).into())
}

/// Rays that leave random points of these triangles and meet the triangle they come from.
pub(super) fn self_hits(tracer: &Tracer, triangles: &[u32], tries: u32) -> usize {
    let is_self_hit = |&i: &u32| {
        let key = Key::of_pixel(7, i);
        let triangle = triangles[i as usize % triangles.len()];
        let point = SurfacePoint::new(tracer.scene(), triangle, uniform_triangle(key.pair()), random(key, 3));
        let direction = frame_around(point.geometric_normal) * cosine_hemisphere(key.with(9).pair());
        let ray = Ray::new(point.origin_in_front(), direction);
        tracer.closest(&ray).is_some_and(|hit| hit.triangle == point.triangle)
    };
    (0..tries).into_par_iter().filter(is_self_hit).count()
}

/// The room with a triangle of these corners after all others.
fn room_and(corners: [DVec3; 3]) -> SceneBuilder {
    let mut b = Room::PLAIN.builder();
    let wall = crate::scene::MaterialId(0);
    let vertices = corners.map(|p| b.add_vertex(p, Vec3::ZERO, Vec2::ZERO));
    b.add_triangle(vertices, wall);
    b
}

fn thrown_away() -> SceneBuilder {
    room_and([dvec(2.0, 0.5, 0.0), dvec(2.0, 0.5, 1.0), dvec(1e30, 0.5, 0.0)])
}

fn compared_with_the_room(b: SceneBuilder) -> Outcome {
    let camera = Room::PLAIN.camera();
    let (with, without) = (full(&tracer(b)?, &camera), full(&Room::PLAIN.tracer()?, &camera));
    let picture = Some((SIZE, super::bench::srgb(&with)));
    let value = other_triangles_percent(&with, &without) + bad_values(&with) as f64;
    Ok(Measured { value, picture, ..Measured::default() })
}

fn outlier_vertex(_: &Trial) -> Outcome {
    compared_with_the_room(thrown_away())
}

fn far() -> SceneBuilder {
    room_and([dvec(1e5, 0.0, 0.0), dvec(1e5, 10.0, 0.0), dvec(1e5, 0.0, 10.0)])
}

fn far_triangle(_: &Trial) -> Outcome {
    compared_with_the_room(far())
}

fn outliers_told(_: &Trial) -> Outcome {
    let mut untold = 0;
    for builder in [thrown_away(), far()] {
        let scene = builder.finish()?;
        let is_told = scene.warnings.iter().any(|w| w.message.contains("far"));
        untold += usize::from(!is_told || !scene.conditioning.repairs.ignores_outliers);
    }
    Ok(untold.into())
}

/// The room that much larger, against the room.
fn at_scale(scale: f64) -> Outcome {
    let room = Room { scale, ..Room::PLAIN };
    let mut builder = room.builder();
    // An intensity in radiance times square metres has no f32 at such sizes.
    builder.point_lights.clear();
    let mut usual = Room::PLAIN.builder();
    usual.point_lights.clear();
    let tracer_there = tracer(builder)?;
    let has_area_light = tracer_there.scene().lights.iter().any(|l| matches!(l, Light::Quad { .. }));
    let (there, here) = (full(&tracer_there, &room.camera()), full(&tracer(usual)?, &Room::PLAIN.camera()));
    let other = here.triangle.iter().zip(&there.triangle).filter(|(a, b)| a != b).count();
    Ok((other + bad_values(&there) + usize::from(!has_area_light) * 1000).into())
}

fn huge(_: &Trial) -> Outcome {
    at_scale(3e38 / 4.0)
}

fn minute(_: &Trial) -> Outcome {
    at_scale(1e-45)
}
