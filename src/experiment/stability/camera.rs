//! Cases B of the catalogue: cameras at, in or very near surfaces, with extreme lenses, sizes and
//! movements.

use super::case::{Case, Outcome, Trial, case, total, worst};
use super::pictures::{
    SIZE, TRACE, bad_values, differing, full, paper, paper_over_full_secs, percent, picture, reference,
    seen_in_white, view,
};
use super::rooms::{Room, ball, cuboid, dvec, random, temporary_folder, tracer};
use crate::camera::{Camera, NEAREST_DEPTH};
use crate::experiment::run::ExperimentError;
use crate::math::{Ray, key::Key};
use crate::raster::{load::Picture, save::save_png};
use crate::reference::ReferenceFrame;
use crate::render::{Frame, Mode};
use crate::scene::{Material, SceneBuilder};
use crate::trace::{NO_TRIANGLE, RayCounts, Tracer};
use glam::{DVec3, Mat3, Vec3};
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};

/// Maximum error of orthonormality of f32 axes of length one: their components are rounded once
/// each, and so are three products and a sum. One eighth of it was measured.
const ORTHONORMALITY: f64 = 8.0 * f32::EPSILON as f64;

/// Maximum error of an angle in degrees: the rounding to f32 of the widest angle that is tried. One
/// eighth of it was measured.
const FOV_ERROR_DEG: f64 = 170.0 * f32::EPSILON as f64;

/// A step of a trembling camera in metres: less than an f32 resolves at the walls of the room.
const TREMOR_M: f64 = 1e-7;

pub(super) const CASES: &[Case] = &[
    case("B1 eye on a wall, a vertex, a mirror", "bad values, pixels reused from too near", 0.0, on_surfaces),
    case("B2 eye at 1e-7 to 1e-6 diagonals of a wall", "pixels unlike full tracing", 0.0, close_to_a_wall),
    case("B2 the wall fills the view", "% of pixels that see something else", 0.0, wall_fills_view),
    case("B3 eye in a closed box", "rays that leave it", 0.0, closed_box),
    case("B4 eye inside glass", "% of pixels off in white light", 0.5, |_| white_light(0.1)),
    case("B4 eye outside glass", "% of pixels off in white light", 0.5, |_| white_light(3.0)),
    case("B5 random poses, straight up and down", "error of orthonormality", ORTHONORMALITY, orthonormal),
    case("B6 field of view 1 to 170 degrees", "error of the angle, degrees", FOV_ERROR_DEG, field_of_view),
    case("B6 invalid fields of view", "cameras accepted that should not be", 0.0, refused_views),
    case("B7 aspects 1:1000 and no pixels", "pictures of a wrong size or with bad values", 0.0, odd_sizes),
    case("B8 memory of 7680x4320", "GB that a reference is estimated to take", 1.06, memory_of_8k),
    case("B8 memory estimated and held", "bytes held per byte estimated, 1x1 to 1024x768", 1.0, memory_held),
    case("B9 a picture 16384 wide", "pixels that differ after saving and loading", 0.0, wide_picture),
    case("B10 moved by 1e-7 m, 100 times", "% of pixels that change in a step", 0.1, steady),
    case("B11 teleport, turn, other lens", "pixels unlike full tracing", 0.0, teleport),
    case("B11 time after a teleport", "times that of full tracing", 1.10, teleport_time).timed(),
    case("B12 a million steps there and back", "metres off, error of orthonormality", ORTHONORMALITY, drift),
];

/// Counts pixels of a reference that are nearer than a reference may keep.
pub(super) fn too_near(reference: &ReferenceFrame) -> usize {
    reference.disparity().iter().filter(|d| **d > 1.0 / NEAREST_DEPTH).count()
}

fn on_surfaces(_: &Trial) -> Outcome {
    let tracer = Room::SHINY.tracer()?;
    let eyes = [dvec(3.0, 1.5, 0.0), dvec(-3.0, 0.0, -4.0), dvec(-1.0, 1.0, -3.875), DVec3::ZERO];
    let targets = [dvec(0.0, 1.0, 0.0), dvec(9.0, 1.5, 0.0), dvec(0.0, 1.0, -9.0)];
    total(eyes.into_iter().flat_map(|eye| targets.map(|at| Camera::look_at(eye, at, 70.0))), |camera| {
        Ok(bad_values(&full(&tracer, &camera)) + too_near(&reference(&tracer, &camera, SIZE)))
    })
}

/// Looks at the wall at x = 3 from a distance in diagonals of the scene.
fn at_wall(distance: f64) -> Camera {
    let diagonal = dvec(6.0, 3.0, 8.0).length();
    let eye = dvec(3.0 - distance * diagonal, 1.5, 1.0);
    Camera::look_at(eye, eye + dvec(1.0, 0.0, 0.0), 60.0)
}

fn close_to_a_wall(_: &Trial) -> Outcome {
    let tracer = Room::PLAIN.tracer()?;
    total([1e-7, 5e-7, 1e-6].map(at_wall), |camera| {
        let reference = reference(&tracer, &camera, SIZE);
        Ok(differing(&paper(&tracer, &camera, &[&reference]), &full(&tracer, &camera)))
    })
}

fn wall_fills_view(_: &Trial) -> Outcome {
    let tracer = Room::PLAIN.tracer()?;
    let corners = |t: u32| tracer.scene().corners(t);
    worst([1e-7, 1e-6, 1e-5, 1e-4, 1e-3], |distance| {
        let seen = full(&tracer, &at_wall(distance)).triangle;
        let x = corners(seen[seen.len() / 2])[0].x;
        let is_wall = |t: u32| t != NO_TRIANGLE && corners(t).iter().all(|p| p.x == x);
        Ok(percent(seen.iter().filter(|t| !is_wall(**t)).count(), seen.len()))
    })
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

/// A ball of clear glass in uniform white light.
fn white_light(eye_z: f64) -> Outcome {
    let mut b = SceneBuilder::new("glass");
    let glass = b.add_material(Material::glass("glass", 1.5, Vec3::ONE));
    ball(&mut b, DVec3::ZERO, 1.0, 48, false, glass);
    seen_in_white(b, &Camera::look_at(dvec(0.01, 0.02, eye_z), dvec(0.0, 0.0, eye_z - 1.0), 50.0))
}

/// Returns the largest element of M^T M - 1, where M is the rotation of the camera.
fn skewness(camera: &Camera, tracer: &Tracer) -> f64 {
    let m = view(tracer, camera).scene_from_camera;
    let difference = m.transpose() * m - Mat3::IDENTITY;
    difference.to_cols_array().iter().fold(0.0, |worst, d| f64::max(worst, f64::from(d.abs())))
}

fn orthonormal(trial: &Trial) -> Outcome {
    let (tracer, camera) = Room::PLAIN.stage()?;
    let pose = |i: u32| {
        let [x, y, _] = random(Key::of_pixel(12, i), 0).as_dvec3().to_array();
        // Every tenth camera looks straight up or down.
        let pitch = if i.is_multiple_of(10) { FRAC_PI_2.copysign(y) } else { y * FRAC_PI_2 };
        Camera { yaw: x * 100.0 * PI, pitch, ..camera }
    };
    let skewness = (0..trial.tries).into_par_iter().map(|i| skewness(&pose(i), &tracer));
    Ok(skewness.reduce(|| 0.0, f64::max).into())
}

fn field_of_view(_: &Trial) -> Outcome {
    let (tracer, camera) = Room::PLAIN.stage()?;
    worst([1.0f64, 20.0, 60.0, 120.0, 170.0], |degrees| {
        let view = view(&tracer, &Camera { fov_y: degrees.to_radians(), ..camera });
        let [x, height] = [SIZE[0] as f32 / 2.0, SIZE[1] as f32];
        let [top, bottom] = [0.0, height].map(|y| view.direction_of_point(x, y).as_dvec3());
        Ok((top.angle_between(bottom).to_degrees() - degrees).abs())
    })
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
    let (tracer, camera) = Room::SHINY.stage()?;
    let sizes = [[0, 0], [0, 64], [64, 0], [1, 1], [1, 1000], [1000, 1], [3, 7]];
    total(sizes.into_iter().flat_map(|size| [(size, Mode::Full), (size, Mode::Paper)]), |(size, mode)| {
        let reference = (!size.contains(&0)).then(|| reference(&tracer, &camera, size));
        let frame = picture(&tracer, &camera, size, mode, &reference.iter().collect::<Vec<_>>());
        Ok(frame.radiance.len().abs_diff(size[0] as usize * size[1] as usize) + bad_values(&frame))
    })
}

fn memory_of_8k(_: &Trial) -> Outcome {
    Ok((7680.0 * 4320.0 * ReferenceFrame::BYTES_PER_PIXEL as f64 / 1e9).into())
}

fn memory_held(_: &Trial) -> Outcome {
    let (tracer, camera) = Room::SHINY.stage()?;
    worst([[1, 1], [64, 48], [1024, 768]], |size: [u32; 2]| {
        let estimated = size[0] as usize * size[1] as usize * ReferenceFrame::BYTES_PER_PIXEL;
        Ok(reference(&tracer, &camera, size).bytes() as f64 / estimated as f64)
    })
}

fn wide_picture(_: &Trial) -> Outcome {
    let size = [16_384, 16];
    let srgb: Vec<[u8; 3]> =
        (0..size[0] * size[1]).map(|i| [i as u8, (i >> 8) as u8, (i >> 16) as u8]).collect();
    let folder = temporary_folder()?;
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
    let (tracer, camera) = Room::SHINY.stage()?;
    let reference = reference(&tracer, &camera, SIZE);
    let frames = |here: &Camera| [full(&tracer, here), paper(&tracer, here, &[&reference])];
    let mut before = frames(&camera);
    worst(1..=trial.frames, |step| {
        let eye = camera.eye + dvec(1.0, 0.5, -0.25) * (TREMOR_M * f64::from(step));
        let now = frames(&Camera { eye, ..camera });
        let changed = before.iter().zip(&now).map(|(a, b)| changed_percent(a, b)).fold(0.0, f64::max);
        before = now;
        Ok(changed)
    })
}

/// Cameras that see nothing of the room's own view.
fn elsewhere() -> [Camera; 3] {
    let camera = Room::SHINY.camera();
    [
        Camera { yaw: camera.yaw + PI, ..camera },
        Camera { eye: camera.eye + dvec(1000.0, 0.0, 0.0), ..camera },
        Camera { yaw: camera.yaw + 2.5, fov_y: 0.3, ..camera },
    ]
}

fn teleport(_: &Trial) -> Outcome {
    let (tracer, camera) = Room::SHINY.stage()?;
    let reference = reference(&tracer, &camera, SIZE);
    let differ = |c: &Camera| differing(&paper(&tracer, c, &[&reference]), &full(&tracer, c));
    Ok(elsewhere().iter().map(differ).sum::<usize>().into())
}

fn teleport_time(_: &Trial) -> Outcome {
    let (tracer, camera) = Room::SHINY.stage()?;
    paper_over_full_secs(&tracer, [&camera, &elsewhere()[0]], [640, 360], 15)
}

fn drift(trial: &Trial) -> Outcome {
    let (tracer, start) = Room::PLAIN.stage()?;
    let step = |i: u32| random(Key::of_pixel(13, i), 0).as_dvec3() * 0.1;
    let walk = |camera: Camera, i: u32, sign: f64| {
        let turn = step(i) * sign;
        Camera { eye: camera.eye + turn, yaw: camera.yaw + turn.x, ..camera }
    };
    let there = (0..trial.tries).fold(start, |camera, i| walk(camera, i, 1.0));
    let back = (0..trial.tries).rev().fold(there, |camera, i| walk(camera, i, -1.0));
    let middle = SIZE[0] * SIZE[1] / 2;
    let seen = |c: &Camera| {
        let traced = tracer.pixel(&view(&tracer, c), middle, &TRACE, &mut RayCounts::default());
        traced.hit.map(|h| h.triangle)
    };
    let off = (back.eye - start.eye).length().max(skewness(&there, &tracer).max(0.0));
    Ok(if seen(&start) == seen(&back) { off.into() } else { f64::NAN.into() })
}
