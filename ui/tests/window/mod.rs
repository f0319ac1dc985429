//! The real app with its real threads on a small scene, driven by events.

mod accessible;
mod adapter;
mod choosing;
mod comparing;
mod daylight;
mod desk;
mod disk;
mod document;
mod driving;
mod dropping;
mod editing;
mod films;
mod idle;
mod inspect;
mod keyboard;
mod keys;
mod lighting;
mod measured;
mod moving;
mod navigation;
mod persistence;
mod picking;
mod pictures;
mod pixels;
mod real;
mod room;
mod section;
mod storm;
mod strangers;
mod threads;
mod timewarp;
mod unsaved_changes;

use afterimage::render::Mode;
use afterimage::scene::GroundChoice;
use afterimage::trace::TraceSettings;
use afterimage::{Camera, Scene};
use afterimage_ui::window::{App, LaunchOptions, SceneSource};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use std::io::Write;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Deadline that is never reached, even on a busy machine.
const DEADLINE: Duration = Duration::from_secs(240);

fn small_room() -> Arc<Scene> {
    Arc::new(room::room("room").expect("the room is sound"))
}

fn request() -> LaunchOptions {
    let mut request = LaunchOptions {
        scene: Some(SceneSource::Ready(small_room())),
        threads: Some(2),
        // A dialog of the system cannot be driven from here.
        has_own_file_list: true,
        ..LaunchOptions::default()
    };
    // The tests of daylight have a ground; others count the triangles of their models.
    request.daylight.ground = Some(GroundChoice::Off);
    // Direct light: most tests are about the window, not about what it shows.
    request.settings.render.trace = TraceSettings { samples: 1, bounces: 0, seed: 0 };
    // In this mode most pixels of a frame at rest are of Type 1.
    request.settings.render.mode = Mode::Paper;
    request
}

/// The app in a window of 900 x 600 without a graphics adapter, with its first frame complete.
fn app() -> Harness<'static, App> {
    open(request(), false)
}

/// The same, with pictures saved in a folder.
fn app_saving_to(pictures: PathBuf) -> Harness<'static, App> {
    open(LaunchOptions { pictures: Some(pictures), ..request() }, false)
}

/// The same with a graphics adapter; `None`, with a message, where there is none.
fn app_with_graphics() -> Option<Harness<'static, App>> {
    if has_adapter() {
        return Some(open(request(), true));
    }
    let is_required = std::env::var("AFTERIMAGE_REQUIRE_GRAPHICS").is_ok_and(|v| v == "1");
    assert!(!is_required, "no graphics adapter");
    // Printed past the test runner, which captures the output of passing tests.
    writeln!(std::io::stderr(), "skipped: no graphics adapter").expect("stderr");
    None
}

fn has_adapter() -> bool {
    use wgpu::{Backends, Instance, InstanceDescriptor};
    let instance = Instance::new(InstanceDescriptor::new_without_display_handle_from_env());
    !pollster::block_on(instance.enumerate_adapters(Backends::all())).is_empty()
}

fn open(request: LaunchOptions, with_graphics: bool) -> Harness<'static, App> {
    let mut harness = begin(request, with_graphics);
    settle(&mut harness);
    harness
}

/// The app as it is opened, before its scene is loaded.
fn begin(request: LaunchOptions, with_graphics: bool) -> Harness<'static, App> {
    let builder =
        Harness::builder().with_size([900.0, 600.0]).with_step_dt(1.0 / 60.0).with_render_cursor(false);
    let builder = if with_graphics { builder.wgpu() } else { builder };
    builder.build_eframe(move |cc| App::new(cc, request).expect("the threads start"))
}

/// Steps until a condition holds.
fn step_until(harness: &mut Harness<'static, App>, what: &str, holds: impl Fn(&App) -> bool) {
    let start = Instant::now();
    harness.step();
    while !holds(harness.state()) {
        assert!(
            start.elapsed() < DEADLINE,
            "timed out waiting for: {what}; {:?}",
            harness.state().state().work
        );
        // The threads need the processor more than the window does.
        std::thread::yield_now();
        harness.step();
    }
}

/// Steps until the newest request is shown and complete, and no reference is being traced or about
/// to be.
fn settle(harness: &mut Harness<'static, App>) {
    step_until(harness, "a complete frame", is_settled);
}

fn is_settled(app: &App) -> bool {
    let threads = app.threads();
    // Read before the generation: a finished reference raises the generation before it no longer
    // counts as being added.
    let may_add = threads.may_add_reference();
    app.loading().is_none()
        && !may_add
        && app
            .state()
            .frame
            .as_ref()
            .is_some_and(|f| f.generation == threads.generation() && f.stats.is_complete)
}

/// Shows a tab of the side panel.
fn show_tab(harness: &mut Harness<'static, App>, title: &str) {
    harness.get_by_role_and_label(egui::accesskit::Role::Tab, title).click_accesskit();
    harness.run_steps(3);
}

fn generation(harness: &Harness<'static, App>) -> u64 {
    harness.state().state().frame.as_ref().map_or(0, |f| f.generation)
}

fn held(harness: &Harness<'static, App>) -> usize {
    harness.state().state().references_used_and_held()[1]
}

fn camera(harness: &Harness<'static, App>) -> Camera {
    *harness.state().state().navigation.fly.camera()
}

/// True where a message with this text is shown.
fn says(app: &App, text: &str) -> bool {
    app.state().notices.iter().any(|notice| notice.text.contains(text))
}

/// True where the window sends this command to the desktop.
fn sends(window: &Harness<'static, App>, wanted: &egui::ViewportCommand) -> bool {
    window.output().viewport_output.values().any(|viewport| viewport.commands.contains(wanted))
}

fn viewport_centre(harness: &Harness<'static, App>) -> egui::Pos2 {
    harness.get_by_label("3D viewport").rect().center()
}
