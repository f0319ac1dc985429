//! Writes references to a store on a thread of its own, so that no frame waits for it.

use super::append::{Appender, SEGMENT_BYTES};
use super::codec::encode;
use super::content::SceneContent;
use super::record::write_record;
use super::segment::SEGMENT_HEADER_BYTES;
use super::summary::{Purpose, RecordSummary};
use super::{StoreSettings, budget};
use crate::reference::ReferenceFrame;
use crate::trace::Tracer;
use std::io;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{SystemTime, UNIX_EPOCH};

/// References that may wait to be written: they keep their memory meanwhile.
const QUEUE: usize = 16;

/// A reference to be written, with the scene that it shows.
pub(super) struct WriteJob {
    pub(super) reference: Arc<ReferenceFrame>,
    pub(super) purpose: Purpose,
    pub(super) tracer: Arc<Tracer>,
    pub(super) content: Arc<SceneContent>,
}

/// What was written so far.
#[derive(Clone, Debug, Default)]
pub struct WriteReport {
    /// Number of records.
    pub records: u64,
    /// Their bytes.
    pub bytes: u64,
    /// References that were not written, because too many waited or the store cannot be written.
    pub dropped: u64,
    /// Why nothing more is written, in one line.
    pub problem: Option<String>,
}

/// Hands references to the thread that writes them.
#[derive(Debug)]
pub(super) struct StoreWriter {
    sender: Option<SyncSender<WriteJob>>,
    thread: Option<JoinHandle<()>>,
    report: Arc<Mutex<WriteReport>>,
    has_told: bool,
}

impl StoreWriter {
    /// Starts the thread. Files are created with the first reference.
    pub(super) fn start(settings: &StoreSettings) -> Self {
        let (sender, jobs) = sync_channel(QUEUE);
        let report = Arc::new(Mutex::new(WriteReport::default()));
        let appender = Appender::new(&settings.folder, SEGMENT_BYTES.min(settings.max_bytes / 4));
        let writing = Writing { settings: settings.clone(), appender, report: Arc::clone(&report) };
        let name = "afterimage-store".to_owned();
        let thread = std::thread::Builder::new().name(name).spawn(move || writing.run(&jobs)).ok();
        Self { sender: Some(sender), thread, report, has_told: false }
    }

    /// Queues a reference. Where too many wait, it is dropped and counted, or, with `waits`, the
    /// caller waits.
    pub(super) fn write(&self, job: WriteJob, waits: bool) {
        let Some(sender) = &self.sender else { return };
        let is_refused = match waits {
            true => sender.send(job).is_err(),
            false => sender.try_send(job).is_err(),
        };
        if is_refused {
            lock(&self.report).dropped += 1;
        }
    }

    /// What was written so far.
    pub(super) fn report(&self) -> WriteReport {
        lock(&self.report).clone()
    }

    /// The problem that ended writing, if it was not taken before.
    pub(super) fn take_problem(&mut self) -> Option<String> {
        let problem = lock(&self.report).problem.clone().filter(|_| !self.has_told);
        self.has_told |= problem.is_some();
        problem
    }

    /// Waits until all references are written.
    pub(super) fn finish(&mut self) {
        self.sender = None;
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

impl Drop for StoreWriter {
    fn drop(&mut self) {
        self.finish();
    }
}

fn lock(report: &Mutex<WriteReport>) -> std::sync::MutexGuard<'_, WriteReport> {
    report.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The state of the thread.
struct Writing {
    settings: StoreSettings,
    appender: Appender,
    report: Arc<Mutex<WriteReport>>,
}

impl Writing {
    fn run(mut self, jobs: &Receiver<WriteJob>) {
        while let Ok(job) = jobs.recv() {
            let is_refused = lock(&self.report).problem.is_some();
            let written = if is_refused { None } else { self.write(&job) };
            let mut report = lock(&self.report);
            match written {
                Some(bytes) => {
                    log::debug!("a reference is in the store, {bytes} bytes");
                    report.records += 1;
                    report.bytes += bytes;
                }
                None => report.dropped += 1,
            }
        }
        // Without it a loss of power may take records, which the next scan then leaves out.
        let _ = self.appender.sync();
    }

    /// Writes a reference and returns the bytes of its record.
    fn write(&mut self, job: &WriteJob) -> Option<u64> {
        profiling::scope!("write to the store");
        let WriteJob { reference, purpose, tracer, content } = job;
        let summary = RecordSummary::of(reference, *purpose, tracer.scene(), content).write();
        let record = write_record(&summary, &encode(reference, tracer, content), now())?;
        match self.append(&record) {
            Ok(()) => Some(record.len() as u64),
            Err(problem) => {
                log::warn!("{problem}; nothing more is written");
                lock(&self.report).problem = Some(problem);
                None
            }
        }
    }

    fn append(&mut self, record: &[u8]) -> Result<(), String> {
        let (folder, most) = (&self.settings.folder, self.settings.max_bytes);
        let failed = |e: io::Error| format!("cannot write to the store {}: {e}", folder.display());
        let bytes = record.len() as u64 + SEGMENT_HEADER_BYTES;
        let free = most.saturating_sub(bytes);
        if bytes > most || budget::shrink(folder, free, self.appender.path()) > free {
            return Err(format!(
                "the store {} is full: it has its limit of {} MB (--store-mb)",
                folder.display(),
                most >> 20
            ));
        }
        self.appender.append(record).map_err(failed)
    }
}

/// Seconds since 1970.
pub(super) fn now() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs())
}
