//! The window: walking through a scene while references are reused, and seeing that they are.
//!
//! The window's thread only reads input and shows the newest finished frame; it never waits for the renderer.

pub mod app;
pub mod export;
pub mod gpu;
pub mod input;
pub mod panels;
pub mod rendering;
pub mod state;

use afterimage::raster::color::ToneMap;
use afterimage::reference::PlacementPolicy;
use afterimage::render::RenderSettings;
use afterimage::trace::TraceSettings;
use afterimage::{Camera, WalkthroughSettings};
use anyhow::anyhow;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

pub use app::App;
pub use rendering::scene_loading::SceneSource;
use state::{Appearance, PictureSettings};

/// What the window is opened with.
#[derive(Clone, Debug)]
pub struct WindowRequest {
    /// The scene; the embedded gallery where none is named.
    pub scene: Option<SceneSource>,
    /// What to walk with at first.
    pub settings: WalkthroughSettings,
    /// Diffuse bounces for models from files: made for no renderer in particular, they are dark without any.
    pub model_bounces: u32,
    /// Where to start instead of at the scene's start view.
    pub camera: Option<Camera>,
    /// Start at the saved view of this name. `camera` goes before it.
    pub view: Option<String>,
    /// Vertical field of view at the start, in degrees, where it is not the view's own.
    pub fov_y_deg: Option<f64>,
    /// Exposure in stops; where nothing is said it is 0, and an opened model's is metered.
    pub exposure_ev: Option<f32>,
    /// From radiance to display.
    pub tone_map: ToneMap,
    /// Threads that render; all there are where nothing is said.
    pub threads: Option<usize>,
    /// Where pictures are saved; the current folder, or the user's pictures, where nothing is said.
    pub pictures: Option<PathBuf>,
    /// How pictures are saved at first.
    pub picture: PictureSettings,
    /// The looks of the window.
    pub appearance: Appearance,
    /// Where changed looks are kept; nowhere where nothing is said.
    pub settings_file: Option<PathBuf>,
    /// Where recent files and sessions for the case of a crash are kept; nowhere where nothing is said.
    pub state_folder: Option<PathBuf>,
    /// What is to be said at the start: settings that could not be used.
    pub warnings: Vec<String>,
}

impl Default for WindowRequest {
    fn default() -> Self {
        let trace = TraceSettings { samples: state::WINDOW_SAMPLES, ..TraceSettings::default() };
        let settings = WalkthroughSettings {
            render: RenderSettings { trace, ..RenderSettings::default() },
            placement: PlacementPolicy::default(),
            audits: true,
            ..WalkthroughSettings::default()
        };
        Self {
            scene: None,
            settings,
            model_bounces: 1,
            camera: None,
            view: None,
            fov_y_deg: None,
            exposure_ev: None,
            tone_map: ToneMap::default(),
            threads: None,
            pictures: None,
            picture: PictureSettings::default(),
            appearance: Appearance::default(),
            settings_file: None,
            state_folder: None,
            warnings: Vec::new(),
        }
    }
}

/// The Debian packages without which a window cannot be opened.
const PACKAGES: &str = "libx11-6 libx11-xcb1 libxcursor1 libxi6 libxkbcommon0 libxkbcommon-x11-0 libwayland-egl1 mesa-vulkan-drivers";

/// True where there is a display to open a window on.
pub fn has_display() -> bool {
    let is_set = |name: &str| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    cfg!(not(target_os = "linux")) || ["WAYLAND_DISPLAY", "WAYLAND_SOCKET", "DISPLAY"].into_iter().any(is_set)
}

/// Opens the window and returns when it is closed. Must be called on the program's first thread.
///
/// # Errors
/// Where there is no display, no graphics adapter or a system library is missing, with what to install.
pub fn run(request: WindowRequest) -> anyhow::Result<()> {
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
        // Its noise would be seen in the picture's flat colours, and costs time on a software adapter.
        dithering: false,
        ..Default::default()
    };
    let is_open = Arc::new(AtomicBool::new(false));
    let opened = is_open.clone();
    let create = move |cc: &eframe::CreationContext<'_>| {
        let app: Box<dyn eframe::App> = Box::new(App::new(cc, request)?);
        opened.store(true, Ordering::Release);
        Ok(app)
    };
    let open = move || eframe::run_native("Afterimage", options, Box::new(create));
    // A missing libxkbcommon-x11 is a panic in winit, not an error.
    let reason = match std::panic::catch_unwind(std::panic::AssertUnwindSafe(open)) {
        Ok(Ok(())) => return Ok(()),
        Ok(Err(error)) => error.to_string(),
        Err(panic) => rendering::render_thread::panic_text(&*panic),
    };
    Err(failure(is_open.load(Ordering::Acquire), &reason))
}

/// What the system shows for the window; nothing where it cannot be read.
fn icon() -> egui::IconData {
    let png = include_bytes!("../../../assets/desktop/afterimage.png");
    eframe::icon_data::from_png_bytes(png).unwrap_or_default()
}

/// Once it was open, nothing is missing that could be installed.
fn failure(was_open: bool, reason: &str) -> anyhow::Error {
    if was_open {
        return anyhow!("the window failed: {reason}");
    }
    anyhow!("the window cannot be opened ({reason}); on Debian or Ubuntu, install: {PACKAGES}")
}
