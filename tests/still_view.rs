//! A view at rest, step by step: where its schedule ends, and pictures that are refined for longer.

use crate::rooms::{room_camera, room_tracer};
use afterimage::render::{CONVERGED_PASSES, StillView, TimedPicture, render_antialiased};
use afterimage::trace::{TraceSettings, parallel::NEVER};
use afterimage::{FrameRequest, Mode, RenderSettings, Tracer, WalkthroughSettings};
use glam::Vec3;
use std::{sync::Arc, time::Duration};

/// Neither side is a multiple of a tile's, and half of it is not whole.
const SIZE: [u32; 2] = [45, 27];
const LIMIT: Duration = Duration::from_secs(3600);
const TRACE: TraceSettings = TraceSettings { samples: 1, bounces: 0, seed: 9 };

fn tracer() -> Arc<Tracer> {
    Arc::new(room_tracer(true, true))
}

fn antialiased(tracer: &Tracer, seed: u64) -> Vec<Vec3> {
    let (camera, trace) = (room_camera(), TraceSettings { seed, ..TRACE });
    let settings = RenderSettings { mode: Mode::Full, trace };
    render_antialiased(&FrameRequest::new(tracer, &camera, SIZE, &settings), CONVERGED_PASSES).radiance
}

#[test]
fn a_view_at_rest_converges_to_the_antialiased_picture() {
    let tracer = tracer();
    let right = antialiased(&tracer, TRACE.seed);
    for mode in [Mode::Full, Mode::Exact] {
        let render = RenderSettings { mode, trace: TRACE };
        let settings = WalkthroughSettings { render, ..WalkthroughSettings::default() };
        let view = || StillView::new(tracer.clone(), settings, &room_camera(), SIZE);
        for (mut view, first_size) in [(view(), SIZE), (view().in_window(), [23, 14])] {
            let first = view.step(NEVER).unwrap();
            assert!(first.is_shown && view.frame().view.size == first_size, "{:?}", view.frame().view.size);
            while view.step(NEVER).is_some() {}
            assert_eq!(view.frame().view.size, SIZE);
            assert!(view.frame().radiance == right, "{mode:?}");
        }
    }
}

#[test]
fn a_picture_refined_for_longer_is_the_mean_of_independent_rounds() {
    let tracer = tracer();
    let render = RenderSettings { mode: Mode::Full, trace: TRACE };
    let mut picture = TimedPicture::new(tracer.clone(), render, (&room_camera(), SIZE), LIMIT, 0.0);
    while picture.passes() < 2 * CONVERGED_PASSES {
        assert!(picture.step(NEVER));
    }
    assert!(picture.estimated_psnr_db().is_some_and(|db| db > 10.0));
    let rounds = [TRACE.seed, TRACE.seed + (1 << 54)].map(|seed| antialiased(&tracer, seed));
    assert!(rounds[0] != rounds[1]);
    let frame = picture.into_frame();
    assert!(frame.stats.is_complete && frame.stats.refined.pass == 2 * CONVERGED_PASSES);
    for ((found, a), b) in frame.radiance.iter().zip(&rounds[0]).zip(&rounds[1]) {
        let right = (*a + *b) / 2.0;
        assert!((*found - right).length() <= 1e-5 * right.length(), "{found} {right}");
    }
}

#[test]
fn a_mode_that_is_not_refined_ends_with_its_frame() {
    let render = RenderSettings { mode: Mode::Paper, trace: TRACE };
    let mut picture = TimedPicture::new(tracer(), render, (&room_camera(), SIZE), LIMIT, 0.0);
    while picture.step(NEVER) {}
    assert_eq!((picture.passes(), picture.estimated_psnr_db()), (1, None));
}

#[test]
fn a_picture_with_bounces_is_complete_after_any_time() {
    let render = RenderSettings { mode: Mode::Exact, trace: TraceSettings { bounces: 2, ..TRACE } };
    for limit in [Duration::ZERO, LIMIT] {
        let mut picture = TimedPicture::new(tracer(), render, (&room_camera(), SIZE), limit, 0.0);
        assert!(picture.step(&|| limit.is_zero()));
        while picture.passes() < 2 && !limit.is_zero() {
            assert!(picture.step(NEVER));
        }
        picture.conclude();
        let frame = picture.into_frame();
        assert!(frame.stats.is_complete && frame.radiance.len() == frame.view.pixel_count());
        let light = frame.radiance.iter().map(|radiance| radiance.element_sum()).sum::<f32>();
        assert!(light.is_finite() && light > 0.0);
    }
}
