//! The app of the window.

use crate::window::app::canvas::Canvas;
use crate::window::app::comparison::update_comparison;
use crate::window::app::open_scene::{hold_close, open, open_session};
use crate::window::app::persistence::{autosave, end_autosave, read_state_folder};
use crate::window::app::poll::poll;
use crate::window::app::render_request::{current_work, send_request};
use crate::window::app::services::Services;
use crate::window::app::session::{Arrival, MOTION_TIME, Session};
use crate::window::app::session_file::is_session;
use crate::window::app::update::{apply, show_appearance};
use crate::window::gpu::adapter;
use crate::window::input::commands::key_commands;
use crate::window::input::pointer::{Input, steer};
use crate::window::panels;
use crate::window::rendering::render_thread::RenderThread;
use crate::window::rendering::scene_loading::SceneSource;
use crate::window::rendering::task::Wake;
use crate::window::request::WindowRequest;
use crate::window::state::{AppState, Command, Severity, Work};
use afterimage::Camera;
use glam::DVec3;
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// The app of the window: shows panels and frames, and applies commands.
pub struct App {
    state: AppState,
    session: Session,
    services: Services,
    input: Input,
}

impl App {
    /// Starts the threads, and starts to load the scene.
    ///
    /// # Errors
    /// Where the system refuses to start the threads.
    pub fn new(cc: &eframe::CreationContext<'_>, mut launch: WindowRequest) -> anyhow::Result<Self> {
        panels::widgets::install_style(&cc.egui_ctx);
        let ctx = cc.egui_ctx.clone();
        // Not request_repaint(), which paints two frames per call.
        let wake: Wake = Arc::new(move || ctx.request_repaint_after(Duration::from_millis(1)));
        let mut state = AppState::new(launch.settings, Camera::look_at(DVec3::ZERO, DVec3::NEG_Z, 60.0));
        state.quality.exposure_ev = launch.exposure_ev.unwrap_or(state.quality.exposure_ev);
        state.quality.tone_map = launch.tone_map;
        state.default_quality = state.quality;
        state.picture.settings = launch.picture.clone();
        state.files.settings_file.clone_from(&launch.settings_file);
        if let Some(folder) = &launch.state_folder {
            read_state_folder(&mut state, folder);
        }
        for warning in std::mem::take(&mut launch.warnings) {
            state.error(warning);
        }
        let graphics_errors = Arc::new(Mutex::new(Vec::new()));
        let graphics = cc.wgpu_render_state.clone();
        state.software_adapter = graphics.as_ref().and_then(|g| adapter::prepare(g, &graphics_errors, &wake));
        let all = || std::thread::available_parallelism().map_or(1, usize::from);
        let threads = launch.threads.unwrap_or_else(all);
        let arrival = Arrival {
            camera: launch.camera,
            view: launch.view.clone(),
            fov_y_deg: launch.fov_y_deg,
            ..Arrival::default()
        };
        let mut session = Session::new(arrival);
        let mut services = Services {
            render: RenderThread::start(threads, wake.clone())?,
            threads,
            launch,
            ctx: cc.egui_ctx.clone(),
            wake,
            graphics,
            graphics_errors,
            loading: None,
            edit: None,
            export: None,
            full_trace: None,
            measurement: None,
            plan: None,
            file_dialog: None,
            watch: None,
            tasks: Vec::new(),
        };
        show_appearance(&mut state, &services, services.launch.appearance);
        match services.launch.scene.clone().unwrap_or_else(SceneSource::default_builtin) {
            SceneSource::File { path, .. } if is_session(&path) => {
                open_session(&mut state, &mut session, &mut services, path);
            }
            scene => open(&mut state, &mut services, scene),
        }
        if services.loading.is_none() {
            open(&mut state, &mut services, SceneSource::default_builtin());
        }
        Ok(Self { state, session, services, input: Input::default() })
    }

    /// Returns what the window shows.
    pub fn state(&self) -> &AppState {
        &self.state
    }

    /// Returns the render thread.
    pub fn threads(&self) -> &RenderThread {
        &self.services.render
    }

    /// Returns the scene that is being loaded, if any.
    pub fn loading(&self) -> Option<&SceneSource> {
        self.services.loading.as_ref().map(|loading| &loading.source)
    }

    /// Shows menu, side panel and viewport; returns the viewport's response and canvas.
    fn show_panels(&mut self, ui: &mut egui::Ui, commands: &mut Vec<Command>) -> (egui::Response, Canvas) {
        let state = &mut self.state;
        if state.options.shows_panels {
            let bare = egui::Frame::side_top_panel(ui.style()).fill(egui::Color32::TRANSPARENT);
            let menu = egui::Panel::top("menu").frame(bare);
            menu.show(ui, |ui| panels::menu::show(ui, state, commands));
            let side = egui::Panel::right("side").frame(bare).default_size(300.0).size_range(260.0..=460.0);
            side.show(ui, |ui| panels::side::show(ui, state, commands));
        }
        egui::CentralPanel::no_frame().show(ui, |ui| Canvas::allocate(ui, state)).inner
    }

    /// Shows messages and dialogs over the viewport.
    fn show_dialogs(&self, ui: &egui::Ui, viewport: egui::Rect, commands: &mut Vec<Command>) {
        let (state, ctx) = (&self.state, &self.services.ctx);
        if ctx.input(|i| !i.raw.hovered_files.is_empty()) {
            panels::notices::drop_hint(ui, viewport);
        }
        panels::notices::show(ctx, viewport, state, commands);
        if state.dialogs.shows_settings {
            panels::files::settings(ctx, state, commands);
        }
        if state.picture.is_open {
            panels::picture::show(ctx, state, commands);
        }
        if let Some(exporting) = &state.picture.exporting {
            panels::picture::progress(ctx, viewport, exporting, commands);
        }
        if state.options.shows_help {
            panels::help::show(ctx, state, commands);
        }
        panels::questions::show(ctx, state, commands);
    }

    /// Asks for later updates: a word or a message may change without any event.
    fn request_updates(&mut self) {
        let ctx = &self.services.ctx.clone();
        if let Some(rest) = autosave(&self.state, &mut self.session, &mut self.services) {
            ctx.request_repaint_after(rest);
        }
        if self.state.work == Work::Moving {
            ctx.request_repaint_after(MOTION_TIME);
        }
        if self.state.notices.iter().any(|n| n.severity == Severity::Info) {
            ctx.request_repaint_after(Duration::from_secs(1));
        }
    }
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        poll(&mut self.state, &mut self.session, &mut self.services);
        hold_close(&mut self.state, &mut self.session, &self.services);
        self.state.note_window_secs(ui.ctx().input(|i| i.unstable_dt));
        self.state.work = current_work(&self.state, &self.session, &self.services);
        let mut commands =
            key_commands(&self.state, &mut self.input, self.session.obstacles.as_ref(), ui.ctx());
        let (response, canvas) = self.show_panels(ui, &mut commands);
        panels::comparison::split_line(ui, response.rect, &self.state, &mut commands);
        steer(&mut self.state, &mut self.input, self.session.obstacles.as_ref(), &response);
        self.show_dialogs(ui, response.rect, &mut commands);
        for command in commands {
            apply(&mut self.state, &mut self.session, &mut self.services, command);
        }
        update_comparison(&mut self.state, &self.session, &mut self.services);
        canvas.draw(&self.state, self.services.graphics.is_some(), self.session.first_generation);
        send_request(&mut self.state, &mut self.session, &self.services);
        self.request_updates();
    }

    /// Returns the background of the panels. Clearing the window costs nothing, and a filled panel much on
    /// a software rasteriser: egui's shader divides 24 times per pixel.
    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        let is_srgb = self.services.graphics.as_ref().is_some_and(|g| g.target_format.is_srgb());
        match visuals.panel_fill {
            fill if is_srgb => egui::Rgba::from(fill).to_array(),
            fill => fill.to_normalized_gamma_f32(),
        }
    }

    fn on_exit(&mut self) {
        self.services.loading = None;
        if let Some(export) = self.services.export.take() {
            export.cancel_and_wait();
        }
        end_autosave(&self.services);
        self.services.render.stop();
    }
}
