//! The paper's steps: identities, a simple twin of the warp, and what must never happen.

use crate::rooms::{dvec, room_camera, room_tracer};
use afterimage::reference::placement::{PREDICTIVE, THRESHOLD};
use afterimage::reference::{PlacementPolicy, ReferenceCache, ReferenceFrame};
use afterimage::warp::{ReferenceSelector, WarpBuffer};
use afterimage::{
    Camera, Frame, FrameRequest, Mode, RenderSettings, Renderer, Tracer, View, Walkthrough,
    WalkthroughSettings, camera::PixelWarp, raster::pixel_types::PixelType, trace::TraceSettings,
    trace::parallel::NEVER,
};
use glam::Vec3;
use std::sync::Arc;

const SIZE: [u32; 2] = [96, 64];
const TRACE: TraceSettings = TraceSettings { samples: 2, bounces: 0, seed: 3 };

fn settings(mode: Mode) -> RenderSettings {
    RenderSettings { mode, trace: TRACE }
}

fn reference(tracer: &Tracer, camera: &Camera) -> ReferenceFrame {
    ReferenceFrame::trace(tracer, camera, SIZE, &TRACE, NEVER).unwrap()
}

fn full(tracer: &Tracer, camera: &Camera) -> Vec<Vec3> {
    Renderer::default()
        .render(&FrameRequest::new(tracer, camera, SIZE, &settings(Mode::Full)))
        .radiance
        .clone()
}

fn paper(tracer: &Tracer, camera: &Camera, references: &[&ReferenceFrame]) -> Frame {
    let settings = settings(Mode::Paper);
    let request = FrameRequest::new(tracer, camera, SIZE, &settings);
    Renderer::default().render(&request.warping(references)).clone()
}

pub(crate) fn moved(camera: &Camera, forward_m: f64, turn: f64) -> Camera {
    Camera { eye: camera.eye + camera.forward() * forward_m, yaw: camera.yaw + turn, ..*camera }
}

/// Maximum error of packed light, as a share of its largest channel.
const PACKING: f32 = 1.0 / 512.0;

#[test]
fn a_reference_warped_onto_its_own_camera_has_no_hole_and_the_same_light() {
    let tracer = room_tracer(false, false);
    let camera = room_camera();
    let reference = reference(&tracer, &camera);
    let frame = paper(&tracer, &camera, &[&reference]);
    assert!(frame.types.iter().all(|t| *t == PixelType::Reused));
    assert_eq!(frame.stats.rays, Default::default(), "Type 1 takes no rays");
    let mut lit = 0;
    for (pixel, shown) in (0u32..).zip(&frame.radiance) {
        let full = tracer.pixel(&frame.view, pixel, &TRACE, &mut Default::default());
        let albedo = tracer.scene().material_of(full.hit.unwrap().triangle).diffuse;
        // The last term is the rounding of the product itself.
        let allowed =
            albedo * full.light.total().max_element() * PACKING + full.radiance * (2.0 * f32::EPSILON);
        let off = (*shown - full.radiance).abs();
        assert!(off.cmple(allowed).all(), "pixel {pixel}: {off} of {}", full.radiance);
        lit += u32::from(full.light.total().max_element() > 0.0);
    }
    assert!(lit > SIZE[0] * SIZE[1] / 2, "{lit} lit pixels");
}

#[test]
fn paper_without_references_is_the_full_tracer_bit_for_bit() {
    let tracer = room_tracer(true, true);
    let paper = paper(&tracer, &room_camera(), &[]);
    assert!(paper.radiance == full(&tracer, &room_camera()));
    assert_eq!(paper.stats.types.unseen, paper.stats.types.total());
}

/// A serial warp too simple to be wrong: every sample in order, a plain depth comparison.
pub(crate) fn warp_slowly(references: &[&ReferenceFrame], view: &View) -> Vec<Option<(usize, u32, f32)>> {
    let mut nearest: Vec<Option<(usize, u32, f32)>> = vec![None; view.pixel_count()];
    for (slot, reference) in references.iter().enumerate() {
        let warp = PixelWarp::new(&reference.view, view);
        for pixel in 0..reference.view.pixel_count() as u32 {
            let (x, y) = (pixel % reference.view.size[0], pixel / reference.view.size[0]);
            let Some((tx, ty, d)) = warp.target(x, y, reference.disparity()[pixel as usize]) else {
                continue;
            };
            let cell = &mut nearest[(ty * view.size[0] + tx) as usize];
            if cell.is_none_or(|(_, _, best)| d > best) {
                *cell = Some((slot, pixel, d));
            }
        }
    }
    nearest
}

#[test]
fn the_parallel_warp_equals_a_simple_serial_one() {
    let tracer = room_tracer(true, false);
    let start = room_camera();
    let references: Vec<_> =
        [(0.0, 0.0), (0.7, 0.1), (-0.2, -0.3)].map(|(f, t)| reference(&tracer, &moved(&start, f, t))).into();
    let references: Vec<&ReferenceFrame> = references.iter().collect();
    let mut warped = WarpBuffer::default();
    for (forward, turn) in [(0.0, 0.0), (0.4, 0.05), (1.5, -0.4), (-0.3, 1.0)] {
        let view = View::new(&moved(&start, forward, turn), &tracer.scene().frame, SIZE);
        warped.warp(&references, &view);
        for (pixel, slow) in warp_slowly(&references, &view).into_iter().enumerate() {
            let fast = warped.sample(pixel).map(|(s, d)| (s.slot(), s.pixel(), d));
            assert_eq!(fast, slow, "pixel {pixel}");
        }
    }
}

#[test]
fn a_warped_point_lands_where_the_camera_sees_it() {
    let tracer = room_tracer(false, false);
    let reference = reference(&tracer, &room_camera());
    let view = View::new(&moved(&room_camera(), 0.5, 0.2), &tracer.scene().frame, SIZE);
    let warp = PixelWarp::new(&reference.view, &view);
    let mut compared = 0;
    for pixel in 0..reference.view.pixel_count() as u32 {
        let (x, y) = (pixel % SIZE[0], pixel / SIZE[0]);
        let Some((tx, ty, disparity)) = warp.target(x, y, reference.disparity()[pixel as usize]) else {
            continue;
        };
        let point = reference.view.eye_f64 + reference.offset_from_eye(pixel).as_dvec3();
        let p = view.scene_from_pixel_f64.inverse() * (point - view.eye_f64);
        let (sx, sy) = (p.x / p.z, p.y / p.z);
        // Within a thousandth of a pixel, rounding may choose different pixels.
        if (sx - sx.round()).abs() < 1e-3 || (sy - sy.round()).abs() < 1e-3 {
            continue;
        }
        assert_eq!((tx, ty), (sx as u32, sy as u32));
        assert!((1.0 / f64::from(disparity) / p.z - 1.0).abs() < 1e-5);
        compared += 1;
    }
    assert!(compared > 3000, "{compared}");
}

#[test]
fn type_counts_sum_and_a_mirror_is_never_type_1() {
    let tracer = room_tracer(true, true);
    let start = room_camera();
    let references = [reference(&tracer, &start), reference(&tracer, &moved(&start, 0.5, 0.2))];
    let references: Vec<&ReferenceFrame> = references.iter().collect();
    for (forward, turn) in [(0.0, 0.0), (0.2, 0.1), (1.0, -0.3), (0.0, 3.0)] {
        let camera = moved(&start, forward, turn);
        let frame = paper(&tracer, &camera, &references);
        let types = frame.stats.types;
        assert_eq!(types.total(), frame.view.pixel_count());
        let p = types.percentages();
        assert!((p.type1_percent + p.type2_percent + p.type3_percent - 100.0).abs() < 1e-9);
        for (t, &triangle) in frame.types.iter().zip(&frame.triangle) {
            if *t == PixelType::Reused {
                assert!(!tracer.scene().material_of(triangle).is_view_dependent(), "a mirror was copied");
            }
        }
        assert!(frame.radiance.iter().all(|r| r.is_finite() && r.min_element() >= 0.0));
    }
}

#[test]
fn type_2_equals_the_plain_tracer_at_the_reference_camera() {
    let tracer = room_tracer(true, true);
    let camera = room_camera();
    let reference = reference(&tracer, &camera);
    let (full, paper) = (full(&tracer, &camera), paper(&tracer, &camera, &[&reference]));
    assert!(paper.stats.types.secondary > 150, "{:?}", paper.stats.types);
    let wrong = full
        .iter()
        .zip(&paper.radiance)
        .filter(|(a, b)| (**a - **b).abs().max_element() > a.max_element().max(0.1) / 64.0)
        .count();
    // Stored points are rounded: at an edge seen in a mirror, a few pixels show its other side.
    assert!(wrong * 200 <= full.len(), "{wrong} of {} pixels differ", full.len());
}

#[test]
fn a_view_that_no_reference_saw_equals_the_full_tracer() {
    let tracer = room_tracer(false, false);
    let reference = reference(&tracer, &room_camera());
    let away = Camera { yaw: room_camera().yaw + std::f64::consts::PI, ..room_camera() };
    let paper = paper(&tracer, &away, &[&reference]);
    assert_eq!(paper.stats.types.unseen, paper.stats.types.total());
    assert!(paper.radiance == full(&tracer, &away));
}

#[test]
fn references_of_another_epoch_are_never_selected() {
    let (old, new) = (room_tracer(false, false), room_tracer(false, false));
    let mut cache = ReferenceCache::new(old.scene(), 1 << 30);
    cache.insert(Arc::new(reference(&old, &room_camera())));
    let view = View::new(&room_camera(), &new.scene().frame, SIZE);
    assert!(ReferenceSelector::default().select(&mut cache, &view, new.epoch(), 8).is_empty());
    assert_eq!(ReferenceSelector::default().select(&mut cache, &view, old.epoch(), 8).len(), 1);
    let mut walk = Walkthrough::new(Arc::new(new), WalkthroughSettings::default());
    assert!(walk.insert(reference(&old, &room_camera())).is_none());
}

#[test]
fn the_cache_keeps_its_budget_and_evicts_what_contributes_least() {
    let tracer = room_tracer(false, false);
    let one = reference(&tracer, &room_camera()).bytes();
    let mut cache = ReferenceCache::new(tracer.scene(), 3 * one);
    let ids: Vec<_> = (0..3)
        .map(|i| cache.insert(Arc::new(reference(&tracer, &moved(&room_camera(), 0.1 * f64::from(i), 0.0)))))
        .collect();
    assert_eq!(cache.bytes(), 3 * one);
    for _ in 0..5 {
        cache.note_contributions(&[(ids[0], 0.5), (ids[2], 0.4)]);
    }
    cache.insert(Arc::new(reference(&tracer, &room_camera())));
    assert_eq!(cache.bytes(), 3 * one);
    assert!(cache.entries().iter().all(|e| e.id != ids[1]), "the idle reference is still there");
    assert_eq!(cache.evicted(), 1);
    const { assert!(ReferenceFrame::BYTES_PER_PIXEL <= 20) };
}

#[test]
fn selection_takes_the_reference_that_covers_most_first() {
    let tracer = room_tracer(false, false);
    let mut cache = ReferenceCache::new(tracer.scene(), 1 << 30);
    let away = Camera { yaw: room_camera().yaw + 2.5, ..room_camera() };
    cache.insert(Arc::new(reference(&tracer, &away)));
    let near = cache.insert(Arc::new(reference(&tracer, &moved(&room_camera(), 0.05, 0.0))));
    let view = View::new(&room_camera(), &tracer.scene().frame, SIZE);
    let chosen = ReferenceSelector::default().select(&mut cache, &view, tracer.epoch(), 4);
    assert_eq!(chosen.first().map(|c| c.id), Some(near));
}

#[test]
fn a_walk_adds_references_only_above_its_threshold() {
    let tracer = Arc::new(room_tracer(true, false));
    let placement = PlacementPolicy::new(&THRESHOLD, 5.0);
    let settings = WalkthroughSettings { render: settings(Mode::Paper), placement, ..Default::default() };
    let mut walk = Walkthrough::new(tracer.clone(), settings);
    let mut added = 0;
    for i in 0..12 {
        let camera = moved(&room_camera(), 0.08 * f64::from(i), 0.02 * f64::from(i));
        let type3 = walk.render(&camera, SIZE, NEVER).stats.types.percentages().type3_percent;
        assert_eq!(walk.wanted_reference().is_some(), type3 > 5.0);
        if let Some(wanted) = walk.wanted_reference() {
            let made = walk.reference_job(wanted, SIZE).trace(NEVER).unwrap();
            assert!(made.is_dense(), "the paper's references light every pixel");
            walk.insert(made);
            added += 1;
            let again = walk.render(&camera, SIZE, NEVER).stats.types.percentages().type3_percent;
            assert!(again < 1.0, "a reference at the viewer's own pose leaves {again} %");
        }
    }
    assert!((1..12).contains(&added), "{added} references");
}

#[test]
fn poisoned_pixels_and_points_behind_the_eye_are_left_out() {
    let view = View::new(&room_camera(), &room_tracer(false, false).scene().frame, SIZE);
    let warp = PixelWarp::new(&view, &view);
    for bad in [f32::NAN, f32::NEG_INFINITY, -1.0] {
        assert_eq!(warp.target(5, 5, bad), None);
    }
    let frame = room_tracer(false, false).scene().frame;
    let turned = View::new(&Camera::look_at(dvec(0.2, 1.5, 3.5), dvec(0.2, 1.5, 9.0), 65.0), &frame, SIZE);
    let behind = PixelWarp::new(&view, &turned);
    assert!((0..SIZE[0]).all(|x| behind.target(x, 30, 0.01).is_none()));
}

#[test]
fn unknown_pixels_take_the_mean_of_the_known_around_them() {
    use afterimage::raster::fill::fill_unknown;
    // So dim that all pixels have the same weight.
    const DIM: f32 = 1e-5;
    // Odd sizes, so that the border cuts cells of the coarser levels.
    let (width, height) = (7, 5);
    let before: Vec<Vec3> = (0..width * height).map(|i| Vec3::splat(i as f32 * DIM)).collect();
    let mut known = vec![true; width * height];
    for hole in [0, 1, 7, 16, 34] {
        known[hole] = false;
    }
    let mut after = before.clone();
    fill_unknown(&mut after, &known, width, &mut Vec::new());
    assert!((0..before.len()).filter(|&i| known[i]).all(|i| after[i] == before[i]));
    // Of the square {0, 1, 7, 8} only 8 is known, and the squares next to it have the means 6 and
    // 18; that of 16 has 64 / 3. Pixel 34 is a square by itself, so its square of four by four, cut
    // to {18, .., 34}, and those around it decide.
    let expected = [(0, 8.0), (1, 8.0 * 0.75 + 6.0 * 0.25), (7, 8.0 * 0.75 + 18.0 * 0.25), (16, 17.0)];
    assert!(expected.iter().all(|&(hole, value)| (after[hole].x / DIM - value).abs() < 0.01), "{after:?}");
    assert!(after[34].x > 8.0 * DIM && after[34].x < 34.0 * DIM);
    let mut nothing = vec![Vec3::ONE; 6];
    fill_unknown(&mut nothing, &[false; 6], 3, &mut Vec::new());
    assert_eq!(nothing, [Vec3::ONE; 6]);
}

#[test]
fn a_stopped_frame_says_so_and_has_no_holes() {
    use std::sync::atomic::{AtomicUsize, Ordering};
    let tracer = room_tracer(false, false);
    let reference = reference(&tracer, &room_camera());
    let camera = moved(&room_camera(), 0.6, 0.3);
    let mut renderer = Renderer::default();
    let asked = AtomicUsize::new(0);
    let stop = || asked.fetch_add(1, Ordering::Relaxed) >= 2;
    let settings = settings(Mode::Paper);
    let request = FrameRequest::new(&tracer, &camera, SIZE, &settings).with_stop(&stop);
    let frame = renderer.render(&request.warping(&[&reference]));
    assert!(!frame.stats.is_complete);
    assert_eq!(frame.stats.types.total(), frame.view.pixel_count());
    assert!(frame.radiance.iter().filter(|r| r.max_element() > 0.0).count() * 10 > 9 * frame.radiance.len());
}

#[test]
fn a_predicted_reference_stands_ahead_and_only_where_it_is_worth_a_frame() {
    use afterimage::reference::Observation;
    let tracer = room_tracer(false, false);
    let previous = room_camera();
    let camera = moved(&previous, 0.1, 0.05);
    let seen = |open_percent: f64, previous: Camera, held: usize| Observation {
        camera,
        previous,
        open_percent,
        is_sparse: false,
        was_cut: false,
        held,
    };
    let decide = |percent: f64, seen: &Observation, foreseen: f64| {
        PlacementPolicy::new(&PREDICTIVE, percent).decide(seen, SIZE, &tracer, &mut |_, _| foreseen)
    };
    for percent in [5.0, 40.0] {
        let quiet = seen(percent, previous, 3);
        assert_eq!(decide(percent, &quiet, 100.0), None, "at the threshold no reference is wanted");
        let open = seen(percent + 25.0, previous, 3);
        let ahead = decide(percent, &open, percent + 25.0).unwrap();
        assert!((ahead.eye - camera.eye).dot(camera.forward()) > 0.2 && ahead.yaw > camera.yaw, "{ahead:?}");
        assert_eq!(decide(percent, &open, 0.0), Some(camera), "the references suffice ahead but not here");
    }
    let little = seen(8.0, previous, 3);
    assert_eq!(decide(5.0, &little, 8.0), None, "not worth a frame while moving");
    assert_eq!(decide(5.0, &seen(8.0, camera, 3), 8.0), Some(camera), "worth it at rest");
    assert_eq!(
        decide(5.0, &seen(100.0, previous, 0), 100.0),
        Some(camera),
        "the first stands where the viewer is"
    );
    // Walking towards a wall: the pose ahead stays in the room.
    let fast = seen(90.0, moved(&camera, -3.0, 0.0), 1);
    let ahead = decide(5.0, &fast, 90.0).unwrap();
    assert!(ahead.eye.z > -4.0, "{:?}", ahead.eye);
}
