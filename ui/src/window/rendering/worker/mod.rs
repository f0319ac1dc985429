//! The work of the thread that makes frames: takes wishes in, renders, asks for references, hands pictures out.

mod references;
mod render_loop;
mod snapshot;

use crate::picture::memory;
use crate::window::rendering::exchange::locked;
use crate::window::rendering::references::Job;
use crate::window::rendering::render_thread::{Message, RenderCommand, RenderRequest, Shared, Wake};
use afterimage::reference::ReferenceId;
use afterimage::{Camera, Walkthrough};
use crossbeam_channel::Sender;
use references::{RequestedPose, Running};
use std::any::Any;
use std::sync::atomic::Ordering;
use std::sync::{Arc, PoisonError};
use std::time::Instant;

/// The window and a software rasteriser's threads go first: on two cores without a graphics card the window came
/// round every 300 ms while the gallery was rendered, and every 75 ms since. References stay equal to frames: the
/// frames after them are the cheaper.
const NICENESS: i32 = 10;

/// Lowers the priority of the calling thread.
pub(crate) fn give_way() {
    // Elsewhere it is the whole process that becomes nicer. Refused means equal shares: nothing is wrong then.
    #[cfg(target_os = "linux")]
    let _ = rustix::process::nice(NICENESS);
    #[cfg(not(target_os = "linux"))]
    let _ = NICENESS;
}

/// What the frames' thread owns.
pub(crate) struct Worker {
    pub(crate) shared: Arc<Shared>,
    pub(crate) pool: rayon::ThreadPool,
    pub(crate) jobs: Sender<Job>,
    pub(crate) messages: Sender<Message>,
    pub(crate) wake: Wake,
    pub(crate) walk: Option<Walkthrough>,
    pub(crate) request: Option<RenderRequest>,
    /// Ends the reference in the making.
    pub(crate) job: Option<Running>,
    /// Poses and sizes at which tracing a reference failed: the policy would ask for them for ever.
    pub(crate) refused: Vec<RequestedPose>,
    /// A reference asked for by hand while another was in the making.
    pub(crate) asked: Option<Camera>,
    pub(crate) wants_picture: bool,
    /// The generation of the last frame, `None` where it is to be made again.
    pub(crate) rendered: Option<u64>,
    /// The generation whose picture has converged.
    pub(crate) converged: Option<u64>,
    pub(crate) added: Vec<(ReferenceId, Instant)>,
}

impl Worker {
    /// Without a scene yet.
    pub(crate) fn new(
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
            job: None,
            refused: Vec::new(),
            asked: None,
            wants_picture: false,
            rendered: None,
            converged: None,
            added: Vec::new(),
        }
    }

    pub(crate) fn run(&mut self) {
        while let Some(generation) = self.wait() {
            if self.can_render() && self.rendered != Some(generation) {
                self.render(generation);
            } else if self.can_resume(generation) {
                self.resume(generation);
            } else if self.can_refine(generation) {
                self.refine(generation);
            }
            self.request_reference();
            self.send_picture();
        }
        self.cancel_reference();
    }

    /// Sleeps until there is something to do and takes it in. Returns the generation taken in, `None` at the end.
    fn wait(&mut self) -> Option<u64> {
        let shared = self.shared.clone();
        let mut inbox = locked(&shared.inbox);
        loop {
            if shared.quit.load(Ordering::Acquire) {
                return None;
            }
            let generation = shared.generation.load(Ordering::Acquire);
            if std::mem::take(&mut inbox.drops_request) {
                self.request = None;
            }
            let request = inbox.request.or(self.request);
            let is_due = self.rendered != Some(generation)
                && self.walk.is_some()
                && request.is_some_and(|w| !w.is_paused && !w.size.contains(&0));
            let has_events =
                inbox.request.is_some() || !inbox.commands.is_empty() || !inbox.outcomes.is_empty();
            // Settings of a new wish are taken in before anything is gone on with.
            let can_go_on = !is_due
                && inbox.request.is_none()
                && (self.can_resume(generation) || self.can_refine(generation));
            if is_due || has_events || can_go_on {
                let is_new = inbox.request.is_some();
                self.request = request;
                inbox.request = None;
                let (commands, outcomes) =
                    (std::mem::take(&mut inbox.commands), std::mem::take(&mut inbox.outcomes));
                drop(inbox);
                if is_new {
                    self.refuse_too_large();
                }
                outcomes.into_iter().for_each(|o| self.take_in(o));
                commands.into_iter().for_each(|o| self.carry_out(o));
                return Some(generation);
            }
            inbox = shared.bell.wait(inbox).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// A wish that memory cannot hold is dropped with a message: a failed allocation would end the program.
    fn refuse_too_large(&mut self) {
        let Some([width, height]) = self.request.map(|w| w.size) else { return };
        if let Err(why) = memory::check(u64::from(width) * u64::from(height), 1) {
            self.request = None;
            self.say(Message::Failed(format!("a picture of {width} x {height}: {why}")));
            (self.wake)();
        }
    }

    fn can_render(&self) -> bool {
        self.walk.is_some() && self.request.is_some_and(|w| !w.is_paused && !w.size.contains(&0))
    }

    /// True where the last frame is still wanted and was cut at the budget.
    fn can_resume(&self, generation: u64) -> bool {
        let is_shown = self.rendered == Some(generation) && self.can_render();
        is_shown && self.walk.as_ref().is_some_and(Walkthrough::can_resume)
    }

    /// True where the last frame is still wanted and its picture has not converged. A reference in the making goes first:
    /// the next frames are the cheaper for it.
    fn can_refine(&self, generation: u64) -> bool {
        let is_shown = self.rendered == Some(generation) && self.converged != Some(generation);
        let is_compared = self.request.is_some_and(|w| w.is_compared);
        is_shown && !is_compared && self.job.is_none() && self.asked.is_none() && self.can_render()
    }

    fn carry_out(&mut self, command: RenderCommand) {
        match command {
            RenderCommand::SetTracer(tracer) => {
                self.cancel_reference();
                self.shared.abandon.store(false, Ordering::Release);
                let settings = self.request.map(|w| w.settings).unwrap_or_default();
                // A new walk rather than the old one with another tracer: what is not traced yet in the first frame
                // would show the old scene.
                self.walk = Some(Walkthrough::new(tracer, settings).progressive());
                self.added.clear();
                self.refused.clear();
            }
            RenderCommand::AddReference(camera) => self.asked = Some(camera),
            RenderCommand::Remove(id) => {
                if let Some(walk) = &mut self.walk {
                    walk.cache_mut().remove(id);
                }
            }
            RenderCommand::Enable(id, is_enabled) => {
                if let Some(walk) = &mut self.walk {
                    walk.cache_mut().set_enabled(id, is_enabled);
                }
            }
            RenderCommand::ShowReference(id) => self.send_reference(id),
            RenderCommand::Clear => {
                self.cancel_reference();
                if let Some(walk) = &mut self.walk {
                    walk.cache_mut().clear();
                }
            }
            RenderCommand::Picture => self.wants_picture = true,
        }
    }

    fn say(&self, message: Message) {
        // Nobody listens once the window is gone.
        let _ = self.messages.send(message);
    }
}

/// What a panic said.
pub(crate) fn panic_text(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|s| (*s).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "no message".to_owned())
}
