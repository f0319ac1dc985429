//! `Worker`: state of the render thread (walkthrough, request, schedule).

use super::super::{Job, Message, Quantity, RenderRequest, Shared, Wake};
use afterimage::Walkthrough;
use afterimage::reference::ReferenceId;
use afterimage::render::schedule::{Schedule, Step};
use afterimage::store::StoreSettings;
use crossbeam_channel::Sender;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// State of the render thread: the walkthrough, the newest request, and what is done next.
pub(in crate::window::rendering) struct Worker {
    pub(super) shared: Arc<Shared>,
    pub(super) pool: rayon::ThreadPool,
    pub(super) jobs: Sender<Job>,
    messages: Sender<Message>,
    pub(super) wake: Wake,
    pub(super) walk: Option<Walkthrough>,
    pub(super) request: Option<RenderRequest>,
    /// What the last frame shows.
    pub(super) quantity: Quantity,
    pub(super) schedule: Schedule,
    /// When the last frame was shown.
    pub(super) framed: Option<Instant>,
    /// Cancels the reference that is being traced.
    pub(super) running: Option<Arc<AtomicBool>>,
    /// The light by groups that is being traced.
    pub(super) layering: Option<Layering>,
    /// Light is traced by groups, because the window shows the controls of the lights.
    pub(super) knows_lights: bool,
    pub(super) has_failed_layers: bool,
    pub(super) wants_picture: bool,
    /// Times at which references were added.
    pub(super) added: Vec<(ReferenceId, Instant)>,
    /// The store of references; `None` for none.
    pub(in crate::window::rendering) store: Option<StoreSettings>,
}

/// Light by groups that is being traced.
pub(super) struct Layering {
    pub(super) cancel: Arc<AtomicBool>,
    /// Hash of the scene at full light.
    pub(super) scene: String,
}

impl Worker {
    /// A worker without a scene.
    pub(in crate::window::rendering) fn new(
        shared: Arc<Shared>,
        pool: rayon::ThreadPool,
        jobs: Sender<Job>,
        messages: Sender<Message>,
        wake: Wake,
    ) -> Self {
        Self {
            shared,
            pool,
            jobs,
            messages,
            wake,
            walk: None,
            request: None,
            quantity: Quantity::Picture,
            schedule: Schedule::default(),
            framed: None,
            running: None,
            layering: None,
            knows_lights: false,
            has_failed_layers: false,
            wants_picture: false,
            added: Vec::new(),
            store: None,
        }
    }

    pub(super) fn can_render(&self) -> bool {
        self.walk.is_some() && self.request.as_ref().is_some_and(asks_for_pixels)
    }

    /// The next step of the newest frame.
    pub(super) fn next_step(&self, generation: u64) -> Step {
        let (Some(walk), Some(request)) = (&self.walk, &self.request) else { return Step::Rest };
        match asks_for_pixels(request) {
            true => self.schedule.next(walk, generation, !request.is_compared),
            false => Step::Rest,
        }
    }

    /// Sends a message and wakes the window.
    pub(super) fn send(&self, message: Message) {
        // Nothing is received once the window is gone.
        let _ = self.messages.send(message);
        (self.wake)();
    }
}

/// True where a request asks for a frame of at least one pixel.
pub(super) fn asks_for_pixels(request: &RenderRequest) -> bool {
    !request.is_paused && !request.size.contains(&0)
}
