//! Watching the files of a model.

use crate::window::rendering::{Task, TaskError, Wake, locked, spawn_task};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::{Duration, SystemTime};

/// Interval at which the files of a model are checked.
const INTERVAL: Duration = Duration::from_secs(1);

/// Time at which a file was written, and its length in bytes.
type Stamp = Option<(SystemTime, u64)>;

/// Stamps of the files of a model.
type Stamps = Vec<(PathBuf, Stamp)>;

/// The files that the program itself has written: they are no reason to load a model again.
#[derive(Clone, Default)]
pub(super) struct OwnWrites(Arc<Mutex<Stamps>>);

impl OwnWrites {
    /// Writes a file; `write` returns its path. Meanwhile no watch looks at files.
    pub(super) fn write<E>(&self, write: impl FnOnce() -> Result<PathBuf, E>) -> Result<PathBuf, E> {
        let mut written = locked(&self.0);
        let path = write()?;
        written.retain(|(p, _)| *p != path);
        written.push((path.clone(), stamp(&path)));
        Ok(path)
    }

    /// Returns the stamps of a model's files. Those that the program has written are entered in
    /// `known`.
    fn stamps(&self, model: &Path, known: &mut Stamps) -> Stamps {
        let written = locked(&self.0);
        let now = stamps(model);
        for own in now.iter().filter(|file| written.contains(file)) {
            known.retain(|(path, _)| *path != own.0);
            known.push(own.clone());
        }
        known.sort();
        now
    }
}

/// Starts a task that ends with the model's path when one of its files has changed and then has
/// stayed the same for an interval: programs do not write a file in one step.
pub(super) fn watch(model: PathBuf, own: OwnWrites, wake: Wake) -> Task<PathBuf> {
    let mut known = stamps(&model);
    spawn_task("watch", wake, move |task| {
        let mut is_changing = false;
        while !task.is_cancelled() {
            std::thread::sleep(INTERVAL);
            let now = own.stamps(&model, &mut known);
            let has_changed = std::mem::replace(&mut known, now) != known;
            if is_changing && !has_changed {
                return Ok(model);
            }
            is_changing = has_changed;
        }
        Err(TaskError::Cancelled)
    })
}

fn stamp(path: &Path) -> Stamp {
    let data = std::fs::metadata(path).ok()?;
    Some((data.modified().ok()?, data.len()))
}

/// Returns when a file was written last.
pub(super) fn modified(path: &Path) -> Option<SystemTime> {
    std::fs::metadata(path).and_then(|m| m.modified()).ok()
}

/// Returns the stamps of the model itself, its sidecar, and the material libraries and buffers in
/// its folder.
fn stamps(model: &Path) -> Stamps {
    let folder = model.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let entries = std::fs::read_dir(folder).into_iter().flatten().filter_map(|e| e.ok().map(|e| e.path()));
    let sidecar = model.with_extension("afterimage.toml");
    let is_part = |p: &PathBuf| {
        let is_library = p.extension().is_some_and(|e| e.eq_ignore_ascii_case("mtl") || e == "bin");
        p.file_name() == model.file_name() || is_library || p.file_name() == sidecar.file_name()
    };
    let mut files: Stamps = entries.filter(is_part).map(|p| (p.clone(), stamp(&p))).collect();
    files.sort();
    files
}
