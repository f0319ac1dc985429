//! The graphics adapter: absent, lost, or replaced by the processor.

use super::desk::Desk;
use super::*;
use afterimage_ui::window::state::Severity;
use std::sync::Mutex;

/// The app on a device that the test can destroy.
fn app_and_device() -> Option<(Harness<'static, App>, wgpu::Device, wgpu::AdapterInfo)> {
    if !has_adapter() {
        // Reports it, or fails where graphics are required.
        app_with_graphics();
        return None;
    }
    let taken = Arc::new(Mutex::new(None));
    let given = taken.clone();
    let builder = Harness::builder().with_size([900.0, 600.0]).with_step_dt(1.0 / 60.0).wgpu();
    let mut harness = builder.build_eframe(move |cc| {
        let graphics = cc.wgpu_render_state.as_ref().expect("graphics");
        *given.lock().expect("no test panics") = Some((graphics.device.clone(), graphics.adapter.get_info()));
        App::new(cc, request()).expect("the threads start")
    });
    settle(&mut harness);
    let (device, info) = taken.lock().expect("no test panics").take().expect("a device");
    Some((harness, device, info))
}

#[test]
fn a_lost_graphics_card_is_reported_with_a_remedy() {
    let Some((mut harness, device, _)) = app_and_device() else { return };
    device.destroy();
    // The system reports the loss at the next poll.
    let _ = device.poll(wgpu::PollType::Poll);
    // Frames are still rendered; each is sent to a device that is gone.
    harness.key_press(egui::Key::N);
    step_until(&mut harness, "a message", |app| says(app, "start the program again"));
    let notices = &harness.state().state().notices;
    assert!(
        notices.iter().all(|n| n.severity == Severity::Error && n.text.lines().count() == 1),
        "{notices:?}"
    );
}

#[test]
fn that_the_processor_draws_is_shown() {
    let Some((harness, _, info)) = app_and_device() else { return };
    let is_processor = info.device_type == wgpu::DeviceType::Cpu;
    assert_eq!(harness.query_by_label("no graphics card").is_some(), is_processor, "{info:?}");
    assert_eq!(harness.state().state().software_adapter, is_processor.then_some(info.name));
}

#[test]
fn without_vulkan_the_window_opens_by_opengl() {
    let none = [
        ("VK_ICD_FILENAMES", "/nonexistent"),
        ("VK_DRIVER_FILES", "/nonexistent"),
        ("WGPU_BACKEND", "vulkan,gl"),
    ];
    let Some(desk) = Desk::open_in(&none) else { return };
    desk.pose();
    desk.xdotool("key t sleep 1 key t");
    desk.wait_for_share("opengl", real::TYPE1, 0.2);
}
