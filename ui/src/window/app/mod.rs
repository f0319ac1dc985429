//! The app: collects input, shows the panels, and is the only one that changes anything.

pub mod canvas;
pub mod event;
pub mod inspect;
pub mod open_file;
pub mod persistence;
pub mod scene_edits;
pub mod session;
pub mod unsaved_changes;
pub mod update;

use crate::window::WindowRequest;
use crate::window::app::event::AppEvent;
use crate::window::app::persistence::Keeping;
use crate::window::app::session::is_session;
use crate::window::export::Export;
use crate::window::gpu::adapter;
use crate::window::input::keymap::Keyboard;
use crate::window::input::walking::Obstacles;
use crate::window::panels;
use crate::window::rendering::full_trace::FullTracing;
use crate::window::rendering::render_thread::{RenderRequest, RenderThread, Wake};
use crate::window::rendering::request::MOTION_TIME;
use crate::window::rendering::scene_loading::{Loader, SceneSource};
use crate::window::rendering::thumbnails::Thumbnails;
use crate::window::state::{AppState, Severity, Work};
use afterimage::Camera;
use afterimage::scene::SceneEdit;
use crossbeam_channel::{Receiver, Sender, unbounded};
use egui_wgpu::RenderState;
use glam::DVec3;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// The window's app.
pub struct App {
    pub(crate) state: AppState,
    pub(crate) threads: RenderThread,
    pub(crate) loader: Option<Loader>,
    pub(crate) keyboard: Keyboard,
    pub(crate) request: WindowRequest,
    pub(crate) wake: Wake,
    pub(crate) news: (Sender<AppEvent>, Receiver<AppEvent>),
    pub(crate) is_browsing: bool,
    /// What outlives the window.
    pub(crate) keeping: Keeping,
    /// The hash of the scene that is expected: a picture of it was opened.
    pub(crate) expected_hash: Option<String>,
    /// The picture that is being saved.
    pub(crate) export: Option<Export>,
    pub(crate) graphics: Option<RenderState>,
    /// The full tracer's picture of this view, in the making or made.
    pub(crate) tracing: Option<FullTracing>,
    pub(crate) is_measuring: bool,
    /// The first generation of the scene that is shown.
    pub(crate) scene_since: u64,
    pub(crate) meters_from: Option<u64>,
    pub(crate) trouble: Arc<Mutex<Vec<String>>>,
    pub(crate) sent: Option<RenderRequest>,
    pub(crate) viewport_size: [u32; 2],
    pub(crate) moved: Instant,
    pub(crate) obstacles: Option<Obstacles>,
    /// Where the pointer is over the viewport: right and up from its centre, -1..1.
    pub(crate) cursor: Option<[f64; 2]>,
    /// The pointer is held in the window.
    pub(crate) has_grab: bool,
    /// The look of the scene that is rendered.
    pub(crate) shown_look: Option<SceneEdit>,
    /// A scene of another look is in the making.
    pub(crate) is_editing: bool,
    /// A plan is in the making.
    pub(crate) is_planning: bool,
    /// Scenes opened so far.
    pub(crate) scenes_opened: u64,
    /// The window closes when it is asked to, whatever is not saved.
    pub(crate) may_close: bool,
    /// The control that the picture is.
    pub(crate) viewport: Option<egui::Id>,
    /// The changes of the scene that is shown were given up for the one that is loading.
    pub(crate) discards: bool,
}

impl App {
    /// Starts the threads and begins to load the scene.
    ///
    /// # Errors
    /// Where the system gives no more threads.
    pub fn new(cc: &eframe::CreationContext<'_>, request: WindowRequest) -> anyhow::Result<Self> {
        panels::install_style(&cc.egui_ctx);
        let ctx = cc.egui_ctx.clone();
        // Not request_repaint(): that paints two frames a call.
        let wake: Wake = Arc::new(move || ctx.request_repaint_after(Duration::from_millis(1)));
        let all = std::thread::available_parallelism().map_or(1, usize::from);
        let threads = RenderThread::start(request.threads.unwrap_or(all), wake.clone())?;
        let trouble = Arc::new(Mutex::new(Vec::new()));
        let mut state = AppState::new(request.settings, Camera::look_at(DVec3::ZERO, DVec3::NEG_Z, 60.0));
        state.quality.exposure_ev = request.exposure_ev.unwrap_or(state.quality.exposure_ev);
        state.quality.tone_map = request.tone_map;
        state.default_quality = state.quality;
        state.thumbnails = Some(Thumbnails::start(wake.clone())?);
        let graphics = cc.wgpu_render_state.as_ref();
        state.software_adapter = graphics.and_then(|graphics| adapter::prepare(graphics, &trouble, &wake));
        let mut app = Self {
            state,
            threads,
            loader: None,
            keyboard: Keyboard::default(),
            wake,
            news: unbounded(),
            is_browsing: false,
            keeping: Keeping::default(),
            expected_hash: None,
            export: None,
            graphics: cc.wgpu_render_state.clone(),
            tracing: None,
            is_measuring: false,
            scene_since: 0,
            meters_from: None,
            trouble,
            sent: None,
            viewport_size: [0, 0],
            moved: Instant::now(),
            obstacles: None,
            cursor: None,
            has_grab: false,
            shown_look: None,
            is_editing: false,
            is_planning: false,
            scenes_opened: 0,
            may_close: false,
            viewport: None,
            discards: false,
            request,
        };
        app.state.picture.settings = app.request.picture.clone();
        app.show_appearance(&cc.egui_ctx, app.request.appearance);
        app.state.files.settings_file.clone_from(&app.request.settings_file);
        for warning in std::mem::take(&mut app.request.warnings) {
            app.state.error(warning);
        }
        app.begin_keeping();
        let scene = app.request.scene.clone().unwrap_or_else(SceneSource::default_builtin);
        match scene {
            SceneSource::File { path, .. } if is_session(&path) => app.open_session(path),
            scene => app.open(scene),
        }
        if app.loader.is_none() {
            app.open(SceneSource::default_builtin());
        }
        Ok(app)
    }

    /// What the window knows and shows.
    pub fn state(&self) -> &AppState {
        &self.state
    }

    /// The threads behind it.
    pub fn threads(&self) -> &RenderThread {
        &self.threads
    }

    /// Threads that a renderer may use.
    pub(crate) fn thread_count(&self) -> usize {
        let all = || std::thread::available_parallelism().map_or(1, usize::from);
        self.request.threads.unwrap_or_else(all)
    }
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        let ctx = ui.ctx().clone();
        self.poll(&ctx);
        self.hold_close(&ctx);
        self.state.note_window_secs(ctx.input(|i| i.unstable_dt));
        self.state.work = self.work();
        let mut commands = self.key_commands(&ctx);
        if self.state.options.shows_panels {
            let bare = egui::Frame::side_top_panel(ui.style()).fill(egui::Color32::TRANSPARENT);
            let menu = egui::Panel::top("menu").frame(bare);
            menu.show(ui, |ui| panels::menu::show(ui, &self.state, &mut commands));
            let side = egui::Panel::right("side").frame(bare).default_size(300.0).size_range(260.0..=460.0);
            side.show(ui, |ui| panels::side(ui, &self.state, &mut commands));
        }
        let (response, canvas) = egui::CentralPanel::no_frame().show(ui, |ui| self.viewport(ui)).inner;
        panels::comparison::split_line(ui, response.rect, &self.state, &mut commands);
        self.steer(&ctx, &response);
        if ctx.input(|i| !i.raw.hovered_files.is_empty()) {
            panels::notices::drop_hint(ui, response.rect);
        }
        panels::notices::show(&ctx, response.rect, &self.state, &mut commands);
        if self.state.dialogs.shows_settings {
            panels::files::settings(&ctx, &self.state, &mut commands);
        }
        if self.state.picture.is_open {
            panels::picture::show(&ctx, &self.state, &mut commands);
        }
        if let Some(exporting) = &self.state.picture.exporting {
            panels::picture::progress(&ctx, response.rect, exporting, &mut commands);
        }
        if self.state.options.shows_help {
            panels::help::show(&ctx, &self.state, &mut commands);
        }
        panels::questions::show(&ctx, &self.state, &mut commands);
        commands.into_iter().for_each(|command| self.apply(&ctx, command));
        let graphics = self.graphics.clone();
        self.compare(graphics.as_ref());
        self.draw(canvas);
        self.send_request();
        if let Some(rest) = self.keep_session() {
            ctx.request_repaint_after(rest);
        }
        // A word or a message may change without anything else happening.
        if self.state.work == Work::Moving {
            ctx.request_repaint_after(MOTION_TIME);
        }
        if self.state.notices.iter().any(|n| n.severity == Severity::Info) {
            ctx.request_repaint_after(Duration::from_secs(1));
        }
    }

    /// The panels' ground: what the window is cleared with costs nothing, and egui's shader much on a processor (it
    /// divides 24 times a pixel).
    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        let is_srgb = self.graphics.as_ref().is_some_and(|graphics| graphics.target_format.is_srgb());
        match visuals.panel_fill {
            fill if is_srgb => egui::Rgba::from(fill).to_array(),
            fill => fill.to_normalized_gamma_f32(),
        }
    }

    fn on_exit(&mut self) {
        (self.loader, self.export) = (None, None);
        self.end_keeping();
        self.threads.stop();
    }
}
