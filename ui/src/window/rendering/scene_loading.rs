//! Loading a scene off the window's thread: the one place that knows where scenes come from.

use super::{Progress, Task, TaskError, TaskHandle, Wake, spawn_activity};
use afterimage::Tracer;
use afterimage::import;
use afterimage::import::{AppliedEdit, DaylightOptions, ImportOptions, Phase};
use afterimage::raster::exposure::Exposure;
use afterimage::scene::{GroundChoice, Scene, SceneError, builtin};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Where a scene is loaded from.
#[derive(Clone, Debug)]
pub enum SceneSource {
    /// An embedded scene, by its name without `builtin:`.
    Builtin(String),
    /// A model file that is imported.
    File {
        /// Path of the model file.
        path: PathBuf,
        /// How the file is imported.
        options: ImportOptions,
    },
    /// A scene that is in memory already.
    Ready(Arc<Scene>),
}

impl SceneSource {
    /// The embedded scene that is shown by default.
    pub fn default_builtin() -> Self {
        Self::Builtin(builtin::NAMES.first().copied().unwrap_or("gallery").to_owned())
    }

    /// A model file with default import options.
    pub fn file(path: impl Into<PathBuf>) -> Self {
        Self::File { path: path.into(), options: ImportOptions::default() }
    }

    /// The scene of a name of the command line: `builtin:NAME` or a path.
    pub fn named(name: &str, options: ImportOptions) -> Self {
        match name.strip_prefix("builtin:") {
            Some(builtin) => Self::Builtin(builtin.to_owned()),
            None => Self::File { path: name.into(), options },
        }
    }

    /// The name that the user knows, as the command line writes it.
    pub fn label(&self) -> String {
        match self {
            Self::Builtin(name) => format!("builtin:{name}"),
            Self::File { path, .. } => path.display().to_string(),
            Self::Ready(scene) => scene.name.clone(),
        }
    }

    /// True where both are the same embedded scene, file or scene in memory.
    pub fn is_same(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Builtin(a), Self::Builtin(b)) => a == b,
            (Self::File { path: a, .. }, Self::File { path: b, .. }) => a == b,
            (Self::Ready(a), Self::Ready(b)) => Arc::ptr_eq(a, b),
            _ => false,
        }
    }
}

/// Makes the edit that a session holds of a scene, on the thread that loads it: the edit may name a
/// picture of the sky.
pub(crate) type ReadEdit = Box<dyn FnOnce(&Scene) -> AppliedEdit + Send>;

/// A scene that was loaded, ready for rays.
pub(crate) struct LoadedScene {
    pub(crate) tracer: Arc<Tracer>,
    /// What the session of the scene makes of it, where it has one.
    pub(crate) edit: Option<AppliedEdit>,
}

/// A scene that is being loaded. Dropping it cancels loading without waiting: a phase that cannot
/// be interrupted would hold up the window.
pub(crate) struct Loading {
    pub(crate) source: SceneSource,
    task: Task<LoadedScene>,
}

impl Loading {
    /// Starts loading on a thread of its own. `daylight` replaces that of the scene.
    pub(crate) fn start(
        source: SceneSource,
        daylight: DaylightOptions,
        edit: Option<ReadEdit>,
        wake: Wake,
    ) -> Self {
        let wanted = source.clone();
        let activity = format!("{}: loading", source.label());
        let work = move |task: &TaskHandle| with_edit(load(&wanted, &daylight, task)?, edit, task);
        Self { source, task: spawn_activity("load", &activity, wake, work) }
    }

    /// Reads the edit of a session once more, for a scene that was loaded.
    pub(crate) fn again(source: SceneSource, tracer: Arc<Tracer>, edit: ReadEdit, wake: Wake) -> Self {
        let activity = format!("{}: reading its session", source.label());
        let work = move |task: &TaskHandle| with_edit(tracer, Some(edit), task);
        Self { source, task: spawn_activity("load", &activity, wake, work) }
    }

    /// Returns the progress of loading.
    pub(crate) fn progress(&self) -> Progress {
        self.task.progress()
    }

    /// Returns the scene, ready for rays, once it is loaded.
    pub(crate) fn result(&self) -> Option<Result<LoadedScene, TaskError>> {
        self.task.result()
    }
}

fn with_edit(
    tracer: Arc<Tracer>,
    edit: Option<ReadEdit>,
    task: &TaskHandle,
) -> Result<LoadedScene, TaskError> {
    task.begin("reading its session")?;
    let edit = edit.map(|read| read(tracer.scene()));
    task.begin("ready")?;
    Ok(LoadedScene { tracer, edit })
}

fn load(
    source: &SceneSource,
    daylight: &DaylightOptions,
    task: &TaskHandle,
) -> Result<Arc<Tracer>, TaskError> {
    let scene = match source {
        SceneSource::Ready(scene) => scene.clone(),
        SceneSource::Builtin(name) => {
            task.begin("building the scene")?;
            Arc::new(daylight.apply(builtin::build(name).map_err(TaskError::failed)?))
        }
        SceneSource::File { path, options } => {
            // A house without a ground floats in the sky, and its sun casts no shadow.
            let ground = Some(daylight.ground.unwrap_or(GroundChoice::Auto));
            let daylight = DaylightOptions { ground, ..daylight.clone() };
            Arc::new(daylight.apply(import(path, options, task)?))
        }
    };
    task.begin("building the ray tree")?;
    let tracer = Arc::new(Tracer::new(scene).with_start_view());
    if tracer.scene().exposure == Exposure::Auto {
        task.begin("measuring the light")?;
        tracer.measure_light(&|part| task.report("measuring the light", part), &|| task.is_cancelled());
    }
    Ok(tracer)
}

/// Reads a model and reports its phases.
fn import(path: &Path, options: &ImportOptions, task: &TaskHandle) -> Result<Scene, TaskError> {
    let report = |phase: Phase, fraction: f32| {
        task.report(phase.label(), fraction);
        !task.is_cancelled()
    };
    import::load(path, options, &report).map_err(|error| match error {
        SceneError::Cancelled => TaskError::Cancelled,
        error => TaskError::failed(error),
    })
}
