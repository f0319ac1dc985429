//! The fast paths of the warp (vectors of any width, bands, skipped tiles) against a slow reference
//! implementation.

use crate::reuse::{moved, warp_slowly};
use crate::rooms::{room_camera, room_tracer};
use afterimage::camera::PixelWarp;
use afterimage::math::key::Key;
use afterimage::reference::ReferenceFrame;
use afterimage::trace::TraceSettings;
use afterimage::trace::parallel::NEVER;
use afterimage::warp::WarpBuffer;
use afterimage::{Camera, Tracer, View};
use fearless_simd::Level;

const TRACE: TraceSettings = TraceSettings { samples: 1, bounces: 0, seed: 5 };

/// All SIMD levels of this machine: on x86-64 four widths, with and without fused multiply-add.
fn levels() -> Vec<Level> {
    let mut levels = vec![Level::new(), Level::baseline()];
    #[cfg(target_arch = "x86_64")]
    {
        levels.extend(Level::new().as_sse4_2().map(Level::Sse4_2));
        levels.extend(Level::new().as_avx2().map(Level::Avx2));
    }
    levels
}

/// References whose sizes are not multiples of a tile or a vector; one is smaller than both.
fn references(tracer: &Tracer) -> Vec<ReferenceFrame> {
    let poses = [(0.0, 0.0, [131, 77]), (0.7, 0.1, [64, 40]), (-0.2, -0.3, [96, 64]), (0.1, 0.2, [7, 3])];
    let trace = |(forward, turn, size)| {
        ReferenceFrame::trace(tracer, &moved(&room_camera(), forward, turn), size, &TRACE, NEVER).unwrap()
    };
    poses.map(trace).into()
}

/// Views after a step, after a turn on the spot, from outside the room, upwards, and from the
/// opposite side.
fn views(tracer: &Tracer) -> Vec<View> {
    let start = room_camera();
    let up = Camera { pitch: 1.2, ..start };
    let poses = [moved(&start, 0.4, 0.05), moved(&start, 0.0, 1.5), moved(&start, 6.0, 0.3), up, {
        moved(&start, 3.0, std::f64::consts::PI)
    }];
    let sizes = [[90, 70], [33, 200], [1, 1], [150, 3], [64, 64]];
    poses.iter().zip(sizes).map(|(pose, size)| View::new(pose, &tracer.scene().frame, size)).collect()
}

#[test]
fn every_vector_width_and_thread_count_gives_the_bits_of_the_slow_version() {
    let tracer = room_tracer(true, false);
    let references = references(&tracer);
    let references: Vec<&ReferenceFrame> = references.iter().collect();
    for threads in [1, 3, 16] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut warped = WarpBuffer::default();
        for (number, view) in views(&tracer).iter().enumerate() {
            let slow = warp_slowly(&references, view);
            for level in levels() {
                pool.install(|| warped.warp_at(level, &references, view));
                let fast = |pixel| warped.sample(pixel).map(|(s, d)| (s.slot(), s.pixel(), d));
                let wrong = slow.iter().enumerate().find(|(pixel, slow)| fast(*pixel) != **slow);
                assert_eq!(wrong, None, "view {number}, {level:?}, {threads} threads");
            }
        }
    }
}

#[test]
fn a_warp_without_references_leaves_every_pixel_empty() {
    let tracer = room_tracer(false, false);
    let reference = ReferenceFrame::trace(&tracer, &room_camera(), [40, 30], &TRACE, NEVER).unwrap();
    let view = View::new(&room_camera(), &tracer.scene().frame, [40, 30]);
    let mut warped = WarpBuffer::default();
    warped.warp(&[&reference], &view);
    assert!((0..1200).all(|pixel| warped.sample(pixel).is_some()));
    warped.warp(&[], &view);
    assert!((0..1200).all(|pixel| warped.sample(pixel).is_none()));
}

#[test]
fn bounds_contain_every_point_of_their_box() {
    let frame = room_tracer(false, false).scene().frame;
    let size = [640, 400];
    let view = |key: Key| {
        let [[a, b], [c, d]] = [key.with(0).pair(), key.with(1).pair()].map(|p| p.map(f64::from));
        let camera = Camera { pitch: c - 0.5, ..moved(&room_camera(), 4.0 * a - 2.0, 3.0 * (b - 0.5)) };
        View::new(&Camera { fov_y: 0.3 + 2.0 * d, ..camera }, &frame, size)
    };
    let (mut bounded, mut behind) = (0, 0);
    for round in 0..2000 {
        let key = Key::of_pixel(11, round);
        let warp = PixelWarp::new(&view(key.with(2)), &view(key.with(3)));
        let [x, y] = key.with(4).pair();
        let [x, y] = [(x * 570.0) as u32, (y * 390.0) as u32];
        let [near, range] = key.with(5).pair();
        // From the sky to closer than a ten-thousandth of the room.
        let near = if round % 3 == 0 { 0.0 } else { 10f32.powf(4.0 * near - 4.0) };
        let (x, y) = ([x, x + 63], [y, y + 7]);
        let d = [near, near + range * range * 2.0 * (0.1 + near)];
        let bounds = warp.bounds(x, y, d);
        bounded += usize::from(bounds.is_some_and(|[across, _]| across[0].is_finite()));
        behind += usize::from(bounds.is_none());
        for sample in 0..64 {
            let [u, v] = key.with(6 + 2 * sample).pair();
            let w = [0.0, 1.0, key.with(7 + 2 * sample).pair()[0]][sample as usize % 3];
            let (sx, sy) = (x[0] + (u * 64.0) as u32, y[0] + (v * 8.0) as u32);
            let Some((px, py, _)) = warp.point(sx, sy, (d[0] + w * (d[1] - d[0])).min(d[1])) else {
                continue;
            };
            let [across, down] = bounds.expect("a point is in front of the eye, but its box is behind it");
            assert!(across[0] <= px && px <= across[1], "{px} is not in {across:?}");
            assert!(down[0] <= py && py <= down[1], "{py} is not in {down:?}");
        }
    }
    assert!(bounded > 500 && behind > 50, "{bounded} bounded and {behind} behind of 2000");
}
