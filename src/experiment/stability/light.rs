//! Cases H of the catalogue: the estimators of reflected light and of the sky, in modes `full`,
//! `exact` and `fast`, in scenes and lights that are extreme.

use super::case::{Case, Measured, Outcome, Trial, case, total, worst};
use super::pictures::{bad_values, differing, unequal};
use super::rooms::{Room, ball, cuboid, dvec, quad, triangle, wall};
use crate::camera::Camera;
use crate::experiment::run::ExperimentError;
use crate::render::{Frame, Mode, RenderSettings, Walkthrough, WalkthroughSettings};
use crate::scene::{Material, PictureSky, SceneBuilder, Sky, SkyImage, Sun};
use crate::trace::{TraceSettings, Tracer, parallel::NEVER};
use glam::{DVec3, Vec3};
use std::f64::consts::{PI, TAU};
use std::path::Path;
use std::sync::Arc;

pub(super) const CASES: &[Case] = &[
    case("H1 bounces, scaled by 2^k", "pixels that differ in a bit, all modes", 0.0, scaled),
    case("H1 bounces, moved by 2^17 m", "pixels that differ in a bit, all modes", 0.0, moved),
    case("H1 bounces, 1e5 m from the origin", "% of difference of the mean, all modes", 5.0, far_off),
    case("H2 light scaled by 2^k", "pixels that differ in a bit, all modes", 0.0, brighter),
    case("H2 light of 1e-38", "bad values, and pixels brighter than it can make them", 0.0, denormal),
    case("H2 a sun of 1e9", "bad values, all modes", 0.0, |_| sunny(1e9)),
    case("H2 a sun of 1e30", "bad values, all modes", 0.0, |_| sunny(1e30)),
    case("H2 a sky picture with a sun of 1e9", "bad values, all modes", 0.0, pictured_bad),
    case("H2 a sky picture with a sun of 1e3", "% of difference from the closed form", 1.0, pictured),
    // Light is stored with an error of up to 2^-9 of its largest channel.
    case("H3 a single triangle under a white sky", "% of difference from its albedo", 0.2, single_triangle),
    case(
        "H3 surfaces that only emit",
        "pixels unlike their emission, rays towards lights",
        0.0,
        only_emission,
    ),
    case("H3 no light", "pixels that are not black, all modes and refined", 0.0, no_light),
    case("H4 a closed room of albedo 1", "bad values, and rays beyond the bound", 0.0, white_room),
    case("H5 no sample and one", "bad values, and pictures that are black", 0.0, few_samples),
    case("H5 1, 2, 3, 5, 7 and 12 samples", "% of difference from the closed form", 3.0, odd_counts),
    case("H5 one sample against 64", "% of difference of the mean, all modes", 10.0, one_sample),
    case("H6 1, 2, 3 and 8 threads", "pixels that differ in a bit, all modes", 0.0, threads),
    // A few pixels may be equal by chance.
    case("H6 another seed", "% of lit pixels that differ in no bit from it, of full", 1.0, seeds),
];

const MODES: [Mode; 3] = [Mode::Full, Mode::Exact, Mode::Fast];

/// Paths are long, so the pictures are small.
const SIZE: [u32; 2] = [36, 24];

const TRACE: TraceSettings = TraceSettings { samples: 2, bounces: 16, seed: 5 };

/// Most rays that a path of [`TRACE`] takes in a scene of one lamp.
const MAX_RAYS_PER_PATH: f64 = 2.0 * (1.0 + 16.0) + 1.0;

/// Renders the last pose of a walk in each mode; frames and references at the poses before it
/// provide light.
fn walks(scene: SceneBuilder, poses: &[Camera], trace: TraceSettings) -> Result<Vec<Frame>, ExperimentError> {
    let tracer = Arc::new(Tracer::new(Arc::new(scene.finish()?)));
    Ok(MODES.map(|mode| walk(&tracer, poses, RenderSettings { mode, trace }).frame().clone()).into())
}

fn walk(tracer: &Arc<Tracer>, poses: &[Camera], render: RenderSettings) -> Walkthrough {
    let settings = WalkthroughSettings { render, ..WalkthroughSettings::default() };
    let mut walk = Walkthrough::new(Arc::clone(tracer), settings);
    for (number, pose) in poses.iter().enumerate() {
        walk.render(pose, SIZE, NEVER);
        if render.mode.looks_up() && number + 1 < poses.len() {
            let traced = walk.reference_job(*pose, SIZE).trace(NEVER);
            let id = traced.and_then(|reference| walk.insert(reference));
            debug_assert!(id.is_some(), "tracing is never stopped here");
        }
    }
    walk
}

/// Two poses in a room.
fn poses(room: Room) -> [Camera; 2] {
    [room.camera(), room.moved(0.25, 0.0625)]
}

fn of_room(room: Room) -> Result<Vec<Frame>, ExperimentError> {
    walks(room.builder(), &poses(room), TRACE)
}

/// Returns the number of pixels that differ in a bit, and of bad values.
fn differences(a: &[Frame], b: &[Frame]) -> usize {
    a.iter().zip(b).map(|(a, b)| differing(a, b)).sum()
}

fn all_bad(frames: &[Frame]) -> usize {
    frames.iter().map(bad_values).sum()
}

fn mean(frame: &Frame) -> f64 {
    frame.radiance.iter().map(|r| f64::from(r.element_sum())).sum::<f64>() / frame.radiance.len() as f64
}

/// Returns the largest relative difference of the means, in percent.
fn mean_percent(a: &[Frame], b: &[Frame]) -> f64 {
    let percent = |(a, b): (&Frame, &Frame)| 100.0 * (mean(a) / mean(b) - 1.0).abs();
    a.iter().zip(b).map(percent).fold(0.0, f64::max)
}

fn scaled(_: &Trial) -> Outcome {
    let base = of_room(Room::SHINY)?;
    total([-20, -1, 10], |k| Ok(differences(&base, &of_room(Room { scale: 2f64.powi(k), ..Room::SHINY })?)))
}

fn moved(_: &Trial) -> Outcome {
    let shift = dvec(131_072.0, -131_072.0, 131_072.0);
    Ok(differences(&of_room(Room::SHINY)?, &of_room(Room { shift, ..Room::SHINY })?).into())
}

fn far_off(_: &Trial) -> Outcome {
    let there = of_room(Room { shift: dvec(1e5, -1e5, 1e5), ..Room::PLAIN })?;
    Ok((mean_percent(&there, &of_room(Room::PLAIN)?) + all_bad(&there) as f64).into())
}

/// The room with all its light multiplied.
fn with_light(factor: f32) -> SceneBuilder {
    let mut b = Room::PLAIN.builder();
    b.materials.iter_mut().for_each(|m| m.emission *= factor);
    b.point_lights.iter_mut().for_each(|(_, intensity)| *intensity *= factor);
    b
}

/// Light is linear. The powers stay within the range in which references store light exactly.
fn brighter(_: &Trial) -> Outcome {
    let base = walks(with_light(1.0), &poses(Room::PLAIN), TRACE)?;
    total([2, 8], |k: i32| {
        let factor = 2f32.powi(k);
        let other = walks(with_light(factor), &poses(Room::PLAIN), TRACE)?;
        let unlike = |(a, b): (&Frame, &Frame)| {
            let scaled: Vec<Vec3> = a.radiance.iter().map(|r| *r * factor).collect();
            unequal(&scaled, &b.radiance) + bad_values(b)
        };
        Ok(base.iter().zip(&other).map(unlike).sum())
    })
}

fn denormal(_: &Trial) -> Outcome {
    // The lamp has a radiance of 8 and the point light an intensity of 2; no pixel is a thousand
    // times as bright.
    let frames = walks(with_light(1e-38), &poses(Room::PLAIN), TRACE)?;
    let bright = frames.iter().flat_map(|f| &f.radiance).filter(|r| r.max_element() > 1e-35).count();
    Ok((bright + all_bad(&frames)).into())
}

fn sunny(irradiance: f32) -> Outcome {
    let mut b = SceneBuilder::new("court");
    let stone = b.add_material(Material::diffuse("stone", Vec3::splat(0.6)));
    quad(&mut b, dvec(-4.0, 0.0, 4.0), dvec(8.0, 0.0, 0.0), dvec(0.0, 0.0, -8.0), stone);
    wall(&mut b, dvec(-4.0, 0.0, -4.0), [8.0, 3.0], stone);
    cuboid(&mut b, [dvec(-1.0, 0.0, -2.0), dvec(0.0, 1.5, -1.0)], stone, false);
    b.sky = Some(Sky::CLEAR_DAY);
    b.sun = Some(Sun { irradiance: Vec3::splat(irradiance), ..Sun::clear_day() });
    let frames = walks(b, &poses(Room::PLAIN), TRACE)?;
    let picture = Measured::from(all_bad(&frames)).with_picture(&frames[1]);
    Ok(picture)
}

/// Renders the ground under a picture of radiance 1, one of whose texels is a sun. Returns the
/// frames and the radiance of the ground.
fn ground_under_picture(sun: f32) -> Result<(Vec<Frame>, f64), ExperimentError> {
    const SIZE: [u32; 2] = [32, 16];
    const SUN: [u32; 2] = [20, 3];
    let at = |i: u32| if [i % SIZE[0], i / SIZE[0]] == SUN { sun } else { 1.0 };
    let texels = (0..SIZE[0] * SIZE[1]).map(|i| [at(i); 3]).collect();
    let unfit = |e| ExperimentError::Unsuitable(format!("the picture of the sky: {e}"));
    let image = SkyImage::new(Path::new("sky.hdr"), SIZE, texels, None).map_err(unfit)?;
    let mut b = SceneBuilder::new("ground");
    let grey = b.add_material(Material::diffuse("grey", Vec3::splat(0.5)));
    quad(&mut b, dvec(-9.0, 0.0, 9.0), DVec3::X * 18.0, DVec3::NEG_Z * 18.0, grey);
    b.sky = Some(Sky::Picture(PictureSky::new(Arc::new(image), 1.0)));
    let pose = |x: f64| Camera::look_at(dvec(x, 2.0, 0.0), dvec(0.0, 0.0, 0.1), 60.0);
    let frames = walks(b, &[pose(0.2), pose(0.0)], TRACE)?;
    // The integral of the cosine over the sun's texel.
    let edge = |row: u32| (PI * f64::from(row) / f64::from(SIZE[1])).cos().powi(2);
    let cosine = (edge(SUN[1]) - edge(SUN[1] + 1)) / 2.0 * TAU / f64::from(SIZE[0]);
    Ok((frames, 0.5 / PI * (PI + f64::from(sun - 1.0) * cosine)))
}

fn pictured_bad(_: &Trial) -> Outcome {
    Ok(all_bad(&ground_under_picture(1e9)?.0).into())
}

fn pictured(_: &Trial) -> Outcome {
    let (frames, radiance) = ground_under_picture(1e3)?;
    let off = frames.iter().map(|f| 100.0 * (mean(f) / (3.0 * radiance) - 1.0).abs());
    Ok(off.fold(0.0, f64::max).into())
}

/// Nothing reflects light onto a plane: under a sky of radiance 1 it has the radiance of its
/// albedo, without noise, because every sample of the sky brings the same light.
fn single_triangle(_: &Trial) -> Outcome {
    let mut b = SceneBuilder::new("triangle");
    let grey = b.add_material(Material::diffuse("grey", Vec3::splat(0.5)));
    triangle(&mut b, [dvec(-9.0, -9.0, 0.0), dvec(9.0, -9.0, 0.0), dvec(0.0, 9.0, 0.0)], grey);
    b.sky = Some(Sky::even(Vec3::ONE));
    let pose = |x: f64| Camera::look_at(dvec(x, -2.0, 2.0), dvec(0.0, -2.0, 0.0), 60.0);
    let frames = walks(b, &[pose(0.2), pose(0.0)], TRACE)?;
    let off = frames.iter().flat_map(|f| &f.radiance).map(|r| (*r / 0.5 - 1.0).abs().max_element());
    Ok(f64::from(100.0 * off.fold(0.0, f32::max)).into())
}

fn only_emission(_: &Trial) -> Outcome {
    let mut b = SceneBuilder::new("lamps");
    let glow = Vec3::new(0.25, 0.5, 2.0);
    let lamp = b.add_material(Material { emission: glow, ..Material::diffuse("lamp", Vec3::ZERO) });
    cuboid(&mut b, [DVec3::splat(-5.0), DVec3::splat(5.0)], lamp, true);
    let frames = walks(b, &poses(Room::PLAIN), TRACE)?;
    let unlike = frames.iter().flat_map(|f| &f.radiance).filter(|r| **r != glow).count();
    let rays = frames.iter().map(|f| f.stats.rays.shadow + f.stats.rays.indirect).sum::<u64>();
    Ok((unlike + rays as usize).into())
}

fn no_light(_: &Trial) -> Outcome {
    let mut b = with_light(0.0);
    b.point_lights.clear();
    // A black sky, because a scene without any light is given that of a clear day.
    b.sky = Some(Sky::even(Vec3::ZERO));
    let tracer = Arc::new(Tracer::new(Arc::new(b.finish()?)));
    let lit = |frame: &Frame| frame.radiance.iter().filter(|r| **r != Vec3::ZERO).count();
    total(MODES, |mode| {
        let mut walk = walk(&tracer, &poses(Room::PLAIN), RenderSettings { mode, trace: TRACE });
        let before = lit(walk.frame());
        walk.refine(NEVER);
        Ok(before + lit(walk.frame()))
    })
}

/// Without a loss, only the bound on length ends a path in a closed room.
fn white_room(_: &Trial) -> Outcome {
    let mut b = SceneBuilder::new("white room");
    let white = b.add_material(Material::diffuse("white", Vec3::ONE));
    let lamp = b.add_material(Material::emissive("lamp", Vec3::ONE));
    cuboid(&mut b, [dvec(-3.0, 0.0, -4.0), dvec(3.0, 3.0, 4.0)], white, true);
    quad(&mut b, dvec(-0.5, 2.875, -0.5), DVec3::X, DVec3::Z, lamp);
    let frames = walks(b, &poses(Room::PLAIN), TRACE)?;
    let paths = f64::from(SIZE[0] * SIZE[1] * TRACE.samples);
    let per_path = frames.iter().map(|f| f.stats.rays.total() as f64 / paths).fold(0.0, f64::max);
    let excess = (per_path - MAX_RAYS_PER_PATH).max(0.0);
    let note = format!("{per_path:.1} rays a path");
    Ok(Measured::from(all_bad(&frames) as f64 + excess).with_note(note).with_picture(&frames[1]))
}

fn few_samples(_: &Trial) -> Outcome {
    total([0, 1], |samples| {
        let frames = walks(Room::SHINY.builder(), &poses(Room::SHINY), TraceSettings { samples, ..TRACE })?;
        let black = frames.iter().filter(|f| mean(f) == 0.0).count();
        Ok(black + all_bad(&frames))
    })
}

/// In the middle of a closed sphere of radius 2 and reflectance 1/2, a light of intensity 4 pi
/// gives every wall the radiance 1, whatever the number of samples. Sequences that are good at
/// powers of two alone must not be biased at others.
fn odd_counts(_: &Trial) -> Outcome {
    let pose = |x: f64| Camera::look_at(dvec(x, 0.2, 0.3), dvec(1.0, 0.4, -0.7), 70.0);
    worst([1, 2, 3, 5, 7, 12], |samples| {
        let mut b = SceneBuilder::new("sphere");
        let grey = b.add_material(Material::diffuse("grey", Vec3::splat(0.5)));
        ball(&mut b, DVec3::ZERO, 2.0, 64, true, grey);
        b.point_lights.push((DVec3::ZERO, Vec3::splat(4.0 * PI as f32)));
        let frames = walks(b, &[pose(0.3), pose(0.1)], TraceSettings { samples, ..TRACE })?;
        let off = frames.iter().map(|f| 100.0 * (mean(f) / 3.0 - 1.0).abs());
        Ok(off.fold(0.0, f64::max) + all_bad(&frames) as f64)
    })
}

/// The room with its point light alone, because few samples of a lamp below a ceiling are noisy.
fn one_sample(_: &Trial) -> Outcome {
    let of = |samples: u32| {
        let mut b = Room::PLAIN.builder();
        b.materials.iter_mut().for_each(|m| m.emission = Vec3::ZERO);
        walks(b, &poses(Room::PLAIN), TraceSettings { samples, bounces: 4, ..TRACE })
    };
    Ok(mean_percent(&of(1)?, &of(64)?).into())
}

fn threads(_: &Trial) -> Outcome {
    let render = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let pool =
            pool.map_err(|e| ExperimentError::Unsuitable(format!("cannot start {threads} threads: {e}")))?;
        pool.install(|| of_room(Room::SHINY))
    };
    let one = render(1)?;
    total([2, 3, 8], |threads| Ok(differences(&one, &render(threads)?)))
}

fn seeds(_: &Trial) -> Outcome {
    let of = |seed: u64| {
        let trace = TraceSettings { seed, ..TRACE };
        let mut b = Room::PLAIN.builder();
        // No lamp in the picture, which has no noise.
        b.materials.iter_mut().for_each(|m| m.emission = Vec3::ZERO);
        walks(b, &poses(Room::PLAIN), trace)
    };
    let [a, b] = [of(1)?, of(2)?].map(|frames| frames[0].radiance.clone());
    let lit = || a.iter().zip(&b).filter(|(a, b)| **a != Vec3::ZERO || **b != Vec3::ZERO);
    let equal = lit().filter(|(a, b)| a == b).count();
    // NaN, which fails, where no pixel is lit.
    Ok((100.0 * equal as f64 / lit().count() as f64).into())
}
