//! Getting a scene off the window's thread: the one place that knows where scenes come from.

use super::frames::locked;
use super::render_thread::{Wake, panic_text};
use super::stand_in;
use afterimage::Tracer;
use afterimage::scene::{Scene, SceneError, builtin};
use crossbeam_channel::{Receiver, bounded};
use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;

/// Where a scene comes from.
#[derive(Clone, Debug)]
pub enum SceneSource {
    /// An embedded scene, by its name without `builtin:`.
    Builtin(String),
    /// A model file.
    File(PathBuf),
    /// A scene that is there already.
    Ready(Arc<Scene>),
}

impl SceneSource {
    /// The embedded scene that is shown when none is asked for.
    pub fn default_builtin() -> Self {
        Self::Builtin(builtin::NAMES.first().copied().unwrap_or("gallery").to_owned())
    }

    /// What the user knows it by.
    pub fn label(&self) -> String {
        match self {
            Self::Builtin(name) => format!("builtin:{name}"),
            Self::File(path) => path.display().to_string(),
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

/// Tells how far loading has come; false asks to stop.
type Report<'a> = &'a dyn Fn(&str, Option<f32>) -> bool;

impl Loader {
    /// Starts loading on a thread of its own.
    ///
    /// # Errors
    /// Where the system gives no more threads.
    pub fn start(source: SceneSource, wake: Wake) -> io::Result<Self> {
        let progress = Arc::new(Mutex::new(Progress::default()));
        let cancel = Arc::new(AtomicBool::new(false));
        let (sender, result) = bounded(1);
        let (shared, cancelled, asked) = (progress.clone(), cancel.clone(), source.clone());
        let work = move || {
            let report = |phase: &str, fraction: Option<f32>| {
                *locked(&shared) = Progress { phase: phase.to_owned(), fraction };
                wake();
                !cancelled.load(Ordering::Acquire)
            };
            let loaded = match catch_unwind(AssertUnwindSafe(|| load(&asked, &report))) {
                Ok(loaded) => loaded.map_err(|error| error.to_string()),
                Err(panic) => Err(format!("{}: loading failed: {}", asked.label(), panic_text(&*panic))),
            };
            // The window may be gone.
            let _ = sender.send(loaded);
            wake();
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

fn load(source: &SceneSource, report: Report<'_>) -> Result<Arc<Tracer>, SceneError> {
    let goes_on = |phase: &str| report(phase, None).then_some(()).ok_or(SceneError::Cancelled);
    let scene = match source {
        SceneSource::Ready(scene) => scene.clone(),
        SceneSource::Builtin(name) => {
            goes_on("building the scene")?;
            Arc::new(embedded(name)?)
        }
        SceneSource::File(path) => Arc::new(import(path, report)?),
    };
    goes_on("building the ray tree")?;
    let tracer = Arc::new(Tracer::new(scene));
    goes_on("ready")?;
    Ok(tracer)
}

/// An embedded scene; a plain room stands in for the default one as long as the engine has none.
fn embedded(name: &str) -> Result<Scene, SceneError> {
    match builtin::build(name) {
        Err(SceneError::UnknownBuiltin { .. }) if builtin::NAMES.contains(&name) => stand_in::room(name),
        built => built,
    }
}

/// Reads a model.
fn import(path: &std::path::Path, report: Report<'_>) -> Result<Scene, SceneError> {
    report("reading", Some(0.0));
    let remedy = "check the path".to_owned();
    std::fs::read(path)
        .map_err(|error| error.to_string())
        .and(Err("this version reads no models yet".to_owned()))
        .map_err(|cause| SceneError::Read { file: path.to_owned(), cause, remedy })
}
