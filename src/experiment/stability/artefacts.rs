//! G: the known artefacts of forward warping, measured against their formulas, and what the modes that look up make of
//! them.

use super::bench::{
    Room, SIZE, TRACE, dvec, full, other_triangles_percent, paper, percent, quad, reference, srgb, tracer,
};
use super::case::{Case, Measured, Outcome, Trial};
use crate::camera::Camera;
use crate::experiment::run::ExperimentError;
use crate::lookup::LookupSet;
use crate::raster::pixel_types::PixelType;
use crate::reference::{ReferenceCache, ReferenceFrame};
use crate::render::{Frame, FrameRequest, Mode, RenderSettings, Renderer};
use crate::scene::{Material, SceneBuilder};
use crate::trace::Tracer;
use crate::trace::parallel::NEVER;
use glam::Vec3;
use std::sync::Arc;

pub(super) const CASES: &[Case] = &[
    Case::new("G1 holes at magnification 1.01", "% of pixels, by 1 - 1/m^2 at most 2", 3.0, |_| holes(1.01)),
    Case::new("G1 holes at magnification 1.05", "% of pixels, by 1 - 1/m^2 at most 9.3", 10.3, |_| {
        holes(1.05)
    }),
    Case::new("G1 holes at magnification 1.10", "% of pixels, by 1 - 1/m^2 at most 17.4", 18.4, |_| {
        holes(1.10)
    }),
    Case::new("G1 holes at magnification 1.25", "% of pixels, by 1 - 1/m^2 at most 36", 37.0, |_| {
        holes(1.25)
    }),
    Case::new(
        "G2 seeing through at m 1.05, paper",
        "% of pixels that show what is behind",
        10.0,
        through_paper,
    ),
    Case::new(
        "G2 seeing through at m 1.05, exact",
        "% of pixels that show what is behind",
        0.0,
        through_exact,
    ),
    Case::new(
        "G3 an occluder outside the reference, exact",
        "% of pixels of another surface",
        0.0,
        frame_edge,
    ),
    Case::new("G4 100 frames at rest", "pixels that change type or colour", 0.0, shimmer),
    Case::new("G5 two references", "holes more than with the better one", 0.0, two_references),
    Case::new(
        "G6 64 references one after the other",
        "pixels of the last unlike the first's",
        0.0,
        generations,
    ),
];

/// A wall with a coloured one behind it, seen from so far.
fn two_walls(distance: f64, has_back: bool) -> Result<(Tracer, Camera), ExperimentError> {
    let mut b = SceneBuilder::new("walls");
    let front = b.add_material(Material::diffuse("front", Vec3::splat(0.7)));
    let back = b.add_material(Material::diffuse("back", Vec3::new(0.8, 0.1, 0.1)));
    // The front one has a slit beside which what is behind is seen by the reference.
    quad(&mut b, dvec(-20.0, -20.0, 0.0), dvec(19.0, 0.0, 0.0), dvec(0.0, 40.0, 0.0), front);
    quad(&mut b, dvec(-0.5, -20.0, 0.0), dvec(20.0, 0.0, 0.0), dvec(0.0, 40.0, 0.0), front);
    if has_back {
        quad(&mut b, dvec(-60.0, -60.0, -4.0), dvec(120.0, 0.0, 0.0), dvec(0.0, 120.0, 0.0), back);
    }
    b.point_lights.push((dvec(0.0, 0.0, 5.0), Vec3::splat(50.0)));
    Ok((tracer(b)?, at_distance(distance)))
}

fn at_distance(distance: f64) -> Camera {
    Camera::look_at(dvec(4.013, 0.007, distance), dvec(4.013, 0.007, 0.0), 40.0)
}

fn holes(magnification: f64) -> Outcome {
    let (tracer, far) = two_walls(5.0, false)?;
    let lent = reference(&tracer, &far, SIZE);
    let shown = paper(&tracer, &at_distance(5.0 / magnification), &[&lent]);
    let open = shown.types.iter().filter(|t| **t == PixelType::Unseen).count();
    let value = percent(open, shown.types.len());
    let note = format!("1 - 1/m^2 is {:.1} %", 100.0 * (1.0 - 1.0 / (magnification * magnification)));
    Ok(Measured { value, note, picture: None })
}

/// From before the slit, where the reference saw the back wall beside the front ones, to the side and nearer.
fn slit() -> Result<(Tracer, Camera, Camera), ExperimentError> {
    let (tracer, _) = two_walls(5.0, true)?;
    let before = Camera::look_at(dvec(-0.75, 0.0, 5.0), dvec(-0.75, 0.0, 0.0), 40.0);
    let beside = Camera::look_at(dvec(0.15, 0.0, 5.0 / 1.05), dvec(-0.6, 0.0, 0.0), 40.0);
    Ok((tracer, before, beside))
}

fn through_paper(_: &Trial) -> Outcome {
    let (tracer, before, beside) = slit()?;
    let lent = reference(&tracer, &before, SIZE);
    let shown = paper(&tracer, &beside, &[&lent]);
    let value = behind_percent(&tracer, &shown, &full(&tracer, &beside));
    Ok(Measured { value, note: String::new(), picture: Some((SIZE, srgb(&shown))) })
}

/// Pixels in percent that show the back wall where the front one stands.
fn behind_percent(tracer: &Tracer, shown: &Frame, right: &Frame) -> f64 {
    let name = |t: u32| if t == u32::MAX { "" } else { tracer.scene().material_of(t).name.as_str() };
    let is_through = |(s, r): &(&u32, &u32)| name(**s) == "back" && name(**r) == "front";
    percent(shown.triangle.iter().zip(&right.triangle).filter(is_through).count(), shown.triangle.len())
}

/// A picture in mode `exact` with the light of a reference taken elsewhere.
fn exact(tracer: &Tracer, from: &Camera, here: &Camera) -> Frame {
    let mut cache = ReferenceCache::new(tracer.scene(), 1 << 30);
    let known = cache.snapshot();
    let lookup = LookupSet::of_snapshot(&known, tracer.epoch());
    if let Some(lent) = ReferenceFrame::trace_sparse(tracer, from, SIZE, &TRACE, &lookup, NEVER) {
        cache.insert(Arc::new(lent));
    }
    let mut renderer = Renderer::default();
    let settings = RenderSettings { mode: Mode::Exact, trace: TRACE };
    renderer.render(&FrameRequest::new(tracer, here, SIZE, &settings).reusing(&cache));
    renderer.into_frame()
}

fn through_exact(_: &Trial) -> Outcome {
    let (tracer, before, beside) = slit()?;
    let shown = exact(&tracer, &before, &beside);
    Ok(behind_percent(&tracer, &shown, &full(&tracer, &beside)).into())
}

fn frame_edge(_: &Trial) -> Outcome {
    let tracer = Room::PLAIN.tracer()?;
    let mut worst = 0f64;
    for (forward, turn) in [(-0.4, 0.0), (0.0, 0.5), (-0.3, -0.7)] {
        let here = Room::PLAIN.moved(forward, turn);
        let shown = exact(&tracer, &Room::PLAIN.moved(1.5, 0.0), &here);
        worst = worst.max(other_triangles_percent(&shown, &full(&tracer, &here)));
    }
    Ok(worst.into())
}

fn shimmer(trial: &Trial) -> Outcome {
    let tracer = Room::SHINY.tracer()?;
    let lent = reference(&tracer, &Room::SHINY.camera(), SIZE);
    let here = Room::SHINY.moved(0.3, 0.1);
    let first = paper(&tracer, &here, &[&lent]);
    let mut changed = 0;
    for _ in 0..trial.frames {
        let shown = paper(&tracer, &here, &[&lent]);
        changed += first.types.iter().zip(&shown.types).filter(|(a, b)| a != b).count();
        changed += first.radiance.iter().zip(&shown.radiance).filter(|(a, b)| a != b).count();
    }
    Ok(changed.into())
}

fn two_references(_: &Trial) -> Outcome {
    let tracer = Room::PLAIN.tracer()?;
    let lent = [(0.0, 0.0), (0.8, 0.2)].map(|(f, t)| reference(&tracer, &Room::PLAIN.moved(f, t), SIZE));
    let here = Room::PLAIN.moved(0.4, 0.1);
    let holes = |lent: &[&ReferenceFrame]| {
        paper(&tracer, &here, lent).types.iter().filter(|t| **t == PixelType::Unseen).count()
    };
    let (both, better) = (holes(&[&lent[0], &lent[1]]), holes(&[&lent[0]]).min(holes(&[&lent[1]])));
    let note = format!("{both} holes with two, {better} with the better one");
    Ok(Measured { note, ..Measured::from(both.saturating_sub(better)) })
}

/// References come from rays, never from warped frames: the sixty-fourth in a place is the first.
fn generations(trial: &Trial) -> Outcome {
    let tracer = Room::PLAIN.tracer()?;
    let camera = Room::PLAIN.camera();
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
