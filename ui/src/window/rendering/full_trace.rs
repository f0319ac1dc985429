//! The full tracer's picture of a view, traced on a thread of its own to be compared with.

use crate::window::rendering::exchange::{Exchange, PublishedFrame};
use crate::window::rendering::render_thread::{Wake, give_way, panic_text};
use afterimage::reference::placement::{NONE, PlacementPolicy};
use afterimage::{Camera, Mode, RenderSettings, Tracer, Walkthrough, WalkthroughSettings};
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// The picture is shown anew after so long.
const SHOW_TIME: Duration = Duration::from_millis(400);

/// What decides the picture.
#[derive(Clone, Debug)]
pub(crate) struct Subject {
    pub(crate) tracer: Arc<Tracer>,
    pub(crate) camera: Camera,
    pub(crate) size: [u32; 2],
    pub(crate) render: RenderSettings,
}

impl PartialEq for Subject {
    fn eq(&self, other: &Self) -> bool {
        let is_same_scene = Arc::ptr_eq(&self.tracer, &other.tracer);
        is_same_scene && (self.camera, self.size, self.render) == (other.camera, other.size, other.render)
    }
}

/// A picture in the making. Dropping it ends the work.
#[derive(Debug)]
pub(crate) struct FullTracing {
    subject: Subject,
    exchange: Arc<Exchange>,
    cancel: Arc<AtomicBool>,
}

impl FullTracing {
    /// Starts it. `fail` is told what a panic said.
    ///
    /// # Errors
    /// Where the system gives no more threads.
    pub(crate) fn start(
        subject: Subject,
        threads: usize,
        wake: Wake,
        fail: impl Fn(String) + Send + 'static,
    ) -> io::Result<Self> {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads.max(1))
            .thread_name(|i| format!("full-{i}"))
            .start_handler(|_| give_way())
            .build()
            .map_err(io::Error::other)?;
        let (exchange, cancel) = (Arc::<Exchange>::default(), Arc::<AtomicBool>::default());
        let (subject_, exchange_, cancel_) = (subject.clone(), exchange.clone(), cancel.clone());
        let work = move || {
            let made = catch_unwind(AssertUnwindSafe(|| {
                pool.install(|| trace(&subject_, &exchange_, &cancel_, &wake));
            }));
            if let Err(panic) = made {
                fail(format!("tracing in full failed: {}", panic_text(&*panic)));
                wake();
            }
        };
        std::thread::Builder::new().name("afterimage-full".to_owned()).spawn(work)?;
        Ok(Self { subject, exchange, cancel })
    }

    pub(crate) fn subject(&self) -> &Subject {
        &self.subject
    }

    /// Swaps the newest picture with the one shown; false where there is none newer.
    pub(crate) fn take(&self, shown: &mut Option<PublishedFrame>) -> bool {
        self.exchange.take(shown)
    }
}

impl Drop for FullTracing {
    fn drop(&mut self) {
        // Not joined: the window never waits. The thread stops within some tiles and keeps nothing of ours.
        self.cancel.store(true, Ordering::Release);
    }
}

/// The first picture, then better ones until it has converged.
fn trace(subject: &Subject, exchange: &Exchange, cancel: &AtomicBool, wake: &Wake) {
    let render = RenderSettings { mode: Mode::Full, ..subject.render };
    let settings =
        WalkthroughSettings { render, placement: PlacementPolicy::new(&NONE, 0.0), ..Default::default() };
    let mut walk = Walkthrough::new(subject.tracer.clone(), settings);
    let is_cancelled = || cancel.load(Ordering::Relaxed);
    walk.render(&subject.camera, subject.size, &is_cancelled);
    let mut is_complete = false;
    while !is_cancelled() {
        let mut published = exchange.spare();
        published.fill(walk.frame(), &subject.tracer.scene().frame, walk.used(), 0);
        exchange.publish(published);
        wake();
        if is_complete {
            return;
        }
        let start = Instant::now();
        let stop = || is_cancelled() || start.elapsed() >= SHOW_TIME;
        is_complete = walk.refine(&stop).is_complete;
    }
}
