//! The session that is kept in case of a crash.

use super::{EXTENSION, SessionFile, modified};
use crate::window::state::AppState;
use afterimage::Camera;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use toml::Table;

/// Interval at which the session is kept.
const INTERVAL: Duration = Duration::from_secs(20);

/// Beginning of the names of kept sessions; the number of the process follows.
const RECOVERY: &str = "recovery-";

/// The session as it was kept last.
#[derive(Debug)]
pub(super) struct Autosave {
    text: String,
    camera: Option<Camera>,
    at: Instant,
}

impl Default for Autosave {
    fn default() -> Self {
        Self { text: String::new(), camera: None, at: Instant::now() }
    }
}

impl Autosave {
    /// Returns the text of a session that is to be kept now, and the time until the next one where
    /// the camera has moved meanwhile.
    pub(super) fn due(&mut self, state: &AppState, unknown: &Table) -> (Option<String>, Option<Duration>) {
        let camera = *state.navigation.fly.camera();
        let rest = INTERVAL.saturating_sub(self.at.elapsed());
        if !rest.is_zero() {
            return (None, (self.camera != Some(camera)).then_some(rest));
        }
        (self.camera, self.at) = (Some(camera), Instant::now());
        let text = SessionFile::of(state, unknown).and_then(|session| session.text().ok());
        let text = text.filter(|text| *text != self.text);
        if let Some(text) = &text {
            self.text.clone_from(text);
        }
        (text, None)
    }
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
    // On other systems, two windows may offer each other's sessions; this loses nothing.
    cfg!(target_os = "linux") && Path::new("/proc").join(process.to_string()).exists()
}
