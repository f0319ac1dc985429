//! Opening the window, and the messages where that fails.

use crate::window::app::App;
use crate::window::launch::LaunchOptions;
use crate::window::rendering::task::panic_text;
use anyhow::anyhow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Debian packages without which a window cannot be opened.
const PACKAGES: &str = "libx11-6 libx11-xcb1 libxcursor1 libxi6 libxkbcommon0 libxkbcommon-x11-0 libwayland-egl1 mesa-vulkan-drivers";

/// True where there is a display for a window.
pub fn has_display() -> bool {
    let is_set = |name: &str| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    cfg!(not(target_os = "linux")) || ["WAYLAND_DISPLAY", "WAYLAND_SOCKET", "DISPLAY"].into_iter().any(is_set)
}

/// Opens the window and returns when it is closed. Must be called on the program's main thread.
///
/// # Errors
/// Where there is no display, no graphics adapter, or a system library is missing; the message says
/// what to install.
pub fn run(request: LaunchOptions) -> anyhow::Result<()> {
    if !has_display() {
        return Err(anyhow!(
            "there is no display (neither WAYLAND_DISPLAY nor DISPLAY is set); use `afterimage tour` or `afterimage \
             render`, which need none"
        ));
    }
    let options = eframe::NativeOptions {
        viewport: egui::ViewportBuilder::default()
            .with_title("Afterimage")
            .with_app_id("afterimage")
            .with_icon(icon())
            .with_inner_size([1280.0, 800.0])
            .with_min_inner_size([480.0, 320.0])
            .with_drag_and_drop(true),
        persist_window: false,
        // Its noise would be visible in the picture's flat colours, and costs time on a software
        // adapter.
        dithering: false,
        ..Default::default()
    };
    let is_open = Arc::new(AtomicBool::new(false));
    let opened = is_open.clone();
    let create = move |cc: &eframe::CreationContext<'_>| {
        let app = App::new(cc, request)?;
        end_on_signals(app.ended(), cc.egui_ctx.clone());
        let app: Box<dyn eframe::App> = Box::new(app);
        opened.store(true, Ordering::Release);
        Ok(app)
    };
    let open = move || eframe::run_native("Afterimage", options, Box::new(create));
    // A missing libxkbcommon-x11 is a panic in winit, not an error.
    let reason = match std::panic::catch_unwind(std::panic::AssertUnwindSafe(open)) {
        Ok(Ok(())) => return Ok(()),
        Ok(Err(error)) => error.to_string(),
        Err(panic) => panic_text(&*panic),
    };
    Err(failure(is_open.load(Ordering::Acquire), &reason))
}

/// Closes the window where the system ends the program. A second signal ends it at once.
fn end_on_signals(ended: Arc<AtomicBool>, ctx: egui::Context) {
    let handler = move || {
        if ended.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
        ctx.request_repaint();
    };
    // Where there is no handler, the session that was kept last is offered at the next start.
    let _ = ctrlc::set_handler(handler);
}

/// Returns the icon of the window; an empty one where it cannot be decoded.
fn icon() -> egui::IconData {
    let png = include_bytes!("../../assets/desktop/afterimage.png");
    eframe::icon_data::from_png_bytes(png).unwrap_or_default()
}

/// Once the window was open, no package can be missing.
fn failure(was_open: bool, reason: &str) -> anyhow::Error {
    if was_open {
        return anyhow!("the window failed: {reason}");
    }
    anyhow!("the window cannot be opened ({reason}); on Debian or Ubuntu, install: {PACKAGES}")
}
