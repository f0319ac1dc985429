//! Getting a scene off the window's thread: the one place that knows where scenes come from.

use crate::window::rendering::exchange::locked;
use crate::window::rendering::render_thread::{Wake, panic_text};
use afterimage::Tracer;
use afterimage::import;
use afterimage::import::{ImportOptions, Phase};
use afterimage::scene::{Scene, SceneError, builtin};
use crossbeam_channel::{Receiver, bounded};
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;

/// Where a scene comes from.
#[derive(Clone, Debug)]
pub enum SceneSource {
    /// An embedded scene, by its name without `builtin:`.
    Builtin(String),
    /// A model file.
    File {
        /// Which.
        path: PathBuf,
        /// How to read it.
        options: ImportOptions,
    },
    /// A scene that is there already.
    Ready(Arc<Scene>),
}

impl SceneSource {
    /// The embedded scene that is shown when none is asked for.
    pub fn default_builtin() -> Self {
        Self::Builtin(builtin::NAMES.first().copied().unwrap_or("gallery").to_owned())
    }

    /// A model file, read as it says itself.
    pub fn file(path: impl Into<PathBuf>) -> Self {
        Self::File { path: path.into(), options: ImportOptions::default() }
    }

    /// As scenes are named on the command line: `builtin:NAME` or a path.
    pub fn named(name: &str, options: ImportOptions) -> Self {
        match name.strip_prefix("builtin:") {
            Some(builtin) => Self::Builtin(builtin.to_owned()),
            None => Self::File { path: name.into(), options },
        }
    }

    /// What the user knows it by.
    pub fn label(&self) -> String {
        match self {
            Self::Builtin(name) => format!("builtin:{name}"),
            Self::File { path, .. } => path.display().to_string(),
            Self::Ready(scene) => scene.name.clone(),
        }
    }
}

/// How far loading has come.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Progress {
    /// What is being done, in words.
    pub phase: String,
    /// Of this phase, 0..1; `None` where it cannot be told.
    pub fraction: Option<f32>,
}

/// A scene on its way. Dropping it cancels.
#[derive(Debug)]
pub struct Loader {
    source: SceneSource,
    progress: Arc<Mutex<Progress>>,
    cancel: Arc<AtomicBool>,
    result: Receiver<Result<Arc<Tracer>, String>>,
    handle: Option<JoinHandle<()>>,
}

/// Tells the window how far loading has come, and the loader whether to go on.
struct Report {
    progress: Arc<Mutex<Progress>>,
    cancel: Arc<AtomicBool>,
    wake: Wake,
}

impl Report {
    fn goes_on(&self) -> bool {
        !self.cancel.load(Ordering::Acquire)
    }

    fn tell(&self, phase: &str, fraction: Option<f32>) -> bool {
        *locked(&self.progress) = Progress { phase: phase.to_owned(), fraction };
        (self.wake)();
        self.goes_on()
    }

    fn begin(&self, phase: &str) -> Result<(), SceneError> {
        if self.tell(phase, None) { Ok(()) } else { Err(SceneError::Cancelled) }
    }
}

impl Loader {
    /// Starts loading on a thread of its own.
    ///
    /// # Errors
    /// Where the system gives no more threads.
    pub fn start(source: SceneSource, wake: Wake) -> io::Result<Self> {
        let progress = Arc::new(Mutex::new(Progress::default()));
        let cancel = Arc::new(AtomicBool::new(false));
        let (sender, result) = bounded(1);
        let report = Report { progress: progress.clone(), cancel: cancel.clone(), wake };
        let asked = source.clone();
        let work = move || {
            let loaded = match catch_unwind(AssertUnwindSafe(|| load(&asked, &report))) {
                Ok(loaded) => loaded.map_err(|error| error.to_string()),
                Err(panic) => Err(format!("{}: loading failed: {}", asked.label(), panic_text(&*panic))),
            };
            // The window may be gone.
            let _ = sender.send(loaded);
            (report.wake)();
        };
        let handle = std::thread::Builder::new().name("afterimage-load".to_owned()).spawn(work)?;
        Ok(Self { source, progress, cancel, result, handle: Some(handle) })
    }

    /// What is being loaded.
    pub fn source(&self) -> &SceneSource {
        &self.source
    }

    /// How far it is.
    pub fn progress(&self) -> Progress {
        locked(&self.progress).clone()
    }

    /// The scene, ready for rays, or a message; `None` while it is not there.
    pub fn result(&self) -> Option<Result<Arc<Tracer>, String>> {
        self.result.try_recv().ok()
    }
}

impl Drop for Loader {
    fn drop(&mut self) {
        self.cancel.store(true, Ordering::Release);
        // Not joined: a phase that cannot be interrupted would hold up the window. The thread keeps nothing of ours.
        drop(self.handle.take());
    }
}

fn load(source: &SceneSource, report: &Report) -> Result<Arc<Tracer>, SceneError> {
    let scene = match source {
        SceneSource::Ready(scene) => scene.clone(),
        SceneSource::Builtin(name) => {
            report.begin("building the scene")?;
            Arc::new(builtin::build(name)?)
        }
        SceneSource::File { path, options } => Arc::new(import(path, options, report)?),
    };
    report.begin("building the ray tree")?;
    let tracer = Arc::new(Tracer::new(scene).beginning_indoors());
    report.begin("ready")?;
    Ok(tracer)
}

/// Reads a model, telling its phases.
fn import(path: &Path, options: &ImportOptions, report: &Report) -> Result<Scene, SceneError> {
    // Every step of a large file is told; the window needs only what it can show.
    let shown = Mutex::new(None);
    import::load(path, options, &|phase: Phase, fraction: f32| {
        let step = (phase, (fraction * 100.0) as u32);
        if locked(&shown).replace(step) == Some(step) {
            return report.goes_on();
        }
        report.tell(phase.label(), Some(fraction))
    })
}
