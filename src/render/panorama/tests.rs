//! Panoramas whose light is looked up, against panoramas whose pixels are traced one by one.

use super::patches::{bands, patches};
use super::resample::PatchPicture;
use super::{Equirectangular, Panorama, PanoramaBand, PanoramaError};
use crate::camera::{Camera, SceneFrame, View};
use crate::render::{Mode, RenderSettings};
use crate::scene::builtin;
use crate::trace::{TraceSettings, Tracer, parallel::NEVER};
use glam::{DVec3, Vec3};
use std::convert::Infallible;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

const SIZE: [u32; 2] = [128, 64];

fn settings(mode: Mode, samples: u32, bounces: u32) -> RenderSettings {
    RenderSettings { mode, trace: TraceSettings { samples, bounces, seed: 3 } }
}

fn tracer(name: &str) -> Tracer {
    Tracer::new(Arc::new(builtin::build(name).unwrap()))
}

/// Renders a panorama as a whole. Its bands must follow each other from the top to the bottom.
fn render(tracer: &Tracer, camera: &Camera, settings: &RenderSettings, points: u32) -> Vec<Vec3> {
    let panorama = Panorama { tracer, camera, size: SIZE, settings, points };
    let (mut picture, mut last) = (Vec::new(), 0);
    let stats = panorama.render(NEVER, &|_| (), &mut |band: PanoramaBand| {
        assert_eq!(band.rows.start, last);
        last = band.rows.end;
        picture.extend(band.radiance);
        Ok::<(), Infallible>(())
    });
    assert!(stats.unwrap().is_complete);
    assert_eq!(picture.len(), (SIZE[0] * SIZE[1]) as usize);
    picture
}

/// In the furnace, every direction has the radiance of the theorem, also at the poles and where
/// the edges of the picture meet.
#[test]
fn the_furnace_is_uniform_in_all_directions() {
    const BOUNCES: u32 = 6;
    let tracer = tracer("furnace");
    let camera = Camera { yaw: 0.4, pitch: 0.3, ..*tracer.scene().start() };
    let expected = 2.0 - 0.5f32.powi(BOUNCES as i32);
    for (mode, points) in [(Mode::Full, 2), (Mode::Exact, 2), (Mode::Fast, 1)] {
        let picture = render(&tracer, &camera, &settings(mode, 32, BOUNCES), points);
        let mean = picture.iter().sum::<Vec3>() / picture.len() as f32;
        assert!((mean / expected - 1.0).abs().max_element() < 0.02, "{mode:?}: {mean}");
        for row in picture.chunks(SIZE[0] as usize) {
            let mean = row.iter().sum::<Vec3>() / row.len() as f32;
            assert!((mean / expected - 1.0).abs().max_element() < 0.15, "{mode:?}: a row has {mean}");
        }
    }
}

/// Pixels on both sides of a border between patches, and of the left and right edge.
fn borders(projection: &Equirectangular) -> Vec<[usize; 2]> {
    let [width, height] = projection.size().map(|side| side as usize);
    let mut pairs = Vec::new();
    for rows in bands(projection) {
        for patch in patches(projection, DVec3::ZERO, &rows) {
            let (left, right) = (patch.columns.start as usize, patch.columns.end as usize);
            let [y0, y1] = [rows.start as usize, rows.end as usize];
            // A patch that goes all the way round meets itself.
            pairs.extend((y0..y1).map(|y| [y * width + left, y * width + (left + width - 1) % width]));
            if y1 < height {
                pairs.extend((left..right).map(|x| [(y1 - 1) * width + x, y1 * width + x]));
            }
        }
    }
    pairs
}

/// The error of the step from a pixel to its neighbour is no larger across borders than elsewhere,
/// and the picture is that of its rays.
#[test]
fn a_panorama_is_that_of_its_rays_without_seams() {
    let tracer = tracer("cornell");
    let camera = Camera { eye: DVec3::new(0.1, 1.0, 0.2), yaw: 0.5, ..*tracer.scene().start() };
    let truth = render(&tracer, &camera, &settings(Mode::Full, 4, 2), 64);
    let projection = Equirectangular::new(&camera, SIZE);
    let shown = |v: Vec3| v / (1.0 + v);
    for mode in [Mode::Exact, Mode::Fast] {
        let picture = render(&tracer, &camera, &settings(mode, 64, 2), 16);
        let error = |at: usize| shown(picture[at]) - shown(truth[at]);
        let mean = (0..picture.len()).map(|at| error(at).abs().element_sum() / 3.0).sum::<f32>()
            / picture.len() as f32;
        assert!(mean < 0.012, "{mode:?}: mean error {mean}");
        let step = |[a, b]: [usize; 2]| (error(a) - error(b)).abs().element_sum();
        let mean_step =
            |pairs: &[[usize; 2]]| pairs.iter().map(|pair| step(*pair)).sum::<f32>() / pairs.len() as f32;
        let width = SIZE[0] as usize;
        let inside: Vec<[usize; 2]> =
            (width..picture.len()).flat_map(|at| [[at, at - 1], [at, at - width]]).collect();
        let (across, elsewhere) = (mean_step(&borders(&projection)), mean_step(&inside));
        assert!(across < 1.3 * elsewhere, "{mode:?}: {across} across borders, {elsewhere} elsewhere");
        // Directly above and below the viewer all columns meet in one point.
        for row in [0, SIZE[1] as usize - 1] {
            let row = &picture[row * width..(row + 1) * width];
            let mean = row.iter().sum::<Vec3>() / width as f32;
            assert!(row.iter().all(|p| (shown(*p) - shown(mean)).abs().max_element() < 0.05), "{mode:?}");
        }
    }
}

#[test]
fn a_panorama_has_the_same_bits_at_any_number_of_threads() {
    let tracer = tracer("mirrors");
    let camera = *tracer.scene().start();
    for mode in [Mode::Full, Mode::Exact, Mode::Fast] {
        let settings = settings(mode, 2, 1);
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| render(&tracer, &camera, &settings, 2))
        };
        assert!(with(1) == with(3), "{mode:?}");
    }
}

#[test]
fn a_stop_keeps_whole_bands_and_an_error_ends_the_work() {
    let tracer = tracer("cornell");
    let (camera, settings) = (*tracer.scene().start(), settings(Mode::Exact, 1, 0));
    let panorama = Panorama { tracer: &tracer, camera: &camera, size: SIZE, settings: &settings, points: 1 };
    let bands = AtomicU32::new(0);
    let stop = || bands.load(Ordering::Relaxed) == 2;
    let stats = panorama.render(&stop, &|part| assert!((0.0..=1.0).contains(&part)), &mut |_| {
        bands.fetch_add(1, Ordering::Relaxed);
        Ok::<(), Infallible>(())
    });
    assert!(!stats.unwrap().is_complete);
    assert_eq!(bands.load(Ordering::Relaxed), 2);
    assert_eq!(panorama.render(NEVER, &|_| (), &mut |_| Err("full")).unwrap_err(), "full");
}

#[test]
fn sizes_that_are_no_panorama_are_refused_with_the_nearest_that_is() {
    for (size, words) in [
        ([1280, 720], "--size 1360x680"),
        ([100, 100], "--size 150x75"),
        ([u32::MAX, u32::MAX], "--size 32768x16384"),
        ([65536, 32768], "maximum is 32768x16384"),
    ] {
        let error = Panorama::check(size).unwrap_err();
        assert!(error.to_string().contains(words), "{error}");
    }
    assert_eq!(Panorama::check([8192, 4096]), Ok(()));
    assert_eq!(Panorama::check([2, 2]), Err(PanoramaError::Shape([2, 2])));
}

/// Of a picture of known content, the bicubic curve shows more than straight lines between pixels.
#[test]
fn the_bicubic_curve_keeps_more_detail_than_straight_lines() {
    let frame = SceneFrame { origin_in_world_m: DVec3::ZERO, units_per_metre: 1.0 };
    let projection = Equirectangular::new(&Camera::look_at(DVec3::ZERO, DVec3::NEG_Z, 60.0), [256, 128]);
    // Waves of six pixels.
    let content =
        |d: DVec3| Vec3::splat((2.0 + (40.0 * d.x).sin() * (40.0 * d.y).cos() * d.z.signum()) as f32);
    let mut errors = [0.0; 2];
    for rows in bands(&projection) {
        for patch in patches(&projection, DVec3::ZERO, &rows) {
            let view = View::new(&patch.camera, &frame, patch.size);
            let pixels: Vec<Vec3> = (0..view.pixel_count() as u32)
                .map(|pixel| content(view.direction_of_pixel(pixel).as_dvec3().normalize_or(DVec3::Y)))
                .collect();
            let picture = PatchPicture::new(&view, &pixels);
            for y in rows.clone() {
                for x in patch.columns.clone() {
                    let d = projection.direction([x, y].map(|at| f64::from(at) + 0.5));
                    if d.z.abs() > 0.1 {
                        for (error, found) in errors.iter_mut().zip([picture.at(d), picture.linear_at(d)]) {
                            *error += (found - content(d)).length_squared();
                        }
                    }
                }
            }
        }
    }
    assert!(errors[0] < 0.2 * errors[1], "squared errors: curve {}, lines {}", errors[0], errors[1]);
}
