//! Frames while the camera moves.

use super::desk::Desk;
use super::measured::{Person, ms_of_pictures, say};
use super::*;
use afterimage::Tracer;
use afterimage::camera::View;
use afterimage_ui::window::state::Work;
use egui::Key;

/// Frames that are looked at.
const FRAMES: usize = 12;

/// Pictures of the real window that are waited for.
const PICTURES: u32 = 8;

/// One pixel in this many is compared with a ray.
const STEP: u32 = 13;

/// True where the frame in the window shows the surfaces that rays meet from its pose.
fn shows_its_surfaces(app: &App, tracer: &Tracer) -> bool {
    let Some(frame) = &app.state().frame else { return false };
    let view = View::new(&frame.camera, &frame.scene_frame, frame.size);
    let Some(([row, _], ranges)) = frame.depth_ranges.levels().next() else { return false };
    (0..frame.size[0] * frame.size[1]).step_by(STEP as usize).all(|pixel| {
        let (x, y) = (pixel % frame.size[0], pixel / frame.size[0]);
        let hit = tracer.closest(&Tracer::primary_ray(&view, pixel));
        ranges[(y * row + x) as usize][0] == hit.map_or(0.0, |hit| 1.0 / hit.t)
    })
}

#[test]
fn every_frame_in_motion_is_of_a_pose_of_the_camera_and_shows_its_surfaces() {
    let tracer = Tracer::new(small_room());
    for mode in [Mode::Exact, Mode::Fast, Mode::Full] {
        let mut request = request();
        request.settings.render.mode = mode;
        // Enough work that frames are cut.
        request.settings.render.trace = TraceSettings { samples: 16, bounces: 2, seed: 0 };
        let mut harness = begin(request, false);
        step_until(&mut harness, "a frame", |app| app.state().frame.is_some());
        let (mut poses, mut newest, mut seen) = (vec![camera(&harness)], generation(&harness), 0);
        let start = Instant::now();
        harness.key_down(Key::A);
        while seen < FRAMES {
            assert!(start.elapsed() < DEADLINE, "{mode:?}: {seen} frames in motion");
            harness.step();
            poses.push(camera(&harness));
            if generation(&harness) > newest {
                newest = generation(&harness);
                let app = harness.state();
                // On a busy machine a frame may be completed between two steps of the camera.
                seen += usize::from(app.state().work == Work::Moving);
                let of = app.state().frame.as_ref().expect("a frame").camera;
                // A pose that was left long ago would be one of a renderer that lags behind.
                assert!(poses.contains(&of), "{mode:?}: a pose that the camera never had");
                assert!(shows_its_surfaces(app, &tracer), "{mode:?}: frame {seen} at {of:?}");
            }
            std::thread::yield_now();
        }
        harness.key_up(Key::A);
        harness.step();
        let rate = harness.state().state().frame_rate.clone();
        assert!(rate.total() >= FRAMES as u64 - 2, "{rate:?}");
        say(&format!("{mode:?}: {:.0} frames per second in motion", rate.per_sec().unwrap_or(0.0)));
    }
}

/// Counts pictures, not milliseconds: other tests take their share of the machine meanwhile. The
/// rate is measured by `measured_flight`, alone on a machine.
#[test]
fn a_real_window_shows_picture_after_picture_in_motion() {
    let Some(desk) = Desk::open() else { return };
    desk.pose();
    let person = Person::at(&desk);
    let ms = ms_of_pictures(&person, PICTURES);
    say(&format!("a real window in motion: {:.1} pictures per second", 1e3 * f64::from(PICTURES) / ms));
}
