//! The comparison with the full tracer.

use super::*;
use afterimage::FrameRequest;
use afterimage::Mode;
use afterimage::raster::rgb9e5;
use afterimage::render::render_antialiased;
use afterimage_ui::window::state::Compare;
use egui::{Key, Modifiers};

fn converged(app: &App) -> bool {
    let comparison = &app.state().comparison;
    comparison.full.as_ref().is_some_and(|full| full.stats.refined.is_complete)
        && comparison.error.is_some_and(|((_, pass, _), _)| {
            comparison.full.as_ref().is_some_and(|full| full.stats.refined.pass == pass)
        })
}

#[test]
fn the_full_tracers_picture_converges_is_measured_and_is_dropped_by_motion() {
    let mut harness = app();
    harness.key_press(Key::C);
    step_until(&mut harness, "a converged comparison", converged);
    let state = harness.state().state();
    let full = state.comparison.full.as_ref().expect("a picture");
    let frame = state.frame.as_ref().expect("a frame");
    assert_eq!((full.camera, full.size), (frame.camera, frame.size));
    let mut render = state.quality.walk.render;
    render.mode = Mode::Full;
    let passes = full.stats.refined.of;
    let tracer = afterimage::Tracer::new(small_room());
    let truth = render_antialiased(&FrameRequest::new(&tracer, &frame.camera, frame.size, &render), passes);
    let expected: Vec<u32> = truth.radiance.iter().map(|c| rgb9e5::pack(*c)).collect();
    assert!(full.radiance == expected, "it is the anti-aliased picture of the full tracer");
    let (_, error) = state.comparison.error.expect("a measure");
    assert!((10.0..60.0).contains(&error.psnr_db) && (0.0..0.5).contains(&error.flip_mean), "{error:?}");
    show_tab(&mut harness, "Method");
    assert!(harness.query_all_by_label_contains("Split at").next().is_some());
    harness.key_down(Key::D);
    harness.run_steps(3);
    harness.key_up(Key::D);
    harness.step();
    let comparison = &harness.state().state().comparison;
    assert!(comparison.full.is_none() && comparison.error.is_none(), "another view, another picture");
    harness.key_press(Key::Escape);
    settle(&mut harness);
    assert_eq!(harness.state().state().comparison.shows, Compare::Off);
}

#[test]
fn a_picture_that_is_compared_is_not_refined() {
    let mut request = request();
    request.settings.render.mode = Mode::Exact;
    let mut harness = open(request, false);
    // The full tracer traces every pixel of the window sixteen times.
    harness.set_size(egui::vec2(560.0, 400.0));
    settle(&mut harness);
    harness.key_press(Key::C);
    step_until(&mut harness, "a converged comparison", converged);
    let refined = harness.state().state().frame.as_ref().expect("a frame").stats.refined;
    assert_eq!(refined.of, 0, "it would be the full tracer's own picture");
}

/// Returns the picture's pixels of the middle row, from the centre to the right.
fn row(harness: &mut Harness<'static, App>) -> Vec<[u8; 3]> {
    let rect = harness.get_by_label("3D viewport").rect();
    let image = harness.render().expect("a picture of the window");
    let y = rect.center().y as u32 + 100;
    let columns = rect.left() as u32 + 4..rect.right() as u32 - 4;
    columns.map(|x| image.get_pixel(x, y).0).map(|[r, g, b, _]| [r, g, b]).collect()
}

#[test]
fn held_x_shows_the_other_picture_and_c_a_part_of_it() {
    let Some(mut harness) = app_with_graphics() else { return };
    harness.key_down(Key::X);
    step_until(&mut harness, "the full tracer's picture", |app| app.state().comparison.full.is_some());
    harness.run_steps(2);
    let full = row(&mut harness);
    harness.key_up(Key::X);
    // A reference may have been added meanwhile.
    settle(&mut harness);
    harness.run_steps(2);
    let own = row(&mut harness);
    harness.key_press(Key::C);
    harness.run_steps(2);
    let split = row(&mut harness);
    let half = own.len() / 2;
    let differing = |a: &[[u8; 3]], b: &[[u8; 3]]| a.iter().zip(b).filter(|(a, b)| a != b).count();
    assert!(differing(&own, &full) > half / 4, "another noise, at least");
    // The line itself, and the filtered pixels next to it.
    assert!(differing(&split[..half - 8], &own[..half - 8]) < 4, "left: the picture");
    assert!(differing(&split[half + 8..], &own[half + 8..]) > half / 8, "right: the full tracer's");
    harness.key_press_modifiers(Modifiers::SHIFT, Key::C);
    step_until(&mut harness, "a map of errors", |app| app.state().comparison.error.is_some());
    harness.run_steps(2);
    let errors = row(&mut harness);
    let dark = errors.iter().filter(|p| p[1] < 100).count();
    assert!(dark * 2 > errors.len(), "most pixels hardly differ: dark in the map");
}
