//! The app: collects input, shows the panels, and is the only one that changes anything.

use super::WindowRequest;
use super::comparing::Measured;
use super::editing::{Edited, SavedLook};
use super::export::Export;
use super::frames::locked;
use super::full_tracing::FullTracing;
use super::keeping::Keeping;
use super::keymap::Keyboard;
use super::load::{Loader, SceneSource};
use super::panels;
use super::plan::Plan;
use super::playback::Playback;
use super::presentation::Presentation;
use super::render_thread::{Message, Order, RenderThread, Wake, Wish};
use super::session::is_session;
use super::state::{Pair, SceneInfo, Severity, State, Work};
use super::thumbnails::Thumbnails;
use super::timewarp::Reprojection;
use super::viewport;
use super::walking::Obstacles;
use crate::picture::restore::PictureView;
use afterimage::scene::Look;
use afterimage::{Camera, Tracer};
use crossbeam_channel::{Receiver, Sender, unbounded};
use egui_wgpu::RenderState;
use glam::DVec3;
use std::path::PathBuf;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// After the last motion the state still says moving for so long: a drag pauses between two events.
const MOTION_TIME: Duration = Duration::from_millis(250);

/// The largest texture that every adapter takes.
const LARGEST_EDGE: f32 = 8192.0;

/// What background work of the app itself brings back.
pub(super) enum News {
    /// The file dialog was closed.
    Chosen(Option<PathBuf>),
    /// Two pictures of a size were measured.
    Measured(Pair, [u32; 2], Measured),
    /// Something failed that nobody waits for.
    Failed(String),
    /// Something was saved, or not.
    Saved(anyhow::Result<PathBuf>),
    /// The scene with a look that was asked for.
    Edited(Box<Edited>),
    /// A look was saved beside its scene, or not.
    SavedLook(Box<SavedLook>),
    /// A plan of the so-manieth scene.
    Plan(u64, Plan),
    /// A session was saved, or not.
    Session(Result<PathBuf, String>),
    /// Something was kept for the next start; only failure is told.
    Kept(Result<(), String>),
    /// The files of this model have changed.
    Changed(PathBuf),
    /// The view of a picture was read, or not.
    View(Result<PictureView, String>),
}

/// The window's app.
pub struct App {
    pub(super) state: State,
    pub(super) threads: RenderThread,
    pub(super) loader: Option<Loader>,
    pub(super) keyboard: Keyboard,
    pub(super) request: WindowRequest,
    pub(super) wake: Wake,
    pub(super) news: (Sender<News>, Receiver<News>),
    pub(super) is_browsing: bool,
    /// What outlives the window.
    pub(super) keeping: Keeping,
    /// The hash of the scene that is expected: a picture of it was opened.
    pub(super) expected_hash: Option<String>,
    /// The picture that is being saved.
    pub(super) export: Option<Export>,
    graphics: Option<RenderState>,
    /// The full tracer's picture of this view, in the making or made.
    pub(super) tracing: Option<FullTracing>,
    pub(super) is_measuring: bool,
    /// The first generation of the scene that is shown.
    scene_since: u64,
    trouble: Arc<Mutex<Vec<String>>>,
    pub(super) sent: Option<Wish>,
    pub(super) viewport_size: [u32; 2],
    moved: Instant,
    pub(super) obstacles: Option<Obstacles>,
    /// Where the pointer is over the viewport: right and up from its centre, -1..1.
    pub(super) cursor: Option<[f64; 2]>,
    /// The pointer is held in the window.
    pub(super) has_grab: bool,
    /// The look of the scene that is rendered.
    pub(super) shown_look: Option<Look>,
    /// A scene of another look is in the making.
    pub(super) is_editing: bool,
    /// A plan is in the making.
    pub(super) is_planning: bool,
    /// Scenes opened so far.
    pub(super) scenes_opened: u64,
    /// The window closes when it is asked to, whatever is not saved.
    pub(super) may_close: bool,
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
        let mut state = State::new(request.settings, Camera::look_at(DVec3::ZERO, DVec3::NEG_Z, 60.0));
        state.quality.exposure_ev = request.exposure_ev.unwrap_or(state.quality.exposure_ev);
        state.quality.tone_map = request.tone_map;
        state.default_quality = state.quality;
        state.thumbnails = Some(Thumbnails::start(wake.clone())?);
        let graphics = cc.wgpu_render_state.as_ref();
        state.software_adapter = graphics.and_then(|graphics| prepare(graphics, &trouble, &wake));
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
            request,
        };
        app.state.picture.settings = app.request.picture.clone();
        app.show_look(&cc.egui_ctx, app.request.look);
        app.state.settings_file.clone_from(&app.request.settings_file);
        for warning in std::mem::take(&mut app.request.warnings) {
            app.state.notify(Severity::Error, warning);
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
    pub fn state(&self) -> &State {
        &self.state
    }

    /// The threads behind it.
    pub fn threads(&self) -> &RenderThread {
        &self.threads
    }

    /// Threads that a renderer may use.
    pub(super) fn thread_count(&self) -> usize {
        let all = || std::thread::available_parallelism().map_or(1, usize::from);
        self.request.threads.unwrap_or_else(all)
    }

    /// Begins to load a scene; the old one stays until the new one is complete.
    pub(super) fn load(&mut self, source: SceneSource) {
        match Loader::start(source, self.wake.clone()) {
            Ok(loader) => self.loader = Some(loader),
            Err(error) => self.state.notify(Severity::Error, format!("loading cannot be started: {error}")),
        }
    }

    /// Takes in all that has happened since the last frame of the window.
    fn poll(&mut self, ctx: &egui::Context) {
        self.poll_loader();
        self.poll_export();
        let messages: Vec<Message> = self.threads.messages().collect();
        for message in messages {
            match message {
                Message::Lent(lending) => self.show_lent(ctx, &lending),
                Message::Picture(picture) => self.save_from_references(picture),
                Message::Failed(text) => self.state.notify(Severity::Error, text),
            }
        }
        let news: Vec<News> = self.news.1.try_iter().collect();
        for news in news {
            match news {
                News::Chosen(path) => {
                    self.is_browsing = false;
                    path.into_iter().for_each(|path| self.open_path(path));
                }
                News::Measured(pair, size, measured) => {
                    let graphics = self.graphics.clone();
                    self.take_measured(pair, size, measured, graphics.as_ref());
                }
                News::Failed(text) => self.state.notify(Severity::Error, text),
                News::Saved(Ok(path)) => {
                    self.state.notify(Severity::Info, format!("saved {}", path.display()));
                }
                News::Edited(edited) => self.take_edited(*edited),
                News::SavedLook(saved) => self.take_saved_look(ctx, *saved),
                News::Plan(scene, plan) => self.take_plan(scene, plan),
                News::Session(saved) => self.session_saved(saved),
                News::Kept(Ok(())) => {}
                News::Kept(Err(message)) => self.state.notify(Severity::Error, message),
                News::Changed(path) => self.reload_changed(&path),
                News::View(Ok(view)) => self.go_to_picture(view),
                News::View(Err(message)) => self.state.notify(Severity::Error, message),
                News::Saved(Err(error)) => self.state.notify(Severity::Error, format!("{error:#}")),
            }
        }
        let trouble = std::mem::take(&mut *locked(&self.trouble));
        trouble.into_iter().for_each(|text| self.state.notify(Severity::Error, text));
        if self.threads.take_frame(&mut self.state.frame) {
            if self.state.frame.as_ref().is_some_and(|f| !f.is_refinement) {
                self.state.record();
            }
            self.state.meter();
            if let (Some(graphics), Some(frame)) = (&self.graphics, &self.state.frame) {
                viewport::upload(graphics, frame);
            }
        }
        self.state.expire_notices();
        self.follow_plan();
        self.want_thumbnails(ctx);
    }

    fn poll_loader(&mut self) {
        let Some(loader) = &self.loader else {
            self.state.loading = None;
            return;
        };
        let source = loader.source().clone();
        match loader.result() {
            None => self.state.loading = Some((source, loader.progress())),
            Some(result) => {
                (self.loader, self.state.loading) = (None, None);
                match result {
                    Ok(tracer) => self.show_scene(source, tracer),
                    Err(message) => {
                        self.forget_awaited();
                        self.state.notify(Severity::Error, message);
                    }
                }
            }
        }
    }

    fn show_scene(&mut self, source: SceneSource, tracer: Arc<Tracer>) {
        let is_reload = self.state.scene.as_ref().is_some_and(|s| s.source.label() == source.label());
        let scene = SceneInfo::new(source, &tracer);
        let (view_index, start) = self.start_pose(&scene);
        self.compare_hash(&tracer.scene().hash);
        // A scene that was edited is looked at from where one was.
        if !is_reload {
            self.state.fly.jump_to(start);
            self.state.view_index = view_index;
        }
        if !scene.warnings.is_empty() {
            let count = scene.warnings.len();
            let text = format!("{}: {count} import warnings, listed in the Scene panel", scene.name);
            self.state.notify(Severity::Info, text);
        }
        let is_model = matches!(scene.source, SceneSource::File { .. });
        self.state.scene = Some(scene);
        self.state.history.clear();
        self.obstacles = Some(Obstacles::new(tracer.clone()));
        self.scenes_opened += 1;
        (self.state.plan, self.is_planning) = (None, false);
        self.state.thumbnails.iter_mut().for_each(|t| t.set_tracer(tracer.clone()));
        self.begin_edits(tracer.scene(), is_reload);
        if !is_reload {
            self.state.plan_view = Default::default();
            self.state.playback = Playback::of_scene(tracer.scene().walk.clone());
            (self.state.recording, self.state.renaming) = (None, None);
        }
        let generation = self.threads.order(Order::SetTracer(tracer));
        self.scene_since = generation;
        if !is_reload {
            let given = self.request.settings.render.trace.bounces;
            let bounces = if is_model { self.request.model_bounces } else { given };
            // A reset goes back to what suits the scene.
            for quality in [&mut self.state.quality, &mut self.state.default_quality] {
                quality.walk.render.trace.bounces = bounces;
            }
            self.state.quality.exposure_ev = self.state.default_quality.exposure_ev;
            let is_metered = is_model && self.request.exposure_ev.is_none();
            self.state.meters_from = is_metered.then_some(generation);
        }
        let source = self.state.scene.as_ref().map(|s| s.source.clone());
        source.iter().for_each(|source| self.keep_scene(source, is_reload));
        self.sent = None;
    }

    /// The number of the saved view to start at and the pose. Only the first scene starts where the request says.
    fn start_pose(&mut self, scene: &SceneInfo) -> (usize, Camera) {
        let name = self.request.view.take();
        let index = name.as_ref().and_then(|name| scene.views.iter().position(|v| v.name == *name));
        if let (Some(name), None) = (&name, index) {
            let known: Vec<&str> = scene.views.iter().map(|v| v.name.as_str()).collect();
            let text = format!("{} has no view '{name}'; it has: {}", scene.name, known.join(", "));
            self.state.notify(Severity::Error, text);
        }
        let index = index.unwrap_or(0);
        let mut camera = self.request.camera.take().unwrap_or(scene.views[index].camera);
        if let Some(degrees) = self.request.fov_y_deg.take() {
            camera.fov_y = degrees.to_radians();
        }
        (index, camera)
    }

    /// Sends the pose and the settings where they have changed.
    fn send_wish(&mut self) {
        let q = &self.state.quality;
        let edge = |pixels: u32| (pixels as f32 * q.render_scale).round().clamp(1.0, LARGEST_EDGE) as u32;
        let size = if self.viewport_size.contains(&0) { [0, 0] } else { self.viewport_size.map(edge) };
        let wish = Wish {
            camera: *self.state.fly.camera(),
            size,
            settings: q.walk,
            budget: Duration::from_secs_f32(q.budget_ms / 1000.0),
            is_paused: self.state.options.is_paused,
            is_compared: self.state.comparison.is_wanted(),
        };
        if self.sent != Some(wish) {
            if self.sent.is_some_and(|s| s.camera != wish.camera) {
                self.moved = Instant::now();
                self.state.shows_hint = false;
            }
            self.threads.wish(wish);
            self.sent = Some(wish);
        }
    }

    fn work(&self) -> Work {
        let frame = self.state.frame.as_ref();
        let is_newest =
            frame.is_some_and(|f| f.generation == self.threads.generation() && f.stats.is_complete);
        match () {
            () if self.loader.is_some() => Work::Loading,
            () if self.state.scene.is_none() => Work::NoScene,
            () if self.state.options.is_paused => Work::Paused,
            () if self.moved.elapsed() < MOTION_TIME && !self.state.shows_hint => Work::Moving,
            () if self.is_editing => Work::Editing,
            () if !is_newest => Work::Filling,
            () if self.threads.is_adding_reference() => Work::AddingReference,
            () => match frame.map(|f| f.stats.refined) {
                Some(refined) if refined.of > 0 && refined.is_complete => Work::Converged,
                Some(refined) if refined.of > 0 => Work::Refining,
                _ => Work::Complete,
            },
        }
    }

    /// Takes the viewport's room; its picture is drawn once it is known where the camera goes in this very frame.
    fn viewport(&mut self, ui: &mut egui::Ui) -> (egui::Response, Canvas) {
        let rect = ui.available_rect_before_wrap();
        let response = ui.allocate_rect(rect, egui::Sense::click_and_drag());
        response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, "3D viewport"));
        let points_to_pixels = ui.ctx().pixels_per_point();
        self.viewport_size =
            [rect.width(), rect.height()].map(|points| (points * points_to_pixels).round() as u32);
        ui.painter().rect_filled(rect, 0.0, egui::Color32::from_gray(24));
        let canvas =
            Canvas { painter: ui.painter().clone(), shape: ui.painter().add(egui::Shape::Noop), rect };
        panels::overlay::show(ui, rect, &self.state);
        let inner = rect.shrink(10.0);
        if self.state.options.shows_statistics && inner.is_positive() {
            ui.scope_builder(egui::UiBuilder::new().max_rect(inner), |ui| panels::hud::show(ui, &self.state));
        }
        if self.state.shows_hint && self.state.loading.is_none() && inner.is_positive() {
            panels::hud::hint(ui, rect);
        }
        (response, canvas)
    }

    /// Draws the newest frame, as it is seen from where the camera is by now.
    fn draw(&self, canvas: Canvas) {
        if self.graphics.is_some() && canvas.rect.is_positive() {
            let points_to_pixels = canvas.painter.ctx().pixels_per_point();
            let presentation = Presentation { overlay: self.overlay(), ..self.state.presentation() };
            let shape = viewport::shape(canvas.rect, points_to_pixels, presentation, self.reprojection());
            canvas.painter.set(canvas.shape, shape);
        }
    }

    /// The way from the newest frame to the camera; `None` at rest, and for frames of a scene that was left.
    fn reprojection(&self) -> Option<Reprojection> {
        let (frame, camera) = (self.state.frame.as_ref()?, self.state.fly.camera());
        let is_elsewhere = frame.camera != *camera && frame.generation >= self.scene_since;
        is_elsewhere
            .then(|| Reprojection::new(&frame.camera, camera, &frame.scene_frame, frame.size, frame.nearest))
    }
}

/// Where the picture is to be drawn.
struct Canvas {
    painter: egui::Painter,
    shape: egui::layers::ShapeIdx,
    rect: egui::Rect,
}

/// Makes the graphics card ready; returns its name where it is none, but the processor.
fn prepare(graphics: &RenderState, trouble: &Arc<Mutex<Vec<String>>>, wake: &Wake) -> Option<String> {
    watch(graphics, trouble, wake);
    viewport::install(graphics);
    let adapter = graphics.adapter.get_info();
    (adapter.device_type == egui_wgpu::wgpu::DeviceType::Cpu).then_some(adapter.name)
}

/// Errors of the graphics card become messages; wgpu's own answer would be a panic.
fn watch(graphics: &RenderState, trouble: &Arc<Mutex<Vec<String>>>, wake: &Wake) {
    let (errors, ring) = (trouble.clone(), wake.clone());
    graphics.device.on_uncaptured_error(Arc::new(move |error: egui_wgpu::wgpu::Error| {
        locked(&errors).push(format!("the graphics card reported an error: {error}"));
        ring();
    }));
    let (errors, ring) = (trouble.clone(), wake.clone());
    graphics.device.set_device_lost_callback(move |reason, text| {
        if reason != egui_wgpu::wgpu::DeviceLostReason::Destroyed {
            locked(&errors)
                .push(format!("the graphics card was lost ({text}); please start the program again"));
            ring();
        }
    });
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
            egui::Panel::top("menu").show(ui, |ui| panels::menu::show(ui, &self.state, &mut commands));
            let side = egui::Panel::right("side").default_size(300.0).size_range(260.0..=460.0);
            side.show(ui, |ui| panels::side(ui, &self.state, &mut commands));
        }
        let (response, canvas) = egui::CentralPanel::no_frame().show(ui, |ui| self.viewport(ui)).inner;
        panels::comparison::split_line(ui, response.rect, &self.state, &mut commands);
        self.steer(&ctx, &response);
        if ctx.input(|i| !i.raw.hovered_files.is_empty()) {
            panels::notices::drop_hint(ui, response.rect);
        }
        panels::notices::show(&ctx, response.rect, &self.state, &mut commands);
        if self.state.shows_settings {
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
        self.send_wish();
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

    fn on_exit(&mut self) {
        (self.loader, self.export) = (None, None);
        self.end_keeping();
        self.threads.stop();
    }
}
