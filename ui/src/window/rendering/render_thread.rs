//! The thread that renders the newest pose and abandons work that is no longer wanted.
//!
//! Every change of the request raises a number, the generation. A frame carries the generation at
//! which it was begun. One thread renders all frames in that order, so an older pose is never shown
//! after a newer one.

use super::{
    Message, PublishedFrame, RenderCommand, RenderRequest, Shared, Wake, Worker, background_pool, locked,
    references,
};
use afterimage::store::StoreSettings;
use crossbeam_channel::{Receiver, unbounded};
use std::io;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::thread::JoinHandle;

/// The render thread and the thread that traces references. Dropping it stops and joins both.
#[derive(Debug)]
pub struct RenderThread {
    shared: Arc<Shared>,
    messages: Receiver<Message>,
    frames: Option<JoinHandle<()>>,
    references: Option<JoinHandle<()>>,
}

impl RenderThread {
    /// Starts both threads, each with a pool of its own. The pool for references is one thread
    /// smaller, so that frames are rendered meanwhile. References are read from the store and added
    /// to it, if there is one.
    ///
    /// # Errors
    /// Where the system refuses to start the threads.
    pub fn start(threads: usize, wake: Wake, store: Option<StoreSettings>) -> io::Result<Self> {
        let shared = Arc::new(Shared::default());
        let (sender, messages) = unbounded();
        let inbox = shared.clone();
        let deliver = move |outcome| inbox.deliver(outcome);
        let (jobs, references) = references::start(threads.saturating_sub(1), deliver)?;
        let pool = background_pool("frames", threads)?;
        let mut worker = Worker::new(shared.clone(), pool, jobs, sender, wake);
        worker.store = store;
        let name = "afterimage-frames".to_owned();
        let frames = std::thread::Builder::new().name(name).spawn(move || worker.run())?;
        Ok(Self { shared, messages, frames: Some(frames), references: Some(references) })
    }

    /// Requests the next frame, and returns its generation.
    pub fn request(&self, request: RenderRequest) -> u64 {
        self.shared.change(|inbox| inbox.request = Some(request))
    }

    /// Sends a command, and returns the generation of the first frame that shows its effect.
    pub fn send(&self, command: RenderCommand) -> u64 {
        match command {
            RenderCommand::Picture
            | RenderCommand::KnowLights(_)
            | RenderCommand::AddReference(_)
            | RenderCommand::ShowReference(_) => {
                self.shared.note(|inbox| inbox.commands.push(command));
                self.generation()
            }
            RenderCommand::SetTracer(_) => {
                self.shared.abandon.store(true, Ordering::Release);
                self.shared.change(|inbox| {
                    (inbox.request, inbox.drops_request) = (None, true);
                    inbox.commands.push(command);
                })
            }
            RenderCommand::Remove(_)
            | RenderCommand::Enable(..)
            | RenderCommand::ReadStore
            | RenderCommand::Clear => self.shared.change(|inbox| inbox.commands.push(command)),
        }
    }

    /// Returns the generation of the newest request.
    pub fn generation(&self) -> u64 {
        self.shared.generation.load(Ordering::Acquire)
    }

    /// Returns the number of frames rendered so far, including those that were abandoned.
    pub fn frames_rendered(&self) -> u64 {
        self.shared.frames_rendered.load(Ordering::Acquire)
    }

    /// True while a reference is being traced.
    pub fn is_adding_reference(&self) -> bool {
        self.shared.is_adding.load(Ordering::Acquire)
    }

    /// True while a reference is being traced, or while it is not known yet whether the frame that
    /// was shown last asks for one.
    pub fn may_add_reference(&self) -> bool {
        // In this order: the thread notes that it traces before it notes that it has decided.
        self.shared.is_deciding.load(Ordering::Acquire) || self.is_adding_reference()
    }

    /// Swaps the newest frame with the one shown; false where there is none newer.
    pub fn take_frame(&self, shown: &mut Option<PublishedFrame>) -> bool {
        self.shared.exchange.take(shown)
    }

    /// Returns the messages that have arrived, oldest first.
    pub fn messages(&self) -> impl Iterator<Item = Message> + '_ {
        self.messages.try_iter()
    }

    /// Stops both threads and waits for them. This takes a few milliseconds: frames and references
    /// stop where they are.
    pub fn stop(&mut self) {
        self.shared.quit.store(true, Ordering::Release);
        // Taking the lock ensures that the thread is not between its check of `quit` and its wait.
        drop(locked(&self.shared.inbox));
        self.shared.bell.notify_all();
        for handle in [self.frames.take(), self.references.take()].into_iter().flatten() {
            // A panic of the thread was reported by its hook.
            let _ = handle.join();
        }
    }
}

impl Drop for RenderThread {
    fn drop(&mut self) {
        self.stop();
    }
}
