//! The thread that renders the newest pose, and nothing that nobody wants any more.
//!
//! Whatever the window wishes for raises a number, the generation. A frame carries the generation it was begun with;
//! one thread makes all frames in that order, so an older pose is never shown after a newer one.

use super::references;
use super::worker::Worker;
pub(crate) use super::worker::{give_way, panic_text};
use crate::window::rendering::exchange::{Exchange, PublishedFrame, locked};
use crate::window::rendering::references::Outcome;
use afterimage::reference::{ReferenceFrame, ReferenceId};
use afterimage::{Camera, RefineState, RenderSettings, Scene, Tracer, WalkthroughSettings};
use crossbeam_channel::{Receiver, unbounded};
use glam::Vec3;
use std::io;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

/// All that decides the next frame; the newest replaces those before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderRequest {
    /// Where to look from.
    pub camera: Camera,
    /// Width and height in pixels. Nothing is rendered while one is zero.
    pub size: [u32; 2],
    /// What to render with.
    pub settings: WalkthroughSettings,
    /// A frame is shown after so long as it is, the worst done first, and then gone on with. `None`: it is shown when it
    /// is complete, and given up where anything newer is wished for.
    pub budget: Option<Duration>,
    /// Nothing is rendered while paused.
    pub is_paused: bool,
    /// The picture stays as its mode makes it: one that is compared is not refined.
    pub is_compared: bool,
}

/// What must be done once, in order.
#[derive(Clone, Debug)]
pub enum RenderCommand {
    /// Shows another scene. Nothing is rendered before the next wish.
    SetTracer(Arc<Tracer>),
    /// Traces a reference at a pose, whatever the policy says.
    AddReference(Camera),
    /// Drops a reference.
    Remove(ReferenceId),
    /// Switches a reference on or off.
    Enable(ReferenceId, bool),
    /// Hands out what a reference holds.
    ShowReference(ReferenceId),
    /// Drops all references.
    Clear,
    /// Hands out the next complete frame, or the one that is there while paused.
    Picture,
}

/// A finished frame as radiance, to be saved.
#[derive(Clone, Debug)]
pub struct Picture {
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Row-major from the top.
    pub radiance: Vec<Vec3>,
    /// What it shows.
    pub scene: Arc<Scene>,
    /// Where it was seen from.
    pub camera: Camera,
    /// What it was made with.
    pub settings: RenderSettings,
    /// False where it was taken as it was, while paused.
    pub is_complete: bool,
    /// How far it was refined at rest.
    pub refined: RefineState,
    /// What another picture of the view can be made from: what the frame used, or in modes that look up all there are.
    pub references: Vec<Arc<ReferenceFrame>>,
}

/// What a reference holds.
#[derive(Clone, Debug)]
pub struct ReferenceRadiance {
    /// Whose.
    pub id: ReferenceId,
    /// Where it was taken.
    pub camera: Camera,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// By pixel, `None` where it holds no light; of the whole `None` where there is no such reference any more.
    pub radiance: Option<Vec<Option<Vec3>>>,
}

/// What the threads have to say beside frames.
#[derive(Clone, Debug)]
pub enum Message {
    /// As ordered.
    Picture(Picture),
    /// As ordered.
    Reference(ReferenceRadiance),
    /// Something failed; the threads go on.
    Failed(String),
}

#[derive(Debug, Default)]
pub(crate) struct Inbox {
    pub(crate) request: Option<RenderRequest>,
    /// Wishes from before another scene mean nothing in it: a reference from such a pose may stand inside a wall.
    pub(crate) drops_request: bool,
    pub(crate) commands: Vec<RenderCommand>,
    pub(crate) outcomes: Vec<Outcome>,
}

#[derive(Debug, Default)]
pub(crate) struct Shared {
    pub(crate) inbox: Mutex<Inbox>,
    pub(crate) bell: Condvar,
    /// Raised with everything that changes the next frame.
    pub(crate) generation: AtomicU64,
    /// Set where the frame in the making is of no use at all.
    pub(crate) abandon: AtomicBool,
    pub(crate) quit: AtomicBool,
    pub(crate) is_adding: AtomicBool,
    pub(crate) frames_rendered: AtomicU64,
    pub(crate) exchange: Exchange,
}

impl Shared {
    /// Changes what the next frame shows; returns its generation. The number is raised under the lock, so that the
    /// thread never takes in a change without its number.
    fn change(&self, write: impl FnOnce(&mut Inbox)) -> u64 {
        let mut inbox = locked(&self.inbox);
        write(&mut inbox);
        let generation = self.generation.fetch_add(1, Ordering::AcqRel) + 1;
        drop(inbox);
        self.bell.notify_all();
        generation
    }

    /// True where nobody wants the picture of a generation any more.
    pub(crate) fn is_useless(&self, generation: u64) -> bool {
        let is_stale = self.generation.load(Ordering::Relaxed) != generation;
        is_stale || self.quit.load(Ordering::Relaxed) || self.abandon.load(Ordering::Relaxed)
    }

    fn deliver(&self, outcome: Outcome) {
        if matches!(outcome, Outcome::Traced(_)) {
            self.change(|inbox| inbox.outcomes.push(outcome));
        } else {
            locked(&self.inbox).outcomes.push(outcome);
            self.bell.notify_all();
        }
    }
}

/// The threads behind the window. Dropping it stops and joins them.
#[derive(Debug)]
pub struct RenderThread {
    shared: Arc<Shared>,
    messages: Receiver<Message>,
    frames: Option<JoinHandle<()>>,
    references: Option<JoinHandle<()>>,
}

/// Called from the threads when there is something new.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

impl RenderThread {
    /// Starts both threads, each with a pool of its own: the references' is one smaller, so that frames go on.
    ///
    /// # Errors
    /// Where the system gives no more threads.
    pub fn start(threads: usize, wake: Wake) -> io::Result<Self> {
        let shared = Arc::new(Shared::default());
        let (sender, messages) = unbounded();
        let inbox = shared.clone();
        let deliver = move |outcome| inbox.deliver(outcome);
        let (jobs, references) = references::start(threads.saturating_sub(1).max(1), deliver)?;
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads.max(1))
            .thread_name(|i| format!("frames-{i}"))
            .start_handler(|_| give_way())
            .build()
            .map_err(io::Error::other)?;
        let mut worker = Worker::new(shared.clone(), pool, jobs, sender, wake);
        let name = "afterimage-frames".to_owned();
        let frames = std::thread::Builder::new().name(name).spawn(move || worker.run())?;
        Ok(Self { shared, messages, frames: Some(frames), references: Some(references) })
    }

    /// Asks for the next frame; returns its generation.
    pub fn request(&self, request: RenderRequest) -> u64 {
        self.shared.change(|inbox| inbox.request = Some(request))
    }

    /// Orders something; returns the generation of the first frame that shows it.
    pub fn send(&self, command: RenderCommand) -> u64 {
        let changes_frame = !matches!(
            command,
            RenderCommand::Picture | RenderCommand::AddReference(_) | RenderCommand::ShowReference(_)
        );
        if matches!(command, RenderCommand::SetTracer(_)) {
            self.shared.abandon.store(true, Ordering::Release);
        }
        if changes_frame {
            return self.shared.change(|inbox| {
                if matches!(command, RenderCommand::SetTracer(_)) {
                    (inbox.request, inbox.drops_request) = (None, true);
                }
                inbox.commands.push(command);
            });
        }
        locked(&self.shared.inbox).commands.push(command);
        self.shared.bell.notify_all();
        self.generation()
    }

    /// The number of the newest wish.
    pub fn generation(&self) -> u64 {
        self.shared.generation.load(Ordering::Acquire)
    }

    /// Frames rendered so far, those given up included.
    pub fn frames_rendered(&self) -> u64 {
        self.shared.frames_rendered.load(Ordering::Acquire)
    }

    /// True while a reference is being traced.
    pub fn is_adding_reference(&self) -> bool {
        self.shared.is_adding.load(Ordering::Acquire)
    }

    /// Swaps the newest frame with the one shown; false where there is none newer.
    pub fn take_frame(&self, shown: &mut Option<PublishedFrame>) -> bool {
        self.shared.exchange.take(shown)
    }

    /// What the threads have to say, oldest first.
    pub fn messages(&self) -> impl Iterator<Item = Message> + '_ {
        self.messages.try_iter()
    }
}

impl RenderThread {
    /// Stops both threads and waits for them: a few milliseconds, frames and references stop where they are.
    pub fn stop(&mut self) {
        self.shared.quit.store(true, Ordering::Release);
        // Under the lock, so that the thread cannot fall asleep between its look at `quit` and the bell.
        drop(locked(&self.shared.inbox));
        self.shared.bell.notify_all();
        for handle in [self.frames.take(), self.references.take()].into_iter().flatten() {
            // A thread that panicked has already said so.
            let _ = handle.join();
        }
    }
}

impl Drop for RenderThread {
    fn drop(&mut self) {
        self.stop();
    }
}
