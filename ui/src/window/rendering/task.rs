//! Background tasks: a thread with progress, cancellation and one result.

use super::locked;
use crossbeam_channel::{Receiver, bounded};
use std::any::Any;
use std::fmt::Display;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Instant;

/// Asks the window to update itself. Threads call it when they have something new.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// Why a task has no result.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TaskError {
    /// The task was cancelled. This is not shown to the user.
    Cancelled,
    /// The task failed or panicked. The text is shown to the user.
    Failed(String),
}

impl TaskError {
    /// A failure with a message for the user.
    pub fn failed(cause: impl Display) -> Self {
        Self::Failed(cause.to_string())
    }
}

/// Progress of a background task, as the window shows it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Progress {
    /// Name of the current phase, such as the part of an import.
    pub phase: String,
    /// Part of the phase that is done, 0..1; `None` where it is unknown.
    pub fraction: Option<f32>,
}

/// Reports are shown in steps of 1 / 200: half a percent, finer than a progress bar can show.
const STEPS: f32 = 200.0;

#[derive(Default)]
struct Shared {
    is_cancelled: AtomicBool,
    progress: Mutex<Progress>,
}

/// The side of a task that its work uses.
pub struct TaskHandle {
    shared: Arc<Shared>,
    wake: Wake,
}

impl TaskHandle {
    /// True once the result is no longer wanted.
    pub fn is_cancelled(&self) -> bool {
        self.shared.is_cancelled.load(Ordering::Relaxed)
    }

    /// Asks the window to update itself.
    pub fn wake(&self) {
        (self.wake)();
    }

    /// Begins a phase of unknown length.
    ///
    /// # Errors
    /// [`TaskError::Cancelled`] once the result is no longer wanted.
    pub fn begin(&self, phase: &str) -> Result<(), TaskError> {
        *locked(&self.shared.progress) = Progress { phase: phase.to_owned(), fraction: None };
        self.wake();
        if self.is_cancelled() { Err(TaskError::Cancelled) } else { Ok(()) }
    }

    /// Reports which part of a phase is done, 0..1. May be called from many threads, after every
    /// tile: a caller that would have to wait leaves the report to another one.
    pub fn report(&self, phase: &str, fraction: f32) {
        let Ok(mut shown) = self.shared.progress.try_lock() else { return };
        let step = |fraction: f32| (fraction * STEPS) as u32;
        if shown.phase != phase || shown.fraction.map(step) != Some(step(fraction)) {
            *shown = Progress { phase: phase.to_owned(), fraction: Some(fraction) };
            drop(shown);
            self.wake();
        }
    }
}

/// The window's side of a task. Dropping it cancels the work and does not wait for its end.
pub struct Task<T> {
    shared: Arc<Shared>,
    result: Receiver<Result<T, TaskError>>,
    thread: Option<JoinHandle<()>>,
}

impl<T> Task<T> {
    /// Returns the progress of the work.
    pub fn progress(&self) -> Progress {
        locked(&self.shared.progress).clone()
    }

    /// Returns the result once, when it is there.
    pub fn result(&self) -> Option<Result<T, TaskError>> {
        self.result.try_recv().ok()
    }

    /// Asks the work to end early. Its result arrives as usual.
    pub fn cancel(&self) {
        self.shared.is_cancelled.store(true, Ordering::Relaxed);
    }

    /// Cancels the work and waits for its end: afterwards it has left no half-written file.
    pub fn cancel_and_wait(mut self) {
        self.shared.is_cancelled.store(true, Ordering::Relaxed);
        if let Some(thread) = self.thread.take() {
            // A panic was caught and has become the result.
            let _ = thread.join();
        }
    }
}

impl<T> Drop for Task<T> {
    fn drop(&mut self) {
        self.shared.is_cancelled.store(true, Ordering::Relaxed);
    }
}

/// Returns the result of a task that has ended, and empties its slot.
pub fn take_result<T>(slot: &mut Option<Task<T>>) -> Option<Result<T, TaskError>> {
    let result = slot.as_ref()?.result()?;
    *slot = None;
    Some(result)
}

/// Runs `work` on a thread of its own and wakes the window when it has ended. A panic, or a thread
/// that cannot be started, is a failure of the task.
pub fn spawn_task<T: Send + 'static>(
    name: &str,
    wake: Wake,
    work: impl FnOnce(&TaskHandle) -> Result<T, TaskError> + Send + 'static,
) -> Task<T> {
    spawn(name, None, wake, work)
}

/// As [`spawn_task`]; the message about a panic or a thread that cannot be started begins with
/// `activity`, such as `saving`. Other failures say themselves what failed.
pub fn spawn_activity<T: Send + 'static>(
    name: &str,
    activity: &str,
    wake: Wake,
    work: impl FnOnce(&TaskHandle) -> Result<T, TaskError> + Send + 'static,
) -> Task<T> {
    spawn(name, Some(activity.to_owned()), wake, work)
}

fn spawn<T: Send + 'static>(
    name: &str,
    activity: Option<String>,
    wake: Wake,
    work: impl FnOnce(&TaskHandle) -> Result<T, TaskError> + Send + 'static,
) -> Task<T> {
    let not_started_text = format!("{} cannot be started", activity.as_deref().unwrap_or("a thread"));
    let panicked_text = activity.map(|activity| format!("{activity} failed: ")).unwrap_or_default();
    let shared = Arc::<Shared>::default();
    let (sender, result) = bounded(1);
    let (handle, not_started) = (TaskHandle { shared: shared.clone(), wake }, sender.clone());
    let what = name.to_owned();
    let run = move || {
        let start = Instant::now();
        let done = catch_unwind(AssertUnwindSafe(|| work(&handle)));
        let done = done.unwrap_or_else(|panic| Err(TaskError::Failed(panicked_text + &panic_text(&*panic))));
        let end = done.as_ref().map_or_else(|error| format!("{error:?}"), |_| "done".to_owned());
        log::debug!("task {what}: {end} after {:.3} s", start.elapsed().as_secs_f64());
        // A task that was dropped receives nothing.
        let _ = sender.send(done);
        handle.wake();
    };
    let thread = std::thread::Builder::new().name(format!("afterimage-{name}")).spawn(run);
    if let Err(error) = &thread {
        // The receiver lives: it is returned below.
        let _ = not_started.send(Err(TaskError::Failed(format!("{not_started_text}: {error}"))));
    }
    Task { shared, result, thread: thread.ok() }
}

/// Returns the message of a panic.
pub(crate) fn panic_text(panic: &(dyn Any + Send)) -> String {
    let text = panic.downcast_ref::<&str>().map(|s| (*s).to_owned());
    text.or_else(|| panic.downcast_ref::<String>().cloned()).unwrap_or_else(|| "no message".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    fn silent() -> Wake {
        Arc::new(|| {})
    }

    fn outcome<T: Send + 'static>(task: &Task<T>) -> Result<T, TaskError> {
        task.result.recv_timeout(Duration::from_secs(60)).unwrap()
    }

    #[test]
    fn a_result_a_failure_and_a_panic_arrive() {
        assert_eq!(outcome(&spawn_task("a", silent(), |_| Ok(7))), Ok(7));
        let failed = spawn_task::<()>("b", silent(), |_| Err(TaskError::failed("full")));
        assert_eq!(outcome(&failed), Err(TaskError::Failed("full".to_owned())));
        let panicked = spawn_task::<()>("c", silent(), |_| panic!("a bug"));
        assert_eq!(outcome(&panicked), Err(TaskError::Failed("a bug".to_owned())));
    }

    #[test]
    fn progress_wakes_the_window_and_cancelling_ends_the_work() {
        let (ring, bell) = crossbeam_channel::unbounded();
        let wake: Wake = Arc::new(move || assert!(ring.send(()).is_ok()));
        let task = spawn_task::<()>("d", wake, |task| {
            (0..1000).for_each(|_| task.report("half", 0.5));
            loop {
                task.begin("waiting")?;
            }
        });
        bell.recv_timeout(Duration::from_secs(60)).unwrap();
        task.cancel_and_wait();
    }

    #[test]
    fn a_result_is_taken_once() {
        let mut slot = Some(spawn_task("e", silent(), |_| Ok(())));
        while slot.is_some() {
            if let Some(result) = take_result(&mut slot) {
                assert_eq!(result, Ok(()));
            }
        }
        assert_eq!(take_result(&mut slot), None);
    }
}
