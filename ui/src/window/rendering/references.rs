//! The thread that traces references while frames are rendered.

use super::{panic_text, reference_pool};
use afterimage::ReferenceJob;
use afterimage::reference::ReferenceFrame;
use crossbeam_channel::{Receiver, Sender, unbounded};
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;

/// A reference to be traced.
#[derive(Debug)]
pub(super) struct Job {
    pub(super) reference: ReferenceJob,
    /// Ends tracing early; the outcome is then [`Outcome::Cancelled`].
    pub(super) cancel: Arc<AtomicBool>,
}

/// Result of tracing a reference.
#[derive(Debug)]
pub(super) enum Outcome {
    Traced(Box<ReferenceFrame>),
    Cancelled,
    Panicked(String),
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
        let trace = || {
            let stop = || job.cancel.load(Ordering::Relaxed);
            job.reference.trace(&stop)
        };
        let outcome = match catch_unwind(AssertUnwindSafe(|| pool.install(trace))) {
            Err(panic) => Outcome::Panicked(panic_text(&*panic)),
            Ok(Some(frame)) if !job.cancel.load(Ordering::Relaxed) => Outcome::Traced(Box::new(frame)),
            Ok(_) => Outcome::Cancelled,
        };
        deliver(outcome);
    }
}
