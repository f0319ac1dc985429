//! Watching the files of a model.

use crate::window::rendering::{Task, TaskError, Wake, spawn_task};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

/// Interval at which the files of a model are checked.
const INTERVAL: Duration = Duration::from_secs(1);

/// Times at which the files of a model were written.
type Stamps = Vec<(PathBuf, Option<SystemTime>)>;

/// Starts a task that ends with the model's path when one of its files has changed and then has
/// stayed the same for an interval: programs do not write a file in one step.
pub(super) fn watch(model: PathBuf, wake: Wake) -> Task<PathBuf> {
    let mut known = stamps(&model);
    spawn_task("watch", wake, move |task| {
        let mut is_changing = false;
        while !task.is_cancelled() {
            std::thread::sleep(INTERVAL);
            let now = stamps(&model);
            let has_changed = std::mem::replace(&mut known, now) != known;
            if is_changing && !has_changed {
                return Ok(model);
            }
            is_changing = has_changed;
        }
        Err(TaskError::Cancelled)
    })
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
    let mut files: Stamps = entries.filter(is_part).map(|p| (p.clone(), modified(&p))).collect();
    files.sort();
    files
}
