//! Frames stopped at a time budget: they are resumed to the same bits, and show the most important
//! pixels first.

use crate::rooms::{room_camera, room_tracer};
use afterimage::{
    Camera, Mode, RenderSettings, Tracer, Walkthrough, WalkthroughSettings, reference::PlacementPolicy,
    reference::placement::NONE, trace::TraceSettings, trace::parallel::NEVER,
};
use glam::Vec3;
use std::{
    sync::Arc,
    sync::atomic::{AtomicUsize, Ordering},
};

const SIZE: [u32; 2] = [45, 27];
const MODES: [Mode; 4] = [Mode::Full, Mode::Paper, Mode::Fast, Mode::Exact];

/// A walk that holds a reference a step behind the room's camera.
fn walk(tracer: &Arc<Tracer>, mode: Mode) -> Walkthrough {
    let trace = TraceSettings { samples: 4, bounces: 0, seed: 9 };
    let settings = WalkthroughSettings {
        render: RenderSettings { mode, trace },
        placement: PlacementPolicy::new(&NONE, 0.0),
        ..WalkthroughSettings::default()
    };
    let mut walk = Walkthrough::new(tracer.clone(), settings).progressive();
    let step_back = Camera { eye: room_camera().eye - room_camera().forward() * 0.2, ..room_camera() };
    let reference = walk.reference_job(step_back, SIZE).trace(NEVER).unwrap();
    walk.insert(reference).unwrap();
    walk
}

/// A stop condition that is true after a number of pixels.
fn stop_after(pixels: &AtomicUsize) -> bool {
    pixels.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |n| n.checked_sub(1)).is_err()
}

#[test]
fn a_frame_that_was_stopped_and_resumed_has_the_bits_of_one_that_was_not() {
    let tracer = Arc::new(room_tracer(true, true));
    for mode in MODES {
        let mut whole = walk(&tracer, mode);
        whole.render(&room_camera(), SIZE, NEVER);
        let mut cut = walk(&tracer, mode);
        let mut pieces = 1;
        let pixels = AtomicUsize::new(40);
        cut.render(&room_camera(), SIZE, &|| stop_after(&pixels));
        while cut.can_resume() {
            pixels.store(40, Ordering::Relaxed);
            cut.resume(&|| stop_after(&pixels));
            pieces += 1;
        }
        let (cut, whole) = (cut.frame(), whole.frame());
        assert!(pieces > 3, "{mode:?} was done in {pieces} pieces");
        assert!(cut.stats.is_complete);
        assert!(cut.radiance == whole.radiance, "{mode:?}");
        assert!(cut.types == whole.types && cut.triangle == whole.triangle, "{mode:?}");
        assert_eq!(cut.stats.rays, whole.stats.rays, "{mode:?}");
    }
}

#[test]
fn a_stopped_frame_is_close_to_the_complete_one_where_it_is_not_done() {
    let tracer = Arc::new(room_tracer(true, true));
    let mut were_cut = 0;
    // The other modes know no surface where they are not done, so one sample of a lamp spreads to
    // all pixels around it.
    for mode in [Mode::Fast, Mode::Exact] {
        let mut walk = walk(&tracer, mode);
        let pixels = AtomicUsize::new(SIZE[0] as usize * SIZE[1] as usize / 8);
        let cut = walk.render(&room_camera(), SIZE, &|| stop_after(&pixels));
        were_cut += u32::from(!cut.stats.is_complete);
        let cut = cut.radiance.clone();
        let whole = &walk.resume(NEVER).radiance;
        // Without the lamp, whose few pixels would outweigh all others.
        let lit: Vec<usize> = (0..whole.len()).filter(|&i| whole[i].max_element() < 1.0).collect();
        let error = |shown: &dyn Fn(usize) -> Vec3| -> f32 {
            lit.iter().map(|&i| (shown(i).min(Vec3::ONE) - whole[i]).length_squared()).sum()
        };
        // A black picture is off by all of its light. In a picture this small, most of what is not
        // done is mirror and glass.
        let (shown, black) = (error(&|i| cut[i]), error(&|_| Vec3::ZERO));
        assert!(shown < 0.75 * black, "{mode:?}: {shown} of {black}");
    }
    assert!(were_cut >= 1, "no frame was stopped, so nothing was tested");
}

#[test]
fn a_frame_is_not_resumed_after_a_change() {
    let tracer = Arc::new(room_tracer(true, false));
    let mut cut = walk(&tracer, Mode::Exact);
    cut.render(&room_camera(), SIZE, &|| true);
    assert!(cut.can_resume());
    let before = cut.frame().radiance.clone();
    cut.cache_mut().clear();
    assert!(!cut.can_resume());
    assert!(cut.resume(NEVER).radiance == before);
    cut.render(&room_camera(), SIZE, &|| true);
    assert!(cut.can_resume());
    cut.set_tracer(Arc::new(room_tracer(false, false)));
    assert!(!cut.can_resume());
    assert!(cut.resume(NEVER).radiance.is_empty(), "another scene's pixels are gone");
}
