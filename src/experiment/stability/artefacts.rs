//! Cases G of the catalogue: the known artefacts of forward warping, measured against their
//! formulas, and the same scenes in the look-up modes.

use super::case::{Case, Measured, Outcome, Trial, case, worst};
use super::pictures::{
    SIZE, count_type, exact, full, other_triangles_percent, paper, percent, reference, unequal,
};
use super::rooms::{Room, dvec, is_named, tracer, wall};
use crate::camera::Camera;
use crate::raster::pixel_types::PixelType;
use crate::reference::ReferenceFrame;
use crate::render::Frame;
use crate::scene::{Material, SceneBuilder, SceneError};
use crate::trace::Tracer;
use glam::Vec3;

pub(super) const CASES: &[Case] = &[
    case("G1 holes at magnification 1.01", "% of pixels, by 1 - 1/m^2 at most 2", 3.0, |_| holes(1.01)),
    case("G1 holes at magnification 1.05", "% of pixels, by 1 - 1/m^2 at most 9.3", 10.3, |_| holes(1.05)),
    case("G1 holes at magnification 1.10", "% of pixels, by 1 - 1/m^2 at most 17.4", 18.4, |_| holes(1.10)),
    case("G1 holes at magnification 1.25", "% of pixels, by 1 - 1/m^2 at most 36", 37.0, |_| holes(1.25)),
    case("G2 seeing through at m 1.05, paper", "% of pixels that show the hidden wall", 10.0, through_paper),
    case("G2 seeing through at m 1.05, exact", "% of pixels that show the hidden wall", 0.0, through_exact),
    case("G3 an occluder outside the reference, exact", "% of pixels of another surface", 0.0, frame_edge),
    case("G4 100 frames at rest", "pixels that change type or colour", 0.0, shimmer),
    case("G5 two references", "holes more than with the better one", 0.0, two_references),
    case("G6 64 references one after the other", "pixels of the last unlike the first's", 0.0, generations),
];

/// A wall with a slit, through which a coloured wall behind it is visible if `has_back`.
fn two_walls(has_back: bool) -> Result<Tracer, SceneError> {
    let mut b = SceneBuilder::new("walls");
    let front = b.add_material(Material::diffuse("front", Vec3::splat(0.7)));
    let back = b.add_material(Material::diffuse("back", Vec3::new(0.8, 0.1, 0.1)));
    wall(&mut b, dvec(-20.0, -20.0, 0.0), [19.0, 40.0], front);
    wall(&mut b, dvec(-0.5, -20.0, 0.0), [20.0, 40.0], front);
    if has_back {
        wall(&mut b, dvec(-60.0, -60.0, -4.0), [120.0, 120.0], back);
    }
    b.point_lights.push((dvec(0.0, 0.0, 5.0), Vec3::splat(50.0)));
    tracer(b)
}

fn holes(magnification: f64) -> Outcome {
    let at_distance = |d: f64| Camera::look_at(dvec(4.013, 0.007, d), dvec(4.013, 0.007, 0.0), 40.0);
    let tracer = two_walls(false)?;
    let reference = reference(&tracer, &at_distance(5.0), SIZE);
    let shown = paper(&tracer, &at_distance(5.0 / magnification), &[&reference]);
    let note = format!("1 - 1/m^2 is {:.1} %", 100.0 * (1.0 - 1.0 / (magnification * magnification)));
    let open = percent(count_type(&shown, PixelType::Unseen), shown.types.len());
    Ok(Measured::from(open).with_note(note))
}

/// A reference in front of the slit, which sees the back wall through it, and a view to the side
/// and nearer.
fn slit() -> Result<(Tracer, Camera, Camera), SceneError> {
    let before = Camera::look_at(dvec(-0.75, 0.0, 5.0), dvec(-0.75, 0.0, 0.0), 40.0);
    let beside = Camera::look_at(dvec(0.15, 0.0, 5.0 / 1.05), dvec(-0.6, 0.0, 0.0), 40.0);
    Ok((two_walls(true)?, before, beside))
}

fn through_paper(_: &Trial) -> Outcome {
    let (tracer, before, beside) = slit()?;
    let reference = reference(&tracer, &before, SIZE);
    let shown = paper(&tracer, &beside, &[&reference]);
    let through = behind_percent(&tracer, &shown, &full(&tracer, &beside));
    Ok(Measured::from(through).with_picture(&shown))
}

/// Returns the share of pixels, in percent, that show the back wall instead of the front one.
fn behind_percent(tracer: &Tracer, shown: &Frame, right: &Frame) -> f64 {
    let is_through = |(s, r): &(&u32, &u32)| is_named(tracer, **s, "back") && is_named(tracer, **r, "front");
    percent(shown.triangle.iter().zip(&right.triangle).filter(is_through).count(), shown.triangle.len())
}

fn through_exact(_: &Trial) -> Outcome {
    let (tracer, before, beside) = slit()?;
    let shown = exact(&tracer, &before, &beside, 0.0);
    Ok(behind_percent(&tracer, &shown, &full(&tracer, &beside)).into())
}

fn frame_edge(_: &Trial) -> Outcome {
    let tracer = Room::PLAIN.tracer()?;
    let from = Room::PLAIN.moved(1.5, 0.0);
    worst([(-0.4, 0.0), (0.0, 0.5), (-0.3, -0.7)], |(forward, turn)| {
        let here = Room::PLAIN.moved(forward, turn);
        Ok(other_triangles_percent(&exact(&tracer, &from, &here, 0.0), &full(&tracer, &here)))
    })
}

fn shimmer(trial: &Trial) -> Outcome {
    let (tracer, camera) = Room::SHINY.stage()?;
    let reference = reference(&tracer, &camera, SIZE);
    let here = Room::SHINY.moved(0.3, 0.1);
    let first = paper(&tracer, &here, &[&reference]);
    let changed = |_| {
        let shown = paper(&tracer, &here, &[&reference]);
        unequal(&first.types, &shown.types) + unequal(&first.radiance, &shown.radiance)
    };
    Ok((0..trial.frames).map(changed).sum::<usize>().into())
}

fn two_references(_: &Trial) -> Outcome {
    let tracer = Room::PLAIN.tracer()?;
    let [one, two] =
        &[(0.0, 0.0), (0.8, 0.2)].map(|(f, t)| reference(&tracer, &Room::PLAIN.moved(f, t), SIZE));
    let here = Room::PLAIN.moved(0.4, 0.1);
    let holes = |from: &[&ReferenceFrame]| count_type(&paper(&tracer, &here, from), PixelType::Unseen);
    let (both, better) = (holes(&[one, two]), holes(&[one]).min(holes(&[two])));
    let note = format!("{both} holes with two, {better} with the better one");
    Ok(Measured::from(both.saturating_sub(better)).with_note(note))
}

/// References come from rays, never from warped frames: the sixty-fourth at a place equals the
/// first.
fn generations(trial: &Trial) -> Outcome {
    let (tracer, camera) = Room::PLAIN.stage()?;
    let first = reference(&tracer, &camera, SIZE);
    let mut last = first.clone();
    let steps = trial.frames.min(64);
    for step in 0..steps {
        let here = Room::PLAIN.moved(0.01 * f64::from(step), 0.0);
        paper(&tracer, &here, &[&last]);
        last = reference(&tracer, if step + 1 == steps { &camera } else { &here }, SIZE);
    }
    let pairs = first.disparity().iter().zip(last.disparity());
    Ok(pairs.filter(|(a, b)| a.to_bits() != b.to_bits()).count().into())
}
