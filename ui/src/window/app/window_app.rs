//! The app of the window.

use super::{
    Arrival, Canvas, Choosing, CurrentScene, FloorWatch, MOTION_TIME, OwnWrites, Parts, Services, apply,
    autosave, current_work, end_autosave, hold_close, is_session, open, open_model, open_session,
    paste_picked, poll, read_state_folder, send_request, show_appearance, update_comparison,
};
use crate::window::gpu::adapter;
use crate::window::input::{Input, key_commands, steer};
use crate::window::launch::LaunchOptions;
use crate::window::panels::{
    self,
    regions::{self, Region},
};
use crate::window::rendering::{RenderThread, SceneSource, Wake};
use crate::window::state::{AppState, Command, Quality, Severity, Work};
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// The app of the window: shows panels and frames, and applies commands.
pub struct App {
    parts: Parts,
    input: Input,
    /// Title of the window, as it was set last.
    title: String,
}

/// Shows what there is to say about the start of the program.
fn say_at_start(state: &mut AppState, launch: &mut LaunchOptions) {
    for warning in std::mem::take(&mut launch.warnings) {
        state.error(warning);
    }
    if let Some(note) = launch.store_note() {
        state.info(note);
    }
}

/// Where the program was asked to start.
fn first_arrival(launch: &LaunchOptions) -> Arrival {
    Arrival {
        camera: launch.camera,
        view: launch.view.clone(),
        fov_y_deg: launch.fov_y_deg,
        ..Arrival::default()
    }
}

/// Opens what the program was started with, or the embedded scene.
fn open_first(app: &mut Parts) {
    match app.services.launch.scene.clone().unwrap_or_else(SceneSource::default_builtin) {
        SceneSource::File { path, .. } if is_session(&path) => open_session(app, path),
        scene => open_model(app, scene),
    }
    if app.services.loading.is_none() {
        open(app, SceneSource::default_builtin());
    }
}

impl App {
    /// Starts the threads, and starts to load the scene.
    ///
    /// # Errors
    /// Where the system refuses to start the threads.
    pub fn new(cc: &eframe::CreationContext<'_>, mut launch: LaunchOptions) -> anyhow::Result<Self> {
        panels::widgets::install_style(&cc.egui_ctx);
        let ctx = cc.egui_ctx.clone();
        // Not request_repaint(), which paints two frames per call.
        let wake: Wake = Arc::new(move || ctx.request_repaint_after(Duration::from_millis(1)));
        let quality = Quality {
            walk: launch.settings,
            keeps_improving: launch.keeps_improving,
            exposure: launch.exposure.unwrap_or_default(),
            tone_map: launch.tone_map,
            ..Quality::default()
        };
        let mut state = AppState { quality, default_quality: quality, ..AppState::default() };
        state.picture.settings = launch.picture.clone();
        state.files.settings_file.clone_from(&launch.settings_file);
        if let Some(folder) = &launch.state_folder {
            read_state_folder(&mut state, folder);
        }
        say_at_start(&mut state, &mut launch);
        let graphics_errors = Arc::new(Mutex::new(Vec::new()));
        let graphics = cc.wgpu_render_state.clone();
        state.software_adapter = graphics.as_ref().and_then(|g| adapter::prepare(g, &graphics_errors, &wake));
        let all = || std::thread::available_parallelism().map_or(1, usize::from);
        let threads = launch.threads.unwrap_or_else(all);
        let arrival = first_arrival(&launch);
        let services = Services {
            render: RenderThread::start(threads, wake.clone(), launch.store.clone())?,
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
            measured_pair: None,
            plan: None,
            outline: None,
            baking: None,
            floor: FloorWatch::default(),
            choosing: Choosing::default(),
            watch: None,
            own_writes: OwnWrites::default(),
            light: None,
            overcast: None,
            plane: None,
            tasks: Vec::new(),
            saving: None,
            ended: Arc::default(),
        };
        show_appearance(&mut state, &services, services.launch.appearance);
        let mut parts = Parts { state, current: CurrentScene::new(arrival), services };
        open_first(&mut parts);
        Ok(Self { parts, input: Input::default(), title: String::new() })
    }

    /// Returns what the window shows.
    pub fn state(&self) -> &AppState {
        &self.parts.state
    }

    /// Returns a flag that ends the program without a question, as the system does. What is not
    /// saved is kept, and offered at the next start.
    pub fn ended(&self) -> Arc<AtomicBool> {
        self.parts.services.ended.clone()
    }

    /// Returns the render thread.
    pub fn threads(&self) -> &RenderThread {
        &self.parts.services.render
    }

    /// Returns the scene that is being loaded, if any.
    pub fn loading(&self) -> Option<&SceneSource> {
        self.parts.services.loading.as_ref().map(|loading| &loading.source)
    }

    /// Shows menu, side panel and viewport; returns the viewport's response and canvas.
    fn show_panels(&mut self, ui: &mut egui::Ui, commands: &mut Vec<Command>) -> (egui::Response, Canvas) {
        let state = &mut self.parts.state;
        if state.options.shows_panels {
            let bare = egui::Frame::side_top_panel(ui.style()).fill(egui::Color32::TRANSPARENT);
            let menu = egui::Panel::top("menu").frame(bare);
            let bar = menu.show(ui, |ui| panels::menu::show(ui, state, commands));
            regions::note_rect(ui.ctx(), Region::Menu, bar.response.rect);
            let side = egui::Panel::right("side").frame(bare).default_size(300.0).size_range(260.0..=460.0);
            let toolbar = egui::Panel::top("toolbar").frame(bare);
            toolbar.show(ui, |ui| panels::toolbar::show(ui, state, commands));
            side.show(ui, |ui| panels::side::show(ui, state, commands));
        }
        let (response, canvas) =
            egui::CentralPanel::no_frame().show(ui, |ui| Canvas::allocate(ui, state)).inner;
        regions::note(&response, Region::Viewport);
        (response, canvas)
    }

    /// Shows messages and dialogs over the viewport.
    fn show_dialogs(&self, ui: &egui::Ui, viewport: egui::Rect, commands: &mut Vec<Command>) {
        let (state, ctx) = (&self.parts.state, &self.parts.services.ctx);
        if ctx.input(|i| !i.raw.hovered_files.is_empty()) {
            panels::notices::drop_hint(ui, viewport);
        }
        panels::overlay::banner(ctx, viewport, state);
        panels::notices::show(ctx, viewport, state, commands);
        if state.dialogs.shows_settings {
            panels::settings::show(ctx, state, commands);
        }
        if state.picture.is_open {
            panels::picture::dim_outside(ui, viewport, state);
            panels::picture::show(ctx, state, commands);
        }
        if let Some(exporting) = &state.picture.exporting {
            panels::picture::progress(ctx, viewport, state, exporting, commands);
        }
        if state.options.shows_help {
            panels::help::show(ctx, state, commands);
        }
        panels::file_list::show(ctx, state, commands);
        panels::questions::show(ctx, state, commands);
        panels::focus_ring::show(ctx);
    }

    /// Shows the scene and whether it has unsaved changes in the title of the window.
    fn show_title(&mut self) {
        let title = self.parts.state.title();
        if title != self.title {
            self.parts.services.ctx.send_viewport_cmd(egui::ViewportCommand::Title(title.clone()));
            self.title = title;
        }
    }

    /// Asks for later updates: a word or a message may change without any event.
    fn request_updates(&mut self) {
        let ctx = &self.parts.services.ctx.clone();
        if let Some(rest) = autosave(&mut self.parts) {
            ctx.request_repaint_after(rest);
        }
        if self.parts.state.work == Work::Moving {
            ctx.request_repaint_after(MOTION_TIME);
        }
        if self.parts.state.notices.iter().any(|n| n.severity != Severity::Error) {
            ctx.request_repaint_after(Duration::from_secs(1));
        }
    }
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        poll(&mut self.parts);
        hold_close(&mut self.parts);
        self.parts.state.note_window_secs(ui.ctx().input(|i| i.unstable_dt));
        self.parts.state.work = current_work(&self.parts);
        let mut commands =
            key_commands(&self.parts.state, &mut self.input, self.parts.current.obstacles.as_ref(), ui.ctx());
        let (response, canvas) = self.show_panels(ui, &mut commands);
        panels::comparison::explain(ui, response.rect, &self.parts.state);
        panels::comparison::split_line(ui, response.rect, &self.parts.state, &mut commands);
        steer(&mut self.parts.state, &mut self.input, self.parts.current.obstacles.as_ref(), &response);
        self.show_dialogs(ui, response.rect, &mut commands);
        for command in commands {
            apply(&mut self.parts, command);
        }
        paste_picked(&mut self.parts);
        update_comparison(&mut self.parts);
        canvas.draw(
            &self.parts.state,
            self.parts.services.graphics.as_ref(),
            self.parts.current.first_generation,
        );
        send_request(&mut self.parts);
        self.show_title();
        self.request_updates();
    }

    /// Returns the background of the panels. Clearing the window costs nothing, and a filled panel
    /// much on a software rasteriser: egui's shader divides 24 times per pixel.
    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        let is_srgb = self.parts.services.graphics.as_ref().is_some_and(|g| g.target_format.is_srgb());
        match visuals.panel_fill {
            fill if is_srgb => egui::Rgba::from(fill).to_array(),
            fill => fill.to_normalized_gamma_f32(),
        }
    }

    fn on_exit(&mut self) {
        self.parts.services.loading = None;
        if let Some(baking) = self.parts.services.baking.take() {
            // What is being written is completed.
            baking.task.cancel_and_wait();
        }
        if let Some(export) = self.parts.services.export.take() {
            export.cancel_and_wait();
        }
        // What is being saved is completed.
        for task in self.parts.services.tasks.drain(..) {
            task.cancel_and_wait();
        }
        end_autosave(&mut self.parts);
        self.parts.services.render.stop();
    }
}
