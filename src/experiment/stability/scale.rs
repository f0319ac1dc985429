//! Cases A of the catalogue: scenes that are very large, very small or far from the origin.

use super::case::{Case, Measured, Outcome, Trial, case, total, worst};
use super::pictures::{
    SIZE, bad_values, differing, full, other_triangles_percent, paper, reference, unequal,
};
use super::rooms::{Room, ball, cuboid, dvec, is_named, random, tracer, triangle};
use crate::camera::Camera;
use crate::experiment::run::ExperimentError;
use crate::math::sampling::{cosine_hemisphere, frame_around, uniform_triangle};
use crate::math::{Ray, key::Key};
use crate::scene::{Light, Material, MaterialId, SceneBuilder};
use crate::trace::{SurfacePoint, Tracer};
use glam::{DVec3, Vec3};
use rayon::prelude::*;

pub(super) const CASES: &[Case] = &[
    case("A1 scaled by 2^k, k -20 to 30", "pixels that differ in a bit, full and paper", 0.0, scaled),
    case("A2 moved by 2^20 and 2^23", "pixels that differ in a bit", 0.0, moved_dyadic),
    case("A2 at UTM coordinates", "% of pixels that see another triangle", 0.1, at_utm),
    case("A2 vertices at UTM coordinates", "largest error of a vertex, metres", 1e-4, vertices_at_utm),
    case("A3 units", "scenes whose diagonal is not 512 to 1024", 0.0, diagonals),
    case("A3 picture in any unit", "% of pixels that see another triangle", 0.1, any_unit),
    case("A4 0.1 mm in 1 km, at the origin", "% of pixels of another silhouette", 0.1, tiny_at_origin),
    case(
        "A4 0.1 mm in 1 km, 300 m off",
        "features too small for their place, not reported",
        0.0,
        tiny_far_off,
    ),
    case("A4 rays from 0.1 mm in 1 km", "self-hits", 0.0, tiny_self_hits),
    case("A5 a vertex at 1e30 m", "% of pixels that see another triangle", 0.1, |_| {
        with_outlier(vertex_far())
    }),
    case("A5 a triangle 100 km away", "% of pixels that see another triangle", 0.1, |_| with_outlier(far())),
    case("A5 outliers are reported", "outliers without a warning", 0.0, outliers_reported),
    case("A6 coordinates of 3e38", "bad values and pixels of another triangle", 6.0, |_| {
        at_scale(3e38 / 4.0)
    }),
    case("A6 coordinates of 1e-45", "bad values and pixels of another triangle", 6.0, |_| at_scale(1e-45)),
];

fn scaled(_: &Trial) -> Outcome {
    let render = |room: Room| -> Result<_, ExperimentError> {
        let (tracer, camera) = room.stage()?;
        let reference = reference(&tracer, &camera, SIZE);
        Ok([full(&tracer, &camera), paper(&tracer, &room.moved(0.25, 0.0625), &[&reference])])
    };
    let base = render(Room::SHINY)?;
    total([-20, -9, -1, 1, 10, 30], |k| {
        let other = render(Room { scale: 2f64.powi(k), ..Room::SHINY })?;
        Ok(base.iter().zip(&other).map(|(a, b)| differing(a, b)).sum())
    })
}

fn full_of(room: Room) -> Result<crate::render::Frame, ExperimentError> {
    Ok(full(&room.tracer()?, &room.camera()))
}

fn moved_dyadic(_: &Trial) -> Outcome {
    let base = full_of(Room::SHINY)?;
    total([2f64.powi(20), 2f64.powi(23)], |shift| {
        let there = full_of(Room { shift: dvec(shift, -shift, shift), ..Room::SHINY })?;
        Ok(differing(&base, &there))
    })
}

const UTM: DVec3 = DVec3::new(500_012.3, 34.7, 5_800_321.9);

fn at_utm(_: &Trial) -> Outcome {
    let there = full_of(Room { shift: UTM, ..Room::SHINY })?;
    Ok(other_triangles_percent(&full_of(Room::SHINY)?, &there).into())
}

fn vertices_at_utm(_: &Trial) -> Outcome {
    let builder = Room { shift: UTM, ..Room::SHINY }.builder();
    let wanted = builder.positions.clone();
    let scene = builder.finish()?;
    let error = |(&p, &wanted): (&Vec3, &DVec3)| (scene.frame.world_from_scene(p) - wanted).length();
    Ok(scene.positions.iter().zip(&wanted).map(error).fold(0.0, f64::max).into())
}

/// A millimetre, an inch and a foot in metres, and the inverse of an inch.
const UNITS: [f64; 4] = [0.001, 0.0254, 0.3048, 1.0 / 0.0254];

fn diagonals(_: &Trial) -> Outcome {
    total(UNITS, |scale| {
        let scene = Room { scale, ..Room::PLAIN }.builder().finish()?;
        let [low, high] = scene.bounds_m;
        let diagonal = (high - low).length() * scene.frame.units_per_metre;
        Ok(usize::from(!(512.0..1024.0).contains(&diagonal)))
    })
}

fn any_unit(_: &Trial) -> Outcome {
    let base = full_of(Room::SHINY)?;
    worst(UNITS, |scale| Ok(other_triangles_percent(&base, &full_of(Room { scale, ..Room::SHINY })?)))
}

/// A stadium of a kilometre with a ball of 0.1 mm in it, or the ball alone.
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

/// Returns the number of pixels in which the ball is visible either alone or in the stadium but not
/// both, in percent of those in which it is visible alone.
fn silhouette_percent(at: DVec3) -> Result<f64, ExperimentError> {
    let camera = Camera::look_at(at + dvec(0.0, 0.0, 0.01), at, 1.0);
    let silhouette = |has_walls: bool| -> Result<Vec<bool>, ExperimentError> {
        let tracer = stadium(at, has_walls)?;
        Ok(full(&tracer, &camera).triangle.iter().map(|&t| is_named(&tracer, t, "ball")).collect())
    };
    let (alone, inside) = (silhouette(false)?, silhouette(true)?);
    let seen = alone.iter().filter(|is_ball| **is_ball).count();
    Ok(100.0 * unequal(&alone, &inside) as f64 / seen.max(1) as f64)
}

fn tiny_at_origin(_: &Trial) -> Outcome {
    Ok(silhouette_percent(dvec(0.001, 0.002, -0.001))?.into())
}

fn tiny_far_off(_: &Trial) -> Outcome {
    let at = dvec(300.0, 20.0, -250.0);
    let wrong = silhouette_percent(at)?;
    let reported_m = stadium(at, true)?.scene().conditioning.smallest_feature_m;
    let is_silent = wrong > 0.1 && reported_m < 1e-4;
    let note = format!(
        "{wrong:.0} % of the silhouette is wrong; the scene reports that features need {reported_m:.1e} m"
    );
    Ok(Measured::from(usize::from(is_silent)).with_note(note))
}

fn tiny_self_hits(trial: &Trial) -> Outcome {
    let tracer = stadium(dvec(0.001, 0.002, -0.001), true)?;
    let triangles = 0..tracer.scene().triangles.len() as u32;
    let balls: Vec<u32> = triangles.filter(|&t| is_named(&tracer, t, "ball")).collect();
    Ok(self_hits(&tracer, &balls, trial.tries).into())
}

/// Counts rays that leave random points of these triangles and hit the triangle they start on.
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

/// The room with one more triangle, after all others.
fn room_and(corners: [DVec3; 3]) -> SceneBuilder {
    let mut b = Room::PLAIN.builder();
    triangle(&mut b, corners, MaterialId(0));
    b
}

fn vertex_far() -> SceneBuilder {
    room_and([dvec(2.0, 0.5, 0.0), dvec(2.0, 0.5, 1.0), dvec(1e30, 0.5, 0.0)])
}

fn far() -> SceneBuilder {
    room_and([dvec(1e5, 0.0, 0.0), dvec(1e5, 10.0, 0.0), dvec(1e5, 0.0, 10.0)])
}

/// Compares a room with an outlier with the room.
fn with_outlier(b: SceneBuilder) -> Outcome {
    let (with, without) = (full(&tracer(b)?, &Room::PLAIN.camera()), full_of(Room::PLAIN)?);
    let value = other_triangles_percent(&with, &without) + bad_values(&with) as f64;
    Ok(Measured::from(value).with_picture(&with))
}

fn outliers_reported(_: &Trial) -> Outcome {
    total([vertex_far(), far()], |builder| {
        let scene = builder.finish()?;
        let has_warning = scene.warnings.iter().any(|w| w.message.contains("far"));
        Ok(usize::from(!has_warning || !scene.conditioning.repairs.ignores_outliers))
    })
}

/// Compares the scaled room with the room.
fn at_scale(scale: f64) -> Outcome {
    let render = |room: Room| -> Result<_, ExperimentError> {
        let mut builder = room.builder();
        // An intensity in radiance times square metres exceeds f32 at such sizes.
        builder.point_lights.clear();
        let tracer = tracer(builder)?;
        let has_area_light = tracer.scene().lights.iter().any(|l| matches!(l, Light::Quad { .. }));
        Ok((full(&tracer, &room.camera()), has_area_light))
    };
    let ((there, has_area_light), (here, _)) = (render(Room { scale, ..Room::PLAIN })?, render(Room::PLAIN)?);
    let other = unequal(&here.triangle, &there.triangle);
    Ok((other + bad_values(&there) + usize::from(!has_area_light) * 1000).into())
}
