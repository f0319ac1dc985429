//! Refinement of a stationary camera's picture: the same bits however it was interrupted.

use crate::rooms::{room_camera, room_tracer};
use afterimage::render::{CONVERGED_PASSES as PASSES, render_antialiased};
use afterimage::trace::parallel::{NEVER, Stop};
use afterimage::{
    Camera, Frame, FrameRequest, Mode, RenderSettings, Renderer, Tracer, Walkthrough, WalkthroughSettings,
    math::key::Key, reference::PlacementPolicy, reference::placement::NONE, trace::TraceSettings,
};
use glam::Vec3;
use std::{
    sync::Arc,
    sync::atomic::{AtomicUsize, Ordering},
};

/// Neither side is a multiple of a tile's.
const SIZE: [u32; 2] = [45, 27];
const PIXELS: usize = 45 * 27;
const TRACE: TraceSettings = TraceSettings { samples: 1, bounces: 0, seed: 9 };

fn settings(mode: Mode) -> RenderSettings {
    RenderSettings { mode, trace: TRACE }
}

fn tracer() -> Arc<Tracer> {
    Arc::new(room_tracer(true, true))
}

/// A walk that has rendered a frame from a reference a step away.
fn walk_at_rest(tracer: &Arc<Tracer>, mode: Mode) -> Walkthrough {
    let settings = WalkthroughSettings {
        render: settings(mode),
        placement: PlacementPolicy::new(&NONE, 0.0),
        ..WalkthroughSettings::default()
    };
    let mut walk = Walkthrough::new(tracer.clone(), settings);
    let step_back = Camera { eye: room_camera().eye - room_camera().forward() * 0.2, ..room_camera() };
    let reference = walk.reference_job(step_back, SIZE).trace(NEVER).unwrap();
    walk.insert(reference).unwrap();
    walk.render(&room_camera(), SIZE, NEVER);
    walk
}

fn full(tracer: &Tracer) -> Frame {
    let settings = settings(Mode::Full);
    Renderer::default().render(&FrameRequest::new(tracer, &room_camera(), SIZE, &settings)).clone()
}

fn antialiased(tracer: &Tracer, passes: u32, stop: Stop<'_>) -> Frame {
    let (camera, settings) = (room_camera(), settings(Mode::Full));
    let request = FrameRequest::new(tracer, &camera, SIZE, &settings).with_stop(stop);
    render_antialiased(&request, passes)
}

fn converged(tracer: &Tracer) -> Frame {
    antialiased(tracer, PASSES, NEVER)
}

/// Refines until a number of pixels is done.
fn refine_pixels(walk: &mut Walkthrough, pixels: usize) -> afterimage::RefineState {
    let left = AtomicUsize::new(pixels);
    let stop = || left.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |n| n.checked_sub(1)).is_err();
    walk.refine(&stop)
}

fn pool(threads: usize) -> rayon::ThreadPool {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap()
}

#[test]
fn after_the_first_pass_the_picture_is_the_full_tracers() {
    let tracer = tracer();
    let full = full(&tracer);
    let mut walk = walk_at_rest(&tracer, Mode::Exact);
    assert!(walk.frame().radiance != full.radiance, "the frame before was looked up");
    let types = walk.frame().types.clone();
    let state = refine_pixels(&mut walk, PIXELS);
    assert_eq!((state.pass, state.of, state.is_complete), (1, PASSES, false));
    let frame = walk.frame();
    assert!(frame.radiance == full.radiance && frame.triangle == full.triangle);
    assert!(frame.disparity == full.disparity);
    assert!(frame.types == types, "the types of the looked-up frame are still shown");
    assert_eq!(frame.stats.refined, state);
    let once = antialiased(&tracer, 1, NEVER);
    assert!(once.radiance == full.radiance && once.triangle == full.triangle && once.stats.is_complete);
    assert_eq!(once.stats.rays, full.stats.rays);
}

#[test]
fn it_converges_to_the_antialiased_picture_however_it_is_interrupted() {
    let tracer = tracer();
    let converged = converged(&tracer);
    for (threads, mode, seed) in [(1, Mode::Exact, 1), (4, Mode::Exact, 2), (3, Mode::Full, 3)] {
        pool(threads).install(|| {
            let mut walk = walk_at_rest(&tracer, mode);
            let mut rounds = 0;
            loop {
                let before = walk.frame().radiance.clone();
                let pixels = (Key::of_pixel(seed, rounds).pair()[0] * 3000.0) as usize;
                let state = refine_pixels(&mut walk, pixels);
                let changed = before.iter().zip(&walk.frame().radiance).filter(|(a, b)| a != b).count();
                assert!(changed <= pixels, "{changed} pixels changed, {pixels} were traced");
                rounds += 1;
                if state.is_complete {
                    break;
                }
                assert!(rounds < 1000);
            }
            assert!(walk.frame().radiance == converged.radiance, "{threads} threads");
            assert!(rounds > 8, "{rounds} rounds");
            // A converged picture stays as it is, and costs nothing.
            let asked = AtomicUsize::new(0);
            let state = walk.refine(&|| asked.fetch_add(1, Ordering::Relaxed) > 0);
            assert!(state.is_complete && asked.into_inner() == 0);
        });
    }
    let sharp = full(&tracer);
    let differs = converged.radiance.iter().zip(&sharp.radiance).filter(|(a, b)| a != b).count();
    assert!(differs * 2 > PIXELS, "{differs} pixels changed by anti-aliasing");
}

#[test]
fn antialiasing_has_the_same_bits_at_any_number_of_threads_and_smooths() {
    let tracer = tracer();
    let trace = TraceSettings { samples: 16, ..TRACE };
    let render = |passes: u32| {
        let settings = RenderSettings { mode: Mode::Full, trace };
        render_antialiased(&FrameRequest::new(&tracer, &room_camera(), SIZE, &settings), passes)
    };
    let [one, four] = [1, 4].map(|threads| pool(threads).install(|| render(PASSES)));
    assert!(one.radiance == four.radiance && one.stats.rays == four.stats.rays);
    // Clipped as on a screen: the lamp's edge alone would outweigh all other pixels.
    let truth = downsampled(&tracer);
    let error = |radiance: &[Vec3]| -> f32 {
        let square = |(a, b): (&Vec3, &Vec3)| (a.min(Vec3::ONE) - b.min(Vec3::ONE)).length_squared();
        (truth.iter().zip(radiance).map(square).sum::<f32>() / PIXELS as f32).sqrt()
    };
    let [before, after] = [error(&render(1).radiance), error(&one.radiance)];
    assert!(after * 2.0 < before, "an error of {before} became {after}");
}

/// Each pixel as the mean of the pixels of a picture sixteen times as wide and high.
fn downsampled(tracer: &Tracer) -> Vec<Vec3> {
    let large = SIZE.map(|s| s * 16);
    let mut renderer = Renderer::default();
    let frame = renderer.render(&FrameRequest::new(tracer, &room_camera(), large, &settings(Mode::Full)));
    let mut small = vec![Vec3::ZERO; PIXELS];
    for (pixel, radiance) in frame.radiance.iter().enumerate() {
        let (x, y) = (pixel % large[0] as usize / 16, pixel / large[0] as usize / 16);
        small[y * SIZE[0] as usize + x] += *radiance / 256.0;
    }
    small
}

#[test]
fn a_new_reference_leaves_a_refined_picture_as_it_is() {
    let tracer = tracer();
    let mut walk = walk_at_rest(&tracer, Mode::Exact);
    refine_pixels(&mut walk, 2 * PIXELS + PIXELS / 3);
    let before = walk.frame().radiance.clone();
    let reference = walk.reference_job(room_camera(), SIZE).trace(NEVER).unwrap();
    walk.insert(reference).unwrap();
    let frame = walk.render(&room_camera(), SIZE, NEVER);
    assert!(frame.radiance == before);
    assert_eq!((frame.stats.refined.pass, frame.stats.references_used), (2, 2));
    walk.refine(NEVER);
    assert!(walk.frame().radiance == converged(&tracer).radiance);
}

#[test]
fn every_change_restarts_refinement() {
    let tracer = tracer();
    let turned = Camera { yaw: room_camera().yaw + 1e-6, ..room_camera() };
    let more = WalkthroughSettings {
        render: RenderSettings { mode: Mode::Exact, trace: TraceSettings { samples: 2, ..TRACE } },
        ..WalkthroughSettings::default()
    };
    let changes: [&dyn Fn(&mut Walkthrough); 4] = [
        &|walk| assert!(walk.render(&turned, SIZE, NEVER).stats.is_complete),
        &|walk| assert!(walk.render(&room_camera(), [44, 27], NEVER).stats.is_complete),
        &|walk| walk.set_settings(more),
        &|walk| walk.set_tracer(Arc::new(room_tracer(true, true))),
    ];
    for change in changes {
        let mut walk = walk_at_rest(&tracer, Mode::Exact);
        assert_eq!(refine_pixels(&mut walk, 3 * PIXELS).pass, 3);
        change(&mut walk);
        assert_eq!(refine_pixels(&mut walk, 0).pass, 0);
    }
}

#[test]
fn the_papers_picture_is_left_as_it_is() {
    let mut walk = walk_at_rest(&tracer(), Mode::Paper);
    let before = walk.frame().radiance.clone();
    assert!(walk.refine(NEVER).is_complete);
    assert!(walk.frame().radiance == before);
}

#[test]
fn a_stopped_picture_says_so_and_has_no_holes() {
    let asked = AtomicUsize::new(0);
    let stop = || asked.fetch_add(1, Ordering::Relaxed) >= PIXELS / 2;
    let frame = antialiased(&tracer(), PASSES, &stop);
    assert!(!frame.stats.is_complete);
    let lit = frame.radiance.iter().filter(|r| r.max_element() > 0.0).count();
    assert!(lit * 10 > 9 * PIXELS, "{lit} of {PIXELS} pixels show something");
}

#[test]
fn a_picture_with_bounces_gets_on_however_soon_it_is_stopped() {
    let render = RenderSettings { mode: Mode::Exact, trace: TraceSettings { bounces: 2, ..TRACE } };
    let mut walk = Walkthrough::new(tracer(), WalkthroughSettings { render, ..Default::default() });
    walk.render(&room_camera(), SIZE, NEVER);
    // Each call has time for a few pixels only, far less than a frame takes.
    let mut calls = 0;
    let passes = loop {
        let asked = AtomicUsize::new(0);
        let state = walk.refine(&|| asked.fetch_add(1, Ordering::Relaxed) >= 2);
        calls += 1;
        if state.pass > 0 || calls == 20_000 {
            break state.pass;
        }
    };
    assert!(passes > 0, "no pass after {calls} calls");
}

fn squared_error(a: &[Vec3], b: &[Vec3]) -> f32 {
    a.iter().zip(b).map(|(a, b)| (*a - *b).length_squared()).sum()
}

#[test]
fn without_end_passes_are_added_and_the_error_falls() {
    let tracer = tracer();
    let truth = antialiased(&tracer, 1024, NEVER).radiance;
    let mut walk = walk_at_rest(&tracer, Mode::Exact);
    walk.set_endless(true);
    let state = refine_pixels(&mut walk, PASSES as usize * PIXELS);
    assert_eq!((state.pass, state.of, state.is_complete), (PASSES, PASSES, false));
    assert!(walk.frame().radiance == converged(&tracer).radiance, "the planned passes have the same bits");
    let before = squared_error(&walk.frame().radiance, &truth);
    let state = refine_pixels(&mut walk, 7 * PASSES as usize * PIXELS);
    assert_eq!((state.pass, state.is_complete), (8 * PASSES, false));
    let after = squared_error(&walk.frame().radiance, &truth);
    assert!(after < before / 3.0, "{after}, before {before}");
    let radiance = walk.frame().radiance.clone();
    walk.set_endless(false);
    assert!(walk.refine(NEVER).is_complete && walk.frame().radiance == radiance, "and it can be ended");
}

#[test]
fn passes_without_end_have_the_same_bits_however_they_were_interrupted() {
    let tracer = tracer();
    let refined = |parts: &[usize], threads: usize| {
        let mut walk = walk_at_rest(&tracer, Mode::Full);
        walk.set_endless(true);
        pool(threads).install(|| parts.iter().map(|pixels| refine_pixels(&mut walk, *pixels)).last());
        walk.frame().radiance.clone()
    };
    // The first pass is the frame's.
    let all = (2 * PASSES as usize - 1) * PIXELS;
    assert!(refined(&[all], 2) == refined(&[all / 3, all / 2, all - all / 3 - all / 2], 1));
}

#[test]
fn a_picture_with_bounces_goes_on_after_its_last_stage() {
    let render = RenderSettings { mode: Mode::Exact, trace: TraceSettings { bounces: 2, ..TRACE } };
    let mut walk = Walkthrough::new(tracer(), WalkthroughSettings { render, ..Default::default() });
    walk.render(&room_camera(), [16, 16], NEVER);
    let last = walk.refine(NEVER);
    assert!(last.is_complete);
    walk.set_endless(true);
    let asked = AtomicUsize::new(0);
    let state = walk.refine(&|| asked.fetch_add(1, Ordering::Relaxed) >= 10 * 16 * 16);
    assert!(state.pass > last.pass && !state.is_complete, "{state:?}");
}
