//! The render thread alone: the newest pose wins, and rest costs nothing.

use super::small_room;
use afterimage::reference::PlacementPolicy;
use afterimage::reference::placement::NONE;
use afterimage::render::render_antialiased;
use afterimage::{Camera, FrameRequest, Mode, Tracer, WalkthroughSettings};
use afterimage_ui::window::rendering::exchange::PublishedFrame;
use afterimage_ui::window::rendering::messages::{Message, Picture, RenderCommand, RenderRequest};
use afterimage_ui::window::rendering::quantity::Quantity;
use afterimage_ui::window::rendering::render_thread::RenderThread;
use crossbeam_channel::{Receiver, unbounded};
use glam::DVec3;
use std::sync::Arc;
use std::time::Duration;

const DEADLINE: Duration = Duration::from_secs(240);

struct Bench {
    thread: RenderThread,
    bell: Receiver<()>,
    shown: Option<PublishedFrame>,
    tracer: Arc<Tracer>,
}

impl Bench {
    fn new() -> Self {
        let (ring, bell) = unbounded();
        let wake = Arc::new(move || {
            let _ = ring.send(());
        });
        let thread = RenderThread::start(2, wake, None).expect("the threads start");
        let tracer = Arc::new(Tracer::new(small_room()));
        thread.send(RenderCommand::SetTracer(tracer.clone()));
        Self { thread, bell, shown: None, tracer }
    }

    fn request(&self, x: f64) -> RenderRequest {
        let camera = Camera { eye: DVec3::new(x, 1.6, 2.0), ..*self.tracer.scene().start() };
        let mut settings =
            WalkthroughSettings { placement: PlacementPolicy::new(&NONE, 0.0), ..Default::default() };
        settings.render.trace.samples = 1;
        RenderRequest {
            camera,
            size: [96, 64],
            settings,
            budget: Some(Duration::ZERO),
            is_moving: false,
            quantity: Quantity::Picture,
            is_paused: false,
            is_compared: false,
            section: None,
            has_edges: false,
            is_endless: false,
        }
    }

    /// Asks for the picture and waits for it.
    fn picture(&self) -> Picture {
        self.thread.send(RenderCommand::Picture);
        loop {
            match self.thread.messages().next() {
                Some(Message::Picture(picture)) => return picture,
                Some(Message::Failed(text)) => panic!("{text}"),
                Some(Message::Reference(reference)) => panic!("unexpected reference {:?}", reference.id),
                None => self.bell.recv_timeout(DEADLINE).expect("the picture"),
            }
        }
    }

    /// Takes frames until one of this generation is complete; none may be older than the one
    /// before.
    fn wait_for(&mut self, generation: u64) {
        let newest = |shown: &Option<PublishedFrame>| shown.as_ref().map_or(0, |f| f.generation);
        loop {
            let before = newest(&self.shown);
            while self.thread.take_frame(&mut self.shown) {}
            assert!(newest(&self.shown) >= before, "an older frame after a newer one");
            if self.shown.as_ref().is_some_and(|f| f.generation >= generation && f.stats.is_complete) {
                return;
            }
            self.bell.recv_timeout(DEADLINE).expect("the thread says something");
        }
    }
}

#[test]
fn the_newest_pose_wins() {
    let mut bench = Bench::new();
    let mut last = 0;
    for i in 0..200 {
        last = bench.thread.request(bench.request(f64::from(i) * 0.01));
    }
    bench.wait_for(last);
    let shown = bench.shown.as_ref().expect("a frame");
    assert_eq!(shown.camera, bench.request(1.99).camera);
    assert!(bench.thread.frames_rendered() < 200, "stale poses are skipped");
}

#[test]
fn rest_renders_nothing() {
    let mut bench = Bench::new();
    let generation = bench.thread.request(bench.request(0.0));
    bench.wait_for(generation);
    let rendered = bench.thread.frames_rendered();
    // A picture needs the thread but no new frame: when it arrives, the thread has passed its loop
    // once more.
    assert_eq!(bench.picture().size, [96, 64]);
    assert_eq!(bench.thread.frames_rendered(), rendered);
}

#[test]
fn a_reference_is_added_and_removed_on_command() {
    let mut bench = Bench::new();
    let generation = bench.thread.request(bench.request(0.0));
    bench.wait_for(generation);
    bench.thread.send(RenderCommand::AddReference(bench.request(0.0).camera));
    // The reference raises the generation by one.
    bench.wait_for(generation + 1);
    let frame = bench.shown.as_ref().expect("a frame");
    assert_eq!((frame.references.len(), frame.stats.references_used), (1, 1));
    assert_eq!(frame.stats.types.type3(), 0, "its own pose has no hole");
    let id = frame.references[0].id;
    let generation = bench.thread.send(RenderCommand::Remove(id));
    bench.wait_for(generation);
    assert!(bench.shown.as_ref().is_some_and(|f| f.references.is_empty()));
}

#[test]
fn nothing_is_rendered_without_pixels_or_while_paused() {
    let mut bench = Bench::new();
    let generation = bench.thread.request(bench.request(0.0));
    bench.wait_for(generation);
    let rendered = bench.thread.frames_rendered();
    for idle in [
        RenderRequest { size: [0, 64], ..bench.request(0.5) },
        RenderRequest { is_paused: true, ..bench.request(0.5) },
    ] {
        bench.thread.request(idle);
        // The old picture arrives once the request has been read.
        assert_eq!(bench.picture().camera, bench.request(0.0).camera);
        assert_eq!(bench.thread.frames_rendered(), rendered, "{idle:?}");
    }
    let generation = bench.thread.request(bench.request(1.0));
    bench.wait_for(generation);
    assert_eq!(bench.shown.as_ref().map(|f| f.camera), Some(bench.request(1.0).camera));
}

#[test]
fn a_picture_at_rest_converges_and_then_costs_nothing() {
    let mut bench = Bench::new();
    let mut request = bench.request(0.0);
    request.settings.render.mode = Mode::Exact;
    let generation = bench.thread.request(request);
    bench.wait_for(generation);
    while !bench.shown.as_ref().is_some_and(|f| f.stats.refined.is_complete) {
        if !bench.thread.take_frame(&mut bench.shown) {
            bench.bell.recv_timeout(DEADLINE).expect("the thread continues");
        }
        assert_eq!(bench.shown.as_ref().map(|f| f.generation), Some(generation));
    }
    let passes = bench.shown.as_ref().map_or(0, |f| f.stats.refined.of);
    let (camera, render) = (&request.camera, &request.settings.render);
    let expected =
        render_antialiased(&FrameRequest::new(&bench.tracer, camera, request.size, render), passes);
    let picture = bench.picture();
    assert!(picture.radiance == expected.radiance && picture.refined.is_complete);
    // The thread has passed its loop for the picture, and had nothing more to show.
    assert!(!bench.thread.take_frame(&mut bench.shown));
    assert_eq!(bench.thread.frames_rendered(), 1);
}

#[test]
fn a_change_ends_the_refining() {
    let mut bench = Bench::new();
    let mut slow = bench.request(0.0);
    slow.settings.render.mode = Mode::Exact;
    (slow.size, slow.settings.render.trace.samples) = ([256, 256], 16);
    bench.thread.request(slow);
    let refined = |bench: &Bench| bench.shown.as_ref().map_or_else(Default::default, |f| f.stats.refined);
    while refined(&bench).of == 0 {
        bench.bell.recv_timeout(DEADLINE).expect("the thread says something");
        bench.thread.take_frame(&mut bench.shown);
    }
    let quick = RenderRequest { size: [16, 16], ..slow };
    let generation = bench.thread.request(quick);
    while bench.shown.as_ref().is_some_and(|f| f.generation < generation) {
        assert!(!refined(&bench).is_complete, "the old picture was brought to its end");
        bench.bell.recv_timeout(DEADLINE).expect("the thread says something");
        bench.thread.take_frame(&mut bench.shown);
    }
    assert_eq!(bench.shown.as_ref().map(|f| f.size), Some([16, 16]));
}

#[test]
fn it_ends_while_it_works() {
    let bench = Bench::new();
    let mut request = bench.request(0.0);
    request.size = [2048, 2048];
    request.settings.render.trace.samples = 64;
    bench.thread.send(RenderCommand::AddReference(request.camera));
    bench.thread.request(request);
    drop(bench);
}
