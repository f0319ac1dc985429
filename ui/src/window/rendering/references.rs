//! The thread that traces references, and their light by groups, while frames are rendered.

use super::{panic_text, reference_pool};
use afterimage::ReferenceJob;
use afterimage::reference::ReferenceFrame;
use afterimage::render::{LayerJob, TracedLayers};
use crossbeam_channel::{Receiver, Sender, unbounded};
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;

/// Something to be traced.
#[derive(Debug)]
pub(super) enum Traceable {
    Reference(ReferenceJob),
    Layers(LayerJob),
}

/// Something to be traced, and what ends it early.
#[derive(Debug)]
pub(super) struct Job {
    pub(super) work: Traceable,
    pub(super) cancel: Arc<AtomicBool>,
}

/// Result of a job.
#[derive(Debug)]
pub(super) enum Outcome {
    Traced(Box<ReferenceFrame>),
    Cancelled,
    Panicked(String),
    /// Light by groups; `None` after a cancellation or a panic.
    Layers(Option<Box<TracedLayers>>),
}

/// Starts the thread with a pool of its own. It ends when the sender is dropped.
///
/// # Errors
/// Where the system refuses to start the threads.
pub(super) fn start(
    threads: usize,
    deliver: impl Fn(Outcome) + Send + 'static,
) -> io::Result<(Sender<Job>, JoinHandle<()>)> {
    let pool = reference_pool(threads)?;
    let (sender, jobs) = unbounded();
    let name = "afterimage-reference".to_owned();
    let handle = std::thread::Builder::new().name(name).spawn(move || serve(&pool, &jobs, &deliver))?;
    Ok((sender, handle))
}

fn serve(pool: &rayon::ThreadPool, jobs: &Receiver<Job>, deliver: &dyn Fn(Outcome)) {
    for job in jobs {
        let stop = || job.cancel.load(Ordering::Relaxed);
        let trace = || match &job.work {
            Traceable::Reference(reference) => match reference.trace(&stop) {
                Some(frame) if !stop() => Outcome::Traced(Box::new(frame)),
                _ => Outcome::Cancelled,
            },
            Traceable::Layers(layers) => Outcome::Layers(layers.trace(&stop).map(Box::new)),
        };
        let traced = catch_unwind(AssertUnwindSafe(|| pool.install(trace)));
        deliver(traced.unwrap_or_else(|panic| match job.work {
            Traceable::Reference(_) => Outcome::Panicked(panic_text(&*panic)),
            Traceable::Layers(_) => Outcome::Layers(None),
        }));
    }
}
