//! The session that is kept in case of a crash.

use super::{EXTENSION, SessionFile, modified};
use crate::window::rendering::{Task, TaskError, Wake, spawn_task, take_result};
use crate::window::state::{AppState, Quality};
use afterimage::Camera;
use afterimage::raster::save::write_atomically;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use sysinfo::{Pid, ProcessRefreshKind, ProcessesToUpdate, System};

/// Interval at which the session is kept where only the camera has moved.
const CAMERA_INTERVAL: Duration = Duration::from_secs(20);

/// Shortest time between two writes after changes of the document or of the settings.
const CHANGE_INTERVAL: Duration = Duration::from_secs(1);

/// Beginning of the names of kept sessions; the number of the process follows.
const RECOVERY: &str = "recovery-";

/// The session as it was kept last.
#[derive(Default)]
pub(super) struct Autosave {
    camera: Option<Camera>,
    /// Revision of the document, and the settings.
    content: Option<(u64, Quality)>,
    at: Option<Instant>,
    task: Option<Task<()>>,
}

impl Autosave {
    /// True where the session is to be kept now; and the time until the next one where something
    /// has changed meanwhile.
    pub(super) fn due(&mut self, state: &AppState) -> (bool, Option<Duration>) {
        let Some(document) = &state.document else { return (false, None) };
        let (camera, content) = (*state.navigation.fly.camera(), (document.revision(), state.quality));
        let since = self.at.get_or_insert_with(Instant::now).elapsed();
        // What was loaded is not a change.
        let interval = if *self.content.get_or_insert(content) != content {
            CHANGE_INTERVAL
        } else if self.camera != Some(camera) {
            CAMERA_INTERVAL
        } else {
            return (false, None);
        };
        let rest = interval.saturating_sub(since);
        if !rest.is_zero() || self.task.is_some() {
            return (false, Some(rest.max(SHORTEST_WAIT)));
        }
        (self.camera, self.content, self.at) = (Some(camera), Some(content), Some(Instant::now()));
        (true, None)
    }

    /// Keeps a session in the background.
    pub(super) fn keep(&mut self, session: SessionFile, folder: PathBuf, wake: Wake) {
        self.task = Some(spawn_task("recovery", wake, move |_| keep_session(&session, &folder)));
    }

    /// Returns the result of keeping the session, once.
    pub(super) fn finished(&mut self) -> Option<Result<(), TaskError>> {
        take_result(&mut self.task)
    }

    /// Waits until nothing is being written.
    pub(super) fn wait(&mut self) {
        if let Some(task) = self.task.take() {
            task.cancel_and_wait();
        }
    }
}

/// Time after which it is looked again whether the last session is written.
const SHORTEST_WAIT: Duration = Duration::from_millis(100);

/// Writes a session for the case of a crash.
///
/// # Errors
/// A message for the user.
pub(super) fn keep_session(session: &SessionFile, folder: &Path) -> Result<(), TaskError> {
    let text = session.text(None).map_err(TaskError::failed)?;
    std::fs::create_dir_all(folder).map_err(|error| {
        TaskError::Failed(format!("cannot make the folder {}: {error}", folder.display()))
    })?;
    write_atomically(&recovery_file(folder), text.as_bytes()).map_err(TaskError::failed)
}

/// File in which this process keeps its session.
pub(super) fn recovery_file(folder: &Path) -> PathBuf {
    folder.join(format!("{RECOVERY}{}.{EXTENSION}", std::process::id()))
}

/// True for the names of kept sessions.
pub(super) fn is_recovery(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(RECOVERY))
}

/// Returns the newest session of a process that has ended without removing it.
pub(super) fn left_behind(folder: &Path) -> Option<PathBuf> {
    let entries = std::fs::read_dir(folder).ok()?.filter_map(|e| e.ok().map(|e| e.path()));
    let is_orphan = |path: &PathBuf| {
        let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        let id = name.strip_prefix(RECOVERY).and_then(|n| n.strip_suffix(&format!(".{EXTENSION}")));
        id.and_then(|id| id.parse().ok()).is_some_and(|id: u32| !is_running(id))
    };
    entries.filter(is_orphan).max_by_key(|path| modified(path))
}

fn is_running(process: u32) -> bool {
    let id = Pid::from_u32(process);
    // Where the system does not say, two windows may offer each other's sessions; this loses nothing.
    System::new().is_ok_and(|mut system| {
        let what = ProcessRefreshKind::nothing();
        system.refresh_processes_specifics(ProcessesToUpdate::Some(&[id]), true, what);
        system.process(id).is_some()
    })
}
