//! `Worker`: state of the render thread (walkthrough, request, running reference).

use super::super::{Job, Message, RenderRequest, Shared, Wake};
use afterimage::reference::ReferenceId;
use afterimage::{Camera, Walkthrough};
use crossbeam_channel::Sender;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// Pose and size of a reference.
pub(super) type RequestedPose = (Camera, [u32; 2]);

/// The reference that is being traced.
pub(super) struct Running {
    pub(super) cancel: Arc<AtomicBool>,
    pub(super) pose: RequestedPose,
}

/// State of the render thread: the walkthrough, the newest request, and the running reference.
pub(in crate::window::rendering) struct Worker {
    pub(super) shared: Arc<Shared>,
    pub(super) pool: rayon::ThreadPool,
    pub(super) jobs: Sender<Job>,
    messages: Sender<Message>,
    pub(super) wake: Wake,
    pub(super) walk: Option<Walkthrough>,
    pub(super) request: Option<RenderRequest>,
    /// The reference that is being traced.
    pub(super) running: Option<Running>,
    /// Poses at which tracing a reference has panicked: the placement policy would choose them
    /// again and again.
    pub(super) refused: Vec<RequestedPose>,
    /// Pose of a reference that the user has added while another one was being traced.
    pub(super) added_by_user: Option<Camera>,
    pub(super) wants_picture: bool,
    /// Generation of the last frame.
    pub(super) rendered: Option<u64>,
    /// Generation whose picture has converged.
    pub(super) converged: Option<u64>,
    /// Times at which references were added.
    pub(super) added: Vec<(ReferenceId, Instant)>,
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
            running: None,
            refused: Vec::new(),
            added_by_user: None,
            wants_picture: false,
            rendered: None,
            converged: None,
            added: Vec::new(),
        }
    }

    pub(super) fn can_render(&self) -> bool {
        self.walk.is_some() && self.request.as_ref().is_some_and(asks_for_pixels)
    }

    /// True where the last frame is still wanted and was cut at its budget.
    pub(super) fn can_resume(&self, generation: u64) -> bool {
        let is_shown = self.rendered == Some(generation) && self.can_render();
        is_shown && self.walk.as_ref().is_some_and(Walkthrough::can_resume)
    }

    /// True where the last frame is still wanted and has not converged. A reference that is being
    /// traced goes first: it makes the next frames cheaper.
    pub(super) fn can_refine(&self, generation: u64) -> bool {
        let is_shown = self.rendered == Some(generation) && self.converged != Some(generation);
        let is_compared = self.request.is_some_and(|r| r.is_compared);
        let has_reference = self.running.is_some() || self.added_by_user.is_some();
        is_shown && !is_compared && !has_reference && self.can_render()
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
