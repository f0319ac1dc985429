//! The full tracer's picture of a view, traced in the background for the comparison.

use super::{
    Exchange, PublishedFrame, Quantity, Task, TaskError, TaskHandle, Wake, background_pool, spawn_task,
};
use afterimage::reference::placement::{NONE, PlacementPolicy};
use afterimage::{Camera, Mode, RenderSettings, Tracer, Walkthrough, WalkthroughSettings};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Time between two pictures that are shown while they converge.
const SHOW_TIME: Duration = Duration::from_millis(400);

/// Everything that decides the picture.
#[derive(Clone)]
pub(crate) struct Subject {
    pub(crate) tracer: Arc<Tracer>,
    pub(crate) camera: Camera,
    pub(crate) size: [u32; 2],
    pub(crate) render: RenderSettings,
}

impl PartialEq for Subject {
    fn eq(&self, other: &Self) -> bool {
        let scene = |subject: &Self| (subject.tracer.epoch(), subject.tracer.section().cloned());
        let is_same_scene = scene(self) == scene(other);
        is_same_scene && (self.camera, self.size, self.render) == (other.camera, other.size, other.render)
    }
}

/// A picture that is being traced, or has converged. Dropping it cancels the work without waiting.
pub(crate) struct FullTrace {
    pub(crate) subject: Subject,
    exchange: Arc<Exchange>,
    task: Task<()>,
}

impl FullTrace {
    /// Starts tracing on a pool of its own.
    pub(crate) fn start(subject: Subject, threads: usize, wake: Wake) -> Self {
        let exchange = Arc::<Exchange>::default();
        let (wanted, shown) = (subject.clone(), exchange.clone());
        let task = spawn_task("full", wake, move |task| {
            let pool = background_pool("full", threads).map_err(TaskError::failed)?;
            pool.install(|| trace(&wanted, &shown, task));
            Ok(())
        });
        Self { subject, exchange, task }
    }

    /// Swaps the newest picture with the one shown; false where there is none newer.
    pub(crate) fn take(&self, shown: &mut Option<PublishedFrame>) -> bool {
        self.exchange.take(shown)
    }

    /// Returns the message of a failure, once.
    pub(crate) fn failure(&self) -> Option<String> {
        match self.task.result() {
            Some(Err(TaskError::Failed(text))) => Some(text),
            _ => None,
        }
    }
}

/// Publishes the first picture, then refined ones until it has converged.
fn trace(subject: &Subject, exchange: &Exchange, task: &TaskHandle) {
    let render = RenderSettings { mode: Mode::Full, ..subject.render };
    let settings =
        WalkthroughSettings { render, placement: PlacementPolicy::new(&NONE, 0.0), ..Default::default() };
    let mut walk = Walkthrough::new(subject.tracer.clone(), settings);
    walk.render(&subject.camera, subject.size, &|| task.is_cancelled());
    let mut is_complete = false;
    while !task.is_cancelled() {
        let mut published = exchange.spare();
        let shown = (walk.frame(), &**subject.tracer.scene());
        published.fill(shown, Quantity::Picture, walk.used(), 0);
        exchange.publish(published);
        task.wake();
        if is_complete {
            return;
        }
        let start = Instant::now();
        let stop = || task.is_cancelled() || start.elapsed() >= SHOW_TIME;
        is_complete = walk.refine(&stop).is_complete;
    }
}
