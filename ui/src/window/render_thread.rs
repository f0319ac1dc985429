//! The thread that renders the newest pose, and nothing that nobody wants any more.
//!
//! Whatever the window wishes for raises a number, the generation. A frame carries the generation it was begun with;
//! one thread makes all frames in that order, so an older pose is never shown after a newer one.

use super::frames::{Exchange, PublishedFrame, locked};
use super::reference_thread::{self, Job, Outcome};
use afterimage::reference::ReferenceId;
use afterimage::{Camera, RenderSettings, Scene, Tracer, Walkthrough, WalkthroughSettings};
use crossbeam_channel::{Receiver, Sender, unbounded};
use glam::Vec3;
use std::any::Any;
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// All that decides the next frame; the newest replaces those before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wish {
    /// Where to look from.
    pub camera: Camera,
    /// Width and height in pixels. Nothing is rendered while one is zero.
    pub size: [u32; 2],
    /// What to render with.
    pub settings: WalkthroughSettings,
    /// A frame that nobody waits for any more is given up after so long.
    pub budget: Duration,
    /// Nothing is rendered while paused.
    pub is_paused: bool,
}

/// What must be done once, in order.
#[derive(Clone, Debug)]
pub enum Order {
    /// Shows another scene. Nothing is rendered before the next wish.
    SetTracer(Arc<Tracer>),
    /// Traces a reference at a pose, whatever the policy says.
    AddReference(Camera),
    /// Drops a reference.
    Remove(ReferenceId),
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
}

/// What the threads have to say beside frames.
#[derive(Clone, Debug)]
pub enum Message {
    /// As ordered.
    Picture(Picture),
    /// Something failed; the threads go on.
    Failed(String),
}

#[derive(Debug, Default)]
struct Inbox {
    wish: Option<Wish>,
    /// Wishes from before another scene mean nothing in it: a reference from such a pose may stand inside a wall.
    forgets_wish: bool,
    orders: Vec<Order>,
    outcomes: Vec<Outcome>,
}

#[derive(Debug, Default)]
struct Shared {
    inbox: Mutex<Inbox>,
    bell: Condvar,
    /// Raised with everything that changes the next frame.
    generation: AtomicU64,
    /// Set where the frame in the making is of no use at all.
    abandon: AtomicBool,
    quit: AtomicBool,
    is_adding: AtomicBool,
    frames_rendered: AtomicU64,
    exchange: Exchange,
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
        let (jobs, references) = reference_thread::start(threads.saturating_sub(1).max(1), deliver)?;
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads.max(1))
            .thread_name(|i| format!("frames-{i}"))
            .start_handler(|_| give_way())
            .build()
            .map_err(io::Error::other)?;
        let mut worker = Worker {
            shared: shared.clone(),
            pool,
            jobs,
            messages: sender,
            wake,
            walk: None,
            wish: None,
            job: None,
            refused: Vec::new(),
            asked: None,
            wants_picture: false,
            rendered: None,
            added: Vec::new(),
        };
        let name = "afterimage-frames".to_owned();
        let frames = std::thread::Builder::new().name(name).spawn(move || worker.run())?;
        Ok(Self { shared, messages, frames: Some(frames), references: Some(references) })
    }

    /// Asks for the next frame; returns its generation.
    pub fn wish(&self, wish: Wish) -> u64 {
        self.shared.change(|inbox| inbox.wish = Some(wish))
    }

    /// Orders something; returns the generation of the first frame that shows it.
    pub fn order(&self, order: Order) -> u64 {
        let changes_frame = !matches!(order, Order::Picture | Order::AddReference(_));
        if matches!(order, Order::SetTracer(_)) {
            self.shared.abandon.store(true, Ordering::Release);
        }
        if changes_frame {
            return self.shared.change(|inbox| {
                if matches!(order, Order::SetTracer(_)) {
                    (inbox.wish, inbox.forgets_wish) = (None, true);
                }
                inbox.orders.push(order);
            });
        }
        locked(&self.shared.inbox).orders.push(order);
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

/// The window and a software rasteriser's threads go first: on two cores without a graphics card the window came
/// round every 300 ms while the gallery was rendered, and every 75 ms since. References stay equal to frames: the
/// frames after them are the cheaper.
const NICENESS: i32 = 4;

/// Lowers the priority of the calling thread.
pub(super) fn give_way() {
    // Elsewhere it is the whole process that becomes nicer. Refused means equal shares: nothing is wrong then.
    #[cfg(target_os = "linux")]
    let _ = rustix::process::nice(NICENESS);
    #[cfg(not(target_os = "linux"))]
    let _ = NICENESS;
}

/// Where a reference stands, and its size.
type Place = (Camera, [u32; 2]);

/// A reference in the making.
struct Running {
    cancel: Arc<AtomicBool>,
    place: Place,
}

struct Worker {
    shared: Arc<Shared>,
    pool: rayon::ThreadPool,
    jobs: Sender<Job>,
    messages: Sender<Message>,
    wake: Wake,
    walk: Option<Walkthrough>,
    wish: Option<Wish>,
    /// Ends the reference in the making.
    job: Option<Running>,
    /// Poses and sizes at which tracing a reference failed: the policy would ask for them for ever.
    refused: Vec<Place>,
    /// A reference asked for by hand while another was in the making.
    asked: Option<Camera>,
    wants_picture: bool,
    /// The generation of the last frame, `None` where it is to be made again.
    rendered: Option<u64>,
    added: Vec<(ReferenceId, Instant)>,
}

impl Worker {
    fn run(&mut self) {
        while let Some(generation) = self.wait() {
            if self.can_render() && self.rendered != Some(generation) {
                self.render(generation);
            }
            self.request_reference();
            self.hand_out_picture();
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
            if std::mem::take(&mut inbox.forgets_wish) {
                self.wish = None;
            }
            let wish = inbox.wish.or(self.wish);
            let is_due = self.rendered != Some(generation)
                && self.walk.is_some()
                && wish.is_some_and(|w| !w.is_paused && !w.size.contains(&0));
            let has_news = inbox.wish.is_some() || !inbox.orders.is_empty() || !inbox.outcomes.is_empty();
            if is_due || has_news {
                self.wish = wish;
                inbox.wish = None;
                let (orders, outcomes) =
                    (std::mem::take(&mut inbox.orders), std::mem::take(&mut inbox.outcomes));
                drop(inbox);
                outcomes.into_iter().for_each(|o| self.take_in(o));
                orders.into_iter().for_each(|o| self.carry_out(o));
                return Some(generation);
            }
            inbox = shared.bell.wait(inbox).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn can_render(&self) -> bool {
        self.walk.is_some() && self.wish.is_some_and(|w| !w.is_paused && !w.size.contains(&0))
    }

    fn carry_out(&mut self, order: Order) {
        match order {
            Order::SetTracer(tracer) => {
                self.cancel_reference();
                self.shared.abandon.store(false, Ordering::Release);
                let settings = self.wish.map(|w| w.settings).unwrap_or_default();
                // A new walk rather than the old one with another tracer: what is not traced yet in the first frame
                // would show the old scene.
                self.walk = Some(Walkthrough::new(tracer, settings));
                self.added.clear();
                self.refused.clear();
            }
            Order::AddReference(camera) => self.asked = Some(camera),
            Order::Remove(id) => {
                if let Some(walk) = &mut self.walk {
                    walk.cache_mut().remove(id);
                }
            }
            Order::Clear => {
                self.cancel_reference();
                if let Some(walk) = &mut self.walk {
                    walk.cache_mut().clear();
                }
            }
            Order::Picture => self.wants_picture = true,
        }
    }

    fn take_in(&mut self, outcome: Outcome) {
        let job = self.job.take();
        let was_cancelled = job.as_ref().is_none_or(|job| job.cancel.load(Ordering::Acquire));
        self.shared.is_adding.store(false, Ordering::Release);
        match outcome {
            Outcome::Traced(frame) if !was_cancelled => {
                let id = self.walk.as_mut().and_then(|walk| walk.insert(*frame));
                self.added.extend(id.map(|id| (id, Instant::now())));
                if let Some(walk) = &self.walk {
                    self.added.retain(|(id, _)| walk.cache().entries().iter().any(|e| e.id == *id));
                }
            }
            Outcome::Panicked(text) => {
                self.refused.extend(job.filter(|_| !was_cancelled).map(|job| job.place));
                self.say(Message::Failed(format!("tracing a reference failed: {text}")))
            }
            Outcome::Traced(_) | Outcome::Cancelled => {}
        }
        (self.wake)();
    }

    fn render(&mut self, generation: u64) {
        let (Some(walk), Some(wish)) = (&mut self.walk, self.wish) else { return };
        let start = Instant::now();
        let shared = &*self.shared;
        let stop = || {
            let is_stale = shared.generation.load(Ordering::Relaxed) != generation;
            let is_useless = shared.quit.load(Ordering::Relaxed) || shared.abandon.load(Ordering::Relaxed);
            is_useless || (is_stale && start.elapsed() >= wish.budget)
        };
        if *walk.settings() != wish.settings {
            walk.set_settings(wish.settings);
            self.refused.clear();
        }
        let mut published = shared.exchange.spare();
        let added = &self.added;
        let made = catch_unwind(AssertUnwindSafe(|| {
            self.pool.install(|| {
                walk.render(&wish.camera, wish.size, &stop);
                published.fill(walk.frame(), walk.used(), generation);
                published.list(walk.cache(), walk.used(), added);
            });
        }));
        self.rendered = Some(generation);
        shared.frames_rendered.fetch_add(1, Ordering::AcqRel);
        match made {
            Ok(()) if !shared.abandon.load(Ordering::Acquire) => shared.exchange.publish(published),
            Ok(()) => {}
            Err(panic) => {
                // Its buffers may be half-written; the scene is not.
                *walk = Walkthrough::new(walk.tracer().clone(), wish.settings);
                let text = panic_text(&*panic);
                self.say(Message::Failed(format!("rendering failed: {text}")));
            }
        }
        (self.wake)();
    }

    /// Starts the reference that was asked for or that the policy wants, unless one is in the making.
    fn request_reference(&mut self) {
        if self.job.is_some() || !self.can_render() {
            return;
        }
        let (Some(walk), Some(wish)) = (&mut self.walk, self.wish) else { return };
        let wanted =
            || wanted(walk, wish.size).filter(|camera| !self.refused.contains(&(*camera, wish.size)));
        let Some(camera) = self.asked.take().or_else(wanted) else { return };
        let cancel = Arc::new(AtomicBool::new(false));
        let (tracer, settings) = (walk.tracer().clone(), walk.reference_settings());
        let job = Job { tracer, camera, size: wish.size, settings, cancel: cancel.clone() };
        if self.jobs.send(job).is_ok() {
            self.job = Some(Running { cancel, place: (camera, wish.size) });
            self.shared.is_adding.store(true, Ordering::Release);
            (self.wake)();
        }
    }

    /// The outcome still arrives and is then dropped.
    fn cancel_reference(&mut self) {
        self.asked = None;
        if let Some(job) = &self.job {
            job.cancel.store(true, Ordering::Release);
        }
    }

    fn hand_out_picture(&mut self) {
        let Some(walk) = self.walk.as_ref().filter(|_| self.wants_picture) else { return };
        let frame = walk.frame();
        let is_paused = self.wish.is_some_and(|w| w.is_paused);
        if frame.radiance.is_empty() || !(frame.stats.is_complete || is_paused) {
            return;
        }
        self.wants_picture = false;
        self.say(Message::Picture(Picture {
            size: frame.view.size,
            radiance: frame.radiance.clone(),
            scene: walk.tracer().scene().clone(),
            camera: frame.camera,
            settings: walk.settings().render,
            is_complete: frame.stats.is_complete,
        }));
        (self.wake)();
    }

    fn say(&self, message: Message) {
        // Nobody listens once the window is gone.
        let _ = self.messages.send(message);
    }
}

/// The pose at which the policy wants a reference, unless there already is one of just that pose: a view whose Type 3
/// stays high all the same would ask for it for ever.
fn wanted(walk: &Walkthrough, size: [u32; 2]) -> Option<Camera> {
    let camera = walk.wanted_reference()?;
    let is_same = |e: &afterimage::reference::cache::CachedReference| {
        e.frame.camera == camera && e.frame.view.size == size
    };
    (!walk.cache().entries().iter().any(is_same)).then_some(camera)
}

/// What a panic said.
pub(super) fn panic_text(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|s| (*s).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "no message".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use afterimage::Mode;
    use afterimage::reference::PlacementPolicy;
    use afterimage::scene::{Material, SceneBuilder};
    use glam::{DVec3, Vec2};

    fn worker() -> (Worker, Receiver<Job>, Receiver<Message>) {
        let mut builder = SceneBuilder::new("square");
        let material = builder.add_material(Material::diffuse("m", Vec3::ONE));
        let corners = [DVec3::ZERO, DVec3::X, DVec3::X + DVec3::Y, DVec3::Y];
        builder.add_quad(corners, Vec2::ONE, material);
        let tracer = Arc::new(Tracer::new(Arc::new(builder.finish().unwrap())));
        let mut settings = WalkthroughSettings {
            placement: PlacementPolicy::Threshold { percent: 5.0 },
            ..WalkthroughSettings::default()
        };
        settings.render.mode = Mode::Paper;
        let camera = Camera::look_at(DVec3::new(0.5, 0.5, 0.5), DVec3::new(0.5, 0.5, 0.0), 60.0);
        let wish = Wish { camera, size: [16, 16], settings, budget: Duration::ZERO, is_paused: false };
        let (jobs, sent) = unbounded();
        let (messages, said) = unbounded();
        let worker = Worker {
            shared: Arc::default(),
            pool: rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap(),
            jobs,
            messages,
            wake: Arc::new(|| {}),
            walk: Some(Walkthrough::new(tracer, settings)),
            wish: Some(wish),
            job: None,
            refused: Vec::new(),
            asked: None,
            wants_picture: false,
            rendered: None,
            added: Vec::new(),
        };
        (worker, sent, said)
    }

    #[test]
    fn a_reference_that_failed_is_not_asked_for_again_until_settings_change() {
        let (mut worker, sent, said) = worker();
        worker.render(0);
        worker.request_reference();
        assert_eq!(sent.try_iter().count(), 1, "the first view has no reference");
        worker.take_in(Outcome::Panicked("a bug".to_owned()));
        assert!(matches!(said.try_recv(), Ok(Message::Failed(text)) if text.contains("a bug")));
        worker.request_reference();
        worker.render(0);
        worker.request_reference();
        assert_eq!(sent.try_iter().count(), 0);
        if let Some(wish) = &mut worker.wish {
            wish.settings.render.trace.samples += 1;
        }
        worker.render(0);
        worker.request_reference();
        assert_eq!(sent.try_iter().count(), 1);
    }
}
