//! B: the camera.

use super::bench::{
    Room, SIZE, TRACE, bad_values, ball, cuboid, differing, dvec, full, paper, percent, picture, random,
    reference, seen_in_white, tracer, view,
};
use super::case::{Case, Outcome, Trial};
use crate::camera::NEAREST_DEPTH;
use crate::camera::{Camera, View};
use crate::experiment::run::ExperimentError;
use crate::math::Ray;
use crate::math::key::Key;
use crate::raster::load::Picture;
use crate::raster::save::save_png;
use crate::reference::ReferenceFrame;
use crate::render::{Frame, FrameRequest, Mode, Renderer};
use crate::scene::{Material, SceneBuilder};
use crate::trace::{RayCounts, Tracer};
use glam::{Mat3, Vec3};
use rayon::prelude::*;
use std::time::Instant;

/// Of f32 axes of length one: their parts are rounded once each, and so are three products and a sum. One step was measured.
const ORTHONORMALITY: f64 = 8.0 * f32::EPSILON as f64;

/// The widest angle that is tried, degrees, rounded to f32. An eighth of it was measured.
const FOV_ERROR_DEG: f64 = 170.0 * f32::EPSILON as f64;

/// A step of who trembles, metres: less than an f32 tells apart at the room's walls.
const TREMOR_M: f64 = 1e-7;

pub(super) const CASES: &[Case] = &[
    Case::new(
        "B1 eye on a wall, a vertex, a mirror",
        "bad values, and pixels lent from too near",
        0.0,
        on_surfaces,
    ),
    Case::new(
        "B2 eye at 1e-7 to 1e-6 diagonals of a wall",
        "pixels unlike the full tracer's",
        0.0,
        close_to_a_wall,
    ),
    Case::new("B2 the wall fills the view", "% of pixels that see something else", 0.0, wall_fills_view),
    Case::new("B3 eye in a closed box", "rays that leave it", 0.0, closed_box),
    Case::new("B4 eye inside glass", "% of pixels off in white light", 0.5, inside_glass),
    Case::new("B4 eye outside glass", "% of pixels off in white light", 0.5, outside_glass),
    Case::new(
        "B5 random poses, straight up and down",
        "largest error of orthonormality",
        ORTHONORMALITY,
        orthonormal,
    ),
    Case::new(
        "B6 field of view 1 to 170 degrees",
        "error of the angle, degrees",
        FOV_ERROR_DEG,
        field_of_view,
    ),
    Case::new("B6 fields of view of nonsense", "cameras accepted that should not be", 0.0, refused_views),
    Case::new(
        "B7 aspects 1:1000 and no pixels",
        "pictures of a wrong size or with bad values",
        0.0,
        odd_sizes,
    ),
    Case::new("B8 memory of 7680x4320", "GB that a reference is told to take", 1.06, memory_of_8k),
    Case::new("B8 memory told and held", "bytes held for one told, 1x1 to 1024x768", 1.0, memory_told),
    Case::new("B9 a picture 16384 wide", "pixels that come back different", 0.0, wide_picture),
    Case::new("B10 moved by 1e-7 m, 100 times", "% of pixels that change in a step", 0.1, steady),
    Case::new("B11 teleport, turn, other lens", "pixels unlike the full tracer's", 0.0, teleport),
    Case::new("B11 time after a teleport", "times that of the full tracer", 1.10, teleport_time).timed(),
    Case::new(
        "B12 a million steps there and back",
        "metres off, and error of orthonormality",
        ORTHONORMALITY,
        drift,
    ),
];

/// Pixels of a reference nearer than any may be kept.
fn too_near(reference: &ReferenceFrame) -> usize {
    reference.disparity().iter().filter(|d| **d > 1.0 / NEAREST_DEPTH).count()
}

fn on_surfaces(_: &Trial) -> Outcome {
    let room = Room::SHINY;
    let tracer = room.tracer()?;
    let eyes = [dvec(3.0, 1.5, 0.0), dvec(-3.0, 0.0, -4.0), dvec(-1.0, 1.0, -3.875), dvec(0.0, 0.0, 0.0)];
    let mut wrong = 0;
    for eye in eyes {
        for at in [dvec(0.0, 1.0, 0.0), dvec(9.0, 1.5, 0.0), dvec(0.0, 1.0, -9.0)] {
            let camera = Camera::look_at(eye, at, 70.0);
            wrong += bad_values(&full(&tracer, &camera)) + too_near(&reference(&tracer, &camera, SIZE));
        }
    }
    Ok(wrong.into())
}

/// Looks at the wall at x = 3 from so many diagonals of the scene away.
fn at_wall(distance: f64) -> Camera {
    let diagonal = dvec(6.0, 3.0, 8.0).length();
    let eye = dvec(3.0 - distance * diagonal, 1.5, 1.0);
    Camera::look_at(eye, eye + dvec(1.0, 0.0, 0.0), 60.0)
}

fn close_to_a_wall(_: &Trial) -> Outcome {
    let tracer = Room::PLAIN.tracer()?;
    let mut wrong = 0;
    for distance in [1e-7, 5e-7, 1e-6] {
        let camera = at_wall(distance);
        let lent = reference(&tracer, &camera, SIZE);
        wrong += differing(&paper(&tracer, &camera, &[&lent]), &full(&tracer, &camera));
    }
    Ok(wrong.into())
}

fn wall_fills_view(_: &Trial) -> Outcome {
    let tracer = Room::PLAIN.tracer()?;
    let mut worst = 0f64;
    for distance in [1e-7, 1e-6, 1e-5, 1e-4, 1e-3] {
        let frame = full(&tracer, &at_wall(distance));
        let wall = frame.triangle[frame.triangle.len() / 2];
        let is_wall = |t: u32| {
            t != u32::MAX
                && tracer.scene().corners(t).iter().all(|p| p.x == tracer.scene().corners(wall)[0].x)
        };
        worst =
            worst.max(percent(frame.triangle.iter().filter(|t| !is_wall(**t)).count(), frame.triangle.len()));
    }
    Ok(worst.into())
}

fn closed_box(trial: &Trial) -> Outcome {
    let mut b = SceneBuilder::new("box");
    let wall = b.add_material(Material::diffuse("wall", Vec3::splat(0.5)));
    cuboid(&mut b, [dvec(-1.3, -0.7, -2.1), dvec(1.1, 0.9, 1.9)], wall, true);
    let tracer = tracer(b)?;
    let aims: Vec<Vec3> = (0..tracer.scene().triangles.len() as u32)
        .flat_map(|t| {
            let [a, b, c] = tracer.scene().corners(t);
            [a, b, c, (a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0, (a + b + c) / 3.0]
        })
        .collect();
    let misses = (0..trial.tries).into_par_iter().filter(|&i| {
        let origin = random(Key::of_pixel(11, i), 0) * 60.0;
        tracer.closest(&Ray::new(origin, aims[i as usize % aims.len()] - origin)).is_none()
    });
    Ok(misses.count().into())
}

/// A ball of clear glass in white light from everywhere.
fn white_light(eye_z: f64) -> Outcome {
    let mut b = SceneBuilder::new("glass");
    let glass = b.add_material(Material::glass("glass", 1.5, Vec3::ONE));
    ball(&mut b, dvec(0.0, 0.0, 0.0), 1.0, 48, false, glass);
    Ok(seen_in_white(b, &Camera::look_at(dvec(0.01, 0.02, eye_z), dvec(0.0, 0.0, eye_z - 1.0), 50.0))?)
}

fn inside_glass(_: &Trial) -> Outcome {
    white_light(0.1)
}

fn outside_glass(_: &Trial) -> Outcome {
    white_light(3.0)
}

/// The largest element of M^T M - 1.
fn skewness(camera: &Camera, tracer: &Tracer) -> f64 {
    let m = view(tracer, camera).scene_from_camera;
    let difference = m.transpose() * m - Mat3::IDENTITY;
    difference.to_cols_array().iter().fold(0.0, |worst, d| f64::max(worst, f64::from(d.abs())))
}

fn orthonormal(trial: &Trial) -> Outcome {
    use std::f64::consts::{FRAC_PI_2, PI};
    let tracer = Room::PLAIN.tracer()?;
    let pose = |i: u32| {
        let r = random(Key::of_pixel(12, i), 0);
        // Every tenth looks straight up or down.
        let pitch = if i.is_multiple_of(10) {
            FRAC_PI_2.copysign(f64::from(r.y))
        } else {
            f64::from(r.y) * FRAC_PI_2
        };
        Camera { yaw: f64::from(r.x) * 100.0 * PI, pitch, ..Room::PLAIN.camera() }
    };
    let worst =
        (0..trial.tries).into_par_iter().map(|i| skewness(&pose(i), &tracer)).reduce(|| 0.0, f64::max);
    Ok(worst.into())
}

fn field_of_view(_: &Trial) -> Outcome {
    let tracer = Room::PLAIN.tracer()?;
    let error = |degrees: f64| {
        let camera = Camera { fov_y: degrees.to_radians(), ..Room::PLAIN.camera() };
        let view = view(&tracer, &camera);
        let [x, height] = [SIZE[0] as f32 / 2.0, SIZE[1] as f32];
        let [top, bottom] = [0.0, height].map(|y| view.direction_of_point(x, y).as_dvec3());
        (top.angle_between(bottom).to_degrees() - degrees).abs()
    };
    Ok([1.0, 20.0, 60.0, 120.0, 170.0].map(error).into_iter().fold(0.0, f64::max).into())
}

fn refused_views(_: &Trial) -> Outcome {
    let camera = Room::PLAIN.camera();
    let with_fov = |degrees: f64| Camera { fov_y: degrees.to_radians(), ..camera };
    let bad = [0.0, -10.0, 180.0, 179.0, 360.0, f64::NAN, f64::INFINITY].map(with_fov);
    let nowhere = Camera { eye: dvec(f64::NAN, 0.0, 0.0), ..camera };
    let accepted = bad.iter().chain([&nowhere]).filter(|c| c.is_valid()).count();
    let clamped = Camera::look_at(camera.eye, camera.eye, 1e9).is_valid();
    Ok((accepted + usize::from(!clamped)).into())
}

fn odd_sizes(_: &Trial) -> Outcome {
    let (tracer, camera) = (Room::SHINY.tracer()?, Room::SHINY.camera());
    let mut wrong = 0;
    for size in [[0, 0], [0, 64], [64, 0], [1, 1], [1, 1000], [1000, 1], [3, 7]] {
        for mode in [Mode::Full, Mode::Paper] {
            let lent = (!size.contains(&0)).then(|| reference(&tracer, &camera, size));
            let frame = picture(&tracer, &camera, size, mode, &lent.iter().collect::<Vec<_>>());
            wrong += frame.radiance.len().abs_diff(size[0] as usize * size[1] as usize) + bad_values(&frame);
        }
    }
    Ok(wrong.into())
}

fn memory_of_8k(_: &Trial) -> Outcome {
    Ok((7680.0 * 4320.0 * ReferenceFrame::BYTES_PER_PIXEL as f64 / 1e9).into())
}

fn memory_told(_: &Trial) -> Outcome {
    let (tracer, camera) = (Room::SHINY.tracer()?, Room::SHINY.camera());
    let share = |size: [u32; 2]| {
        let told = size[0] as usize * size[1] as usize * ReferenceFrame::BYTES_PER_PIXEL;
        reference(&tracer, &camera, size).bytes() as f64 / told as f64
    };
    Ok([[1, 1], [64, 48], [1024, 768]].map(share).into_iter().fold(0.0, f64::max).into())
}

fn wide_picture(_: &Trial) -> Outcome {
    let size = [16_384, 16];
    let srgb: Vec<[u8; 3]> =
        (0..size[0] * size[1]).map(|i| [i as u8, (i >> 8) as u8, (i >> 16) as u8]).collect();
    let folder = tempfile::tempdir()
        .map_err(|e| ExperimentError::Unsuitable(format!("no folder to write to: {e}")))?;
    let file = folder.path().join("wide.png");
    save_png(&file, size, &srgb, &[])?;
    let back = Picture::load(&file).map_err(|e| ExperimentError::Unsuitable(e.to_string()))?;
    let is_right = back.size == size && back.values.len() == srgb.len();
    let differ = back.values.iter().zip(&srgb).filter(|(shown, wanted)| {
        let stored = shown.to_array().map(|c| (c * 255.0).round() as u8);
        stored != **wanted
    });
    Ok(if is_right { differ.count().into() } else { f64::NAN.into() })
}

fn changed_percent(a: &Frame, b: &Frame) -> f64 {
    let pairs = a.radiance.iter().zip(&b.radiance).zip(a.triangle.iter().zip(&b.triangle));
    let changed = pairs.filter(|((ra, rb), (ta, tb))| ta != tb || (**ra - **rb).abs().max_element() > 1e-3);
    percent(changed.count(), a.radiance.len())
}

fn steady(trial: &Trial) -> Outcome {
    let (tracer, camera) = (Room::SHINY.tracer()?, Room::SHINY.camera());
    let lent = reference(&tracer, &camera, SIZE);
    let mut before = [full(&tracer, &camera), paper(&tracer, &camera, &[&lent])];
    let mut worst = 0f64;
    for step in 1..=trial.frames {
        let eye = camera.eye + dvec(1.0, 0.5, -0.25) * (TREMOR_M * f64::from(step));
        let here = Camera { eye, ..camera };
        let now = [full(&tracer, &here), paper(&tracer, &here, &[&lent])];
        worst = before.iter().zip(&now).map(|(a, b)| changed_percent(a, b)).fold(worst, f64::max);
        before = now;
    }
    Ok(worst.into())
}

/// Poses that share nothing with the room's own.
fn elsewhere() -> [Camera; 3] {
    let camera = Room::SHINY.camera();
    [
        Camera { yaw: camera.yaw + std::f64::consts::PI, ..camera },
        Camera { eye: camera.eye + dvec(1000.0, 0.0, 0.0), ..camera },
        Camera { yaw: camera.yaw + 2.5, fov_y: 0.3, ..camera },
    ]
}

fn teleport(_: &Trial) -> Outcome {
    let tracer = Room::SHINY.tracer()?;
    let lent = reference(&tracer, &Room::SHINY.camera(), SIZE);
    let differ = |camera: &Camera| differing(&paper(&tracer, camera, &[&lent]), &full(&tracer, camera));
    Ok(elsewhere().iter().map(differ).sum::<usize>().into())
}

fn teleport_time(_: &Trial) -> Outcome {
    let size = [640, 360];
    let tracer = Room::SHINY.tracer()?;
    let lent = reference(&tracer, &Room::SHINY.camera(), size);
    let away = elsewhere()[0];
    let mut renderer = Renderer::default();
    let mut secs = |mode, lent: &[&ReferenceFrame]| {
        let settings = crate::render::RenderSettings { mode, trace: TRACE };
        let start = Instant::now();
        renderer.render(&FrameRequest::new(&tracer, &away, size, &settings).warping(lent));
        start.elapsed().as_secs_f64()
    };
    Ok(fastest_ratio(15, || [secs(Mode::Paper, &[&lent]), secs(Mode::Full, &[])]).into())
}

/// The least time of the first over the least of the second: what each takes where nothing comes between.
pub(super) fn fastest_ratio(rounds: u32, mut both: impl FnMut() -> [f64; 2]) -> f64 {
    let [a, b] = (0..rounds)
        .map(|_| both())
        .fold([f64::INFINITY; 2], |least, now| [least[0].min(now[0]), least[1].min(now[1])]);
    a / b
}

fn drift(trial: &Trial) -> Outcome {
    let tracer = Room::PLAIN.tracer()?;
    let start = Room::PLAIN.camera();
    let step = |i: u32| random(Key::of_pixel(13, i), 0).as_dvec3() * 0.1;
    let walk = |camera: Camera, i: u32, sign: f64| {
        let turn = step(i) * sign;
        Camera { eye: camera.eye + turn, yaw: camera.yaw + turn.x, ..camera }
    };
    let there = (0..trial.tries).fold(start, |camera, i| walk(camera, i, 1.0));
    let back = (0..trial.tries).rev().fold(there, |camera, i| walk(camera, i, -1.0));
    let mut rays = RayCounts::default();
    let middle = SIZE[0] * SIZE[1] / 2;
    let seen = [start, back]
        .map(|c| tracer.pixel(&View::new(&c, &tracer.scene().frame, SIZE), middle, &TRACE, &mut rays));
    let is_same = seen[0].hit.map(|h| h.triangle) == seen[1].hit.map(|h| h.triangle);
    let off = (back.eye - start.eye).length().max(skewness(&there, &tracer).max(0.0));
    Ok(if is_same { off.into() } else { f64::NAN.into() })
}
