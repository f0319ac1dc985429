//! A trace of the stages of frames, in a build with the Cargo feature `profile`: when each began and
//! ended on each thread, in the format of chrome://tracing, which Perfetto and Speedscope read as
//! well.

use super::failure::Failure;
use afterimage::raster::save::write_atomically;
use std::collections::HashMap;
use std::fmt::Write;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::Instant;
use tracing::span::{Attributes, Id, Record};
use tracing::{Event, Metadata, Subscriber};

/// File of the trace, in the current folder.
const FILE: &str = "afterimage-trace.json";

/// Events that are kept, about 400 MB; what comes later is left out.
const MAX_EVENTS: usize = 1 << 23;

static TRACE: OnceLock<Trace> = OnceLock::new();

/// What was noted so far.
struct Trace {
    begin: Instant,
    state: Mutex<State>,
}

#[derive(Default)]
struct State {
    names: HashMap<u64, &'static str>,
    events: Vec<StageEvent>,
}

/// A stage begins or ends.
struct StageEvent {
    name: &'static str,
    begins: bool,
    thread: u64,
    micros: f64,
}

/// Receives the stages. A stage is a span of the crate `tracing`, by which `profiling` names it.
struct Collector;

/// Starts the trace.
pub(super) fn start() {
    let _ = TRACE.set(Trace { begin: Instant::now(), state: Mutex::default() });
    let _ = tracing::subscriber::set_global_default(Collector);
}

/// Writes the trace.
pub(super) fn finish() -> Result<(), Failure> {
    let Some(trace) = TRACE.get() else { return Ok(()) };
    write_atomically(Path::new(FILE), json(&trace.state().events).as_bytes())?;
    super::output::say(&format!("the trace is in {FILE}"));
    Ok(())
}

/// Returns the events as JSON.
fn json(events: &[StageEvent]) -> String {
    let mut text = "[\n".to_owned();
    for (i, StageEvent { name, begins, thread, micros }) in events.iter().enumerate() {
        let (phase, comma) = (if *begins { "B" } else { "E" }, if i + 1 < events.len() { "," } else { "" });
        // Names are those of the source: without quotes and backslashes.
        let _ = writeln!(
            text,
            "{{\"name\":\"{name}\",\"ph\":\"{phase}\",\"pid\":1,\"tid\":{thread},\"ts\":{micros:.3}}}{comma}"
        );
    }
    text + "]\n"
}

impl Trace {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn note(&self, span: &Id, begins: bool) {
        thread_local!(static THREAD: u64 = next());
        let micros = self.begin.elapsed().as_secs_f64() * 1e6;
        let mut state = self.state();
        if let Some(&name) = state.names.get(&span.into_u64())
            && state.events.len() < MAX_EVENTS
        {
            state.events.push(StageEvent { name, begins, thread: THREAD.with(|id| *id), micros });
        }
    }
}

/// Returns a number that was not returned before, from 1.
fn next() -> u64 {
    static LAST: AtomicU64 = AtomicU64::new(0);
    LAST.fetch_add(1, Ordering::Relaxed) + 1
}

impl Subscriber for Collector {
    fn enabled(&self, metadata: &Metadata<'_>) -> bool {
        metadata.is_span()
    }

    fn new_span(&self, span: &Attributes<'_>) -> Id {
        let id = next();
        if let Some(trace) = TRACE.get() {
            trace.state().names.insert(id, span.metadata().name());
        }
        Id::from_u64(id)
    }

    fn enter(&self, span: &Id) {
        TRACE.get().into_iter().for_each(|trace| trace.note(span, true));
    }

    fn exit(&self, span: &Id) {
        TRACE.get().into_iter().for_each(|trace| trace.note(span, false));
    }

    fn try_close(&self, span: Id) -> bool {
        TRACE.get().is_some_and(|trace| trace.state().names.remove(&span.into_u64()).is_some())
    }

    fn record(&self, _: &Id, _: &Record<'_>) {}

    fn record_follows_from(&self, _: &Id, _: &Id) {}

    fn event(&self, _: &Event<'_>) {}
}
