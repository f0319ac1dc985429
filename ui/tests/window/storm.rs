//! Threads in trouble: a storm of requests and commands, a scene that makes tiles panic, pictures
//! too large for memory, light that is not a number. Each ends in one message, and the next frame
//! is rendered.

use super::small_room;
use afterimage::reference::PlacementPolicy;
use afterimage::reference::placement::{NONE, THRESHOLD};
use afterimage::scene::MaterialId;
use afterimage::{Camera, Mode, Scene, Tracer, WalkthroughSettings};
use afterimage_ui::window::rendering::exchange::PublishedFrame;
use afterimage_ui::window::rendering::messages::{Message, RenderCommand, RenderRequest};
use afterimage_ui::window::rendering::quantity::Quantity;
use afterimage_ui::window::rendering::render_thread::RenderThread;
use crossbeam_channel::{Receiver, unbounded};
use glam::{DVec3, Vec3};
use std::sync::Arc;
use std::time::Duration;

const DEADLINE: Duration = Duration::from_secs(240);

struct Storm {
    thread: RenderThread,
    bell: Receiver<()>,
    shown: Option<PublishedFrame>,
    tracers: Vec<Arc<Tracer>>,
    newest: u64,
    random: u64,
}

impl Storm {
    fn new() -> Self {
        let (ring, bell) = unbounded();
        let wake = Arc::new(move || {
            let _ = ring.send(());
        });
        let thread = RenderThread::start(2, wake, None).expect("the threads start");
        let first = Arc::new(Tracer::new(small_room()));
        let mut look = first.scene().to_edit();
        look.materials[0].diffuse = Vec3::new(0.2, 0.5, 0.3);
        let edited = Arc::new(first.with_same_geometry(Arc::new(first.scene().with_edit(&look))));
        let other = Arc::new(Tracer::new(small_room()));
        thread.send(RenderCommand::SetTracer(first.clone()));
        let tracers = vec![first, edited, other];
        Self { thread, bell, shown: None, tracers, newest: 0, random: 0x9e37_79b9_7f4a_7c15 }
    }

    /// Returns the next random number below `bound`.
    fn below(&mut self, bound: u64) -> u64 {
        self.random ^= self.random << 13;
        self.random ^= self.random >> 7;
        self.random ^= self.random << 17;
        (self.random >> 11) % bound
    }

    fn request(&mut self) -> RenderRequest {
        let modes = [Mode::Full, Mode::Paper, Mode::Fast, Mode::Exact];
        let placements = [PlacementPolicy::new(&NONE, 0.0), PlacementPolicy::new(&THRESHOLD, 5.0)];
        let placement = placements[self.below(2) as usize];
        let mut settings = WalkthroughSettings { placement, ..WalkthroughSettings::default() };
        settings.render.mode = modes[self.below(4) as usize];
        settings.render.trace.samples = 1 + self.below(2) as u32;
        let x = self.below(100) as f64 * 0.01;
        let camera = Camera { eye: DVec3::new(x, 1.6, 2.0), ..*self.tracers[0].scene().start() };
        let size = [self.below(48) as u32, self.below(32) as u32];
        let budget = [Some(0), Some(1), Some(2), None][self.below(4) as usize].map(Duration::from_millis);
        RenderRequest {
            camera,
            size,
            settings,
            budget,
            is_moving: false,
            quantity: Quantity::Picture,
            is_paused: self.below(20) == 0,
            is_compared: self.below(10) == 0,
            section: None,
            has_edges: false,
            is_endless: self.below(4) == 0,
        }
    }

    /// Sends one of: move, resize and change mode; load or edit; add a reference; clear; take a
    /// picture.
    fn event(&mut self) {
        let generation = match self.below(20) {
            0 => {
                let which = self.below(3) as usize;
                let tracer = self.tracers[which].clone();
                self.thread.send(RenderCommand::SetTracer(tracer))
            }
            1 => {
                let camera = self.request().camera;
                self.thread.send(RenderCommand::AddReference(camera))
            }
            2 => self.thread.send(RenderCommand::Clear),
            3 => self.thread.send(RenderCommand::Picture),
            _ => {
                let request = self.request();
                self.thread.request(request)
            }
        };
        assert!(generation >= self.newest, "generation {generation} after {}", self.newest);
        self.newest = generation;
    }

    /// Takes frames and messages. No frame may be older than the one before, and nothing may have
    /// failed.
    fn look(&mut self) {
        let before = self.shown.as_ref().map_or(0, |f| f.generation);
        while self.thread.take_frame(&mut self.shown) {}
        let now = self.shown.as_ref().map_or(0, |f| f.generation);
        assert!(now >= before && now <= self.thread.generation(), "frame {now} after {before}");
        for message in self.thread.messages() {
            assert!(!matches!(message, Message::Failed(_)), "{message:?}");
        }
    }

    /// Shows a valid request in a valid scene to its end.
    fn recovers(&mut self) {
        self.thread.send(RenderCommand::SetTracer(self.tracers[0].clone()));
        let request = RenderRequest {
            size: [32, 24],
            is_moving: false,
            quantity: Quantity::Picture,
            is_paused: false,
            budget: Some(Duration::ZERO),
            ..self.request()
        };
        let generation = self.thread.request(request);
        while !self.shown.as_ref().is_some_and(|f| f.generation >= generation && f.stats.is_complete) {
            if !self.thread.take_frame(&mut self.shown) {
                self.bell.recv_timeout(DEADLINE).expect("the thread continues");
            }
        }
    }

    /// Returns the message of the one failure in which a request in a scene ends.
    fn failure(&mut self, scene: Scene, request: RenderRequest) -> String {
        self.thread.send(RenderCommand::SetTracer(Arc::new(Tracer::new(Arc::new(scene)))));
        self.thread.request(request);
        let failed = loop {
            let failures = self.thread.messages().filter_map(|message| match message {
                Message::Failed(text) => Some(text),
                Message::Picture(_) | Message::Reference(_) => None,
            });
            let failures: Vec<String> = failures.collect();
            if !failures.is_empty() {
                break failures;
            }
            self.bell.recv_timeout(DEADLINE).expect("the thread says what failed");
        };
        assert_eq!(failed.len(), 1, "{failed:?}");
        failed.into_iter().next().unwrap_or_default()
    }

    fn plain_request(&mut self) -> RenderRequest {
        let mut request = RenderRequest {
            size: [64, 48],
            is_moving: false,
            quantity: Quantity::Picture,
            is_paused: false,
            budget: Some(Duration::ZERO),
            ..self.request()
        };
        request.settings.render.mode = Mode::Full;
        request.settings.placement = PlacementPolicy::new(&NONE, 0.0);
        request
    }
}

#[test]
fn ten_thousand_random_events_never_bring_an_older_frame() {
    let mut storm = Storm::new();
    for i in 0..10_000 {
        storm.event();
        if i & 15 == 0 {
            storm.look();
        }
    }
    storm.recovers();
    storm.look();
    assert!(storm.thread.frames_rendered() < 10_000, "stale requests are skipped");
}

#[test]
fn a_panic_in_a_tile_is_one_message_and_the_next_scene_is_shown() {
    let mut storm = Storm::new();
    let mut broken = Scene::clone(&small_room());
    // No builder creates such a scene: it simulates a bug, met by every ray that hits this
    // triangle.
    Arc::make_mut(&mut broken.triangle_materials).iter_mut().for_each(|m| *m = MaterialId(u32::MAX));
    let request = storm.plain_request();
    let text = storm.failure(broken, request);
    assert!(text.contains("rendering failed"), "{text}");
    storm.recovers();
}

#[test]
fn a_picture_beyond_memory_is_refused_with_a_message() {
    let mut storm = Storm::new();
    let request = RenderRequest { size: [60_000, 60_000], ..storm.plain_request() };
    let text = storm.failure(Scene::clone(&small_room()), request);
    assert!(text.contains("60000 x 60000") && text.contains("GB"), "{text}");
    storm.recovers();
}

#[test]
fn light_that_is_no_number_stays_in_its_pixels() {
    let mut storm = Storm::new();
    let mut broken = Scene::clone(&small_room());
    broken.materials[0].emission = Vec3::NAN;
    let tracer = Arc::new(Tracer::new(Arc::new(broken)));
    for mode in [Mode::Full, Mode::Paper, Mode::Exact] {
        storm.thread.send(RenderCommand::SetTracer(tracer.clone()));
        let mut request = storm.plain_request();
        request.settings.render.mode = mode;
        let generation = storm.thread.request(request);
        while !storm.shown.as_ref().is_some_and(|f| f.generation >= generation && f.stats.is_complete) {
            if !storm.thread.take_frame(&mut storm.shown) {
                storm.bell.recv_timeout(DEADLINE).expect("a frame");
            }
        }
        storm.look();
    }
    storm.recovers();
}
